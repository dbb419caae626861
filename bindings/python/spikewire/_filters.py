"""Filters of rate codes by what they let pass."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray


def low_pass(cut_off: float, rate: float, length: int | None = None, sum: float = 1.0) -> NDArray[np.float64]:
    """Taps of a low-pass for ``filter=`` of :class:`Hough`, :class:`ThresholdHough` and :class:`Bsa`.

    A Gaussian: none of its taps is below 0 and its step response never overshoots, as a code of spikes needs it. At
    `cut_off`, in Hz, it lets 1/√2 (-3 dB) pass; `rate` is that of the samples, in Hz. `length` is an odd number of taps,
    three deviations to each side unless given. Their `sum` is the signal's range above the minimum that the code shall
    reach.

    >>> import spikewire as sw
    >>> taps = sw.low_pass(cut_off=20, rate=1000, sum=2.0)
    >>> len(taps), round(float(taps.sum()), 9)
    (41, 2.0)
    """
    if not (math.isfinite(rate) and rate > 0):
        raise ValueError(f"rate {rate} must be above 0 and finite")
    if not 0 < cut_off < rate / 2:
        raise ValueError(f"cut_off {cut_off} must be above 0 and below half the rate, {rate / 2}")
    deviation = rate * math.sqrt(math.log(2)) / (2 * math.pi * cut_off)
    if length is None:
        length = 2 * math.ceil(3 * deviation) + 1
    if not 1 <= length <= 4096:
        raise ValueError(f"length {length} must be 1 to 4096 taps; a higher cut_off needs fewer")
    if length % 2 == 0:
        raise ValueError(f"length {length} must be odd: the filter's middle is a tap")
    places = np.arange(length) - length // 2
    taps = np.exp(-0.5 * (places / deviation) ** 2)
    return taps * (sum / taps.sum())
