"""Trains the network of `network_pilot.py` to do what the cascade does, and writes `network.nir`: `network_imitate.py`.

1. The cascade flies at random. What the network hears of it and what the cascade does about it is kept.
2. A layer of neurons with currents (CubaLIF) is laid out as in the Neural Engineering Framework (Eliasmith and Anderson,
   2003): each hears one quantity, in one direction, from a point of its own on. What their spikes are worth to the
   outputs is learnt by least squares.
3. The network flies, the cascade says beside it what it would have done, and that is learnt too (DAgger: Ross, Gordon
   and Bagnell, 2011). Once more from 2.
"""

from __future__ import annotations

from math import exp, pi, sin

import nir
import numpy as np

import flight
from flight import Registers
from manoeuvres import DEGREE, Manoeuvre, flip
from network_pilot import NETWORK, SIGNALS, THRESHOLD, Networked

DT = 1 / flight.RATE
#: Neurons that hold a turn that is left, and those that hold a rate, by axis.
TURNS, RATES = (24, 24, 12), (24, 24, 12)
#: How long a turn is held, s, by axis: roll and pitch as in the cascade's filter, yaw longer, which no force corrects.
HELD = (5.0, 5.0, 100.0)
#: Other time constants, s: low passes of rates; potentials; what the outputs add up, for the fast and the slow ones.
QUICK, MEMBRANE, FAST, SLOW = (0.003, 0.03), 0.02, 0.01, 1.0
#: How much less the slow outputs may weigh.
SLOWLY = 0.05
#: Where a turn and a rate end, rad and rad/s.
FARTHEST, QUICKEST = 1.1, 8.0
#: Wishes are compared through a low pass of so many samples, as motors have one.
LAG = 5
#: Flights of a round, rounds, and the weight of the squares of what is learnt.
FLIGHTS, ROUNDS, RIDGE = 24, 5, 3e-3


