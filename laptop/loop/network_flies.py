"""Flies all manoeuvres on the network of `network.nir`, five times each, and prints a table: `network_flies.py SPIKES`.

The network is the controller's, bit for bit: `spikewire.Network`. What it hears of a flip goes into the file, a line a sample.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import spikewire as sw

import flight
from control import Control
from flight import Registers
from manoeuvres import ALL, Manoeuvre, eight, still
from network_pilot import MOST, NETWORK, REFERENCE, RULE, SIGNALS, THRESHOLD, Encoder, Networked, inputs

SEEDS = range(100, 105)
#: Flown once.
LONG = [Manoeuvre("hover, 60 s", 60, path=still), Manoeuvre("eight, 60 s", 60, path=eight)]


class Flown:
    """The network at rest, as :class:`Networked` takes it; counts what comes in and fires."""

    heard: list[list[int]] = []
    fired: list[int] = []

    def __init__(self):
        self.network = sw.Network.from_nir(NETWORK, **RULE)

    def step(self, counts: np.ndarray) -> np.ndarray:
        numbers = inputs(counts)
        potentials = self.network.step(numbers)
        self.heard.append(numbers)
        self.fired.append(len(self.network.fired[0]))
        return potentials


def check(threshold: np.ndarray = THRESHOLD, most: int = MOST) -> None:
    """The encoders of `network_pilot.py` are the crate's, spike by spike."""
    signals = np.random.default_rng(1).normal(size=(500, SIGNALS)).astype(np.float32) * 3 * threshold + REFERENCE
    encoder, counts = Encoder(threshold, most), []
    for encoder.signals in signals:
        counts.append(encoder.fire())
    for own, signal, worth, reference in zip(np.transpose(counts), signals.T, threshold, REFERENCE):
        code = sw.IntegrateAndFire(threshold=float(worth), reference=float(reference), power=8, spikes=most)
        if not np.array_equal(code.encode(signal).array.sum(axis=(1, 2)), own):
            raise SystemExit("the encoders are not the crate's")


def flown(manoeuvre: Manoeuvre, make) -> list[flight.Flight]:
    """The manoeuvre with each seed, or a long one with the first."""
    seeds = SEEDS if manoeuvre in ALL else SEEDS[:1]
    return [flight.fly(manoeuvre, Registers(), seed, control=make()) for seed in seeds]


def mean(flights: list[flight.Flight]) -> float:
    return float(np.mean([own.errors.mean() for own in flights if not own.lost]))


def main(spikes: str) -> None:
    check()
    print("| mean error, ° | cascade | the network | worst | lost |\n|---|---:|---:|---:|---:|")
    means, lost = [], 0
    for manoeuvre in ALL + LONG:
        cascade, before = flown(manoeuvre, lambda: Control(flight.RATE)), len(Flown.heard)
        network = flown(manoeuvre, lambda: Networked(flight.RATE, Flown()))
        row, own_lost = (mean(cascade), mean(network)), sum(own.lost for own in network)
        worst = max(own.errors.max() for own in network)
        print(f"| {manoeuvre.name} | {row[0]:.1f} | {row[1]:.1f} | {worst:.0f} | {own_lost} of {len(network)} |", flush=True)
        if manoeuvre.name == "flip":
            lines = [" ".join(map(str, heard)) for heard in Flown.heard[before:][: round(manoeuvre.seconds * flight.RATE)]]
            Path(spikes).write_text("\n".join(lines) + "\n")
        if manoeuvre in ALL:
            means.append(row)
            lost += own_lost
    (cascade, network), flights = np.mean(means, axis=0), len(ALL) * len(SEEDS)
    print(f"| **the ten** | {cascade:.1f} | {network:.1f} | | {lost} of {flights} |\n")
    (neurons, _), heard = sw.Network.from_nir(NETWORK, **RULE).layers, [len(own) for own in Flown.heard]
    print(
        f"{neurons} neurons fly with {network / cascade:.2f} of the cascade's error. In a sample {np.mean(heard):.1f} spikes come in, "
        f"{max(heard)} at most, and {np.mean(Flown.fired):.1f} neurons fire."
    )


if __name__ == "__main__":
    main(sys.argv[1])
