"""Lays out the network that holds a drone's attitude on tinyODIN, and writes it as a NIR graph: `attitude.py`.

Nothing is trained. For each axis the network keeps a number: the turn that is left, in steps of STEP. The number has balanced
ternary digits, -1, 0 or 1 times a power of three. Eight neurons keep a digit:

- Three *up* neurons and three *down* neurons, one for each value of the digit. The two neurons of the present value are set:
  their potential is SET, that of the others is 0. An event that counts up adds PUSH to the up neurons, so that the one that is
  set fires. Its spike sets the neurons of the next value, resets the down neuron of its own, and takes PUSH from the other up
  neurons. Past 1 it also counts up the next digit.
- Two *answers*, one for 1 and one for -1, are set along with these. A question, sent once a sample, makes those that are set
  fire and sets them again. They are outputs.

Other neurons are relays: a gyroscope's spike passes one to be an output itself, which makes the rate; four each for roll and
pitch count the number back to 0 within some 1 / FADES samples, so that over minutes the accelerometer says what is level; 16 are
set with a digit of roll or pitch and asked by the turns of the other, and by their spikes two more correct the yaw by what a roll
and a pitch make together.

The last layer of the graph says what a spike of each neuron is worth, in rad/s² for a sample. It is the microcontroller's.
"""

from __future__ import annotations

from pathlib import Path

import nir
import numpy as np

from network_pilot import FADES

#: The graph that `main` writes.
NETWORK = Path(__file__).with_name("attitude.nir")

#: Seconds of a sample.
DT = 0.002
#: Roll, pitch, yaw: a number's step, rad, and its digits.
STEP, DIGITS = (2**-8, 2**-8, 2**-5), (7, 7, 4)
#: Angular acceleration per turn that is left, 1/s², and per rate, 1/s, by axis.
TURN, RATE = (380, 380, 72), (48, 48, 18)
#: The potential of a neuron that is set, what an event adds to it, and the threshold.
SET, PUSH, THRESHOLD = 4, 3, 7
#: The largest weight.
MOST = 7
#: The digit that the inputs of far turns count, each of whose spikes is NEARBY steps.
COARSE = 3
NEARBY = 3**COARSE
#: The digit of a tilt that corrects the yaw, and the threshold of the relays. Digit 4 is 1 for tilts of 9 to 27° only: from 27
#: to 45° it is -1, so that the yaw is moved the wrong way, and from 45 to 63° it is 0. By the formula the threshold is 354; half
#: of it flies best, as it makes up for small tilts.
TILT, CROSS = 4, 177

#: First inputs of each kind, up before down: gyroscopes by axis, accelerometers ahead and aside, wanted turns by axis, the rate
#: that leads a flip, wanted far turns of roll and pitch. Then the question, the times at which numbers fade, and the start.
GYRO, ACCEL, WANTED, LEAD, FAR, ASK, FADE, START = 0, 6, 10, 16, 18, 22, 23, 25
INPUTS = 26


