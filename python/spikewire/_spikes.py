"""What encoding returns."""

import numpy as np

from . import _progress
from ._arrays import cells, row
from ._stream import Decoder


class Spikes:
    """The spikes of an array of samples, and all that decoding needs.

    ``array`` holds them: ``int8`` of the samples' shape, -1 for a spike down, 1 for one up and more where a code sends
    several spikes a sample. Codes of populations add an axis of neurons at the end, and those with sub-timesteps one of
    these before it.
    """

    def __init__(self, scheme, fitted, flat, shape, cell_shape):
        self._scheme, self._fitted, self._shape = scheme, fitted, cell_shape
        #: The spikes, ``int8``.
        self.array = flat.reshape(*shape, *row(cell_shape))

    @property
    def scheme(self):
        """The scheme that made them."""
        return self._scheme

    @property
    def shape(self):
        """The shape of ``array``."""
        return self.array.shape

    @property
    def neurons(self):
        """How many neurons a channel has."""
        return self._shape[0]

    @property
    def slots(self):
        """How many sub-timesteps a sample has."""
        return self._shape[1]

    @property
    def latency(self):
        """How many samples after its own a spike comes out in flight. ``array`` has it at its own sample."""
        return self._fitted.latency()

    @property
    def parameters(self):
        """The parameters of each channel as they ran, in the sample type, texts by name."""
        return [dict(own) for own in self._fitted.parameters()]

    @property
    def count(self):
        """How many spikes there are in all."""
        return int(np.abs(self.array.astype(np.int64)).sum())

    @property
    def samples(self):
        """How many samples there are in all."""
        return self.array.size // (self.neurons * self.slots)

    @property
    def efficiency(self):
        """Percent of the samples without a spike, where each has one at most."""
        return (1 - self.count / max(self.samples, 1)) * 100

    def decode(self, progress=None):
        """What a decoder makes of them: ``float32`` of ``f32``, ``int16`` of ``i16``, else ``float64``."""
        flat, outer = cells(self.array, self._shape, type(self._scheme).__name__)
        channels = int(np.prod(outer[:-1]))
        with _progress.bar(progress, "decode") as tell:
            return self._fitted.decode(flat, channels, tell).reshape(outer)

    def decoder(self):
        """A decoder as it starts on this signal, that keeps its state between chunks."""
        outer = self.array.shape[: self.array.ndim - len(row(self._shape))]
        channels = int(np.prod(outer[:-1]))
        return Decoder._of(self._scheme, self._fitted.decoder(channels), self._shape, None if len(outer) == 1 else channels)

    def events(self, period=1, times=None):
        """The spikes as a structured array, in the order of time; see :data:`~spikewire.EVENTS`.

        A sample lasts `period` µs, or `times` has each sample's time in µs. Channels count their neurons on: the
        address of the second channel's first neuron is ``neurons``.
        """
        from ._bank import events

        flat, outer = cells(self.array, self._shape, type(self._scheme).__name__)
        return events(flat.reshape(-1, outer[-1], self.slots, self.neurons), period, times)

    def __array__(self, dtype=None, copy=None):
        if copy is False and dtype not in (None, self.array.dtype):
            raise ValueError(f"spikes are {self.array.dtype}; {dtype} needs a copy")
        array = self.array if dtype is None else self.array.astype(dtype, copy=False)
        return array.copy() if copy else array

    def __len__(self):
        return len(self.array)

    def __getitem__(self, place):
        return self.array[place]

    def __repr__(self):
        of = type(self._scheme).__name__
        return f"Spikes of {of}: {self.shape}, {self.count} spikes of {self.samples} samples"
