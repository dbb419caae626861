"""A bank of channels at one end of a link, and its decoders at the other: the frames that fly."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import Number, Whole, read, remark, remark_outside
from ._errors import Error, checked
from ._filters import Filter
from ._scheme import Scheme


class Sender:
    """The encoders of a bank's channels, and the frames of their events.

    `schemes` are one scheme for all `channels`, six unless given, as an inertial sensor has; or a list of one for each
    channel, of one kind and with as many neurons. A bank has 1 to 64 channels. A sample is taken every `period` µs. After
    the first and every `keyframe_every` samples comes a keyframe, or a heartbeat of codes without.
    `filter` is one before the code of all channels, or one for each, or None. `label` is a text that both ends must share,
    such as names and units of the channels. The first event of a channel in a frame carries `step_bits` low bits of its step
    number, 0 to 4: with 4, a step code has the sender's value again at its next event after a loss of 7 net steps or fewer.
    Events wait up to `gathering` µs for others, so that fewer frames go; and after `full_every` µs a frame is full, so that a
    receiver can join. The bytes are those of a firmware with the same schemes, filters, `period`,
    `label`, `session` and these three. It pickles before its first sample.

    >>> import spikewire as sw
    >>> scheme = sw.StepForward(threshold=0.1)
    >>> sender, receiver = sw.Sender(scheme, period=2000), sw.Receiver(scheme, period=2000)
    >>> for sample in [[0, 0, 0, 0, 0, 9.8], [0.25, 0, 0, 0, 0, 9.8]]:
    ...     for frame in sender.encode(sample):
    ...         receiver.hear(frame)
    >>> receiver.advance(4000)
    >>> receiver.values.round(2).tolist(), bool(receiver.exact.all())
    ([0.1, 0.0, 0.0, 0.0, 0.0, 9.8], True)
    """

    @checked
    def __init__(
        self,
        schemes: Scheme | Sequence[Scheme],
        period: Whole,
        keyframe_every: Whole = 25,
        session: Whole = 0,
        filter: Filter | Sequence[Filter | None] | None = None,
        label: str | None = None,
        channels: Whole | None = None,
        step_bits: Whole = 0,
        gathering: Whole = 0,
        full_every: Whole | None = None,
    ):
        self._made_of = (
            schemes,
            period,
            keyframe_every,
            session,
            filter,
            label,
            channels,
            step_bits,
            gathering,
            full_every,
        )
        coders = _coders(schemes, channels)
        filters = _filters(filter, len(coders))
        sends = {"step_bits": step_bits, "gathering": gathering, "full_every": full_every}
        self._native = _native.Sender(coders, filters, period, keyframe_every, session, label, sends)
        self._sample = schemes[0].sample if isinstance(schemes, Sequence) else schemes.sample
        # Behind a filter, a sample may be in the range again.
        ranges = [] if any(filters) else [coder.ranges() for coder in coders]
        self._ranges = [own[0] for own in ranges] if all(ranges) else []
        self._has_begun = False
        #: The address of each event of the last sample, and whether it went up.
        self.fired: list[tuple[int, bool]] = []

    @checked
    def encode(self, sample: ArrayLike) -> list[bytes]:
        """The frames that a sample of all channels makes: none, if nothing fired and no keyframe is due.

        >>> import spikewire as sw
        >>> sender = sw.Sender(sw.StepForward(threshold=0.1), period=2000)
        >>> keyframe = sender.encode([0, 0, 0, 0, 0, 9.8])
        >>> [len(sender.encode([rate, 0, 0, 0, 0, 9.8])) for rate in (0.05, 0.25)], sender.fired
        ([0, 1], [(0, True)])
        """
        sample = read(sample).array.astype(float)
        frames, self.fired = self._native.encode(sample.tolist())
        self._has_begun = True
        # A channel has one sample, and no steps.
        remark(self._sample, sample[:, None])
        remark_outside(self._ranges, self._sample, sample[:, None])
        return frames

    def __reduce__(self) -> Any:
        return _again(self)


class Receiver:
    """The decoders of a :class:`Sender`, which know whether their values are exact.

    `schemes`, `filter`, `label` and `channels` are those of the sender, whose frames carry their fingerprint: from others no value is
    exact.
    `clock_tolerance` is by how much the time from sample to sample may differ from `period`, as a fraction. A bank whose
    samples are taken by a timer of the clock that its ticks come from has 0. Codes with sub-timesteps need to know it, or
    heartbeats less than half a period over the tolerance apart. It pickles before its first bytes.

    >>> import spikewire as sw
    >>> sender = sw.Sender(sw.StepForward(threshold=0.1), period=2000)
    >>> receiver = sw.Receiver(sw.StepForward(threshold=0.1), period=2000)
    >>> for frame in sender.encode([0, 0, 0, 0, 0, 9.8]):
    ...     receiver.hear(frame)
    >>> bool(receiver.exact.all()), receiver.withheld[0], receiver.lost
    (True, None, 0)
    """

    @checked
    def __init__(
        self,
        schemes: Scheme | Sequence[Scheme],
        period: Whole,
        clock_tolerance: Number = 0.02,
        filter: Filter | Sequence[Filter | None] | None = None,
        label: str | None = None,
        channels: Whole | None = None,
    ):
        self._made_of = schemes, period, clock_tolerance, filter, label, channels
        self._has_begun = self._has_warned = False
        coders = _coders(schemes, channels)
        filters = _filters(filter, len(coders))
        self._native = _native.Hearer(coders, filters, period, clock_tolerance, label)

    @checked
    def hear(self, data: bytes | bytearray | memoryview) -> None:
        """Takes the next bytes of the link, cut anywhere: frames that were lost are noticed.

        Warns once if frames of two senders come in turn, as from two boards on one line: one of them is decoded, and the
        frames of the other are left out as :attr:`late`.

        >>> import spikewire as sw
        >>> sender = sw.Sender(sw.StepForward(threshold=0.1), period=2000)
        >>> receiver = sw.Receiver(sw.StepForward(threshold=0.1), period=2000)
        >>> data = b"".join(sender.encode([0, 0, 0, 0, 0, 9.8]))
        >>> receiver.hear(data[:5]), receiver.hear(bytearray(data[5:])), round(float(receiver.values[5]), 1)
        (None, None, 9.8)
        """
        self._has_begun = True
        data = data if isinstance(data, bytes) else bytes(memoryview(data))
        if self._native.hear(data) and not self._has_warned:
            self._has_warned = True
            what = "frames of two sessions come in turn: are there two senders on the line?"
            warnings.warn(what, stacklevel=3)

    @checked
    def advance(self, now: Whole) -> None:
        """Says that all events before this time, in µs, have arrived: the samples that are over by then are decoded.

        >>> import spikewire as sw
        >>> sender = sw.Sender(sw.StepForward(threshold=0.1), period=2000)
        >>> receiver = sw.Receiver(sw.StepForward(threshold=0.1), period=2000)
        >>> for number, rate in enumerate([0, 0.25]):
        ...     for frame in sender.encode([rate, 0, 0, 0, 0, 9.8]):
        ...         receiver.hear(frame)
        ...     receiver.advance((number + 1) * 2000)
        >>> receiver.values.round(1).tolist()
        [0.1, 0.0, 0.0, 0.0, 0.0, 9.8]
        """
        self._has_begun = True
        self._native.advance(now)

    def __reduce__(self) -> Any:
        return _again(self)

    @property
    def values(self) -> NDArray[np.float64]:
        """The value of each channel, exact or not."""
        return np.array(self._native.values()[0])

    @property
    def exact(self) -> NDArray[np.bool_]:
        """Whether each value has the bits of a decoder that lost no event."""
        return np.array(self._native.values()[1])

    @property
    def withheld(self) -> list[str | None]:
        """Why each channel has no exact value; ``None`` where it has one."""
        return self._native.withheld()

    @property
    def lost(self) -> int:
        """How many frames were lost, as far as later ones tell."""
        return self._native.lost()

    @property
    def late(self) -> int:
        """How many frames came after later ones, or from another sender, and were left out."""
        return self._native.late()


def _again(end: Sender | Receiver) -> Any:
    """What an end is made of."""
    if end._has_begun:
        name = type(end).__name__.lower()
        raise Error(f"this {name} is at work: a pickle has what it was made of, and not what it did since")
    return type(end), end._made_of


def _filters(filter: Filter | Sequence[Filter | None] | None, channels: int) -> list[Any]:
    own = list(filter) if isinstance(filter, Sequence) else [filter] * channels
    return [one and one._native for one in own]


def _coders(schemes: Scheme | Sequence[Scheme], channels: Whole | None) -> list[Any]:
    if not isinstance(schemes, Sequence):
        return [schemes._coder] * (6 if channels is None else int(channels))
    if channels is not None and channels != len(schemes):
        raise Error(f"there are {len(schemes)} schemes for {channels} channels")
    return [scheme._coder for scheme in schemes]
