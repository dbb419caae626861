"""Encoders and decoders that keep their state between chunks."""

import numpy as np

from ._arrays import cells, row, samples


class Encoder:
    """Encodes chunk after chunk; the codes of all chunks and of :meth:`finish` are those of the whole.

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

    def __init__(self, scheme, channels=None):
        self._scheme, self._channels = scheme, channels
        self._native = scheme._coder.encoder(channels or 1)
        self._shape = None

    def encode(self, x):
        """The codes that the next samples, (samples,) or (channels, samples), complete: `int8`, as ``Spikes.array``.

        Those of a rate code are as many samples late as it looks ahead. What is not finite is an error, and taken is
        nothing then.
        """
        x = samples(x)
        if x.ndim != (1 if self._channels is None else 2):
            told = "(samples,)" if self._channels is None else f"({self._channels}, samples)"
            raise ValueError(f"a chunk is an array {told}, not {x.shape}")
        return self._rows(self._native.encode(x))

    def finish(self):
        """The codes of the samples that wait for later ones. The encoder is as at its start then."""
        return self._rows(self._native.finish())

    def _rows(self, flat):
        inner = row(self._native.shape())
        outer = (-1,) if self._channels is None else (self._channels, -1)
        if flat.size == 0:
            outer = outer[:-1] + (0,)
        return flat.reshape(*outer, *inner)


class Decoder:
    """Decodes chunk after chunk.

    >>> import spikewire as sw
    >>> decoder = sw.StepForward(threshold=0.5).decoder(first=1.0)
    >>> decoder.decode([0, 1, 1, -1]), decoder.decode([1])
    (array([1. , 1.5, 2. , 1.5], dtype=float32), array([2.], dtype=float32))
    """

    def __init__(self, scheme, first=None, channels=None):
        has_first = scheme._info["has_first_value"] and "start" not in scheme.parameters
        if first is None and has_first:
            raise ValueError(
                f"{scheme.name} decodes from a first value: first=, the first sample of each channel, or start="
            )
        first = np.asarray(0.0 if first is None else first, dtype=float)
        if channels is None and first.ndim == 1:
            channels = len(first)
        firsts = np.broadcast_to(first, (channels or 1,))
        self._set(scheme, scheme._coder.decoder(list(firsts)), scheme._coder.shape(), channels)

    @classmethod
    def _of(cls, scheme, native, shape, channels):
        own = cls.__new__(cls)
        own._set(scheme, native, shape, channels)
        return own

    def _set(self, scheme, native, shape, channels):
        self._scheme, self._native, self._shape, self._channels = scheme, native, shape, channels

    def decode(self, codes):
        """The values of the next codes, an array as :meth:`Encoder.encode` returns it."""
        flat, outer = cells(codes, self._shape, type(self._scheme).__name__)
        channels = int(np.prod(outer[:-1]))
        if channels != (self._channels or 1):
            raise ValueError(f"there are {self._channels or 1} channels, not {channels}")
        return self._native.decode(flat, outer[-1]).reshape(outer)
