"""A chip in the loop: a spiking network on tinyODIN's model, clock by clock, holds attitude, rates and yaw of a drone.

Six inertial channels and what is wanted come in as spikes of integrate-and-fire, one event after the other. What comes out
is added up, each spike by what its neuron is worth: three angular accelerations for the mixer. Nothing else knows an attitude.

`chip.py SPIKEWIRE` brings the network of `attitude.nir` onto the chip by the laptop's program, flies all manoeuvres on it and
prints a table. `chip.py` alone flies the graph in whole numbers with other seeds, in the other world, with other vibration and
losses.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import nir
import numpy as np
from numba import njit

import flight
from attitude import ACCEL, ASK, DT, FADE, FAR, GYRO, LEAD, NETWORK, NEARBY, RATE, START, STEP, TURN, WANTED, Layout
from banks import LEVEL
from brushless import Brushless
from control import Control, F
from flight import Registers
from manoeuvres import ALL, Manoeuvre
from network_flies import LONG, Flown, check, mean
from network_pilot import Encoder, Networked
from world import CRAZYFLIE, Drone, World

#: Force times samples, in m/s², by which the accelerometer moves a number by one step: STEP * 9.81 / FADES.
LEAN = 96.0
#: What a spike of each signal is worth, in its unit times a sample.
THRESHOLD = np.array([*(step / DT for step in STEP), LEAN, LEAN, LEAN, *STEP, STEP[0] / DT], np.float32)
#: The most spikes of a signal in a sample.
MOST = 127
#: Each manoeuvre is flown so often.
SEEDS = range(100, 300, 100)

#: Neurons that return to 0 and compare after each event, as they stand in the graph.
HOW = "--live --dt 1 --reset zero --fires above --compare spike --no-held-out".split()


def events(counts: list[int]) -> list[int]:
    """What the chip hears of a sample, an event after the other."""
    heard = []

    def hear(first: int, count: int) -> None:
        heard.extend([first + (count < 0)] * abs(count))

    for axis in range(3):
        hear(GYRO + 2 * axis, counts[axis])
    for axis in range(2):
        hear(ACCEL + 2 * axis, counts[3 + axis])
        far = round(counts[6 + axis] / NEARBY)
        hear(FAR + 2 * axis, far)
        hear(WANTED + 2 * axis, counts[6 + axis] - NEARBY * far)
    hear(WANTED + 4, counts[8])
    hear(LEAD, counts[9])
    return [*heard, ASK, FADE, FADE + 1]


class Network:
    """The committed graph, in whole numbers."""

    def __init__(self):
        self.nodes = nir.read(NETWORK).nodes
        self.inputs = self.nodes["weights"].weight.T.astype(int)
        self.recurrent = self.nodes["recurrent"].weight.T.astype(int)
        self.thresholds = np.ceil(self.nodes["neurons"].v_threshold).astype(int)
        self.worth = self.nodes["worth"].weight
        layout = Layout()
        for own, laid_out in [
            (self.inputs, layout.inputs),
            (self.recurrent, layout.recurrent),
            (self.thresholds, layout.thresholds),
            (self.worth, layout.worth),
        ]:
            if not np.array_equal(own, laid_out):
                raise SystemExit(f"{NETWORK.name} is not what attitude.py lays out")


class Plain:
    """The network as it stands in the graph: neurons that add up and start again at 0. Nothing of the chip's."""

    def __init__(self, network: Network):
        self.network = network
        self.potentials = np.zeros(len(network.thresholds), int)
        self.fired = [self.event(START)]

    def event(self, event: int) -> list[int]:
        """The neurons that fire, in order."""
        own = self.network
        return follow(own.inputs[event], self.potentials, own.thresholds, own.recurrent).tolist()

    def step(self, events: list[int]) -> np.ndarray:
        """How often each neuron fires in a sample."""
        self.fired = [self.event(event) for event in events]
        return counted(self.fired, len(self.potentials))


def counted(fired: list[list[int]], neurons: int) -> np.ndarray:
    return np.bincount([neuron for each in fired for neuron in each], minlength=neurons)


