"""What encoding returns."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import _native, _progress
from ._arrays import cells, row

if TYPE_CHECKING:
    from collections.abc import Callable

    from ._scheme import Scheme


class Spikes(NDArrayOperatorsMixin):
    """The spikes of an array of samples, and all that decoding needs.

    They calculate and compare as ``array`` does, cell by cell, and what comes of it is an array of NumPy.

    >>> import numpy as np, spikewire as sw
    >>> spikes = sw.StepForward(threshold=0.4).encode([0.0, 1.0, 1.0, 0.0])
    >>> int(np.count_nonzero(spikes == 1)), int(spikes.sum()), (2 * spikes).tolist()
    (2, 1, [0, 2, 2, -2])

    ``array`` holds them: ``int8`` of the samples' shape, -1 for a spike down, 1 for one up and more where a code sends
    several spikes a sample. Codes of populations add an axis of neurons at the end, and those with sub-timesteps one of
    these before it.
    """

    def __init__(
        self, scheme: Scheme, fitted: Any, flat: NDArray[np.int8], shape: tuple[Any, ...], cell_shape: tuple[Any, ...], axis: int = -1
    ):
        self._scheme, self._fitted, self._shape = scheme, fitted, cell_shape
        self._axes, self._axis = len(shape), axis % len(shape)
        #: The spikes, ``int8``.
        self.array: NDArray[np.int8] = np.moveaxis(
            flat.reshape(*shape, *row(cell_shape)), self._axes - 1, self._axis
        )

    def _flat(self) -> tuple[NDArray[np.int8], tuple[int, ...]]:
        """The cells, flat, one channel after the other, and the shape of what they decode to, with time last."""
        by_time = np.moveaxis(self.array, self._axis, self._axes - 1)
        return cells(by_time, self._shape, type(self._scheme).__name__)

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
        return (self._fitted or self._scheme._coder).latency()

    @property
    def parameters(self) -> list[dict[str, str]]:
        """The parameters of each channel as they ran, in the sample type, texts by name."""
        return [dict(own) for own in self._fitted.parameters()] if self._fitted else []

    @property
    def count(self) -> int:
        """How many spikes there are in all."""
        return int(np.abs(self.array).view(np.uint8).sum(dtype=np.int64))

    @property
    def samples(self) -> int:
        """How many samples there are in all."""
        return self.array.size // (self.neurons * self.slots)

    @property
    def efficiency(self) -> float:
        """Percent of the samples without a spike, where each has one at most."""
        return (1 - self.count / max(self.samples, 1)) * 100

    def decode(self, progress: bool | Callable[[int, int], object] | None = None) -> NDArray[Any]:
        """What a decoder makes of them: ``float32`` of ``f32``, ``int16`` of ``i16``, else ``float64``."""
        flat, outer = self._flat()
        channels = int(np.prod(outer[:-1]))
        if self._fitted is None:
            types = {"f32": np.float32, "i16": np.int16}
            values = np.zeros(outer, types.get(self._scheme.sample, np.float64))
        else:
            with _progress.bar(progress, "decode") as tell:
                values = self._fitted.decode(flat, channels, tell).reshape(outer)
        return np.moveaxis(values, -1, self._axis)

    def events(self, period: float = 1, times: ArrayLike | None = None) -> NDArray[Any]:
        """The spikes as a structured array, in the order of time; see :data:`~spikewire.EVENTS`.

        A sample lasts `period` µs, or `times` has each sample's time in µs. Channels count their neurons on: the
        address of the second channel's first neuron is ``neurons``.
        """
        from ._bank import EVENTS, events

        if self._fitted is None:
            return np.zeros(0, EVENTS)
        flat, outer = self._flat()
        return events(flat.reshape(-1, outer[-1], self.slots, self.neurons), period, times)

    def raster(self, axes: Any = None, rate: float | None = None, **style: Any) -> Any:
        """Draws the spikes on `axes` of matplotlib, its current ones unless given, and returns them.

        Each address is a row; a spike down is of another colour than one up. Time is in seconds if `rate`, in samples a
        second, is given, and else in samples. `style` goes to ``scatter``.
        """
        if axes is None:
            from matplotlib import pyplot

            axes = pyplot.gca()
        flat, outer = self._flat()
        slots, neurons = self.slots, self.neurons
        codes = flat.reshape(-1, outer[-1], slots, neurons)
        channel, sample, slot, neuron = np.nonzero(codes)
        times = (sample + slot / slots) / (rate or 1)
        colours = np.where(codes[channel, sample, slot, neuron] > 0, "C0", "C3")
        axes.scatter(times, channel * neurons + neuron, **{"c": colours, "marker": "|", **style})
        axes.set_xlabel("time in s" if rate else "sample")
        axes.set_ylabel("address" if neurons > 1 else "channel")
        return axes

    def fingerprint(self, before: int = 0xCBF29CE484222325, values: ArrayLike | None = None) -> int:
        """The hash of all spikes and decoded bits, channel after channel, that the firmware prints of a flight.

        FNV-1a of 64 bits; `before` is the hash of the channels before these, if there are any. `values` is what
        another decoder made of the spikes.
        """
        flat, _ = self._flat()
        values = self.decode(progress=False) if values is None else np.asarray(values)
        values = np.moveaxis(values, self._axis, -1).astype(np.float64).reshape(-1)
        return _native.fingerprint(flat, values, self.neurons, self.slots, before)

    def __reduce__(self) -> Any:
        flat, outer = self._flat()
        parts = self._fitted.parts() if self._fitted else None
        return _again, (self._scheme, parts, flat, outer, self._shape, self._axis)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        if copy is False and dtype not in (None, self.array.dtype):
            raise ValueError(f"spikes are {self.array.dtype}; {dtype} needs a copy")
        array = self.array if dtype is None else self.array.astype(dtype, copy=False)
        return array.copy() if copy else array

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **keywords: Any) -> Any:
        if any(isinstance(own, Spikes) for own in keywords.get("out", ())):
            raise TypeError("spikes are not written to; their array is")
        arrays = (own.array if isinstance(own, Spikes) else own for own in inputs)
        return getattr(ufunc, method)(*arrays, **keywords)

    def __buffer__(self, flags: int) -> memoryview:
        # Python asks for it from 3.12.
        return self.array.__buffer__(flags)

    def __dlpack__(self, **keywords: Any) -> Any:
        return self.array.__dlpack__(**keywords)

    def __dlpack_device__(self) -> tuple[int, int]:
        return self.array.__dlpack_device__()

    @property
    def ndim(self) -> int:
        """The number of axes of ``array``."""
        return self.array.ndim

    @property
    def size(self) -> int:
        """The number of cells of ``array``."""
        return self.array.size

    @property
    def dtype(self) -> np.dtype[np.int8]:
        """``int8``."""
        return self.array.dtype

    @property
    def T(self) -> NDArray[np.int8]:
        """``array`` with its axes in reverse order."""
        return self.array.T

    def astype(self, dtype: DTypeLike, **keywords: Any) -> NDArray[Any]:
        """``array`` in another type, as ``numpy.ndarray.astype``."""
        return self.array.astype(dtype, **keywords)

    def sum(self, axis: int | tuple[int, ...] | None = None, **keywords: Any) -> Any:
        """The sum of the cells, up less down, as ``numpy.ndarray.sum``; :attr:`count` counts both."""
        return self.array.sum(axis, **keywords)

    def mean(self, axis: int | tuple[int, ...] | None = None, **keywords: Any) -> Any:
        """The mean of the cells, as ``numpy.ndarray.mean``."""
        return self.array.mean(axis, **keywords)

    def __len__(self) -> int:
        return len(self.array)

    def __getitem__(self, place: Any) -> Any:
        return self.array[place]

    def __repr__(self) -> str:
        of = type(self._scheme).__name__
        return f"Spikes of {of}: {self.shape}, {self.count} spikes of {self.samples} samples"


def _again(scheme, parts, flat, shape, cell_shape, axis):
    fitted = _native.Fitted.of_parts(*parts) if parts else None
    return Spikes(scheme, fitted, flat, shape, cell_shape, axis)
