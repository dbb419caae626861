"""What is flown: attitudes that are wanted, places that are wanted, and what gets in the way.

A manoeuvre says at each moment which attitude, thrust and turn the cascade is to bring about. Height and place come from
the world itself, as from a motion capture: the codes carry the inertial sensor and nothing else.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import cos, pi, sin, sqrt

import numpy as np

from world import GRAVITY, World

DEGREE = pi / 180
#: Roll and pitch in rad, the rate at which roll is to turn, and a factor on the thrust, at a time.
Attitude = Callable[[float], tuple[float, float, float, float]]
#: Place and velocity at a time.
Path = Callable[[float], tuple[tuple[float, float, float], tuple[float, float, float]]]


@dataclass
class Manoeuvre:
    """A flight of some seconds."""

    name: str
    seconds: float
    attitude: Attitude | None = None
    path: Path | None = None
    world: dict = field(default_factory=dict)
    wind: Callable[[float], tuple[float, float, float]] = lambda _: (0.0, 0.0, 0.0)


class Pilot:
    """Follows a manoeuvre: what the cascade is told, a sample at a time."""

    def __init__(self, manoeuvre: Manoeuvre, rate: int):
        self.manoeuvre, self.dt = manoeuvre, 1 / rate
        self.missed = [0.0, 0.0, 0.0]

    def wanted(self, time: float, world: World) -> tuple[tuple, float, tuple]:
        """Attitude (w, x, y, z), thrust in N, rates that lead."""
        x, v = world.state[:3], world.state[3:6]
        if self.manoeuvre.attitude:
            roll, pitch, turn, share = self.manoeuvre.attitude(time)
            rise = GRAVITY - 6 * x[2] - 4 * v[2]
            lean = max(cos(roll) * cos(pitch), 0.5)
            thrust = world.drone.mass * (rise / lean if share == 1 else share * GRAVITY)
            r, p = roll / 2, pitch / 2
            attitude = (cos(r) * cos(p), sin(r) * cos(p), cos(r) * sin(p), -sin(r) * sin(p))
            return attitude, max(thrust, 0.0), (turn, 0.0, 0.0)
        place, speed = self.manoeuvre.path(time)
        push = [0.0, 0.0, GRAVITY]
        for axis in range(3):
            miss = place[axis] - x[axis]
            self.missed[axis] += miss * self.dt
            push[axis] += 4 * miss + 3 * (speed[axis] - v[axis]) + 1.5 * self.missed[axis]
        return toward(push, world)


def toward(push: list[float], world: World) -> tuple[tuple, float, tuple]:
    """The attitude whose thrust gives this acceleration, with the nose ahead; leaning 35° at most."""
    flat, up = sqrt(push[0] ** 2 + push[1] ** 2), max(push[2], 2.0)
    scale = min(1.0, 0.7 * up / flat) if flat > 0 else 1.0
    ax, ay = push[0] * scale, push[1] * scale
    norm = sqrt(ax * ax + ay * ay + up * up)
    w = sqrt((1 + up / norm) / 2)
    attitude = (w, -ay / norm / (2 * w), ax / norm / (2 * w), 0.0)
    ux, uy, uz = world.up()
    return attitude, max(world.drone.mass * (ax * ux + ay * uy + up * uz), 0.0), (0.0, 0.0, 0.0)


def steps(size: float) -> Attitude:
    """Roll to this many degrees, to the other side and back; then pitch."""

    def attitude(time: float) -> tuple[float, float, float, float]:
        part = int(time / 0.4)
        roll, pitch = {1: (1, 0), 2: (-1, 0), 5: (0, 1), 6: (0, -1)}.get(part, (0, 0))
        return roll * size * DEGREE, pitch * size * DEGREE, 0.0, 1.0

    return attitude


def sines(time: float) -> tuple[float, float, float, float]:
    """10° in roll and pitch, from 0.5 Hz up to 3 Hz, which is about the bandwidth of the cascade."""
    phase = 2 * pi * (0.5 * time + 2.5 * time * time / 8)
    return 10 * DEGREE * sin(phase), 10 * DEGREE * sin(1.3 * phase), 0.0, 1.0


#: The flip's beginning and length, s.
FLIP, TURN = 0.6, 0.8


def flip(time: float) -> tuple[float, float, float, float]:
    """A jump, and once around the nose in 0.8 s: 16 rad/s."""
    since = time - FLIP
    if since < -0.3:
        return 0.0, 0.0, 0.0, 1.0
    if since < 0:
        return 0.0, 0.0, 0.0, 1.7
    if since >= TURN:
        return 2 * pi, 0.0, 0.0, 1.0
    angle = 2 * pi * (since / TURN - sin(2 * pi * since / TURN) / (2 * pi))
    rate = 2 * pi / TURN * (1 - cos(2 * pi * since / TURN))
    return angle, 0.0, rate, max(cos(angle), 0.2) * 0.999


def still(_: float) -> tuple[tuple, tuple]:
    """Where it is."""
    return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)


def eight(time: float) -> tuple[tuple, tuple]:
    """A figure of eight, 1.6 m wide, in 4 s, begun from rest within a second."""
    a, along = pi / 2 * min(time, 1.0), pi / 2 * (time * time / 2 if time < 1 else time - 0.5)
    place = (0.8 * sin(along), 0.4 * sin(2 * along), 0.0)
    return place, (0.8 * a * cos(along), 0.8 * a * cos(2 * along), 0.0)


def circle(time: float) -> tuple[tuple, tuple]:
    """A circle of 0.5 m, once in 3 s, begun from rest within a second."""
    a, along = 2 * pi / 3 * min(time, 1.0), 2 * pi / 3 * (time * time / 2 if time < 1 else time - 0.5)
    return (0.5 * sin(along), 0.5 * (1 - cos(along)), 0.0), (0.5 * a * cos(along), 0.5 * a * sin(along), 0.0)


def gust(time: float) -> tuple[float, float, float]:
    """6 m/s from the side for a second, rising and falling as a cosine."""
    since = time - 1
    return (0.0, 3 * (1 - cos(2 * pi * since)), 0.0) if 0 <= since < 1 else (0.0, 0.0, 0.0)


#: What the table flies.
ALL = [
    Manoeuvre("hover", 4, path=still),
    Manoeuvre("steps of 10°", 4, steps(10)),
    Manoeuvre("steps of 20°", 4, steps(20)),
    Manoeuvre("steps of 30°", 4, steps(30)),
    Manoeuvre("sines", 4, sines),
    Manoeuvre("eight", 4, path=eight),
    Manoeuvre("gust", 4, path=still, wind=gust),
    Manoeuvre("mass +20 %", 4, path=eight, world={"mass": 1.2}),
    Manoeuvre("motor 10 % weak", 4, path=eight, world={"weak": 0.9}),
    Manoeuvre("flip", 3, flip),
]


def lesson(time: float) -> tuple[float, float, float, float]:
    """The flight that codes are tuned on: steps of 15° and 25°, sines, a flip, in 12 s."""
    if time < 4:
        return steps(15)(time)
    if time < 8:
        return sines(time - 4)
    if time < 11:
        return flip(time - 8)
    return steps(25)(time - 11)


LESSON = Manoeuvre("lesson", 13, lesson)


def at_random(seed: int, seconds: int = 4) -> Manoeuvre:
    """Steps or sines of any size up to 40° in roll and pitch, or a flip."""
    random = np.random.default_rng([seed, 7])
    if seed % 4 == 0:
        return Manoeuvre("flip", 3, flip)
    sizes = random.uniform(-1, 1, (5 * seconds, 2)) * random.choice([5, 15, 40]) * DEGREE
    rates, share = random.uniform(0.5, 4, 2), random.uniform(0, 0.5)

    def attitude(time: float):
        roll, pitch = sizes[int(time / 0.25)]
        waves = [share * sin(2 * pi * rate * time) * 0.5 for rate in rates]
        return roll * (1 - share) + waves[0], pitch * (1 - share) + waves[1], 0.0, 1.0

    return Manoeuvre("at random", seconds, attitude)


#: A minute of what is hardest to hold, and of what is easiest: drift has the time to show.
MINUTES = [
    Manoeuvre("hover, 60 s", 60, path=still),
    Manoeuvre("eight, 60 s", 60, path=eight),
    Manoeuvre("eight with a weak motor, 60 s", 60, path=eight, world={"weak": 0.9}),
    at_random(102, 60),
]
