"""A drone that is flown by a spiking network: six inertial channels and what is wanted come in as spikes, wishes go out.

Every signal is coded by integrate-and-fire, whose spikes are steps of the signal's integral: a spike of the gyroscope
is a turn of 0.002 rad, one of what is wanted a turn of 1/128 rad. Neurons whose currents decay within seconds therefore
hold the attitude that is left to turn, neurons whose currents decay within milliseconds the rate. Nothing else in the
loop knows an attitude: the mixer takes three angular accelerations, and the thrust that is wanted.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from control import Control, F

#: What `network_imitate.py` has written, and by which rule its neurons step, which a NIR file does not say.
NETWORK = Path(__file__).with_name("network.nir")
RULE = {"reset": "subtract", "fires": "above", "decay": "euler", "current": "new", "dt": 0.002}

#: Signals: three rates (rad/s), three forces (m/s²), three turns of the attitude that is wanted (rad a sample, in the
#: drone's axes), the rate at which roll is to turn (rad/s).
SIGNALS = 10
#: What the network has of an attitude fades by so much a sample; of one that is wanted it hears as much again.
FADES = 0.2 * 0.002
#: What a spike is worth, in the signal's unit times a sample. Powers of two, so that single precision rounds nothing.
THRESHOLD = np.array([1, 1, 1, 8, 8, 8, 2**-7, 2**-7, 2**-7, 1], np.float32)
#: The value without spikes, and the most spikes a sample.
REFERENCE = np.array([0, 0, 0, 0, 0, 9.8125, 0, 0, 0, 0], np.float32)
MOST = 31


class Encoder:
    """Integrate-and-fire of all signals: input `2 s` is signal `s` up, `2 s + 1` down."""

    def __init__(self, threshold: np.ndarray = THRESHOLD, most: int = MOST):
        self.threshold, self.most = threshold, most
        self.potential, self.before = np.zeros(SIGNALS, np.float32), (1.0, 0.0, 0.0, 0.0)
        self.signals = np.zeros(SIGNALS, np.float32)

    def counts(self, sample, wanted, feed: float) -> np.ndarray:
        """Spikes of a sample: how many of each signal, negative for down."""
        w, x, y, z = wanted
        roll, pitch, yaw = turn(self.before, wanted)
        lean = 2 * (y * z + w * x), 2 * (w * y - x * z)
        self.signals[:6], self.signals[8:] = sample, (yaw, feed)
        self.signals[6:8] = roll + FADES * lean[0], pitch + FADES * lean[1]
        self.before = wanted
        return self.fire()

    def fire(self) -> np.ndarray:
        """Spikes of `signals`: those of the crate's integrate-and-fire, which `check` compares."""
        self.potential += self.signals - REFERENCE
        counts = np.clip(np.trunc(self.potential / self.threshold), -self.most, self.most)
        self.potential -= counts * self.threshold
        return counts.astype(int)


def inputs(counts: np.ndarray) -> list[int]:
    """The numbers of the inputs that fire."""
    return [2 * at + (count < 0) for at, count in enumerate(counts.tolist()) for _ in range(abs(count))]


def turn(before, now) -> list[float]:
    """The turn from one attitude to another, in the axes of the first, rad: exact to 0.1 % up to 60°."""
    (w, x, y, z), (a, b, c, d) = before, now
    part = [w * b - x * a - y * d + z * c, w * c + x * d - y * a - z * b, w * d - x * c + y * b - z * a]
    sign = 2 if w * a + x * b + y * c + z * d >= 0 else -2
    square = sum(own * own for own in part)
    return [sign * own * (1 + square / 6 + square * square * 3 / 40) for own in part]


class Networked(Control):
    """The cascade's mixer behind a network. `network.step` takes the inputs' counts and gives potentials, a fast and a
    slow one for each axis. The cascade says beside it what it would have done: `heard` keeps both, and the counts."""

    def __init__(self, rate: int, network=None):
        super().__init__(rate)
        self.network, self.encoder = network, Encoder()
        self.heard: list[tuple] = []

    def step(self, sample, wanted, thrust, feed=(0.0, 0.0, 0.0)):
        counts = self.encoder.counts(sample, wanted, feed[0])
        self.own = None
        if self.network is not None:
            potentials = self.network.step(counts)
            self.own = [F(potentials[axis] + potentials[axis + 3]) for axis in range(3)]
        speeds = super().step(sample, wanted, thrust, feed)
        self.heard.append((counts, self.teacher, self.own))
        return speeds

    def _wishes(self, rates, turns):
        self.teacher = super()._wishes(rates, turns)
        return self.teacher if self.own is None else self.own
