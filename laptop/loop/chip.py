"""A chip in the loop: roll and pitch rates are controlled by a spiking network on tinyODIN's model, clock by clock.

The wheel's position code makes the network's inputs: a spike says the rate of an axis, another the turn that is wanted.
Spikes come back; those of the first half of an axis' neurons push one way, those of the second the other. Mahony's filter,
attitude, yaw and mixer stay the cascade's.

`chip.py SPIKEWIRE` brings the network of `rate.nir` onto the chip by the laptop's program, flies all manoeuvres on it and prints
a table.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import nir
import numpy as np
import spikewire as sw

import control
import flight
from codes import Coded, schemes
from control import RATE, Control, F
from manoeuvres import ALL, LESSON

#: What `imitate.py` has written.
NETWORK = Path(__file__).with_name("rate.nir")

AXES = 2
#: Centres of a position: rad/s, dense about 0.
CENTRES, RANGE = 63, 19.0
#: Inputs of an axis: the rate's, then those of the turn that is wanted.
INPUTS = 2 * CENTRES
#: Neurons of an axis.
NEURONS = 32
#: What a spike of the network is worth, rad/s².
WORTH = 60.0

#: Neurons that return to 0, compare after each event, as they were trained, and are tuned on the whole lesson.
HOW = "--live --reset zero --compare spike --no-held-out".split()

POSITION = sw.Position(centres=(np.sinh(np.linspace(-3, 3, CENTRES)) / np.sinh(3) * RANGE).tolist())


def events(rates, turns) -> list[list[int]]:
    """What the chip hears of a sample, an event after the other: the rates, then the turns. A neuron hears one at a time."""
    spikes = POSITION.encoder().encode(np.concatenate([rates[:AXES], turns[:AXES]])).argmax(axis=1).tolist()
    return [[axis * INPUTS + kind * CENTRES + spikes[kind * AXES + axis] for axis in range(AXES)] for kind in range(2)]


class Plain:
    """The network in whole numbers, as it was trained: neurons that add up and start again at 0. Nothing of the chip's."""

    def __init__(self, weights: np.ndarray, threshold: int):
        self.weights, self.threshold = weights, threshold
        self.potentials = np.zeros(weights.shape[1])

    def step(self, events: list[list[int]]) -> np.ndarray:
        """How often each neuron fires in a sample."""
        fired = np.zeros(len(self.potentials), int)
        for event in events:
            self.potentials = np.maximum(self.potentials + self.weights[event].sum(axis=0), -2048)
            fires = self.potentials >= self.threshold
            self.potentials[fires] = 0
            fired += fires
        return fired


class Chip:
    """The network on tinyODIN's model, in a process of its own: an event in, the neurons that fire out."""

    def __init__(self, program: str, lesson: list[list[int]]):
        nodes = nir.read(NETWORK).nodes
        self._plain = Plain(nodes["weights"].weight.T, nodes["neurons"].v_threshold)
        with tempfile.NamedTemporaryFile("w", suffix=".txt") as steps:
            steps.writelines(line(event) for event in lesson)
            steps.flush()
            command = [program, "network", str(NETWORK), steps.name, *HOW]
            self._process = subprocess.Popen(
                command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
            )
            # The answer to nothing at all: by then the recording is read.
            self.clocks: list[int] = []
            self.step([[]])
        self.clocks.clear()

    def step(self, events: list[list[int]]) -> np.ndarray:
        """How often each neuron fires in a sample."""
        fired, clocks = np.zeros(AXES * NEURONS, int), 0
        for event in events:
            self._process.stdin.write(line(event))
            self._process.stdin.flush()
            answer = self._process.stdout.readline().split()
            if not answer:
                raise SystemExit(f"the chip ended: {self._process.stderr.read()}")
            clocks += int(answer[0])
            np.add.at(fired, [int(own) for own in answer[1:]], 1)
        self.clocks.append(clocks)
        if not np.array_equal(fired, self._plain.step(events)):
            raise SystemExit(f"sample {len(self.clocks)}: the chip fires otherwise than the network that was trained")
        return fired

    def end(self) -> str:
        """Ends the process, and returns what it has said of the network."""
        return self._process.communicate()[1]


