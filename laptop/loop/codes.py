"""Codes on their way: tuned on one flight, carried by the link's frames, decoded at the other end."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import spikewire as sw

from flight import RATE, Frame, Registers, Way, fly
from manoeuvres import LESSON
from sensor import UNIT

#: Samples from keyframe to keyframe, or heartbeat: 20 ms.
KEYFRAME_EVERY = RATE // 50
#: No keyframe but the first.
NEVER = 1 << 40
#: The channels that share parameters, with the error that is aimed at: rates in rad/s, then sideways forces and the
#: one along the thrust in m/s².
GROUPS = [([0, 1, 2], 0.05), ([3, 4], 0.2), ([5], 0.3)]
#: What a bank's channels must share beside all choices between words, so that the rates' is kept for the forces.
SHARED = ("neurons", "slots", "spikes", "filter")
#: The codes that draw by chance, here from a fixed seed.
CHANCE = {name for name, scheme in sw.schemes.items() if any(own["name"] == "seed" for own in scheme._info["parameters"])}
#: What was found.
KEPT = Path(__file__).with_name("codes.json")
#: How many settings the tuner scores a group.
EVALUATIONS = 150


def lesson(vibration: float = 0.0) -> np.ndarray:
    """The six channels of the flight that all codes are tuned on, flown without a code: (channels, samples)."""
    flight = fly(LESSON, Registers(), seed=1000, trace=True, vibration=vibration)
    return np.array([shown[2] for shown in flight.trace], dtype=np.float64).T


def tuned(name: str, flight: np.ndarray) -> list[dict]:
    """The parameters for each group: the fewest spikes within the aim, or else the least error, whatever the spikes."""
    found, shared = [], {}
    takes = [parameter["name"] for parameter in sw.schemes[name]._info["parameters"] if is_shared(parameter)]
    for channels, aim in GROUPS:
        signals = [flight[channel] for channel in channels]
        common = {"rate": RATE, "hold_out": 0, "evaluations": EVALUATIONS, "seed": 1, **shared}
        try:
            best = sw.tune(signals, name, max_rmse=aim, **common)
        except ValueError:  # it does not come so near
            best = sw.tune(signals, name, min_efficiency=-100_000, **common)
        found.append(best.scheme.parameters)
        shared = {key: best.scheme.parameters[key] for key in takes if key in best.scheme.parameters}
    return found


def is_shared(parameter: dict) -> bool:
    """Whether the channels of a bank have one value of it."""
    return parameter["name"] in SHARED or parameter["kind"] in ("choice", "flag")


def schemes(name: str) -> list[sw.Scheme]:
    """The scheme of each channel, as it was tuned."""
    found: list[sw.Scheme | None] = [None] * 6
    for (channels, _), parameters in zip(GROUPS, json.loads(KEPT.read_text())[name]):
        given = parameters | ({"seed": 1} if name in CHANCE else {})
        for channel in channels:
            found[channel] = sw.schemes[name](**given)
    return found


def instructions(name: str) -> float | None:
    """What encoding a sample of all six channels costs a Cortex-M4F, from the measured table; `None` if not measured."""
    each = [scheme._coder.instructions() for scheme in schemes(name)]
    return None if None in each else sum(each)


class Coded(Way):
    """The way of a sample by spikes: perhaps a low-pass, six encoders, frames that may be lost, six decoders."""

    def __init__(
        self,
        schemes: list[sw.Scheme],
        keyframe_every: int = KEYFRAME_EVERY,
        low_pass: float | None = None,
        rate: int = RATE,
        step_bits: int = 0,
    ):
        self.period = 1_000_000 // rate
        before = low_pass and sw.Filter.low_pass(low_pass, rate)
        self.sender = sw.Sender(schemes, self.period, keyframe_every, filter=before, step_bits=step_bits)
        self.receiver = sw.Receiver(schemes, self.period, clock_tolerance=0, filter=before)
        self.samples = self.whole = 0

    def send(self, sample: np.ndarray) -> Iterator[Frame]:
        """The link's frames: events, and now and then keyframes."""
        for frame in self.sender.encode(sample):
            yield Frame(len(frame), frame)
        self.fired = self.sender.fired
        self.spikes += len(self.fired)

    def hear(self, frame: Frame) -> None:
        """Decodes a frame."""
        self.receiver.hear(frame.content)

    def values(self) -> np.ndarray:
        """Ends a sample at the far end too: all of its frames that are not lost have arrived by now."""
        self.samples += 1
        self.receiver.advance(self.samples * self.period)
        self.whole += int(self.receiver.exact.sum())
        return self.receiver.values.astype(np.float32)

    @property
    def exact(self) -> float:
        """The share of values that were exact."""
        return self.whole / (6 * max(self.samples, 1))
