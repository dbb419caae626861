"""Trains a small recurrent network on a flight, and writes it as a NIR graph: has the aircraft rolled one way in the last
0.2 s, the other way, or neither?

    turns.py FLIGHT.csv NETWORK.nir [DIRECTORY]

FLIGHT.csv is data/hexarotor.csv. A rate becomes one spike of 25 inputs, as `--scheme position --neurons 25 --min -1.2
--max 1.2` has it; 32 leaky integrate-and-fire neurons lead to each other, and to 3 outputs that never fire. The one
rate of a step says little about 40 steps: what came before must stay in the neurons.

Every third stretch of 250 samples is held out. DIRECTORY gets both parts as tables, for `spikewire network`.

The network is trained as frameworks do it: backpropagation through time, with a smooth slope in the place of the step
with which neurons fire (Neftci, Mostafa and Zenke, 2019). Needs NumPy and nir.
"""

import sys
from pathlib import Path

import nir
import numpy as np

INPUTS, NEURONS, OUTPUTS = 25, 32, 3
STEP = 0.005  # s
TAU, TAU_OUT = 0.050, 0.100  # s
KEEP, KEEP_OUT = 1 - STEP / TAU, 1 - STEP / TAU_OUT
STRETCH = 250  # samples
PAST = 40  # samples that a label looks back
TURNS = 0.06  # rad/s: the mean rate above which the aircraft rolls
ROUNDS = 1500


def read(path):
    """The roll rates that are trained on, and those that are held out."""
    rates = np.loadtxt(path, delimiter=",", skiprows=1, usecols=1)
    stretches = [rates[at : at + STRETCH] for at in range(0, len(rates), STRETCH)]
    held_out = stretches[2::3]
    del stretches[2::3]
    return np.concatenate(stretches), np.concatenate(held_out)


def encode(rates):
    """The input that fires, by step: that of the nearest centre, of which the outermost lie beyond the range."""
    return np.clip(np.ceil((rates + 1.2) / 2.4 * (INPUTS - 2)), 0, INPUTS - 1).astype(int)


def label(rates):
    """0, 1, 2: falls, neither, rises, by the mean of the last rates."""
    sums = np.cumsum(np.concatenate([np.zeros(PAST), rates]))
    means = (sums[PAST:] - sums[:-PAST]) / PAST
    return np.where(means < -TURNS, 0, np.where(means > TURNS, 2, 1))


def run(weights, inputs):
    """Potentials, spikes and outputs, by step: for inputs of shape (steps, recordings)."""
    first, back, out = weights
    steps, count = inputs.shape
    v, s = np.zeros((steps, count, NEURONS)), np.zeros((steps, count, NEURONS))
    y = np.zeros((steps, count, OUTPUTS))
    before = np.zeros((count, NEURONS)), np.zeros((count, NEURONS)), np.zeros((count, OUTPUTS))
    for t in range(steps):
        v_old, s_old, y_old = before
        v[t] = KEEP * v_old * (1 - s_old) + first[inputs[t]] + s_old @ back
        s[t] = v[t] > 1
        y[t] = KEEP_OUT * y_old + s[t] @ out
        before = v[t], s[t], y[t]
    return v, s, y


def gradients(weights, inputs, labels):
    """The gradient of the loss by each weight."""
    first, back, out = weights
    v, s, y = run(weights, inputs)
    steps, count = inputs.shape
    p = np.exp(y - y.max(axis=2, keepdims=True))
    p /= p.sum(axis=2, keepdims=True)
    wrong = p - np.eye(OUTPUTS)[labels]
    slope = 1 / (1 + 5 * abs(v - 1)) ** 2
    grown = [np.zeros_like(w) for w in weights]
    dv, dy = np.zeros((count, NEURONS)), np.zeros((count, OUTPUTS))
    for t in reversed(range(steps)):
        dy = wrong[t] / count / steps + KEEP_OUT * dy
        # Spikes cost a little: they are what the chip's time goes into.
        ds = dy @ out.T + dv @ back.T + 0.02 / count / steps
        dv = ds * slope[t] + KEEP * dv * (1 - s[t])
        np.add.at(grown[0], inputs[t], dv)
        if t > 0:
            grown[1] += s[t - 1].T @ dv
        grown[2] += s[t].T @ dy
    return grown


