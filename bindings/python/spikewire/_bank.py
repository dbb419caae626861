"""Several channels as one stream of events."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from ._scheme import Scheme

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

    def __init__(self, scheme: Scheme, channels: int):
        self._encoder = scheme.encoder(channels)
        self.scheme: Scheme = scheme
        self.channels: int = channels
        self._done = 0

    def __repr__(self) -> str:
        return f"Bank({self.scheme!r}, channels={self.channels})"

    def encode(self, x: ArrayLike, period: float) -> NDArray[Any]:
        """The events of the next samples, (channels, samples), one every `period` µs; the bank goes on from there."""
        return self._events(self._encoder.encode(x), period)

    def finish(self, period: float) -> NDArray[Any]:
        """The events of the samples that wait for later ones. The bank is as at its start then."""
        events = self._events(self._encoder.finish(), period)
        self._done = 0
        return events

    def _events(self, codes: NDArray[np.int8], period: float) -> NDArray[Any]:
        neurons, slots = self._encoder._native.shape()
        codes = codes.reshape(self.channels, -1, slots, neurons)
        found = events(codes, period, None, self._done)
        self._done += codes.shape[1]
        return found


def events(codes: NDArray[Any], period: float, times: ArrayLike | None = None, first: int = 0) -> NDArray[Any]:
    """The events of codes (channels, samples, sub-timesteps, neurons), from the sample of this number on."""
    channels, length, slots, neurons = codes.shape
    if channels * neurons > 1 << 16:
        raise ValueError(f"{channels} channels of {neurons} neurons are more than 65536 addresses")
    by_time = codes.transpose(1, 2, 0, 3)
    sample, slot, channel, neuron = np.nonzero(by_time)
    counts = by_time[sample, slot, channel, neuron]
    if times is None:
        start = (first + sample) * period
        step = period
    else:
        times = np.asarray(times)
        if times.shape != (length,):
            raise ValueError(f"times are {times.shape}, but there are {length} samples")
        steps = np.diff(times, append=times[-1:] + (np.median(np.diff(times)) if length > 1 else 0))
        start, step = times[sample], steps[sample]
    found = np.empty(len(sample), dtype=EVENTS)
    found["t"] = start + step * slot // slots
    found["x"] = channel * neurons + neuron
    found["p"] = counts > 0
    return np.repeat(found, np.abs(counts.astype(np.int64)))