def line(event: list[int]) -> str:
    """An event for the program."""
    return " ".join(map(str, event)) + "\n"


class Chipped(Control):
    """The cascade, whose rates of roll and pitch a network controls.

    `heard` keeps, by sample, rates, turns and what the cascade would have done about them, but for its derivative and its
    integral: the network has no memory for these.
    """

    def __init__(self, network=None):
        super().__init__(flight.RATE)
        self.network, self.fired = network, 0
        self.heard: list[list[float]] = []

    def _wishes(self, rates, turns):
        wishes = super()._wishes(rates, turns)
        pushes = [RATE[axis] * (turns[axis] - rates[axis]) for axis in range(AXES)]
        self.heard.append([*rates[:AXES], *turns[:AXES], *pushes])
        if self.network is None:
            return wishes
        fired = self.network.step(events(rates, turns))
        self.fired += int(fired.sum())
        halves = fired.reshape(AXES, 2, -1).sum(axis=2)
        return [*(F(WORTH * int(up - down)) for up, down in halves), wishes[2]]


def lesson() -> list[list[int]]:
    """The events of a flight on the cascade, on which the chip's numbers are found."""
    teacher = Chipped()
    flight.fly(LESSON, Coded(schemes("sod")), seed=1000, control=teacher)
    return [event for heard in teacher.heard for event in events(heard[:AXES], heard[AXES : 2 * AXES])]


def flown(make) -> list[flight.Flight]:
    """All manoeuvres on the spikes of send-on-delta, with a controller that `make` makes for each."""
    seeds = enumerate(ALL, start=100)
    return [flight.fly(manoeuvre, Coded(schemes("sod")), seed, control=make()) for seed, manoeuvre in seeds]


def main(program: str) -> None:
    cascade = flown(lambda: Control(flight.RATE))
    kept = control.INTEGRAL, control.DERIVATIVE
    control.INTEGRAL, control.DERIVATIVE = ([own[yaw] if yaw == 2 else F(0) for yaw in range(3)] for own in kept)
    part = flown(lambda: Control(flight.RATE))
    control.INTEGRAL, control.DERIVATIVE = kept

    chip, all_chipped = Chip(program, lesson()), []

    def chipped() -> Chipped:
        all_chipped.append(Chipped(chip))
        return all_chipped[-1]

    on_chip = flown(chipped)
    said = chip.end()
    print(said, file=sys.stderr)

    print("| mean error, ° | cascade | its proportional part alone | the chip | worst on the chip |\n|---|---:|---:|---:|---:|")
    for manoeuvre, *flights in zip(ALL, cascade, part, on_chip):
        errors = ["lost" if own.lost else f"{own.errors.mean():.1f}" for own in flights]
        print(f"| {manoeuvre.name} | {' | '.join(errors)} | {flights[-1].errors.max():.0f} |")
    means = [np.mean([own.errors.mean() for own in way if not own.lost]) for way in (cascade, part, on_chip)]
    worst = max(own.errors.max() for own in on_chip)
    print(f"| **all** | {' | '.join(f'{mean:.1f}' for mean in means)} | {worst:.0f} |\n")
    samples, clocks = len(chip.clocks), np.array(chip.clocks)
    heard = 2 * AXES
    agreement = next(own for own in said.splitlines() if own.startswith("outputs agree"))
    print(
        f"A sample is {heard} spikes in, {heard * AXES * NEURONS} synaptic operations and {sum(c.fired for c in all_chipped) / samples:.1f} "
        f"spikes out, in {clocks.mean():.0f} of the chip's clocks, {clocks.max()} at most. The network as trained and on the chip: "
        f"{agreement}; of the flights above, in all {samples} samples."
    )


if __name__ == "__main__":
    main(sys.argv[1])