def train(rates, random):
    """Weights from inputs, from neurons and to outputs: [from, to]. By Adam."""
    shapes = [(INPUTS, NEURONS, 0.4), (NEURONS, NEURONS, 0.1), (NEURONS, OUTPUTS, 0.3)]
    weights = [random.normal(0, size, (rows, columns)) for rows, columns, size in shapes]
    means = [np.zeros_like(w) for w in weights]
    squares = [np.zeros_like(w) for w in weights]
    for i in range(1, ROUNDS + 1):
        # Stretches that begin elsewhere each time, of rates that are larger or smaller and have the other sign.
        starts = random.integers(0, len(rates) - STRETCH, 12)
        steps = starts[None, :] + np.arange(STRETCH)[:, None]
        changed = rates * random.choice([-1, 1]) * random.uniform(0.7, 1.4)
        inputs, labels = encode(changed), label(changed)
        rate = 0.01 * (1 - i / (ROUNDS + 1))
        for at, g in enumerate(gradients(weights, inputs[steps], labels[steps])):
            means[at] += 0.1 * (g - means[at])
            squares[at] += 0.001 * (g * g - squares[at])
            mean, square = means[at] / (1 - 0.9**i), squares[at] / (1 - 0.999**i)
            weights[at] -= rate * mean / (np.sqrt(square) + 1e-8)
        if i % 300 == 0:
            print(f"round {i}: {accuracy(weights, rates):.1%} of the labels", flush=True)
    return weights


def accuracy(weights, rates):
    _, _, y = run(weights, encode(rates)[:, None])
    return (y[:, 0].argmax(axis=1) == label(rates)).mean()


def write(path, weights):
    first, back, out = (w.T for w in weights)  # NIR has them as [to, from].
    each, every = np.ones(NEURONS), np.ones(OUTPUTS)
    ends = {
        "input": nir.Input({"input": np.array([INPUTS])}),
        "output": nir.Output({"output": np.array([OUTPUTS])}),
    }
    # A spike adds its weight in a step: r makes up for what a step is of a time constant.
    neurons = nir.LIF(
        tau=TAU * each, r=TAU / STEP * each, v_leak=0 * each, v_threshold=each, v_reset=0 * each
    )
    outputs = nir.LI(tau=TAU_OUT * every, r=TAU_OUT / STEP * every, v_leak=0 * every)
    nodes = ends | {
        "first": nir.Linear(first),
        "neurons": neurons,
        "back": nir.Linear(back),
        "out": nir.Linear(out),
        "outputs": outputs,
    }
    chain = ["input", "first", "neurons", "out", "outputs", "output"]
    edges = list(zip(chain, chain[1:])) + [("neurons", "back"), ("back", "neurons")]
    nir.write(path, nir.NIRGraph(nodes, edges))


def main():
    flight, network, *directory = sys.argv[1:]
    parts = dict(zip(["trained", "held_out"], read(flight)))
    weights = train(parts["trained"], np.random.default_rng(1))
    write(network, weights)
    for name, rates in parts.items():
        inputs, labels = encode(rates), label(rates)
        _, s, _ = run(weights, inputs[:, None])
        share, most = accuracy(weights, rates), np.bincount(labels).max() / len(labels)
        print(
            f"{name}: {share:.1%} of {len(labels)} labels, {most:.1%} have the commonest; "
            f"{int(s.sum())} spikes"
        )
        for place in directory:
            rows = (f"{at / 200:.3f},{rate!r}\n" for at, rate in enumerate(rates.tolist()))
            Path(place, f"{name}.csv").write_text("time_s,gyro_x\n" + "".join(rows))


if __name__ == "__main__":
    main()