class Layout:
    """Hidden neurons: weights by input (20), the decay of each current, what each potential gets in a step."""

    def __init__(self, random, turns=TURNS, rates=RATES):
        weights, decays, biases = [], [], []
        for axis in range(3):
            # Up is positive; the accelerometer says how the drone leans, as in Mahony's filter (`control.TRUST`).
            turn = np.zeros(SIGNALS)
            turn[axis], turn[6 + axis] = -THRESHOLD[axis] * DT, THRESHOLD[6 + axis]
            if axis < 2:
                turn[4 - axis] = (-1 if axis == 0 else 1) * 0.2 / 9.81 * THRESHOLD[3] * DT
            rate = np.zeros(SIGNALS)
            rate[axis] = -THRESHOLD[axis]
            if axis == 0:
                rate[9] = THRESHOLD[9]
            kinds = [(turns[axis], turn, FARTHEST, (HELD[axis],)), (rates[axis], rate, QUICKEST, QUICK)]
            for count, signal, end, taus in kinds:
                for number in range(count):
                    way, decay = (1, -1)[number % 2], exp(-DT / taus[number // 2 % len(taus)])
                    gain = 1 if signal is turn else 1 - decay
                    place = (number // 2 + 0.5) / (count // 2)
                    start = end * (np.sinh(3 * place) / np.sinh(3) * 0.7 - 0.02 - 0.1 * random.random() * place)
                    slope = 0.5 / (end - start) * random.uniform(0.7, 1.4) * (3 if place < 0.5 else 1)
                    weights.append(way * slope * gain * signal)
                    decays.append(decay)
                    biases.append(-slope * start + DT / MEMBRANE)
        signed = np.array(weights).T
        self.weights = np.stack([signed, -signed], axis=1).reshape(2 * SIGNALS, -1)
        self.decays, self.biases = np.array(decays), np.array(biases)
        self.leak = 1 - DT / MEMBRANE


class Plain:
    """The network in double precision."""

    def __init__(self, layout: Layout, worth: np.ndarray | None = None):
        self.layout, self.worth = layout, worth
        self.signed = layout.weights[::2]
        count = len(layout.decays)
        self.currents, self.potentials, self.outputs = np.zeros(count), np.zeros(count), np.zeros(6)
        self.keeps = np.repeat([1 - DT / FAST, 1 - DT / SLOW], 3)

    def hidden(self, counts) -> np.ndarray:
        """The neurons that fire."""
        layout = self.layout
        self.currents = self.currents * layout.decays + counts @ self.signed
        self.potentials = self.potentials * layout.leak + self.currents + layout.biases
        fired = self.potentials > 1
        self.potentials[fired] -= 1
        return fired

    def step(self, counts) -> np.ndarray:
        """The potentials of the outputs."""
        self.outputs = self.outputs * self.keeps + self.hidden(counts) @ self.worth
        return self.outputs


def at_random(seed: int) -> Manoeuvre:
    """Steps and sines of any size up to 40° in roll and pitch, or a flip; a drone that is heavy or has a weak motor."""
    random = np.random.default_rng([seed, 11])
    world = {"mass": random.uniform(1, 1.2), "weak": random.choice([1, random.uniform(0.88, 1)])}
    if seed % 6 == 0:
        return Manoeuvre("flip", 3, flip)
    sizes = random.uniform(-1, 1, (20, 2)) * random.choice([2, 8, 20, 40]) * DEGREE
    rates, share = random.uniform(0.3, 3, 2), random.uniform(0, 1) * (seed % 3 > 0)
    length = random.choice([0.25, 0.5, 1])

    def attitude(time: float):
        roll, pitch = sizes[int(time / length)]
        waves = [share * sin(2 * pi * rate * time) * 12 * DEGREE for rate in rates]
        return roll * (1 - share) + waves[0], pitch * (1 - share) + waves[1], 0.0, 1.0

    return Manoeuvre("at random", 4, attitude, world=world)


def lagged(values: np.ndarray, keep: float = 1 - 1 / LAG) -> np.ndarray:
    """A low pass along the first axis, whose gain is 1."""
    low, out = np.zeros(values.shape[1:]), np.empty(values.shape)
    for at, value in enumerate(values):
        low = low * keep + value * (1 - keep)
        out[at] = low
    return out


def learn(layout: Layout, flights: list) -> np.ndarray:
    """What a spike of each neuron is worth to each output, by least squares."""
    count = len(layout.decays)
    square, product = np.zeros((2 * count, 2 * count)), np.zeros((2 * count, 3))
    wrong = []
    for counts, wishes in flights:
        network = Plain(layout)
        fired = np.array([network.hidden(own) for own in counts], float)
        fast, slow = (lagged(fired, 1 - DT / tau) * tau / DT for tau in (FAST, SLOW))
        features = np.concatenate([fast, slow * SLOWLY], axis=1)
        features, wishes = lagged(features), lagged(wishes)
        square += features.T @ features
        product += features.T @ wishes
        wrong.append((features, wishes))
    square += RIDGE * np.trace(square) / len(square) * np.eye(2 * count)
    worth = np.linalg.solve(square, product)
    errors = np.concatenate([wishes - features @ worth for features, wishes in wrong])
    print("  wishes", np.concatenate([w for _, w in wrong]).std(0).round(1), "off", errors.std(0).round(2), flush=True)
    return np.concatenate([worth[:count], worth[count:] * SLOWLY], axis=1)


def watched(make, seeds) -> list[tuple]:
    """Flights on a network, or on the cascade: counts of spikes, and the cascade's wishes."""
    rows = []
    for seed in seeds:
        control = Networked(flight.RATE, make and make())
        flown = flight.fly(at_random(seed), Registers(), seed, control=control)
        counts, teacher, _ = zip(*control.heard)
        rows.append((np.array(counts), np.clip(np.array(teacher, float), -900, 900)))
        if flown.lost:
            print(f"  seed {seed} is lost after {flown.seconds:.1f} s")
    return rows


def train(layout: Layout) -> np.ndarray:
    data, make, worth = [], None, None
    for number in range(ROUNDS):
        data += watched(make, range(FLIGHTS * number, FLIGHTS * (number + 1)))
        print(f"round {number + 1}: {len(data)} flights", flush=True)
        worth = learn(layout, data)
        make = lambda worth=worth: Plain(layout, worth)
    return worth


def write(layout: Layout, worth: np.ndarray) -> None:
    """The network as a graph, whose currents decay by Euler's step as the controller's do."""
    count, one = len(layout.decays), np.ones
    neurons = nir.CubaLIF(
        tau_syn=DT / (1 - layout.decays),
        tau_mem=MEMBRANE * one(count),
        r=MEMBRANE / DT * one(count),
        v_leak=layout.biases * MEMBRANE / DT,
        v_threshold=one(count),
        w_in=1 / (1 - layout.decays),
    )
    nodes = {
        "input": nir.Input({"input": np.array([2 * SIGNALS])}),
        "heard": nir.Linear(layout.weights.T.astype(np.float32)),
        "neurons": neurons,
        "worth": nir.Linear(worth.T.astype(np.float32)),
        "wishes": nir.LI(
            tau=np.repeat([FAST, SLOW], 3), r=np.repeat([FAST, SLOW], 3) / DT, v_leak=np.zeros(6)
        ),
        "output": nir.Output({"output": np.array([6])}),
    }
    nir.write(NETWORK, nir.NIRGraph(nodes, list(zip(nodes, list(nodes)[1:]))))


def main() -> None:
    layout = Layout(np.random.default_rng(1))
    write(layout, train(layout))


if __name__ == "__main__":
    main()