class Layout:
    """Weights from inputs (inputs, neurons) and between neurons (from, to), thresholds, and what spikes are worth (3, neurons)."""

    def __init__(self):
        self.edges, self.from_inputs = [], []
        self.thresholds: list[int] = []
        #: By axis and digit: the first up neuron, the first down neuron, the first answer.
        self.digits: list[list[tuple[int, int, int]]] = []
        #: The relay of an input. It fires whenever the input does.
        self.relay: dict[int, int] = {}
        worth: dict[tuple[int, int], float] = {}

        # A relay that takes back what its input has added to others comes before them, as neurons fire in order.
        self._relay(ASK)
        for axis in range(3):
            self._number(axis)
        for axis in range(3):
            for way in range(2):
                # A turn of the drone leaves less to turn.
                self._count(self.from_inputs, GYRO + 2 * axis + way, axis, 1 - way)
                self._count(self.from_inputs, WANTED + 2 * axis + way, axis, way)
                for source, sign in [(GYRO + 2 * axis + way, -1)] + [(LEAD + way, 1)] * (axis == 0):
                    self._relay(source)
                    worth[axis, self.relay[source]] = sign * (1, -1)[way] * RATE[axis] * STEP[axis] / DT
                if axis < 2:
                    self._count(self.from_inputs, FAR + 2 * axis + way, axis, way, COARSE)
                    # Gravity is felt upwards: ahead if the nose is up, to the right if the drone leans to the left.
                    self._count(self.from_inputs, ACCEL + 2 * (1 - axis) + way, axis, way if axis == 1 else 1 - way)
            if axis < 2:
                self._fade(axis)
            for digit, (_, _, answers) in enumerate(self.digits[axis]):
                for way in range(2):
                    worth[axis, answers + way] = (1, -1)[way] * TURN[axis] * STEP[axis] * 3**digit
        self._cross()

        count = len(self.thresholds)
        self.inputs = np.zeros((INPUTS, count), int)
        self.recurrent = np.zeros((count, count), int)
        self.worth = np.zeros((3, count))
        for weights, edges in ((self.inputs, self.from_inputs), (self.recurrent, self.edges)):
            for source, to, weight in edges:
                weights[source, to] += weight
        for place, value in worth.items():
            self.worth[place] = value

    def _add(self, threshold: int = THRESHOLD) -> int:
        """Adds a neuron."""
        self.thresholds.append(threshold)
        return len(self.thresholds) - 1

    def _relay(self, source: int) -> None:
        """Adds a relay of an input that has none."""
        if source not in self.relay:
            self.relay[source] = self._add()
            self.from_inputs.append((source, self.relay[source], THRESHOLD))

    def _count(self, edges: list, source: int, axis: int, way: int, digit: int = 0) -> None:
        """Makes a spike of `source` count a number up (0) or down (1)."""
        first = self.digits[axis][digit][way]
        edges += [(source, first + value, PUSH) for value in range(3)]

    def _ask(self, source: int, answer: int) -> None:
        """Makes an input ask a neuron that may be set, and that is set again if it answers."""
        self.from_inputs.append((source, answer, PUSH))
        self.edges += [(self.relay[source], answer, -PUSH), (answer, answer, SET + PUSH)]

    def _number(self, axis: int) -> None:
        """Adds the digits of an axis. Values -1, 0 and 1 have the places 0, 1 and 2."""
        banks = [tuple(self._add() for _ in range(8))[::3] for _ in range(DIGITS[axis])]
        self.digits.append(banks)
        for digit, (up, down, answers) in enumerate(banks):
            self.from_inputs += [(START, up + 1, SET), (START, down + 1, SET)]
            for value in range(3):
                for way, (bank, other) in enumerate(((up, down), (down, up))):
                    source, to, ends = bank + value, (value + (1, -1)[way]) % 3, value == (2, 0)[way]
                    self.edges += [(source, bank + each, -PUSH) for each in range(3) if each != value]
                    if ends and digit + 1 == len(banks):
                        # The number is as far as it goes.
                        self.edges.append((source, source, SET))
                        continue
                    if ends:
                        self._count(self.edges, source, axis, way, digit + 1)
                    self.edges += [(source, bank + to, SET), (source, other + to, SET), (source, other + value, -SET)]
                    self.edges += [(source, answers + (each == 0), sign * SET) for each, sign in ((to, 1), (value, -1)) if each != 1]
            for way in range(2):
                self._ask(ASK, answers + way)

    def _fade(self, axis: int) -> None:
        """Adds relays that count a number towards 0: one pair for the digits of 3 and 9, one for those above."""
        for way in range(2):
            for first, digits in ((1, 2), (3, 3)):
                relay = self._add(round(1 / (3**first * FADES)))
                self._count(self.edges, relay, axis, 1 - way)
                # Only FADE lets it fire: a number must not count both ways at once, nor while it is asked.
                self.from_inputs.append((FADE + way, relay, MOST))
                self.edges.append((self.relay[ASK], relay, -MOST))
                for digit in range(digits):
                    self.edges.append((self.digits[axis][first + digit][2] + way, relay, min(3**digit, MOST)))

    def _cross(self) -> None:
        """Adds what corrects the yaw by half the product of the tilt that is left and the turns, of drone and wish: a drone that
        rolls while its nose is to rise turns it. A neuron is set along with a digit of one tilt, and asked by turns of the other."""
        yaw = [self._add(CROSS) for _ in range(2)]
        for way in range(2):
            self._count(self.edges, yaw[way], 2, way)
        for axis in range(2):
            up, _, answers = self.digits[axis][TILT]
            for source in (kind + 2 * (1 - axis) + turns for kind in (GYRO, WANTED) for turns in range(2)):
                self._relay(source)
                sets = [edge for edge in self.edges if up <= edge[0] < answers <= edge[1] <= answers + 1]
                for way in range(2):
                    product = self._add()
                    self.edges += [(value, product, weight) for value, to, weight in sets if to == answers + way]
                    self._ask(source, product)
                    self.edges.append((product, yaw[(way + source + axis) % 2], MOST))


def main() -> None:
    layout = Layout()
    each = np.ones(len(layout.thresholds))
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


if __name__ == "__main__":
    main()
