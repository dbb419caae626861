"""Trains a network of 6, 16 and 3 leaky neurons in ordinary arithmetic, with no chip in mind.

    plain.py FLIGHT.csv NETWORK.json

FLIGHT.csv is data/hexarotor.csv; its first half is trained on. Inputs, labels and the loss are those of
bindings/python/examples/on_chip.py, which trains in tinyODIN's arithmetic. Needs NumPy.
"""

import json
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[4] / "bindings/python/examples"))
import on_chip

KEEP, STRETCH, BATCH, ROUNDS = 0.9, 200, 16, 400


def run(weights, inputs):
    layers = []
    for own in weights:
        reached = np.zeros((*inputs.shape[:2], own.shape[1]))
        fired, potentials = np.zeros_like(reached), np.zeros_like(reached[0])
        for t, driven in enumerate(inputs @ own):
            reached[t] = KEEP * potentials + driven
            fired[t] = reached[t] > 1
            potentials = reached[t] * (1 - fired[t])
        layers.append((reached, fired))
        inputs = fired
    return layers


def gradients(weights, inputs, labels):
    (hidden, sent), (outs, told) = run(weights, inputs)
    (steps, count), wrong = labels.shape, on_chip.blame(told, labels)
    slope = [1 / (1 + 3 * abs(v - 1)) ** 2 for v in (hidden, outs)]
    grown = [np.zeros_like(own) for own in weights]
    dcount, dout, dhidden = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros((count, 16))
    for t in reversed(range(steps)):
        dcount = wrong[t] + on_chip.FORGET * dcount
        dout = dcount * slope[1][t] + dout * (1 - told[t]) * KEEP
        grown[1] += sent[t].T @ dout
        back = dout @ weights[1].T + 0.01 / count / steps
        dhidden = back * slope[0][t] + dhidden * (1 - sent[t]) * KEEP
        grown[0] += inputs[t].T @ dhidden
    return grown


def main():
    flight, network = sys.argv[1:]
    rates = np.loadtxt(flight, delimiter=",", skiprows=1, usecols=(1, 2, 3))
    inputs, labels = on_chip.encode(rates), on_chip.label(rates[:, 0])
    half, random = len(inputs) // 2, np.random.default_rng(1)
    weights = [random.normal(0.1, 0.4, shape) for shape in ((6, 16), (16, 3))]
    means, squares = [[np.zeros_like(own) for own in weights] for _ in range(2)]
    for i in range(1, ROUNDS + 1):
        starts = random.integers(0, half - STRETCH, BATCH)
        steps = starts[None] + np.arange(STRETCH)[:, None]
        for at, grown in enumerate(gradients(weights, inputs[steps], labels[steps])):
            means[at] += 0.1 * (grown - means[at])
            squares[at] += 0.001 * (grown * grown - squares[at])
            rate = 0.01 * (1 - i / (ROUNDS + 1)) / (1 - 0.9**i)
            weights[at] = weights[at] - rate * means[at] / (np.sqrt(squares[at] / (1 - 0.999**i)) + 1e-8)
    layers = [
        {"name": name, "weights": own.T.round(3).tolist(), "keep": KEEP, "threshold": 1.0}
        for name, own in zip(("hidden", "outputs"), weights)
    ]
    Path(network).write_text(json.dumps({"layers": layers}) + "\n")


if __name__ == "__main__":
    main()
