"""The network that holds a drone's attitude on tinyODIN: `attitude.py` lays it out and writes it as `attitude.nir`.

Nothing is trained. The turn that is left, of each axis, is a number of balanced ternary digits, -1, 0 or 1 times a power of
three. A digit is a ring of three places, and the place that is set is the neuron whose potential is `SET`:

- One bank of the ring's neurons fires when the number goes up, another when it goes down. The one that is set fires, sets its
  neighbour in all banks, and takes `PUSH` from the others, which the spike before had pushed too; past 1 it pushes the next digit.
- A third bank, without the 0, fires when it is asked, twice a sample, and sets itself again: these are the outputs.
- Each spike of a gyroscope passes a relay, which is an output too: the rate.
- Relays without a reset in sight add up what the third bank says, and move the number towards 0: within `1 / FADES` samples it
  would be there, so that the accelerometer, whose spikes move it too, has the last word over minutes.

What a spike of each neuron is worth, in rad/s² during a sample, is the graph's last layer.
"""

from __future__ import annotations

from pathlib import Path

import nir
import numpy as np

from network_pilot import FADES

#: What `main` writes.
NETWORK = Path(__file__).with_name("attitude.nir")

DT = 0.002
#: Roll, pitch, yaw: a step of the number, rad; its digits.
STEP, DIGITS = (2**-7, 2**-7, 2**-5), (6, 6, 4)
#: Angular acceleration per turn that is left, 1/s², and per rate, 1/s, by axis.
TURN, RATE = (380, 380, 72), (48, 48, 18)
#: A place's potential when it is set, what an event adds to it, and where it fires.
SET, PUSH, THRESHOLD = 4, 3, 7
#: The largest weight.
MOST = 7
#: Where the relays that move the yaw by a product of turn and rate fire: at 1 rad of turn, for 7 of the threshold's turns.
CROSS = 266
#: The digit at which the inputs of large turns move roll and pitch, and by which yaw is corrected: a spike is 27 steps.
COARSE = 3
NEARBY = 3**COARSE

#: Inputs, up before down: three gyroscopes, two accelerometers, three wanted turns, a turn that leads, two wanted turns of
#: 27 steps; then the question, what lets numbers fade upwards and downwards, and what sets all zeros at the start.
GYRO, ACCEL, WANTED, LEAD, FAR, ASK, FADE, START = 0, 6, 10, 16, 18, 22, 23, 25
INPUTS = 26