@njit(cache=True)
def follow(row, potentials, thresholds, recurrent):
    """An event, and the spikes that follow, each of which acts on all neurons before the next does."""
    fired = [0 for _ in range(0)]
    done = 0
    while True:
        for neuron in range(len(potentials)):
            potential = min(max(potentials[neuron] + row[neuron], -2048), 2047)
            if potential >= thresholds[neuron]:
                potential = 0
                fired.append(neuron)
            potentials[neuron] = potential
        if done == len(fired):
            return np.array(fired, np.int64)
        row = recurrent[fired[done]]
        done += 1


class Chip:
    """The network on tinyODIN's model, in a process of its own: an event in, the neurons that fire out."""

    #: The clocks of each start and sample of all chips, and the most of an event.
    clocks: list[int] = []
    longest = 0

    def __init__(self, program: str, network: Network):
        self.network, self.plain = network, Plain(network)
        # What spikes are worth is the microcontroller's: the chip gets the graph without it.
        graph = nir.read(NETWORK)
        del graph.nodes["worth"]
        graph.edges = [edge for edge in graph.edges if "worth" not in edge] + [("neurons", "output")]
        graph.nodes["output"] = nir.Output({"output": np.array([len(network.thresholds)])})
        with tempfile.TemporaryDirectory() as place:
            path, lesson = Path(place) / "attitude.nir", Path(place) / "lesson.txt"
            nir.write(path, graph)
            lesson.write_text("".join(f"{event}\n" for event in [START, *range(START)]))
            command = [program, "network", str(path), str(lesson), *HOW]
            self.process = subprocess.Popen(
                command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
            )
            # By the first answer, the files are read.
            self.fired = self.ask([START])
        self.before = len(self.clocks)
        self.compare(self.plain.fired)

    def ask(self, events: list[int]) -> list[list[int]]:
        """The neurons that fire of each event."""
        self.process.stdin.write("".join(f"{event}\n" for event in events))
        self.process.stdin.flush()
        answers = [[int(word) for word in self.process.stdout.readline().split()] for _ in events]
        if not all(answers):
            raise SystemExit(f"the chip ended: {self.process.stderr.read()}")
        clocks = [answer[0] for answer in answers]
        Chip.clocks.append(sum(clocks))
        Chip.longest = max(Chip.longest, *clocks)
        return [answer[1:] for answer in answers]

    def compare(self, expected: list[list[int]]) -> None:
        if self.fired != expected:
            raise SystemExit(f"sample {len(self.clocks) - self.before}: the chip fires {self.fired}, the graph {expected}")

    def step(self, events: list[int]) -> np.ndarray:
        """How often each neuron fires in a sample; the graph's neurons must fire in the same events and order."""
        self.fired = self.ask(events)
        counts = self.plain.step(events)
        self.compare(self.plain.fired)
        return counts

    def end(self) -> None:
        self.process.communicate()


class Held(Control):
    """The cascade's mixer behind the network, and nothing else of the cascade.

    `heard` keeps, by sample, how many events came in; `fired`, how often each neuron fired. In a share `loss` of the samples
    the sensor's spikes are lost.
    """

    def __init__(self, network: Plain | Chip, drone: Drone = CRAZYFLIE, loss: float = 0.0):
        super().__init__(flight.RATE, drone)
        self.network, self.encoder = network, Encoder(THRESHOLD, MOST)
        self.loss, self.dice = loss, np.random.default_rng(1)
        self.heard: list[int] = []
        self.fired: list[np.ndarray] = []

    def step(self, sample, wanted, thrust, feed=(0.0, 0.0, 0.0)):
        counts = self.encoder.counts(sample, wanted, feed[0])
        if self.loss and self.dice.random() < self.loss:
            counts[:6] = 0
        heard = events(counts.tolist())
        self.heard.append(len(heard))
        self.fired.append(self.network.step(heard))
        wishes = self.network.network.worth @ self.fired[-1]
        return self._mix(F(thrust), [inertia * F(wish) for inertia, wish in zip(self.inertia, wishes)])


class Stiff(Control):
    """The cascade with the network's gains."""

    def __init__(self, rate: int, drone: Drone = CRAZYFLIE):
        super().__init__(rate, drone)
        self.attitude_gains = [F(turn / own) for turn, own in zip(TURN, RATE)]
        self.rate_gains = [F(own) for own in RATE]


