"""Times and periods in whole µs."""

from __future__ import annotations

import datetime
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray

from ._arrays import Number, read, warn
from ._errors import Error

#: A time from sample to sample: a number is in µs.
Period = Union[Number, datetime.timedelta, "np.timedelta64"]

#: Bits of a time in the formats of events.
BITS = 32


def micros(times: Any) -> NDArray[np.int64]:
    """Times in µs: whole numbers are µs, floats are seconds, and ``datetime64`` and ``timedelta64`` have a unit of their own."""
    times = read(times).array
    kind = times.dtype.kind
    if kind not in "fiumM":
        raise Error(f"times are whole µs, seconds as floats, datetime64 or timedelta64, and not {times.dtype}")
    if kind == "f":
        if not np.isfinite(times).all():
            raise Error(f"time {times[~np.isfinite(times)].flat[0]} is not finite")
        if times.any() and (times == np.trunc(times)).all():
            raise Error("times that are floats are seconds, and these are whole numbers: integers are µs, and timedelta64 has a unit")
        times = np.rint(times.astype(np.float64) * 1e6)
    elif kind in "mM":
        if np.isnat(times).any():
            raise Error("a time is missing (NaT)")
        times = times.astype(f"{kind}8[us]").view(np.int64)
    if times.size and times.min() < 0:
        raise Error(f"time {times.min():.0f} µs is negative")
    if times.size and times.max() > np.iinfo(np.int64).max // 2:
        raise Error(f"time {times.max():.0f} µs is too large")
    return times.astype(np.int64)


def period_in_micros(period: Period) -> float:
    """A period in µs, 1 or more."""
    if isinstance(period, datetime.timedelta):
        period = period.total_seconds() * 1e6
    elif isinstance(period, np.timedelta64):
        period = period / np.timedelta64(1, "us")
    if isinstance(period, bool) or not isinstance(period, (int, float, np.integer, np.floating)):
        raise Error(f"period {period!r} must be a number, in µs, or a timedelta")
    if not 1 <= period < 1 << 53:
        raise Error(f"period {period} must be 1 µs or more and finite: it is in µs, as 1e6 / rate")
    return period if isinstance(period, (int, np.integer)) else float(period)


def ticks(times: Any) -> NDArray[np.uint32]:
    """The times of events in the 32 bits of their formats, which wrap after 71.6 minutes.

    A reader goes on where they wrap, if no gap is longer than half of that.
    """
    times = micros(times)
    gaps = np.abs(np.diff(times))
    if len(gaps) and gaps.max() >= 1 << (BITS - 1):
        place = int(gaps.argmax())
        raise Error(
            f"{gaps[place] / 1e6:.0f} s lie between events {place} and {place + 1}: formats of events have times of {BITS} bits, "
            f"and gaps below {(1 << BITS - 1) / 1e6:.0f} s"
        )
    if len(times) and times[0] >= 1 << BITS:
        warn(f"the first time, {times[0]} µs, has more than {BITS} bits: it is written as {times[0] % (1 << BITS)} µs")
    return (times & ((1 << BITS) - 1)).astype(np.uint32)
