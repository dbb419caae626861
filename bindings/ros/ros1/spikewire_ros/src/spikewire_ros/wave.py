"""The toolbox's signal: three sines and noise."""

from collections.abc import Iterator
from math import pi, sin
from random import Random
from typing import Any

# As `generate_spikes.py` has them.
HERTZ = (1.0, 3.0, 5.0)
_PEAKS = (2.0, -0.5, 0.75)
_NOISE = 0.2


def wave(dt: float, t_max: float, seed: int = 0, hertz: Any = HERTZ) -> Iterator[float]:
    """A sample every `dt` seconds, for `t_max` seconds. Each sine brings even noise from 0 to 0.2."""
    for name, value in (("dt", dt), ("T_max", t_max)):
        if not isinstance(value, (int, float)) or not 0.0 < value < float("inf"):
            raise ValueError(f"{name} {value}: it must be above 0 and finite, in seconds")
    if not isinstance(hertz, (list, tuple)) or len(hertz) != len(_PEAKS):
        raise ValueError(f"hertz {hertz}: it must be a list of {len(_PEAKS)} numbers")
    return _wave(dt, t_max, Random(seed), hertz)


def _wave(dt: float, t_max: float, random: Random, hertz: Any) -> Iterator[float]:
    for index in range(round(t_max / dt)):
        time = index * dt
        yield sum(peak * sin(2.0 * pi * f * time) + random.random() * _NOISE for peak, f in zip(_PEAKS, hertz))
