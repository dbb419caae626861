"""Encoders and decoders that keep their state between chunks."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _scheme as _base
from ._arrays import Whole, cells, codes_time_last, read, remark, remark_outside, row, samples
from ._errors import Error, checked


class Encoder:
    """Encodes chunk after chunk; the codes of all chunks and of :meth:`finish` are those of the whole.

    It pickles and copies at any time, with its scheme and its state: as few bytes after a day as after a second. No
    other version of the package reads the pickle.

    >>> import numpy as np, spikewire as sw
    >>> x = np.sin(np.linspace(0, 6, 200))
    >>> scheme = sw.Hough(filter="triang:5,sum=0.5", shift=-1)
    >>> encoder = scheme.encoder()
    >>> chunks = [encoder.encode(chunk) for chunk in np.split(x, 10)] + [encoder.finish()]
    >>> [len(chunk) for chunk in chunks][:2] + [len(chunks[-1])]
    [16, 20, 4]
    >>> bool((np.concatenate(chunks) == scheme.encode(x)).all())
    True
    """

    @checked
    def __init__(self, scheme: _base.Scheme, channels: Whole | None = None):
        if channels is not None and channels < 1:
            raise Error(f"channels {channels} must be 1 or more")
        self._scheme, self._channels = scheme, channels
        self._native = scheme._seeded().encoder(channels or 1)
        self._ranges = scheme._coder.ranges()

    def encode(self, x: ArrayLike) -> NDArray[np.int8]:
        """The codes that the next samples, (samples,) or (channels, samples), complete: ``int8``, as ``Spikes.array``. Of a
        table the columns are the channels.

        Those of a rate code are as many samples late as it looks ahead. Where one is not finite it is an error, and
        none is taken.

        >>> import spikewire as sw
        >>> encoder = sw.StepForward(threshold=0.5).encoder(channels=2)
        >>> encoder.encode([[0.0, 1.0], [0.0, -1.0]]).tolist(), encoder.encode([[2.0], [0.5]]).tolist()
        ([[0, 1], [0, -1]], [[1], [1]])
        """
        _, x = samples(x)
        if x.ndim != (1 if self._channels is None else 2):
            told = "(samples,)" if self._channels is None else f"({self._channels}, samples)"
            raise Error(f"a chunk is an array {told}, not {x.shape}")
        codes = self._rows(self._native.encode(x))
        remark(self._scheme.sample, x)
        remark_outside(self._ranges, self._scheme.sample, x)
        return codes

    def finish(self) -> NDArray[np.int8]:
        """The codes of the samples that wait for later ones. The encoder is as at its start then.

        >>> import spikewire as sw
        >>> encoder = sw.Hough(filter=[0.5, 1.0, 0.5], shift=0).encoder()
        >>> encoder.encode([2.0, 2.0, 2.0, 2.0]).tolist(), encoder.finish().tolist()
        ([1, 1], [0, 0])
        """
        return self._rows(self._native.finish())

    def _rows(self, flat: NDArray[np.int8]) -> NDArray[np.int8]:
        inner = row(self._native.shape())
        outer = () if self._channels is None else (self._channels,)
        return flat.reshape(*outer, flat.size // (int(np.prod(inner)) * (self._channels or 1)), *inner)

    def __repr__(self) -> str:
        return f"{self._scheme!r}.encoder({'' if self._channels is None else f'channels={self._channels}'})"

    def __reduce__(self) -> Any:
        return type(self), (self._scheme, self._channels), self._native.state()

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        self._native.set_state(state)


class Decoder:
    """Decodes chunk after chunk; pickles and copies as :class:`Encoder` does.

    A code of steps needs the `first` value; a code of a mean may have it, and starts from its own middle otherwise.

    >>> import spikewire as sw
    >>> decoder = sw.StepForward(threshold=0.5).decoder(first=1.0)
    >>> decoder.decode([0, 1, 1, -1]), decoder.decode([1])
    (array([1. , 1.5, 2. , 1.5], dtype=float32), array([2.], dtype=float32))
    """

    @checked
    def __init__(self, scheme: _base.Scheme, first: ArrayLike | None = None, channels: Whole | None = None):
        has_first = scheme._info["has_first_value"] and "start" not in scheme.parameters
        if first is None and has_first:
            raise Error(
                f"{scheme.name} decodes from a first value: first=, the first sample of each channel, or start="
            )
        first = None if first is None else read(first).array
        if channels is None and first is not None and first.ndim == 1:
            channels = len(first)
        self._scheme, self._channels = scheme, channels
        firsts = [None if first is None else float(own) for own in np.broadcast_to(first, (channels or 1,))]
        self._native = scheme._coder.decoder(firsts)
        if first is not None:
            remark(scheme.sample, np.array(firsts)[:, None])
        self._shape = scheme._coder.shape()

    def decode(self, codes: ArrayLike) -> NDArray[Any]:
        """The values of the next codes, an array as :meth:`Encoder.encode` returns it.

        A code that no encoder sends is an error, and none of the rows is taken.

        >>> import spikewire as sw
        >>> sw.StepForward(threshold=0.5).decoder(first=[0.0, 5.0]).decode([[0, 1], [0, -1]]).tolist()
        [[0.0, 0.5], [5.0, 4.5]]
        """
        codes, _ = codes_time_last(codes, self._shape, None)
        flat, outer = cells(codes, self._shape, type(self._scheme).__name__)
        if outer[:-1] != (() if self._channels is None else (self._channels,)):
            raise Error(f"there are {self._channels or 1} channels, not codes of the shape {np.shape(codes)}")
        return self._native.decode(flat, outer[-1]).reshape(outer)

    def __repr__(self) -> str:
        return f"{self._scheme!r}.decoder({'' if self._channels is None else f'channels={self._channels}'})"

    def __reduce__(self) -> Any:
        # Where the decoder began does not matter to one that goes on.
        return type(self), (self._scheme, 0.0, self._channels), self._native.state()

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        self._native.set_state(state)
