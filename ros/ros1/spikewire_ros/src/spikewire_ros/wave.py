"""The toolbox's signal: three sines and noise."""

from math import pi, sin
from random import Random
from typing import Iterator

# As `generate_spikes.py` has them.
_SINES = ((2.0, 1.0), (-0.5, 3.0), (0.75, 5.0))
_NOISE = 0.2


def wave(dt: float, t_max: float, seed: int) -> Iterator[float]:
    """A sample every `dt` seconds, for `t_max` seconds. Each sine brings even noise from 0 to 0.2."""
    for name, value in (("dt", dt), ("T_max", t_max)):
        if not 0.0 < value < float("inf"):
            raise ValueError(f"{name} {value}: it must be above 0 and finite, in seconds")
    random = Random(seed)
    for index in range(round(t_max / dt)):
        time = index * dt
        yield sum(peak * sin(2.0 * pi * hertz * time) + random.random() * _NOISE for peak, hertz in _SINES)
