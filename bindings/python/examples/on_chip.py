"""Trains a network of 6, 16 and 3 neurons in tinyODIN's arithmetic, so that the chip does what was trained.

    on_chip.py FLIGHT.csv NETWORK.json

FLIGHT.csv is data/hexarotor.csv; its first half is trained on. Rises and falls of three turn rates come in, as
`--scheme sf --threshold 0.05 --columns gyro_x,gyro_y,gyro_z` has them; which way the aircraft rolled in the last 0.1 s comes
out. Afterwards

    spikewire network NETWORK.json --compare step --scheme sf --threshold 0.05 --columns gyro_x,gyro_y,gyro_z FLIGHT.csv

finds the same numbers for the chip and says in how many steps it agrees. Needs NumPy.

The chip's arithmetic is `step`: weights are whole numbers from -8 to 7, a leak is an amount, and a neuron at its threshold
fires and starts again at 0. What is trained are real numbers beside the weights, of which the chip's are the nearest: the
gradient passes straight through the rounding, and through the step with which a neuron fires by a smooth slope (Neftci,
Mostafa and Zenke, 2019).
"""

import json
import sys

import numpy as np

INPUTS, HIDDEN, OUTPUTS = 6, 16, 3
THRESHOLD, LEAK = 16, 1
SF = 0.05  # rad/s
PAST = 20  # samples that a label looks back
TURNS = 0.05  # rad/s: the mean rate above which the aircraft rolls
STRETCH, BATCH, ROUNDS = 200, 16, 800
FORGET = 0.9  # the share of a spike's count that a step leaves


def step(potentials, driven):
    """A step of tinyODIN's neurons, in whole numbers: potentials before they reset, and whether they fire."""
    kept = np.sign(potentials) * np.maximum(np.abs(potentials) - LEAK, 0)
    reached = np.clip(kept + driven, -2048, 2047)
    return reached, reached >= THRESHOLD


def whole(weights):
    """The chip's weights."""
    return np.clip(np.rint(weights), -8, 7)


def encode(rates):
    """Step-forward: the rises and falls of each axis by step, as `f32` has them."""
    spikes = np.zeros((len(rates), INPUTS))
    size = np.float32(SF)
    for axis, rate in enumerate(rates.T.astype("f4")):
        base = rate[0]
        for at, value in enumerate(rate):
            if value > base + size:
                spikes[at, 2 * axis], base = 1, base + size
            elif value < base - size:
                spikes[at, 2 * axis + 1], base = 1, base - size
    return spikes


def label(rates):
    """0, 1, 2: falls, neither, rises, by the mean of the last rates."""
    sums = np.cumsum(np.concatenate([np.zeros(PAST), rates]))
    means = (sums[PAST:] - sums[:-PAST]) / PAST
    return np.where(means < -TURNS, 0, np.where(means > TURNS, 2, 1))


def run(weights, inputs):
    """For each layer its potentials and spikes, by step: for inputs of shape (steps, recordings, inputs)."""
    layers = []
    for own in map(whole, weights):
        reached = np.zeros((*inputs.shape[:2], own.shape[1]))
        fired = np.zeros_like(reached)
        potentials = reached[0]
        for t, driven in enumerate(inputs @ own):
            reached[t], fired[t] = step(potentials, driven)
            potentials = reached[t] * (1 - fired[t])
        layers.append((reached, fired))
        inputs = fired
    return layers


def blame(told, labels):
    """The gradient of the loss by each output's count of spikes, in each step: cross entropy of the counts, which fade."""
    steps, count = labels.shape
    counts = np.zeros_like(told)
    for t in range(steps):
        counts[t] = FORGET * counts[t - 1] * (t > 0) + told[t]
    p = np.exp(counts - counts.max(axis=2, keepdims=True))
    p /= p.sum(axis=2, keepdims=True)
    return (p - np.eye(OUTPUTS)[labels]) / count / steps


def gradients(weights, inputs, labels):
    """The gradient of the loss by each weight."""
    (hidden, sent), (outs, told) = run(weights, inputs)
    (steps, count), wrong = labels.shape, blame(told, labels)
    slope = [1 / (1 + 3 * abs(v / THRESHOLD - 1)) ** 2 for v in (hidden, outs)]
    grown = [np.zeros_like(own) for own in weights]
    dcount, dout, dhidden = np.zeros((count, OUTPUTS)), np.zeros((count, OUTPUTS)), np.zeros((count, HIDDEN))
    onward = whole(weights[1])
    for t in reversed(range(steps)):
        dcount = wrong[t] + FORGET * dcount
        # A leak of an amount passes a gradient on unless it ends at 0.
        dout = dcount * slope[1][t] + dout * (1 - told[t]) * (abs(outs[t]) > LEAK)
        grown[1] += sent[t].T @ dout
        # Spikes cost a little.
        back = dout @ onward.T + 0.01 / count / steps
        dhidden = back * slope[0][t] + dhidden * (1 - sent[t]) * (abs(hidden[t]) > LEAK)
        grown[0] += inputs[t].T @ dhidden
    return grown


def train(inputs, labels, random):
    """Weights from inputs and from hidden neurons: [from, to]. By Adam."""
    weights = [random.normal(1, 4, (INPUTS, HIDDEN)), random.normal(1, 4, (HIDDEN, OUTPUTS))]
    means, squares = [[np.zeros_like(own) for own in weights] for _ in range(2)]
    for i in range(1, ROUNDS + 1):
        starts = random.integers(0, len(inputs) - STRETCH, BATCH)
        steps = starts[None, :] + np.arange(STRETCH)[:, None]
        rate = 0.1 * (1 - i / (ROUNDS + 1))
        for at, grown in enumerate(gradients(weights, inputs[steps], labels[steps])):
            means[at] += 0.1 * (grown - means[at])
            squares[at] += 0.001 * (grown**2 - squares[at])
            mean, square = means[at] / (1 - 0.9**i), squares[at] / (1 - 0.999**i)
            weights[at] = np.clip(weights[at] - rate * mean / (np.sqrt(square) + 1e-8), -8, 7)
    return [whole(own) for own in weights]


def main():
    flight, network = sys.argv[1:]
    rates = np.loadtxt(flight, delimiter=",", skiprows=1, usecols=(1, 2, 3))
    inputs, labels = encode(rates), label(rates[:, 0])
    half = len(rates) // 2
    weights = train(inputs[:half], labels[:half], np.random.default_rng(1))
    # Potentials are whole numbers: above half a number less is at the threshold.
    layers = [
        {"name": name, "weights": own.T.tolist(), "leak": LEAK, "threshold": THRESHOLD - 0.5}
        for name, own in zip(("hidden", "outputs"), weights)
    ]
    with open(network, "w") as file:
        json.dump({"layers": layers}, file)
    for name, part in (("trained", slice(half)), ("held out", slice(half, None))):
        fired = run(weights, inputs[part, None])[1][1][:, 0]
        print(f"{name}: {int(fired.sum())} spikes in {int(fired.any(axis=1).sum())} of {len(fired)} steps")


if __name__ == "__main__":
    main()
