"""A flight's file: both ends of a link from one description."""

from __future__ import annotations

import os
import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._errors import checked
from ._filters import Filter
from ._link import Receiver, Sender
from ._scheme import Scheme


class Flight:
    """A flight's file, ``flight.toml``, as ``spikewire advise -o`` writes it: what the vehicle codes and its far end decodes.

    Both ends are made from it, so that they cannot disagree on a threshold, and their frames carry :attr:`fingerprint`, as
    those of a firmware from the same file do. Samples and values are in counts: :attr:`counts` times the unit. A bad file
    is a :class:`spikewire.Error` with its line. Warns of each parameter that the sample type changes.

    >>> import pathlib, tempfile, numpy as np, spikewire as sw
    >>> text = 'version = 1\\nscheme = "sf"\\nperiod = 2000\\nparameters = { threshold = 0.1 }\\n'
    >>> names = ["gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z"]
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "flight.toml"
    >>> _ = path.write_text(text + "".join(f'[[channel]]\\nname = "{name}"\\n' for name in names))
    >>> flight = sw.Flight(path)
    >>> flight
    Flight of sf: gyro_x, gyro_y, gyro_z, accel_x, accel_y, accel_z, one sample in 2000 µs
    >>> sender, receiver = flight.sender(), flight.receiver()
    >>> for frame in sender.encode([0, 0, 0, 0, 0, 9.8]):
    ...     receiver.hear(frame)
    >>> receiver.values.tolist() == [0, 0, 0, 0, 0, float(np.float32(9.8))], bool(receiver.exact.all())
    (True, True)
    """

    @checked
    def __init__(self, path: str | os.PathLike[str]):
        told = _native.flight(os.fspath(path))
        scheme, sample, period, keyframe_every, clock_ppm, label, fingerprint, filtered, channels, rounded, sends = told
        for change in rounded:
            warnings.warn(change, stacklevel=2)
        #: The short name of the scheme of every channel.
        self.scheme: str = scheme
        #: Names of the channels, in the order of a sample.
        self.names: list[str] = [own[0] for own in channels]
        #: The column, or topic and field, of a recording that holds each channel.
        self.sources: list[str] = [own[1] for own in channels]
        #: The unit of each channel; empty if it is not known.
        self.units: list[str] = [own[2] for own in channels]
        #: Counts for one unit of each channel.
        self.counts: NDArray[Any] = np.array([own[3] for own in channels])
        #: The scheme of each channel, with the parameters that the sample type has.
        self.schemes: list[Scheme] = [_scheme(scheme, dict(own[4]), sample) for own in channels]
        #: The time from sample to sample in µs.
        self.period: int = period
        #: Samples from one keyframe or heartbeat to the next.
        self.keyframe_every: int = keyframe_every
        #: By how many millionths the time from sample to sample may differ from `period`.
        self.clock_ppm: int = clock_ppm
        #: Period, names, units and counts in a text that both ends compare.
        self.label: str = label
        #: The 32 bits of schemes, filter and label that the frames carry.
        self.fingerprint: int = fingerprint
        #: Low bits of its step number that the first event of a channel in a frame carries, so that step codes heal.
        self.step_bits: int = sends[0]
        #: The longest time in µs that events wait for others.
        self.gathering: int = sends[1]
        #: The time in µs from one full frame to the next.
        self.full_every: int = sends[2]
        #: The filter before every code; ``None`` without.
        self.filter: Filter | None = _filter(filtered, 1e6 / period)

    def sender(self, session: int = 0) -> Sender:
        """The bank and the frames of its events; `session` differs at each start."""
        sends = {"step_bits": self.step_bits, "gathering": self.gathering, "full_every": self.full_every}
        return Sender(self.schemes, self.period, self.keyframe_every, session, self.filter, self.label, **sends)

    def receiver(self) -> Receiver:
        """The decoders."""
        return Receiver(self.schemes, self.period, self.clock_ppm / 1e6, self.filter, self.label)

    def __repr__(self) -> str:
        return f"Flight of {self.scheme}: {', '.join(self.names)}, one sample in {self.period} µs"


def _scheme(name: str, options: dict[str, Any], sample: str) -> Scheme:
    """The scheme of a channel. A flight's `start` is a number of the file, and not found from a first sample."""
    from ._schemes import schemes

    start = {"start": options["start"]} if "start" in options else None
    return schemes[name]._of(options, sample, start)


def _filter(told: tuple[str, float, float | None] | None, rate: float) -> Filter | None:
    if told is None:
        return None
    kind, corner, q = told
    return Filter.notch(corner, rate, q) if kind == "notch" else getattr(Filter, kind)(corner, rate)
