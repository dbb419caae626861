"""What encoding returns."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native, _progress
from . import _scheme as _base
from ._arrays import cells, row
from ._errors import CallError, Error
from ._times import Period


class Spikes(np.ndarray[Any, np.dtype[np.int8]]):
    """The spikes of an array of samples, and all that decoding needs.

    They are an array of NumPy themselves, for all that takes one, such as ``torch.from_numpy`` and ``pandas.DataFrame``;
    they calculate and compare cell by cell, and what comes of it, a part of them too, is a plain array.

    >>> import numpy as np, spikewire as sw
    >>> spikes = sw.StepForward(threshold=0.4).encode([0.0, 1.0, 1.0, 0.0])
    >>> int(np.count_nonzero(spikes == 1)), int(spikes.sum()), (2 * spikes).tolist()
    (2, 1, [0, 2, 2, -2])

    ``array`` holds them: ``int8`` of the samples' shape, -1 for a spike down, 1 for one up and more where a code sends
    several spikes a sample. Codes of populations add an axis of neurons at the end, and those with sub-timesteps one of
    these before it.
    """

    #: The spikes as a plain array, ``int8``, which shares their memory.
    array: NDArray[np.int8]
    #: What the channels are called, if the samples came in a table or an array with labels.
    names: list[str] | None

    _scheme: _base.Scheme
    _fitted: Any
    _shape: tuple[int, int]
    _axis: int

    def __new__(
        cls,
        scheme: _base.Scheme,
        fitted: Any,
        flat: NDArray[np.int8],
        shape: tuple[Any, ...],
        cell_shape: tuple[int, int],
        axis: int = -1,
        names: list[str] | None = None,
    ) -> Spikes:
        axes, axis = len(shape), axis % len(shape)
        array = np.moveaxis(flat.reshape(*shape, *row(cell_shape)), axes - 1, axis)
        own = array.view(cls)
        own.array, own.names = array, names
        own._scheme, own._fitted, own._shape, own._axis = scheme, fitted, cell_shape, axis
        return own

    @property
    def _axes(self) -> int:
        """How many axes the samples had."""
        return self.ndim - len(row(self._shape))

    def _flat(self) -> tuple[NDArray[np.int8], tuple[int, ...]]:
        """The cells, flat, one channel after the other, and the shape of what they decode to, with time last."""
        by_time = np.moveaxis(self.array, self._axis, self._axes - 1)
        return cells(by_time, self._shape, type(self._scheme).__name__)

    @property
    def scheme(self) -> _base.Scheme:
        """The scheme that made them."""
        return self._scheme

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
        """What a decoder makes of them: ``float32`` of ``f32``, ``int16`` of ``i16``, else ``float64``.

        >>> import spikewire as sw
        >>> sw.StepForward(threshold=0.5).encode([0.0, 1.0, 2.0]).decode().tolist()
        [0.0, 0.5, 1.0]
        """
        flat, outer = self._flat()
        channels = int(np.prod(outer[:-1]))
        if self._fitted is None:
            types = {"f32": np.float32, "i16": np.int16}
            values = np.zeros(outer, types.get(self._scheme.sample, np.float64))
        else:
            with _progress.bar(progress, "decode") as tell:
                values = self._fitted.decode(flat, channels, tell).reshape(outer)
        return np.moveaxis(values, -1, self._axis)

    def events(self, period: Period = 1, times: ArrayLike | None = None) -> NDArray[Any]:
        """The spikes as a structured array, in the order of time; see :data:`~spikewire.EVENTS`.

        A sample lasts `period` µs or a timedelta, or `times` has each sample's time: in whole µs, in seconds as floats, or
        as ``datetime64``. Channels count their neurons on: the address of the second channel's first neuron is ``neurons``.

        >>> import spikewire as sw
        >>> spikes = sw.StepForward(threshold=0.5).encode([0.0, 1.0, -1.0])
        >>> spikes.events(period=1000).tolist(), spikes.events(times=[0.0, 0.5, 0.75]).tolist()
        ([(1000, 0, 1), (2000, 0, 0)], [(500000, 0, 1), (750000, 0, 0)])
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

        >>> import spikewire as sw
        >>> from matplotlib.figure import Figure
        >>> axes = sw.StepForward(threshold=0.5).encode([0.0, 1.0, 0.0]).raster(Figure().subplots(), rate=200)
        >>> axes.get_xlabel()
        'time in s'
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

        >>> import spikewire as sw
        >>> spikes = sw.StepForward(threshold=0.5).encode([0.0, 1.0, 0.0])
        >>> f"{spikes.fingerprint():016x}"
        '5432d4e8ff2e59c5'
        """
        flat, _ = self._flat()
        values = self.decode(progress=False) if values is None else np.asarray(values)
        values = np.moveaxis(values, self._axis, -1).astype(np.float64).reshape(-1)
        return _native.fingerprint(flat, values, self.neurons, self.slots, before)

    def __reduce__(self) -> Any:
        flat, outer = self._flat()
        parts = self._fitted.parts() if self._fitted else None
        return _again, (self._scheme, parts, flat, outer, self._shape, self._axis, self.names)

    def __reduce_ex__(self, protocol: Any) -> Any:
        return self.__reduce__()

    def __copy__(self) -> Spikes:
        function, arguments = self.__reduce__()
        return function(*arguments)

    def __deepcopy__(self, memo: Any) -> Spikes:
        function, arguments = self.__reduce__()
        return function(*copy.deepcopy(arguments, memo))

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **keywords: Any) -> Any:
        if any(isinstance(own, Spikes) for own in keywords.get("out", ())):
            raise CallError("spikes are not written to; their array is")
        return getattr(ufunc, method)(*map(_plain, inputs), **keywords)

    def __array_function__(self, function: Any, types: Any, arguments: Any, keywords: Any) -> Any:
        made = super().__array_function__(function, types, arguments, keywords)
        return type(made)(map(_plain, made)) if type(made) in (list, tuple) else _plain(made)

    def __getitem__(self, place: Any) -> Any:
        return _plain(self)[place]

    def __setitem__(self, place: Any, value: Any) -> None:
        raise CallError("spikes are not written to; their array is")

    def __iter__(self) -> Any:
        return iter(_plain(self))

    def __repr__(self) -> str:
        if not hasattr(self, "_scheme"):
            # NumPy's own code made a copy that knows no scheme.
            return repr(_plain(self))
        of = type(self._scheme).__name__
        return f"Spikes of {of}: {self.shape}, {self.count} spikes of {self.samples} samples"

    __str__ = __repr__


def _plain(own: Any) -> Any:
    """An array of NumPy in the place of spikes."""
    return np.ndarray.view(own, np.ndarray) if isinstance(own, Spikes) else own


def _delegate(name: str) -> Any:
    """A method or attribute of arrays, whose result is one of the plain array."""
    words = f"``numpy.ndarray.{name}`` of the plain array."
    if not callable(getattr(np.ndarray, name)):
        return property(lambda self: getattr(_plain(self), name), doc=words)

    def method(self: Spikes, *arguments: Any, **keywords: Any) -> Any:
        return getattr(_plain(self), name)(*arguments, **keywords)

    method.__name__, method.__doc__ = name, words
    return method


# Those that give an array would give spikes without a scheme.
for _name in dir(np.ndarray):
    if not _name.startswith("_") and _name not in ("shape", "strides", "dtype") and _name not in vars(Spikes):
        setattr(Spikes, _name, _delegate(_name))


def _again(
    scheme: _base.Scheme, parts: Any, flat: NDArray[np.int8], shape: Any, cell_shape: Any, axis: int, names: list[str] | None
) -> Spikes:
    fitted = _native.Fitted.of_parts(*parts) if parts else None
    return Spikes(scheme, fitted, flat, shape, cell_shape, axis, names)
