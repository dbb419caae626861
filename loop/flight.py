"""A flight: world, sensor, code, link, decoder, cascade, motors, 500 times a second unless RATE in the environment says."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from math import acos, pi

import numpy as np

from control import Control
from manoeuvres import Manoeuvre, Pilot
from sensor import Sensor, physical
from world import World

#: Samples a second.
RATE = int(os.environ.get("RATE", "500"))
#: A flight is lost once its thrust points this far from where it should, degrees, or it is so far from its height or
#: place, m.
TILT, FALL = 80, 4


class Registers:
    """The control: no code. A sample's twelve bytes go in a frame of 22 more; if it is lost, the last one stays."""

    def __init__(self):
        self.spikes, self.bytes, self.exact = 0, 0, 1.0
        self.fired: list[tuple[int, bool]] = []
        self.values = np.zeros(6, np.float32)

    def carry(self, sample: np.ndarray, is_lost) -> np.ndarray:
        """What the cascade hears of a sample."""
        self.bytes += 34
        if not is_lost():
            self.values = sample
        return self.values


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
    manoeuvre: Manoeuvre, path, seed: int, loss: float = 0.0, trace: bool = False, control: Control | None = None
) -> Flight:
    """Flies a manoeuvre, the sensor heard by way of `path`; the same seed gives the same flight."""
    random = np.random.default_rng(seed)
    samples = round(manoeuvre.seconds * RATE)
    world, pilot, control = World(**manoeuvre.world), Pilot(manoeuvre, RATE), control or Control(RATE)
    sensor = Sensor(random, RATE, samples)
    dice = np.random.default_rng([seed, 1])
    is_lost = (lambda: bool(dice.random() < loss)) if loss else (lambda: False)
    errors, shown, lost = [], [], False
    for number in range(samples):
        time = number / RATE
        world.wind = manoeuvre.wind(time)
        counts = sensor.read(world.feel())
        truth = physical(counts)
        heard = path.carry(truth, is_lost)
        attitude, thrust, turn = pilot.wanted(time, world)
        speeds = control.step(heard, attitude, thrust, turn)
        errors.append(between(attitude, world))
        if trace:
            shown.append((time, counts, truth, np.array(heard), attitude, list(world.state), list(path.fired), speeds))
        world.step(speeds, 1 / RATE)
        astray = world.state[2:3] if manoeuvre.attitude else world.state[:3]
        if errors[-1] > TILT or max(abs(own) for own in astray) > FALL:
            lost = True
            break
    seconds = len(errors) / RATE
    return Flight(lost, seconds, np.array(errors), path.spikes / seconds, path.bytes / seconds, path.exact, shown)


def between(wanted: tuple, world: World) -> float:
    """Degrees between the direction of thrust that is wanted and the true one."""
    w, x, y, z = wanted
    up = 2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)
    cosine = sum(one * other for one, other in zip(up, world.up()))
    return acos(min(max(cosine, -1.0), 1.0)) * 180 / pi
