"""What all schemes have in common."""

import numpy as np

from . import _native, _progress
from ._arrays import row, samples
from ._spikes import Spikes
from ._stream import Decoder, Encoder


class Scheme:
    """A spike code and what was given of its parameters, checked.

    What is not given a signal tells: :meth:`encode` finds it for each channel by itself, and :meth:`fit` once for all.
    """

    #: What the catalogue says of it.
    _info = None

    def __init__(self, sample="f32", paper=False, **parameters):
        given = {name: value for name, value in parameters.items() if value is not None and value is not False}
        self._sample, self._paper, self._given = str(sample), bool(paper), given
        options = {name: _text(value) for name, value in given.items()}
        self._coder = _native.Coder(self._info["name"], self._sample, options, self._paper)

    @property
    def name(self):
        """Its short name, as the laptop program and files have it."""
        return self._info["name"]

    @property
    def sample(self):
        """The sample type that it runs in: ``"f32"``, ``"i16"``, ``"q8.8"``, ``"q16.16"`` …"""
        return self._sample

    @property
    def parameters(self):
        """What was given, by name."""
        return dict(self._given)

    def fit(self, x):
        """This scheme with the parameters that `x`, all channels together, tells: the one that flies.

        >>> import spikewire as sw
        >>> sw.Hough(filter="triang:3").fit([[-2.0, 1.0], [0.5, 3.0]]).parameters["shift"]
        -2.0
        """
        options = dict(self._coder.fit(samples(x), True).options(0))
        of_signal = {own["name"] for own in self._info["parameters"] if own["found"] == "the first sample"}
        own = {name: self._value(name, text) for name, text in options.items() if name not in of_signal}
        own.update((name, value) for name, value in self._given.items() if name in of_signal)
        return type(self)(sample=self._sample, **own)

    def encode(self, x, progress=None):
        """The spikes of `x`, an array (samples,) or (channels, samples) or (…, samples) of floats or integers.

        `progress`: a function of what is done and of the total, ``True`` for a bar, ``False`` for none; unless given, a
        bar on work of some seconds in a terminal.
        """
        x = samples(x)
        fitted = self._coder.fit(x, False)
        shape = fitted.shape()
        with _progress.bar(progress, "encode") as tell:
            flat = fitted.encode(x, tell)
        return Spikes(self, fitted, flat, x.shape, shape)

    def decode(self, spikes, first=None, progress=None):
        """The values of `spikes`: of :class:`Spikes`, or of an array as their ``array`` is.

        An array does not say where a signal began. So a code of steps needs its `first` sample, one for each channel
        or one for all; and what a signal else tells must be given or :meth:`fit`.
        """
        if isinstance(spikes, Spikes):
            return spikes.decode(progress=progress)
        x = np.asarray(spikes)
        decoder = self.decoder(first=first, channels=_channels(x, self._coder.shape()))
        return decoder.decode(x)

    def encoder(self, channels=None):
        """An encoder that keeps its state between chunks (samples,), or (channels, samples) of so many channels."""
        return Encoder(self, channels)

    def decoder(self, first=None, channels=None):
        """A decoder that keeps its state between chunks; a code of steps starts from the `first` sample."""
        return Decoder(self, first, channels)

    def __repr__(self):
        given = dict(self._given)
        if self._sample != "f32":
            given["sample"] = self._sample
        if self._paper:
            given["paper"] = True
        told = ", ".join(f"{name}={value!r}" for name, value in given.items())
        return f"{type(self).__name__}({told})"

    def _value(self, name, text):
        """What a text of the catalogue is in Python."""
        kind = next(own["kind"] for own in self._info["parameters"] if own["name"] == name)
        if kind == "flag":
            return True
        if kind in ("number", "count"):
            return float(text) if kind == "number" else int(text)
        return [float(tap) for tap in text.split(",") if tap] if kind == "filter" else text

    def _key(self):
        given = {name: _text(value) for name, value in self._given.items()}
        return self.name, self._sample, self._paper, tuple(sorted(given.items()))

    def __eq__(self, other):
        return isinstance(other, Scheme) and self._key() == other._key()

    def __hash__(self):
        return hash(self._key())

    def __reduce__(self):
        return _again, (self.name, {"sample": self._sample, "paper": self._paper, **self._given})


def _again(name, keywords):
    from ._schemes import schemes

    return schemes[name](**keywords)


def _channels(codes, shape):
    """How many channels an array of codes has; none if it has no axis of them."""
    outer = codes.shape[: codes.ndim - len(row(shape))]
    return None if len(outer) <= 1 else int(np.prod(outer[:-1]))


def _text(value):
    """A keyword's value as the catalogue takes it."""
    if value is True:
        return ""
    if isinstance(value, (str, int)):
        return str(value)
    if np.ndim(value) == 0:
        return _number(value)
    # A comma at the end, or one number alone would be the name of a file.
    return ",".join(_number(number) for number in np.ravel(value)) + ","


def _number(value):
    number = float(value)
    return str(int(number)) if number.is_integer() and abs(number) < 2**53 else repr(number)

