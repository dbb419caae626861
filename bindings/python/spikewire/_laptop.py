"""What the laptop program does, on arrays: score, tune, advise, plot, and constants for the firmware."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native, _progress
from ._arrays import Number, Whole, one, remark, remark_outside, samples as samples_of
from ._errors import Error, checked
from ._scheme import Scheme, _plain


@checked
def score(x: ArrayLike, scheme: Scheme, rate: Number | None = None) -> dict[str, Any]:
    """How few spikes `scheme` makes of `x`, an array (samples,), and how near it comes: a dictionary.

    ``efficiency`` is the percentage of samples without a spike, ``rmse`` is in the signal's unit, ``snr`` in dB;
    `rate`, in samples a second, gives ``spikes_per_second``.

    >>> import numpy as np, spikewire as sw
    >>> x = np.sin(np.linspace(0, 6, 200))
    >>> figures = sw.score(x, sw.StepForward(threshold=0.1))
    >>> figures["spikes"], round(figures["rmse"], 3)
    (33, 0.062)
    """
    return json.loads(_native.score(scheme._coder, one(x).array, _rate(rate)))


class Tuned:
    """A scheme with the parameters that were found for it.

    >>> import numpy as np, spikewire as sw
    >>> tuned = sw.tune(np.sin(np.linspace(0, 60, 2000)), "sf", max_rmse=0.05, evaluations=40)
    >>> type(tuned.scheme).__name__, tuned.figures["tuned_on"]["rmse"] <= 0.05
    ('StepForward', True)
    """

    def __init__(self, told: tuple[Any, ...], sample: str):
        from ._schemes import schemes

        name, options, figures, comments = told
        kind = schemes[name]
        #: What flies: the parameters found, for `start` or where a signal begins the default.
        self.scheme: Scheme = kind._of(dict(options), sample)
        #: Figures on what it was tuned on, on what was held out, and on the whole; costs; notes of what speaks against it.
        self.figures: dict[str, Any] = json.loads(figures)
        self._comments = comments

    def to_rust(self, name: str = "CHANNEL") -> str:
        """The scheme as a constant in Rust, with how good it is in its documentation.

        >>> import numpy as np, spikewire as sw
        >>> tuned = sw.tune(np.sin(np.linspace(0, 60, 2000)), "sf", max_rmse=0.05, evaluations=40)
        >>> tuned.to_rust("ROLL").splitlines()[-1].split(" = ")[0]
        'pub static ROLL: spikewire::temporal::StepForward<f32>'
        """
        return _native.to_rust(self.scheme._coder, name, self._comments)

    def to_toml(self) -> str:
        """The scheme as a file of parameters for the laptop program.

        >>> import numpy as np, spikewire as sw
        >>> tuned = sw.tune(np.sin(np.linspace(0, 60, 2000)), "sf", max_rmse=0.05, evaluations=40)
        >>> sw.Scheme.from_toml(tuned.to_toml()) == tuned.scheme
        True
        """
        return _native.to_toml(self.scheme._coder, self._comments)

    def __repr__(self) -> str:
        own = self.figures["held_out"] or self.figures["tuned_on"]
        return f"Tuned({self.scheme!r}, rmse={own['rmse']:.4g}, efficiency={own['efficiency']:.1f})"


@overload
def tune(x: ArrayLike | list[ArrayLike], scheme: Literal["all"] = "all", **keywords: Any) -> list[Tuned]: ...
@overload
def tune(x: ArrayLike | list[ArrayLike], scheme: str | type[Scheme], **keywords: Any) -> Tuned: ...
@checked
def tune(
    x: ArrayLike | list[ArrayLike],
    scheme: str | type[Scheme] = "all",
    *,
    rate: Number | None = None,
    min_efficiency: Number | None = None,
    max_rmse: Number | None = None,
    max_ram: Number | None = None,
    max_instructions: Number | None = None,
    max_latency: Number | None = None,
    max_rate: Number | None = None,
    core: str | None = None,
    hold_out: Number | None = None,
    blocks: Whole | None = None,
    worst_flight: bool = False,
    seconds: Number | None = None,
    evaluations: Whole | None = None,
    seed: Whole | None = None,
    anyway: bool = False,
    below: Number | None = None,
    sample: str = "f32",
    name: str | None = None,
    progress: bool | Callable[[int, int], object] | None = None,
    **kept: Any,
) -> Tuned | list[Tuned]:
    """The parameters of `scheme`, its short name or class, for the signal `x`: :class:`Tuned`.

    `x` is an array (samples,), or a list of them that are tuned on together. Looked for is the least RMSE at
    `min_efficiency` percent of samples without a spike, or the greatest efficiency at `max_rmse`; without either, the
    least RMSE at the efficiency of the paper's settings. With `scheme` ``"all"`` it is a list, the best first.

    `rate`: samples a second. `max_ram` in bytes a channel, `max_instructions` a sample on `core`, `max_latency` in
    samples and `max_rate` in events a second limit what may be found. `hold_out` is the share to hold out and score
    on: of the signals or, if there is only one, of its `blocks`. With `worst_flight` the search reduces the largest error
    on a single signal instead of the error over all. It scores `evaluations` settings; the same number and `seed` give
    the same result, unless it is cut short after so many `seconds`.
    What is not given is as in ``spikewire tune``. `kept` are parameters that stay as given.

    >>> import numpy as np, spikewire as sw
    >>> x = np.sin(np.linspace(0, 60, 2000))
    >>> tuned = sw.tune(x, "sod", spikes=3, max_rmse=0.05, evaluations=40)
    >>> tuned.scheme.parameters["spikes"], sw.score(x, tuned.scheme)["rmse"] <= 0.05
    (3, True)
    """
    of_one = scheme != "all"
    scheme = scheme if isinstance(scheme, str) else scheme._info["name"]
    options = {
        "min_efficiency": min_efficiency,
        "max_rmse": max_rmse,
        "max_ram": max_ram,
        "max_instructions": max_instructions,
        "max_latency": max_latency,
        "max_rate": max_rate,
        "core": core,
        "hold_out": hold_out,
        "blocks": blocks,
        "worst_flight": worst_flight,
        "seconds": seconds,
        "evaluations": evaluations,
        "seed": seed,
        "anyway": anyway,
        "below": below,
        "sample": sample,
        "scheme": scheme,
        "kept": dict(_plain({name: value for name, value in kept.items() if value is not None})),
    }
    are_several = isinstance(x, (list, tuple)) and len(x) > 0 and np.ndim(x[0]) > 0
    several = [one(own) for own in x] if are_several else [one(x)]
    signals = [own.array for own in several]
    with _progress.bar(progress, "tune") as tell:
        told, _ = _native.tune(signals, _rate(rate), name or _name(several[0].names), options, tell)
    remark(sample, *signals)
    found = [Tuned(own, sample) for own in told]
    return found[0] if of_one else found


class Advice:
    """What a signal is like, and which scheme suits it. Printed, it is a page to read.

    >>> import numpy as np, spikewire as sw
    >>> advice = sw.advise(np.sin(np.linspace(0, 60, 2000)), rate=200, evaluations=4, name="gyro_x")
    >>> advice.page.startswith("gyro_x"), isinstance(advice.best, sw.Tuned)
    (True, True)
    """

    def __init__(self, told: tuple[Any, ...], sample: str):
        page, figures, best = told
        #: What a person reads.
        self.page = page
        #: All of it: the look at the signal, the schemes that come near enough, and why others do not.
        self.figures: dict[str, Any] = json.loads(figures)
        #: The scheme advised: :class:`Tuned`, or ``None`` if there is none.
        self.best: Tuned | None = Tuned(best, sample) if best else None

    def __repr__(self) -> str:
        return self.page


@overload
def advise(x: Sequence[float] | np.ndarray[tuple[int], np.dtype[Any]], **keywords: Any) -> Advice: ...
@overload
def advise(x: ArrayLike, **keywords: Any) -> Any: ...
@checked
def advise(
    x: ArrayLike,
    *,
    rate: Number | None = None,
    max_rmse: Number | None = None,
    max_latency: Number | None = None,
    loop_bandwidth: Number | None = None,
    frame_loss: Number | None = None,
    core: str | None = None,
    seconds: Number | None = None,
    evaluations: Whole | None = None,
    seed: Whole | None = None,
    sample: str = "f32",
    name: str | None = None,
    progress: bool | Callable[[int, int], object] | None = None,
) -> Advice | list[Advice]:
    """What the signal `x`, (samples,), is like and which scheme suits it: :class:`Advice`, for (channels, samples) a list.
    Of a table each column is a signal, and has its name.

    All schemes are tuned for a moment. Of those within `max_rmse`, a fifth of the signal's deviation unless given, the
    one with the fewest bytes a second on the link is advised. `loop_bandwidth` is the frequency in Hz up to which the
    control loop acts that is to fly on it: codes that are late for it, or that fall behind the signal, are not advised, nor
    those that a simulated drone did not fly on well with `frame_loss` percent of its frames lost, 1 unless given.
    Without `max_rmse`, a channel whose `name` is that of an inertial sensor's axis, such as ``gyro_x`` in rad/s or
    ``accel_z_g``, then has the parameters that flew, or finer ones.

    >>> import numpy as np, spikewire as sw
    >>> x = np.sin(np.linspace(0, 60, 2000))
    >>> [type(advice.best.scheme).__name__ != "" for advice in sw.advise([x, 2 * x], rate=200, evaluations=4)]
    [True, True]
    """
    options = {
        "max_rmse": max_rmse,
        "max_latency": max_latency,
        "loop_bandwidth": loop_bandwidth,
        "frame_loss": frame_loss,
        "core": core,
        "seconds": seconds,
        "evaluations": evaluations,
        "seed": seed,
        "sample": sample,
    }
    (array, _, names), lanes = samples_of(x)
    if array.ndim == 1:
        signals = [(name or _name(names), lanes.astype(np.float64))]
    else:
        names = names or [f"{name or 'x'}[{place}]" for place in range(len(lanes))]
        signals = [(own, one(lane).array) for own, lane in zip(names, lanes)]
    with _progress.bar(progress, "advise") as tell:
        told = [Advice(own, sample) for own in _native.advise(signals, _rate(rate), options, tell)]
    remark(sample, *(values for _, values in signals))
    return told[0] if array.ndim == 1 else told


class Picture:
    """A picture, which a notebook shows.

    >>> import spikewire as sw
    >>> sw.plot([0.0, 1.0, 2.0], sw.StepForward(threshold=0.5))
    Picture of x by StepForward(threshold=0.5)
    """

    def __init__(self, drawn: Callable[[str], bytes], words: str):
        self._drawn, self._words = drawn, words

    def __repr__(self) -> str:
        return f"Picture of {self._words}"

    @checked
    def save(self, path: str | Path) -> None:
        """Writes it as ``.svg`` or ``.png``, by the ending of `path`.

        >>> import pathlib, tempfile, spikewire as sw
        >>> path = pathlib.Path(tempfile.mkdtemp()) / "spikes.svg"
        >>> sw.plot([0.0, 1.0, 2.0], sw.StepForward(threshold=0.5)).save(path)
        >>> path.read_text().startswith("<svg")
        True
        """
        path = Path(path)
        path.write_bytes(self._drawn(path.suffix[1:]))

    def _repr_svg_(self) -> str:
        return self._drawn("svg").decode()


@checked
def plot(
    x: ArrayLike,
    *schemes: Scheme,
    rate: Number | None = None,
    name: str | None = None,
    unit: str | None = None,
    samples: tuple[Whole, Whole] | None = None,
) -> Picture:
    """A picture of `x`, (samples,), its spikes by each of `schemes` and what they decode to: :class:`Picture`.

    `rate`, in samples a second, gives it a time axis; `samples`, a pair, shows some only, all of which are encoded.

    >>> import numpy as np, spikewire as sw
    >>> sw.plot(np.sin(np.arange(200) / 9), sw.StepForward(threshold=0.1), rate=200, name="gyro_x", unit="rad/s")
    Picture of gyro_x by StepForward(threshold=0.1)
    """
    if not schemes:
        raise Error("plot takes schemes, as in plot(x, StepForward(threshold=0.1))")
    x, _, names = one(x)
    name = name or _name(names)
    coders = [scheme._coder for scheme in schemes]

    def drawn(ending: str) -> bytes:
        return _native.plot(coders, x, _rate(rate), name, unit, samples, ending)

    drawn("svg")  # what is wrong is told at once
    for sample in dict.fromkeys(scheme.sample for scheme in schemes):
        remark(sample, x)
    for scheme in schemes:
        remark_outside(scheme._coder.ranges(), scheme.sample, x)
    return Picture(drawn, f"{name} by {', '.join(repr(scheme) for scheme in schemes)}")


def _name(names: list[str] | None) -> str:
    return names[0] if names else "x"


def _rate(rate: Number | None) -> float | None:
    return None if rate is None else float(rate)