class Layout:
    """Weights from inputs (inputs, neurons) and between neurons (from, to), thresholds, and what spikes are worth (3, neurons)."""

    def __init__(self):
        self.count, self.edges, self.from_inputs = 0, [], []
        self.thresholds: list[int] = []
        #: By axis and digit: the first neurons of the banks for up, down and answers.
        self.digits: list[list[tuple[int, int, int]]] = []
        #: The relays of inputs that are a rate.
        self.relay: dict[int, int] = {}
        worth: dict[tuple[int, int], float] = {}

        # Takes back what a question adds: the first neuron, so that it is the first to fire.
        self.back = self._add(THRESHOLD)
        self.from_inputs.append((ASK, self.back, THRESHOLD))
        for axis in range(3):
            self._number(axis)
        for axis in range(3):
            for way in range(2):
                # A drone that turns up has less left to turn.
                self._move(self.from_inputs, GYRO + 2 * axis + way, axis, 1 - way)
                self._move(self.from_inputs, WANTED + 2 * axis + way, axis, way)
                sources = [(GYRO + 2 * axis + way, -1)] + [(LEAD + way, 1)] * (axis == 0)
                for source, sign in sources:
                    relay = self.relay[source] = self._add(THRESHOLD)
                    self.from_inputs.append((source, relay, THRESHOLD))
                    worth[axis, relay] = sign * (1, -1)[way] * RATE[axis] * STEP[axis] / DT
                if axis < 2:
                    self._move(self.from_inputs, FAR + 2 * axis + way, axis, way, COARSE)
                    # Forces ahead say that the nose is up, forces to the left that roll is; gravity is felt upwards.
                    other = 1 - axis
                    self._move(self.from_inputs, ACCEL + 2 * other + way, axis, 1 - way if axis == 0 else way)
            if axis < 2:
                self._fade(axis)
            for digit, (_, _, answers) in enumerate(self.digits[axis]):
                for way in range(2):
                    worth[axis, answers + way] = (1, -1)[way] * TURN[axis] * STEP[axis] * 3**digit
        self._cross()

        self.inputs = np.zeros((INPUTS, self.count), int)
        self.recurrent = np.zeros((self.count, self.count), int)
        self.worth = np.zeros((3, self.count))
        for source, to, weight in self.from_inputs:
            self.inputs[source, to] += weight
        for source, to, weight in self.edges:
            self.recurrent[source, to] += weight
        for place, value in worth.items():
            self.worth[place] = value

    def _add(self, threshold: int) -> int:
        """A neuron."""
        self.thresholds.append(threshold)
        self.count += 1
        return self.count - 1

    def _move(self, edges: list, source: int, axis: int, way: int, digit: int = 0) -> None:
        """A spike of `source` moves a number up (0) or down (1)."""
        first = self.digits[axis][digit][way]
        edges += [(source, first + place, PUSH) for place in range(3)]

    def _number(self, axis: int) -> None:
        """The digits of an axis."""
        banks = []
        for _ in range(DIGITS[axis]):
            first = self.count
            for _ in range(8):
                self._add(THRESHOLD)
            banks.append((first, first + 3, first + 6))
        self.digits.append(banks)
        for digit, (up, down, answers) in enumerate(banks):
            self.from_inputs += [(START, up + 1, SET), (START, down + 1, SET)]
            for place in range(3):
                for way, bank in ((0, up), (1, down)):
                    source, end, step = bank + place, (2, 0)[way], (1, -1)[way]
                    self.edges += [(source, bank + other, -PUSH) for other in range(3) if other != place]
                    if place == end and digit + 1 == len(banks):
                        self.edges.append((source, source, SET))
                        continue
                    if place == end:
                        self._move(self.edges, source, axis, way, digit + 1)
                    to = (place + step) % 3
                    self.edges += [(source, other + to, SET) for other in (up, down)]
                    self.edges.append((source, (down, up)[way] + place, -SET))
                    # Of the answers, the first is 1's and the second is -1's.
                    self.edges += [
                        (source, answers + (0 if at == 2 else 1), sign * SET) for at, sign in ((to, 1), (place, -1)) if at != 1
                    ]
            for way in range(2):
                self.from_inputs.append((ASK, answers + way, PUSH))
                self.edges += [(self.back, answers + way, -PUSH), (answers + way, answers + way, SET + PUSH)]

    def _cross(self) -> None:
        """Yaw that comes of a roll and a pitch: neurons that are set with a digit of one, and asked by the other's gyroscope,
        move the yaw's number by way of two relays."""
        yaw = [self._add(CROSS) for _ in range(2)]
        for way in range(2):
            self._move(self.edges, yaw[way], 2, way)
        for axis in range(2):
            up, _, answers = self.digits[axis][COARSE]
            for source, turns in ((kind + 2 * (1 - axis) + turns, turns) for kind in (GYRO, WANTED) for turns in range(2)):
                if source not in self.relay:
                    self.relay[source] = self._add(THRESHOLD)
                    self.from_inputs.append((source, self.relay[source], THRESHOLD))
                kept = [edge for edge in self.edges if up <= edge[0] < answers <= edge[1] <= answers + 1]
                for way in range(2):
                    own = self._add(THRESHOLD)
                    self.edges += [(place, own, weight) for place, to, weight in kept if to == answers + way]
                    self.from_inputs.append((source, own, PUSH))
                    self.edges += [(self.relay[source], own, -PUSH), (own, own, SET + PUSH)]
                    self.edges.append((own, yaw[(way + turns + axis) % 2], MOST))

    def _fade(self, axis: int) -> None:
        """Relays that move a number towards 0, for digits 1 and 2 and for those above."""
        for way in range(2):
            for first, digits in ((1, 2), (3, 3)):
                # A digit of 1 here moves the number so often a second.
                relay = self._add(round(1 / (3**first * FADES)))
                self._move(self.edges, relay, axis, 1 - way)
                # Fires at its own time only, as a number must not move both ways at once, nor while it is asked.
                self.from_inputs.append((FADE + way, relay, MOST))
                self.edges.append((self.back, relay, -MOST))
                for digit in range(digits):
                    weight = min(3**digit, MOST)
                    self.edges.append((self.digits[axis][first + digit][2] + way, relay, weight))


def main() -> None:
    layout = Layout()
    each = np.ones(layout.count)
    nodes = {
        "input": nir.Input({"input": np.array([INPUTS])}),
        "weights": nir.Linear(layout.inputs.T.astype(float)),
        "neurons": nir.IF(r=each, v_threshold=np.array(layout.thresholds) - 0.5, v_reset=0 * each),
        "worth": nir.Linear(layout.worth),
        "output": nir.Output({"output": np.array([3])}),
    }
    edges = [*zip(nodes, list(nodes)[1:]), ("neurons", "recurrent"), ("recurrent", "neurons")]
    nodes["recurrent"] = nir.Linear(layout.recurrent.T.astype(float))
    nir.write(NETWORK, nir.NIRGraph(nodes, edges))
    print(f"{layout.count} neurons, {INPUTS} inputs")


if __name__ == "__main__":
    main()
