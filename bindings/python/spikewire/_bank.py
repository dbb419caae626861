"""Several channels as one stream of events."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _scheme as _base
from ._arrays import Whole
from ._errors import Error
from ._times import Period, micros, period_in_micros

#: An event: its time ``t`` in µs, its address ``x`` and its polarity ``p``, 1 up and 0 down. Names and order are those
#: of the field, so that ``tonic`` and others take such arrays; ``y`` is left out, as there is no second axis.
EVENTS = np.dtype([("t", np.int64), ("x", np.int64), ("p", np.int64)])


class Bank:
    """One scheme for all channels of an array, as the flight controller has it.

    >>> import numpy as np, spikewire as sw
    >>> x = np.array([[0.0, 1.0, 1.0], [0.0, 0.0, -1.0]])
    >>> sw.Bank(sw.StepForward(threshold=0.5), channels=2).encode(x, period=1000)
    array([(1000, 0, 1), (2000, 1, 0)],
          dtype=[('t', '<i8'), ('x', '<i8'), ('p', '<i8')])
    """

    def __init__(self, scheme: _base.Scheme, channels: Whole):
        self._encoder = scheme.encoder(channels)
        self.scheme: _base.Scheme = scheme
        self.channels: int = int(channels)
        self._done = 0

    def __repr__(self) -> str:
        return f"Bank({self.scheme!r}, channels={self.channels})"

    def encode(self, x: ArrayLike, period: Period) -> NDArray[Any]:
        """The events of the next samples, (channels, samples), one every `period` µs; the bank goes on from there.

        >>> import numpy as np, spikewire as sw
        >>> bank = sw.Bank(sw.StepForward(threshold=0.5), channels=1)
        >>> bank.encode([[0.0, 1.0]], period=1000).tolist(), bank.encode([[2.0]], np.timedelta64(1, "ms")).tolist()
        ([(1000, 0, 1)], [(2000, 0, 1)])
        """
        each = period_in_micros(period)
        return self._events(self._encoder.encode(x), each)

    def finish(self, period: Period) -> NDArray[Any]:
        """The events of the samples that wait for later ones. The bank is as at its start then.

        >>> import spikewire as sw
        >>> bank = sw.Bank(sw.Hough(filter=[0.5, 1.0, 0.5], shift=0), channels=1)
        >>> bank.encode([[2.0, 2.0, 2.0, 2.0]], period=1000)["t"].tolist(), len(bank.finish(period=1000))
        ([0, 1000], 0)
        """
        events = self._events(self._encoder.finish(), period)
        self._done = 0
        return events

    def _events(self, codes: NDArray[np.int8], period: Period) -> NDArray[Any]:
        neurons, slots = self._encoder._native.shape()
        codes = codes.reshape(self.channels, -1, slots, neurons)
        found = events(codes, period, None, self._done)
        self._done += codes.shape[1]
        return found


def events(codes: NDArray[Any], period: Period, times: ArrayLike | None = None, first: int = 0) -> NDArray[Any]:
    """The events of codes (channels, samples, sub-timesteps, neurons), from the sample of this number on."""
    channels, length, slots, neurons = codes.shape
    if channels * neurons > 1 << 16:
        raise Error(f"{channels} channels of {neurons} neurons are more than 65536 addresses")
    by_time = codes.transpose(1, 2, 0, 3)
    sample, slot, channel, neuron = np.nonzero(by_time)
    counts = by_time[sample, slot, channel, neuron]
    start: NDArray[Any]
    step: Any
    if times is None:
        step = period_in_micros(period)
        start = (first + sample) * step
    else:
        times = micros(times)
        if times.shape != (length,):
            raise Error(f"times are {times.shape}, but there are {length} samples")
        if (np.diff(times) < 0).any():
            raise Error(f"times go back after sample {int(np.argmin(np.diff(times)))}")
        steps = np.diff(times, append=times[-1:] + (np.median(np.diff(times)) if length > 1 else 0))
        start, step = times[sample], steps[sample]
    found = np.empty(len(sample), dtype=EVENTS)
    found["t"] = start + step * slot // slots
    found["x"] = channel * neurons + neuron
    found["p"] = counts > 0
    return np.repeat(found, np.abs(counts.astype(np.int64)))