def flown(manoeuvre: Manoeuvre, make) -> list[flight.Flight]:
    """The manoeuvre with each seed, on a drone that its rotors shake."""
    number = (ALL + LONG).index(manoeuvre)
    flights = []
    for seed in SEEDS:
        control = make()
        flights.append(flight.fly(manoeuvre, Registers(), seed + number, control=control, vibration=LEVEL))
        if isinstance(control, Held):
            HELD.append(control)
            control.network.end()
    return flights


#: All that have flown on the chip.
HELD: list[Held] = []


def main(program: str) -> None:
    check(THRESHOLD, MOST)
    network = Network()
    ways = [
        lambda: Control(flight.RATE),
        lambda: Stiff(flight.RATE),
        lambda: Networked(flight.RATE, Flown()),
        lambda: Held(Chip(program, network)),
    ]
    print("| mean error, ° | cascade | cascade with the chip's gains | network on the microcontroller | the chip | worst on the chip | lost on the chip |")
    print("|---|---:|---:|---:|---:|---:|---:|")
    means, lost = [], np.zeros(len(ways), int)
    for manoeuvre in ALL + LONG:
        flights = [flown(manoeuvre, make) for make in ways]
        own = [sum(each.lost for each in way) for way in flights]
        errors = [mean(way) for way in flights]
        words = [f"{error:.1f}" + (f", {gone} lost" if gone else "") for error, gone in zip(errors, own)]
        worst = max(each.errors.max() for each in flights[-1])
        print(f"| {manoeuvre.name} | {' | '.join(words)} | {worst:.0f} | {own[-1]} of {len(SEEDS)} |", flush=True)
        if manoeuvre in ALL:
            means.append(errors)
            lost += own
    every = " | ".join(f"{own:.1f}" for own in np.mean(means, axis=0))
    print(f"| **the ten** | {every} | | {lost[-1]} of {len(ALL) * len(SEEDS)} |\n")
    heard = np.concatenate([own.heard for own in HELD])
    fired = np.concatenate([np.sum(own.fired, axis=1) for own in HELD])
    clocks = np.array(Chip.clocks)
    print(
        f"{len(network.thresholds)} neurons and {len(network.inputs)} inputs take {len(network.thresholds) + len(network.inputs)} of the "
        f"chip's 256 rows. A sample is {heard.mean():.1f} events in, {heard.max()} at most, and {fired.mean():.1f} spikes, in "
        f"{clocks.mean():.0f} of the chip's clocks, {clocks.max()} at most; an event takes {Chip.longest} at most. "
        f"In all {heard.sum()} events of the {len(heard)} samples above, the chip fires as the graph does, spike by spike."
    )


def elsewhere() -> None:
    network = Network()
    whole = [(World, LEVEL, 0, 5), (Brushless, LEVEL, 0, 2), (World, 2 * LEVEL, 0, 2), (World, 0, 0, 2)]
    for world, vibration, loss, seeds in [*whole, (World, LEVEL, 0.01, 2), (World, LEVEL, 0.1, 2)]:
        ways = {
            "cascade": lambda: Control(flight.RATE, world.drone),
            "cascade with the network's gains": lambda: Stiff(flight.RATE, world.drone),
            "network": lambda: Held(Plain(network), world.drone, loss),
        }
        for name, make in ways.items():
            # The network loses spikes by itself; the cascade loses frames.
            more = {"world": world, "vibration": vibration, "loss": 0 if name == "network" else loss}
            flights = []
            for number, manoeuvre in enumerate(ALL):
                for seed in range(300 + number, 300 + 100 * seeds, 100):
                    flights.append(flight.fly(manoeuvre, Registers(), seed, control=make(), **more))
            lost = sum(own.lost for own in flights)
            words = f"{world.__name__}, vibration {vibration:g}, {loss:.0%} lost on the way: {name}"
            print(f"{words} {mean(flights):.1f}°, {lost} of {len(flights)} lost", flush=True)


if __name__ == "__main__":
    main(sys.argv[1]) if len(sys.argv) > 1 else elsewhere()
