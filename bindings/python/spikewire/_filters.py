"""Filters before a code, and filters of rate codes by what they let pass."""

from __future__ import annotations

import functools
import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import Number, Whole, remark, samples
from ._errors import Error, checked


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

    def __init__(self, *stages: tuple[Any, ...]):
        #: The filters in a row: the name of each one's constructor, and its arguments.
        self._stages = stages
        first, *others = (getattr(_native.Filter, kind)(*arguments) for kind, *arguments in stages)
        self._native = functools.reduce(lambda all, own: all.then(own), others, first)

    @classmethod
    @checked
    def low_pass(cls, corner: Number, rate: Number, q: Number | None = None) -> Filter:
        """Second order: Butterworth's unless `q` is given.

        >>> import spikewire as sw
        >>> round(sw.Filter.low_pass(40, rate=500).delay, 1)
        2.8
        """
        return cls(("low_pass", float(corner), float(rate), None if q is None else float(q)))

    @classmethod
    @checked
    def first_order(cls, corner: Number, rate: Number) -> Filter:
        """A low-pass of first order, which has the least delay.

        >>> import spikewire as sw
        >>> round(sw.Filter.first_order(40, rate=500).delay, 1)
        1.6
        """
        return cls(("first_order", float(corner), float(rate)))

    @classmethod
    @checked
    def notch(cls, centre: Number, rate: Number, q: Number) -> Filter:
        """Takes a line out, and some `centre / q` around it.

        >>> import numpy as np, spikewire as sw
        >>> line = np.sin(np.arange(2000) * 2 * np.pi * 60 / 500)
        >>> bool(np.abs(sw.Filter.notch(60, rate=500, q=2).filter(line)[-100:]).max() < 1e-3)
        True
        """
        return cls(("notch", float(centre), float(rate), float(q)))

    def then(self, other: Filter) -> Filter:
        """This filter, and another behind it.

        >>> import spikewire as sw
        >>> sw.Filter.notch(60, rate=500, q=2).then(sw.Filter.first_order(40, rate=500))
        Filter.notch(60, rate=500, q=2).then(Filter.first_order(40, rate=500))
        """
        return Filter(*self._stages, *other._stages)

    @property
    def delay(self) -> float:
        """The group delay at DC, in samples."""
        return self._native.delay()

    def filter(self, x: ArrayLike, sample: str = "f32", axis: int | None = None) -> NDArray[np.float64]:
        """Filters along `axis`, that of time as for :meth:`Scheme.encode`, with the bits of a firmware whose samples are of
        this type. A sample that is not finite is an error, and one that the type clamps a warning.

        >>> import numpy as np, spikewire as sw
        >>> sw.Filter.first_order(40, rate=500).filter([[0.0, 1.0, 1.0], [2.0, 2.0, 2.0]]).round(2).tolist()
        [[0.0, 0.39, 0.63], [2.0, 2.0, 2.0]]
        """
        (_, time, _), lanes = samples(x, axis)
        filtered = self._native.filter(lanes, sample).reshape(lanes.shape)
        remark(sample, lanes)
        return np.moveaxis(filtered, -1, time)

    def __reduce__(self) -> Any:
        return Filter, self._stages

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Filter) and self._stages == other._stages

    def __hash__(self) -> int:
        return hash(self._stages)

    def __repr__(self) -> str:
        first, *others = (_stage_words(*stage) for stage in self._stages)
        return first + "".join(f".then({own})" for own in others)


def _stage_words(kind: str, corner: float, rate: float, q: float | None = None) -> str:
    return f"Filter.{kind}({corner:g}, rate={rate:g}{'' if q is None else f', q={q:g}'})"


@checked
def low_pass(cut_off: Number, rate: Number, length: Whole | None = None, sum: Number = 1.0) -> NDArray[np.float64]:
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
        raise Error(f"rate {rate} must be above 0 and finite")
    if not 0 < cut_off < rate / 2:
        raise Error(f"cut_off {cut_off} must be above 0 and below half the rate, {rate / 2}")
    deviation = rate * math.sqrt(math.log(2)) / (2 * math.pi * cut_off)
    if length is None:
        length = 2 * math.ceil(3 * deviation) + 1
    if not 1 <= length <= 4096:
        raise Error(f"length {length} must be 1 to 4096 taps; a higher cut_off needs fewer")
    if length % 2 == 0:
        raise Error(f"length {length} must be odd: the filter's middle is a tap")
    places = np.arange(length) - length // 2
    taps = np.exp(-0.5 * (places / deviation) ** 2)
    return taps * (sum / taps.sum())
