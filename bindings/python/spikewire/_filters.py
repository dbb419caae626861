"""Filters before a code, and filters of rate codes by what they let pass."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native


class Filter:
    """A filter before a code, as the crate has it in every sample type: against vibration, which a code would spend spikes on.

    Corners and centres are in Hz, 0.001 to 0.49 of the `rate` of the samples; `q` is 0.1 to 100. `delay` is by how many
    samples a slow signal comes late: what a control loop waits for it. :class:`Sender` takes one as ``filter=``.

    >>> import numpy as np, spikewire as sw
    >>> quiet = sw.Filter.notch(250, rate=1000, q=2).then(sw.Filter.low_pass(80, rate=1000))
    >>> quiet, round(quiet.delay, 1)
    (Filter.notch(250, rate=1000, q=2).then(Filter.low_pass(80, rate=1000)), 3.0)
    >>> shaken = 1 + np.sin(np.pi / 2 * np.arange(400))
    >>> bool(abs(quiet.filter(shaken)[-100:] - 1).max() < 0.001)
    True
    """

    def __init__(self, native: _native.Filter, words: str):
        self._native, self._words = native, words

    @classmethod
    def low_pass(cls, corner: float, rate: float, q: float | None = None) -> Filter:
        """Second order: Butterworth's unless `q` is given."""
        given = "" if q is None else f", q={q:g}"
        return cls(_native.Filter.low_pass(corner, rate, q), f"Filter.low_pass({corner:g}, rate={rate:g}{given})")

    @classmethod
    def first_order(cls, corner: float, rate: float) -> Filter:
        """A low-pass of first order, which has the least delay."""
        return cls(_native.Filter.first_order(corner, rate), f"Filter.first_order({corner:g}, rate={rate:g})")

    @classmethod
    def notch(cls, centre: float, rate: float, q: float) -> Filter:
        """Takes a line out, and some `centre / q` around it."""
        return cls(_native.Filter.notch(centre, rate, q), f"Filter.notch({centre:g}, rate={rate:g}, q={q:g})")

    def then(self, other: Filter) -> Filter:
        """This filter, and another behind it."""
        return Filter(self._native.then(other._native), f"{self!r}.then({other!r})")

    @property
    def delay(self) -> float:
        """The group delay at DC, in samples."""
        return self._native.delay()

    def filter(self, x: ArrayLike, sample: str = "f32", axis: int = -1) -> NDArray[np.float64]:
        """Filters along `axis`, with the bits of a firmware whose samples are of this type."""
        one = lambda lane: self._native.filter(np.ascontiguousarray(lane, dtype=np.float64), sample)
        return np.apply_along_axis(one, axis, np.asarray(x))

    def __repr__(self) -> str:
        return self._words


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
