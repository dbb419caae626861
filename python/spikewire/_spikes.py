"""What encoding returns."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native, _progress
from ._arrays import cells, row

if TYPE_CHECKING:
    from collections.abc import Callable

    from ._scheme import Scheme


class Spikes:
    """The spikes of an array of samples, and all that decoding needs.

    ``array`` holds them: ``int8`` of the samples' shape, -1 for a spike down, 1 for one up and more where a code sends
    several spikes a sample. Codes of populations add an axis of neurons at the end, and those with sub-timesteps one of
    these before it.
    """

    def __init__(self, scheme: Scheme, fitted: Any, flat: NDArray[np.int8], shape: tuple, cell_shape: tuple):
        self._scheme, self._fitted, self._shape = scheme, fitted, cell_shape
        #: The spikes, ``int8``.
        self.array: NDArray[np.int8] = flat.reshape(*shape, *row(cell_shape))

    @property
    def scheme(self) -> Scheme:
        """The scheme that made them."""
        return self._scheme

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of ``array``."""
        return self.array.shape

    @property
    def neurons(self) -> int:
        """How many neurons a channel has."""
        return self._shape[0]

    @property
    def slots(self) -> int:
        """How many sub-timesteps a sample has."""
        return self._shape[1]

    @property
    def latency(self) -> int:
        """How many samples after its own a spike comes out in flight. ``array`` has it at its own sample."""
        return self._fitted.latency()

    @property
    def parameters(self) -> list[dict[str, str]]:
        """The parameters of each channel as they ran, in the sample type, texts by name."""
        return [dict(own) for own in self._fitted.parameters()]

    @property
    def count(self) -> int:
        """How many spikes there are in all."""
        return int(np.abs(self.array.astype(np.int64)).sum())

    @property
    def samples(self) -> int:
        """How many samples there are in all."""
        return self.array.size // (self.neurons * self.slots)

    @property
    def efficiency(self) -> float:
        """Percent of the samples without a spike, where each has one at most."""
        return (1 - self.count / max(self.samples, 1)) * 100

    def decode(self, progress: bool | Callable[[int, int], object] | None = None) -> NDArray:
        """What a decoder makes of them: ``float32`` of ``f32``, ``int16`` of ``i16``, else ``float64``."""
        flat, outer = cells(self.array, self._shape, type(self._scheme).__name__)
        channels = int(np.prod(outer[:-1]))
        with _progress.bar(progress, "decode") as tell:
            return self._fitted.decode(flat, channels, tell).reshape(outer)

    def events(self, period: float = 1, times: ArrayLike | None = None) -> NDArray:
        """The spikes as a structured array, in the order of time; see :data:`~spikewire.EVENTS`.

        A sample lasts `period` µs, or `times` has each sample's time in µs. Channels count their neurons on: the
        address of the second channel's first neuron is ``neurons``.
        """
        from ._bank import events

        flat, outer = cells(self.array, self._shape, type(self._scheme).__name__)
        return events(flat.reshape(-1, outer[-1], self.slots, self.neurons), period, times)

    def fingerprint(self, before: int = 0xCBF29CE484222325, values: ArrayLike | None = None) -> int:
        """The hash of all spikes and decoded bits, channel after channel, that the firmware prints of a flight.

        FNV-1a of 64 bits; `before` is the hash of the channels before these, if there are any. `values` is what
        another decoder made of the spikes.
        """
        flat, _ = cells(self.array, self._shape, type(self._scheme).__name__)
        values = self.decode(progress=False) if values is None else values
        values = np.asarray(values, dtype=np.float64).reshape(-1)
        return _native.fingerprint(flat, values, self.neurons, self.slots, before)

    def __reduce__(self) -> Any:
        outer = self.array.shape[: self.array.ndim - len(row(self._shape))]
        return _again, (self._scheme, self._fitted.parts(), self.array.reshape(-1), outer, self._shape)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray:
        if copy is False and dtype not in (None, self.array.dtype):
            raise ValueError(f"spikes are {self.array.dtype}; {dtype} needs a copy")
        array = self.array if dtype is None else self.array.astype(dtype, copy=False)
        return array.copy() if copy else array

    def __len__(self) -> int:
        return len(self.array)

    def __getitem__(self, place: Any) -> Any:
        return self.array[place]

    def __repr__(self) -> str:
        of = type(self._scheme).__name__
        return f"Spikes of {of}: {self.shape}, {self.count} spikes of {self.samples} samples"


def _again(scheme, parts, flat, shape, cell_shape):
    return Spikes(scheme, _native.Fitted.of_parts(*parts), flat, shape, cell_shape)
