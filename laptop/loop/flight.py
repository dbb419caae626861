"""A flight: world, sensor, code, link, decoder, cascade, motors, 500 times a second unless RATE in the environment says."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from math import acos, cos, pi, sin, sqrt

import numpy as np

from control import Control
from manoeuvres import Manoeuvre, Pilot
from sensor import Sensor, physical
from vibration import Vibration
from world import World

#: Samples a second.
RATE = int(os.environ.get("RATE", "500"))
#: A flight is lost once its thrust points this far from where it should, degrees, or it is so far from its height or
#: place, m.
TILT, FALL = 80, 4


class LowPass:
    """A low-pass of second order before the registers of six channels, Butterworth's: what `spikewire.Filter` is to codes."""

    def __init__(self, corner: float, rate: int):
        sine, cosine = sin(pi * corner / rate), cos(pi * corner / rate)
        alpha = sine * cosine * sqrt(2)
        self.gain, self.damping = 4 * sine * sine / (1 + alpha), 2 * alpha / (1 + alpha)
        self.level = self.slope = None

    def next(self, sample: np.ndarray) -> np.ndarray:
        """The next sample, filtered."""
        if self.level is None:
            self.level, self.slope = sample.astype(float), np.zeros(6)
        error = sample - self.level
        change = self.gain * error - self.damping * self.slope
        output = self.level + change / 4
        self.slope = self.slope + change
        self.level = self.level + self.slope
        return output.astype(np.float32)


class Way:
    """The way of a sample to the controller: what is sent of it, and the values that the receiver holds.

    A subclass has `send`, `hear` and `values`. `carry` is the line that loses frames and does nothing else to them;
    `line.py` has others."""

    spikes = bytes = 0
    exact = 1.0
    fired: list[tuple[int, bool]] = []

    def send(self, sample: np.ndarray) -> Iterator[Frame]:
        """The frames that go out after a sample."""
        raise NotImplementedError

    def hear(self, frame: Frame) -> None:
        """Takes a frame that arrived."""
        raise NotImplementedError

    def values(self) -> np.ndarray:
        """Ends a sample: the receiver's values, exact or not."""
        raise NotImplementedError

    def carry(self, sample: np.ndarray, is_lost: Callable[[], bool]) -> np.ndarray:
        """Sends a sample over a line that may lose each frame; returns what the controller gets."""
        for frame in self.send(sample):
            self.bytes += frame.size
            if not is_lost():
                self.hear(frame)
        return self.values()


@dataclass(frozen=True)
class Frame:
    """Bytes on the line: how many there are, and what they mean to the receiver."""

    size: int
    content: object


class Registers(Way):
    """The control: no code. A sample's twelve bytes go in a frame of `frame` more; if it is lost, the last one stays."""

    def __init__(self, low_pass: LowPass | None = None, frame: int = 22):
        self.held = np.zeros(6, np.float32)
        self.low_pass, self.size = low_pass, frame + 12

    def send(self, sample: np.ndarray) -> Iterator[Frame]:
        yield Frame(self.size, self.low_pass.next(sample) if self.low_pass else sample)

    def hear(self, frame: Frame) -> None:
        self.held = frame.content

    def values(self) -> np.ndarray:
        return self.held


@dataclass
class Flight:
    """What became of a flight."""

    lost: bool
    seconds: float
    #: Degrees between wanted and true thrust, a sample.
    errors: np.ndarray
    spikes: float
    bytes: float
    exact: float
    trace: list = field(default_factory=list)


def fly(
    manoeuvre: Manoeuvre,
    path,
    seed: int,
    loss: float = 0.0,
    trace: bool = False,
    control: Control | None = None,
    world: type[World] = World,
    vibration: float = 0.0,
    rate: int = RATE,
) -> Flight:
    """Flies a manoeuvre, the sensor heard by way of `path`; the same seed gives the same flight.

    `vibration` is its level, as `vibration.py` has it; 0 is a drone whose rotors do not shake it."""
    random = np.random.default_rng(seed)
    samples = round(manoeuvre.seconds * rate)
    air, pilot, control = world(**manoeuvre.world), Pilot(manoeuvre, rate), control or Control(rate, world.drone)
    sensor = Sensor(random, rate, samples)
    dice = np.random.default_rng([seed, 1])
    is_lost = (lambda: bool(dice.random() < loss)) if loss else (lambda: False)
    shaken = Vibration(np.random.default_rng([seed, 2]), rate, samples, air.drone.hover, vibration) if vibration else None
    errors, shown, lost = [], [], False
    for number in range(samples):
        time = number / rate
        air.wind = manoeuvre.wind(time)
        felt = air.feel()
        counts = sensor.read(felt if shaken is None else felt + shaken.next(air.rotors()))
        truth = physical(counts)
        heard = path.carry(truth, is_lost)
        attitude, thrust, turn = pilot.wanted(time, air)
        speeds = control.step(heard, attitude, thrust, turn)
        errors.append(between(attitude, air))
        if trace:
            shown.append((time, counts, truth, np.array(heard), attitude, list(air.state), list(path.fired), speeds))
        air.step(speeds, 1 / rate)
        astray = air.state[2:3] if manoeuvre.attitude else air.state[:3]
        if errors[-1] > TILT or max(abs(own) for own in astray.tolist()) > FALL:
            lost = True
            break
    seconds = len(errors) / rate
    return Flight(lost, seconds, np.array(errors), path.spikes / seconds, path.bytes / seconds, path.exact, shown)


def between(wanted: tuple, world: World) -> float:
    """Degrees between the direction of thrust that is wanted and the true one."""
    w, x, y, z = wanted
    up = 2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)
    cosine = sum(one * other for one, other in zip(up, world.up()))
    return acos(min(max(cosine, -1.0), 1.0)) * 180 / pi
