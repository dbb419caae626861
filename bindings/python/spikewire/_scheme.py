"""What all schemes have in common."""

from __future__ import annotations

import secrets
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native, _progress, _weighted
from ._arrays import Whole, codes_time_last, remark, remark_outside, row, samples, warn
from ._errors import Error, checked
from ._spikes import Spikes
from ._stream import Decoder, Encoder

Own = TypeVar("Own", bound="Scheme")

#: What a parameter takes, by its kind.
KINDS = {
    "number": "a number",
    "count": "a whole number",
    "choice": "one of its words",
    "flag": "True or False",
    "text": "a text, a number or numbers",
    "filter": "a text, or the taps",
}


class Scheme:
    """A spike code and what was given of its parameters, checked.

    What is not given a signal tells: :meth:`encode` finds it for each channel by itself, and :meth:`fit` once for all.

    >>> import spikewire as sw
    >>> scheme = sw.schemes["sf"](threshold=0.1)
    >>> isinstance(scheme, sw.Scheme), scheme.name, scheme.sample, scheme.parameters
    (True, 'sf', 'f32', {'threshold': 0.1})
    """

    #: What the catalogue says of it.
    _info: dict[str, Any]

    @checked
    def __init__(self, sample: str = "f32", paper: bool = False, **parameters: Any):
        kinds = {own["name"]: own["kind"] for own in self._info["parameters"]}
        given = {name: _checked(name, kinds.get(name), value) for name, value in parameters.items() if value is not None}
        given = {name: value for name, value in given.items() if value is not False}
        self._sample, self._paper, self._given = str(sample), bool(paper), given
        #: Whether its spikes are drawn by chance.
        self._draws = "seed" in kinds
        fixed = {name: value for name, value in given.items() if not isinstance(value, np.random.Generator)}
        self._coder = _native.Coder(self._info["name"], self._sample, _plain(fixed), self._paper)
        for words in self._coder.cut():
            warn(words)

    def _seeded(self) -> Any:
        """The compiled scheme, whose draws begin where those of the next call do."""
        seed = self._given.get("seed")
        if not self._draws or (seed is not None and not isinstance(seed, np.random.Generator)):
            return self._coder
        return self._coder.seeded(secrets.randbits(63) if seed is None else int(seed.integers(1 << 63)))

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

    def fit(self: Own, x: ArrayLike, per_channel: bool = False, axis: int | None = None) -> Own:
        """This scheme with the parameters that `x` tells: the one that flies.

        It is one for all channels, or with `per_channel` has a value for each. `axis` is the one of time, as for
        :meth:`encode`.

        >>> import spikewire as sw
        >>> sw.Hough(filter="triang:3").fit([[-2.0, 1.0], [0.5, 3.0]]).parameters["shift"]
        -2.0
        >>> sw.Hough(filter="triang:3").fit([[-2.0, 1.0], [0.5, 3.0]], per_channel=True).parameters["shift"]
        [-2.0, 0.5]
        """
        _, x = samples(x, axis)
        fitted = self._coder.fit(x, not per_channel, True)
        remark(self._sample, x)
        options = dict(fitted.keywords(0))
        if per_channel:
            all_options = [dict(fitted.keywords(channel)) for channel in range(int(np.prod(x.shape[:-1])))]
            for name in options:
                values = [own[name] for own in all_options]
                if any(value != values[0] for value in values):
                    if not all(isinstance(value, float) for value in values):
                        raise Error(f"channels differ in {name}, which has one value for all: fit each by itself")
                    options[name] = values
        kept = ("start", "seed")
        return self._of(options, self._sample, {name: self._given[name] for name in kept if name in self._given})

    @classmethod
    def _of(cls: type[Own], options: dict[str, Any], sample: str, given: dict[str, Any] | None = None) -> Own:
        """Of the catalogue's values; where a signal begins is no parameter of what flies, and a seed is the caller's."""
        named = {own["name"]: own for own in cls._info["parameters"]}
        own = {name: value for name, value in options.items() if named[name]["found"] != "the first sample"}
        own.pop("seed", None)
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

        >>> import pathlib, tempfile, spikewire as sw
        >>> place = pathlib.Path(tempfile.mkdtemp()) / "roll"
        >>> sw.StepForward(threshold=0.35).to_c(place, name="roll")
        >>> (place / "Cargo.toml").is_file()
        True
        """
        _native.to_c(self._coder, name, Path(directory), None if spikewire is None else Path(spikewire))

    def to_toml(self) -> str:
        """It as a file of parameters, for ``--params`` of the laptop program; :meth:`from_toml` reads it.

        >>> import spikewire as sw
        >>> print(sw.StepForward(threshold=0.35).to_toml(), end="")
        scheme = "sf"
        sample = "f32"
        threshold = 0.35
        """
        return _native.to_toml(self._coder, [])

    @staticmethod
    @checked
    def from_toml(file: str | Path) -> Scheme:
        """The scheme that a file of parameters describes: what :meth:`to_toml` and ``spikewire tune --emit toml`` write.

        `file` is a text, or a :class:`~pathlib.Path` to a file.

        >>> import spikewire as sw
        >>> sw.Scheme.from_toml('scheme = "sf"\\nthreshold = 0.35\\n')
        StepForward(threshold=0.35)
        """
        place, text = (str(file), file.read_text(encoding="utf-8")) if isinstance(file, Path) else ("TOML", file)
        name, sample, options = _native.from_toml(place, text)
        return _again(name, {**dict(options), "sample": sample})

    def encode(
        self, x: ArrayLike, progress: bool | Callable[[int, int], object] | None = None, axis: int | None = None
    ) -> Spikes:
        """The spikes of `x`, an array (samples,) or (channels, samples) or (…, samples) of floats or integers.

        `axis` is the one of time, where it is not the last: 0 for (time, batch, channels). Of a table, such as a frame of
        pandas or polars, it is that of the rows, and columns are channels; of xarray, the dimension ``time``. `progress`: a
        function of what is done and of the total, ``True`` for a bar, ``False`` for none; unless given, a bar on work of
        some seconds in a terminal.

        A code by chance draws afresh in each call, and apart in each channel. With an integer as ``seed`` it draws the
        same in each call; with a ``numpy.random.Generator``, what comes next of it.

        >>> import numpy as np, spikewire as sw
        >>> spikes = sw.StepForward(threshold=0.5).encode(np.zeros((100, 3)), axis=0)
        >>> spikes.shape, spikes.decode().shape
        ((100, 3), (100, 3))
        """
        (_, time, names), x = samples(x, axis)
        if not x.size:
            inner = self._coder.shape()
            return Spikes(self, None, np.zeros(0, np.int8), x.shape, inner, time, names)
        fitted = self._seeded().fit(x, False, False)
        shape = fitted.shape()
        with _progress.bar(progress, "encode") as tell:
            flat, is_outside = fitted.encode(x, tell)
        remark(self._sample, x)
        if is_outside:
            remark_outside(self._coder.ranges(), self._sample, x)
        return Spikes(self, fitted, flat, x.shape, shape, time, names)

    def decode(self, spikes: Spikes | ArrayLike, first: ArrayLike | None = None, axis: int | None = None) -> NDArray[Any]:
        """The values of `spikes`: of :class:`Spikes`, or of an array as their ``array`` is.

        An array does not say where a signal began. So a code of steps needs its `first` sample, one for each channel
        or one for all; and what a signal else tells must be given, or found by :meth:`fit`. `axis` is the one of time, as
        for :meth:`encode`, counted without the axes of a sample's neurons and sub-timesteps.

        Spikes that no encoder of the scheme sends are an error; :meth:`decode_weighted` takes what a network gives.

        >>> import spikewire as sw
        >>> sw.StepForward(threshold=0.5).decode([[0, 1], [0, -1]], first=[1.0, 2.0]).tolist()
        [[1.0, 1.5], [2.0, 1.5]]
        """
        if isinstance(spikes, Spikes):
            return spikes.decode()
        inner = row(self._coder.shape())
        codes, axis = codes_time_last(spikes, self._coder.shape(), axis)
        outer = codes.shape[: codes.ndim - len(inner)]
        if len(outer) <= 1:
            return self.decoder(first).decode(codes)
        channels = int(np.prod(outer[:-1]))
        if not channels:
            return np.zeros(outer, np.float32)
        first = np.ravel(first) if np.ndim(first) > 1 else first
        values = self.decoder(first, channels).decode(codes.reshape(channels, outer[-1], *inner)).reshape(outer)
        return np.moveaxis(values, -1, axis)

    def decode_weighted(
        self, weights: ArrayLike, first: ArrayLike | None = None, axis: int | None = None
    ) -> NDArray[np.float64]:
        """The values of `weights` in the place of spikes, such as rates in 0 to 1 or what a network gives.

        The array is as :attr:`Spikes.array` is. A population code takes the mean of its neurons' values by their
        weights, and the value before where all are 0; a step, a filter and a digit count by their parts. Spikes of an
        encoder give what :meth:`decode` gives of them, up to rounding; of a population that has one spike a sample.

        >>> import spikewire as sw
        >>> sw.Position(min=0, max=3, neurons=5).decode_weighted([[0, 0.5, 0.5, 0, 0], [0, 0, 0, 1, 3]]).tolist()
        [1.0, 3.25]
        """
        return _weighted.decode(self, weights, first, axis)

    def encoder(self, channels: Whole | None = None) -> Encoder:
        """An encoder that keeps its state between chunks (samples,), or (channels, samples) of so many channels.

        >>> import spikewire as sw
        >>> encoder = sw.StepForward(threshold=0.5).encoder()
        >>> encoder.encode([0.0, 1.0]).tolist(), encoder.encode([2.0]).tolist()
        ([0, 1], [1])
        """
        return Encoder(self, channels)

    def decoder(self, first: ArrayLike | None = None, channels: Whole | None = None) -> Decoder:
        """A decoder that keeps its state between chunks; a code of steps starts from the `first` sample.

        >>> import spikewire as sw
        >>> decoder = sw.StepForward(threshold=0.5).decoder(first=0.0)
        >>> decoder.decode([0, 1]).tolist(), decoder.decode([1]).tolist()
        ([0.0, 0.5], [1.0])
        """
        return Decoder(self, first, channels)

    def __repr__(self) -> str:
        given = dict(self._given)
        if self._sample != "f32":
            given["sample"] = self._sample
        if self._paper:
            given["paper"] = True
        told = ", ".join(f"{name}={value!r}" for name, value in given.items())
        return f"{type(self).__name__}({told})"

    def _key(self) -> tuple[Any, ...]:
        given = {name: id(own) if isinstance(own, np.random.Generator) else own for name, own in self._given.items()}
        given = [(name, tuple(own) if isinstance(own, list) else own) for name, own in _plain(given)]
        return self.name, self._sample, self._paper, tuple(sorted(given, key=lambda own: own[0]))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Scheme) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def __reduce__(self) -> Any:
        return _again, (self.name, {"sample": self._sample, "paper": self._paper, **self._given})


def _again(name: str, keywords: dict[str, Any]) -> Scheme:
    from ._schemes import schemes

    return schemes[name](**keywords)


def _plain(given):
    """Keywords with their values as bool, text, number or list of floats."""
    return [(name, _plain_value(value)) for name, value in given.items()]


def _checked(name, kind, value):
    """A keyword's value, with truth only where it is asked for."""
    if isinstance(value, (bool, np.bool_)):
        if kind not in ("flag", None):
            raise Error(f"{name}={value} must be {KINDS[kind]}, not True or False")
        return bool(value)
    if isinstance(value, np.random.Generator) and name != "seed":
        raise Error(f"{name} takes no generator; seed does")
    return value


def _plain_value(value):
    if isinstance(value, np.integer):
        value = int(value)
    if isinstance(value, (bool, str, int)):
        return value
    return float(value) if np.ndim(value) == 0 else [float(number) for number in np.ravel(value)]
