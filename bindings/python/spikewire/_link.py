"""A bank of channels at one end of a link, and its decoders at the other: the frames that fly."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import tell_cut

if TYPE_CHECKING:
    from ._filters import Filter
    from ._scheme import Scheme


class Sender:
    """The encoders of a bank's channels, and the frames of their events.

    `schemes` are one scheme for all `channels`, six unless given, as an inertial sensor has; or a list of one for each
    channel, of one kind and with as many neurons. A bank has 1 to 64 channels. A sample is taken every `period` µs. After the first and every `keyframe_every` samples comes a keyframe, or a heartbeat of codes without.
    `filter` is one before the code of all channels, or one for each, or None. `label` is a text that both ends must share,
    such as names and units of the channels. The bytes are those of a firmware with the same schemes, filters, `period`,
    `label` and `session`.

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

    def __init__(
        self,
        schemes: Scheme | Sequence[Scheme],
        period: int,
        keyframe_every: int = 25,
        session: int = 0,
        filter: Filter | Sequence[Filter | None] | None = None,
        label: str | None = None,
        channels: int | None = None,
    ):
        coders = _coders(schemes, channels)
        filters = _filters(filter, len(coders))
        self._native = _native.Sender(coders, filters, period, keyframe_every, session, label)
        self._sample = schemes[0].sample if isinstance(schemes, Sequence) else schemes.sample
        #: The address of each event of the last sample, and whether it went up.
        self.fired: list[tuple[int, bool]] = []

    def encode(self, sample: ArrayLike) -> list[bytes]:
        """The frames that a sample of all channels makes: none, if nothing fired and no keyframe is due."""
        sample = np.asarray(sample, dtype=float)
        frames, self.fired = self._native.encode([float(value) for value in sample])
        tell_cut(self._sample, sample)
        return frames


class Receiver:
    """The decoders of a :class:`Sender`, which know whether their values are exact.

    `schemes`, `filter`, `label` and `channels` are those of the sender, whose frames carry their fingerprint: from others no value is
    exact.
    `clock_tolerance` is by how much the time from sample to sample may differ from `period`, as a fraction. A bank whose
    samples are taken by a timer of the clock that its ticks come from has 0. Codes with sub-timesteps need to know it, or
    heartbeats less than half a period over the tolerance apart.
    """

    def __init__(
        self,
        schemes: Scheme | Sequence[Scheme],
        period: int,
        clock_tolerance: float = 0.02,
        filter: Filter | Sequence[Filter | None] | None = None,
        label: str | None = None,
        channels: int | None = None,
    ):
        coders = _coders(schemes, channels)
        filters = _filters(filter, len(coders))
        self._native = _native.Hearer(coders, filters, period, clock_tolerance, label)
        self._has_warned = False

    def hear(self, data: bytes) -> None:
        """Takes the next bytes of the link, cut anywhere: frames that were lost are noticed.

        Warns once if frames of two senders come in turn, as from two boards on one line: one of them is decoded, and the
        frames of the other are left out as :attr:`late`.
        """
        if self._native.hear(data) and not self._has_warned:
            self._has_warned = True
            what = "frames of two sessions come in turn: are there two senders on the line?"
            warnings.warn(what, stacklevel=2)

    def advance(self, now: int) -> None:
        """Says that all events before this time, in µs, have arrived: the samples that are over by then are decoded."""
        self._native.advance(now)

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


def _filters(filter: Filter | Sequence[Filter | None] | None, channels: int) -> list:
    own = list(filter) if isinstance(filter, Sequence) else [filter] * channels
    return [one and one._native for one in own]


def _coders(schemes: Scheme | Sequence[Scheme], channels: int | None) -> list:
    if not isinstance(schemes, Sequence):
        return [schemes._coder] * (6 if channels is None else channels)
    if channels is not None and channels != len(schemes):
        raise ValueError(f"there are {len(schemes)} schemes for {channels} channels")
    return [scheme._coder for scheme in schemes]
