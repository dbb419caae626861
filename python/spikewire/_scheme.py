"""What all schemes have in common."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native, _progress
from ._arrays import row, samples
from ._spikes import Spikes
from ._stream import Decoder, Encoder

if TYPE_CHECKING:
    from collections.abc import Callable


class Scheme:
    """A spike code and what was given of its parameters, checked.

    What is not given a signal tells: :meth:`encode` finds it for each channel by itself, and :meth:`fit` once for all.
    """

    #: What the catalogue says of it.
    _info: dict

    def __init__(self, sample: str = "f32", paper: bool = False, **parameters: Any):
        given = {name: value for name, value in parameters.items() if value is not None and value is not False}
        self._sample, self._paper, self._given = str(sample), bool(paper), given
        self._coder = _native.Coder(self._info["name"], self._sample, _plain(given), self._paper)

    @property
    def name(self) -> str:
        """Its short name, as the laptop program and files have it."""
        return self._info["name"]

    @property
    def sample(self) -> str:
        """The sample type that it runs in: ``"f32"``, ``"i16"``, ``"q8.8"``, ``"q16.16"`` …"""
        return self._sample

    @property
    def parameters(self) -> dict[str, Any]:
        """What was given, by name."""
        return dict(self._given)

    @property
    def neurons(self) -> int:
        """How many neurons a channel has.

        >>> import spikewire as sw
        >>> sw.Gaussian(neurons=20).neurons
        20
        """
        return self._coder.shape()[0]

    @property
    def slots(self) -> int:
        """How many sub-timesteps a sample has.

        >>> import spikewire as sw
        >>> sw.SendOnDelta(threshold=0.5, spikes=3).slots
        3
        """
        return self._coder.shape()[1]

    def fit(self, x: ArrayLike) -> Scheme:
        """This scheme with the parameters that `x`, all channels together, tells: the one that flies.

        >>> import spikewire as sw
        >>> sw.Hough(filter="triang:3").fit([[-2.0, 1.0], [0.5, 3.0]]).parameters["shift"]
        -2.0
        """
        options = dict(self._coder.fit(samples(x), True).keywords(0))
        return self._of(options, self._sample, {name: self._given[name] for name in ("start",) if name in self._given})

    @classmethod
    def _of(cls, options: dict, sample: str, given: dict | None = None) -> Scheme:
        """Of the catalogue's values; where a signal begins is no parameter of what flies."""
        named = {own["name"]: own for own in cls._info["parameters"]}
        own = {name: value for name, value in options.items() if named[name]["found"] != "the first sample"}
        return cls(sample=sample, **own, **(given or {}))

    def to_rust(self, name: str = "CHANNEL") -> str:
        """It as a constant in Rust for the firmware; what a signal tells must be given or :meth:`fit`.

        >>> import spikewire as sw
        >>> print(sw.StepForward(threshold=0.35).to_rust("ROLL"), end="")
        pub static ROLL: spikewire::temporal::StepForward<f32> = spikewire::temporal::StepForward::new(0.35);
        """
        return _native.to_rust(self._coder, name, [])

    def to_c(self, directory: str | Path, name: str = "codec", spikewire: str | Path | None = None) -> None:
        """Writes a crate that makes the library for C of this very codec, its parameters in flash: ``spikewire emit c``.

        The `directory` must not be there; functions are called after `name`, as ``sw_codec_encode``. `spikewire` is a
        checkout; the published crates unless given.
        """
        _native.to_c(self._coder, name, Path(directory), None if spikewire is None else Path(spikewire))

    def to_toml(self) -> str:
        """It as a file of parameters, for ``--params`` of the laptop program."""
        return _native.to_toml(self._coder, [])

    def encode(self, x: ArrayLike, progress: bool | Callable[[int, int], object] | None = None) -> Spikes:
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

    def decode(self, spikes: Spikes | ArrayLike, first: ArrayLike | None = None) -> NDArray:
        """The values of `spikes`: of :class:`Spikes`, or of an array as their ``array`` is.

        An array does not say where a signal began. So a code of steps needs its `first` sample, one for each channel
        or one for all; and what a signal else tells must be given, or found by :meth:`fit`.
        """
        if isinstance(spikes, Spikes):
            return spikes.decode()
        codes = np.asarray(spikes)
        inner = row(self._coder.shape())
        outer = codes.shape[: codes.ndim - len(inner)]
        if len(outer) <= 1:
            return self.decoder(first).decode(codes)
        channels = int(np.prod(outer[:-1]))
        first = np.ravel(first) if np.ndim(first) > 1 else first
        return self.decoder(first, channels).decode(codes.reshape(channels, outer[-1], *inner)).reshape(outer)

    def encoder(self, channels: int | None = None) -> Encoder:
        """An encoder that keeps its state between chunks (samples,), or (channels, samples) of so many channels."""
        return Encoder(self, channels)

    def decoder(self, first: ArrayLike | None = None, channels: int | None = None) -> Decoder:
        """A decoder that keeps its state between chunks; a code of steps starts from the `first` sample."""
        return Decoder(self, first, channels)

    def __repr__(self) -> str:
        given = dict(self._given)
        if self._sample != "f32":
            given["sample"] = self._sample
        if self._paper:
            given["paper"] = True
        told = ", ".join(f"{name}={value!r}" for name, value in given.items())
        return f"{type(self).__name__}({told})"

    def _key(self) -> tuple:
        given = [(name, tuple(own) if isinstance(own, list) else own) for name, own in _plain(self._given)]
        return self.name, self._sample, self._paper, tuple(sorted(given, key=lambda own: own[0]))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Scheme) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def __reduce__(self) -> Any:
        return _again, (self.name, {"sample": self._sample, "paper": self._paper, **self._given})


def _again(name, keywords):
    from ._schemes import schemes

    return schemes[name](**keywords)


def _plain(given):
    """Keywords with their values as bool, text, number or list of floats."""
    return [(name, _plain_value(value)) for name, value in given.items()]


def _plain_value(value):
    if isinstance(value, (bool, str, int)):
        return value
    return float(value) if np.ndim(value) == 0 else [float(number) for number in np.ravel(value)]


def _text(value):
    """A keyword's value as the laptop program takes it."""
    if value is True:
        return ""
    if isinstance(value, (str, int)):
        return str(value)
    if np.ndim(value) == 0:
        return _number(value)
    # A comma at the end makes a list of one number.
    return ",".join(_number(number) for number in np.ravel(value)) + ","


def _number(value):
    number = float(value)
    return str(int(number)) if number.is_integer() and abs(number) < 2**53 else repr(number)
