"""Recordings and events from and to files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple, Optional

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._bank import EVENTS


class Log(NamedTuple):
    """Channels of a recording."""

    #: The samples, ``float64`` (channels, samples), perhaps not finite.
    x: np.ndarray
    #: Their times in µs, ``int64``; none where a table has no time.
    t: Optional[np.ndarray]
    #: What the channels are called.
    names: list[str]
    #: How it was read, in sentences.
    notes: list[str]

    @property
    def rate(self) -> float | None:
        """Samples a second, by the usual step in time; none where there are no times."""
        if self.t is None or len(self.t) < 2:
            return None
        return 1e6 / float(np.median(np.diff(self.t)))

    def __repr__(self) -> str:
        return f"Log of {', '.join(self.names)}: {self.x.shape}"

    def __getitem__(self, place: Any) -> Any:
        return self.x[self.names.index(place)] if isinstance(place, str) else tuple.__getitem__(self, place)


def read(
    path: str | Path,
    *channels: str | int,
    topic: str | None = None,
    field: str | Sequence[str] = (),
    time: str | None = None,
    time_unit: str | None = None,
    delimiter: str | None = None,
    rate: float | None = None,
    gap: float | None = None,
    skip_non_finite: bool = False,
    accept_cut: bool = False,
) -> Log:
    """Channels of a flight log or table, by name; all of a table unless some are named: :class:`Log`.

    Of a log, `topic` and one `field` of it or several. `time` is the column of times and `time_unit` ``"s"``, ``"ms"``,
    ``"us"`` or ``"ns"``, both found unless given; without times, `rate` says how many samples a second there are. Steps
    in time above `gap` usual ones are noted. `skip_non_finite` goes on over values that are missing, and `accept_cut`
    over what is damaged.
    """
    keywords = {
        "columns": [str(name) for name in channels],
        "fields": [field] if isinstance(field, str) else list(field),
        "topic": topic,
        "time": None if time is None else str(time),
        "time_unit": time_unit,
        "delimiter": delimiter,
        "rate": rate,
        "gap": gap,
        "skip_non_finite": skip_non_finite,
        "accept_cut": accept_cut,
    }
    names, columns, times, notes = _native.read(str(Path(path)), keywords)
    return Log(np.array(columns), times if len(times) else None, names, notes)


def read_ulog(path: str | Path, topic: str, *fields: str, accept_cut: bool = False) -> Log:
    """Fields of a topic of a PX4 flight log: :class:`Log`.

    ``read_ulog("flight.ulg", "sensor_combined", "gyro_rad[0]")``; ``topic`` with ``:1`` is its second instance.
    """
    return read(path, topic=topic, field=fields, accept_cut=accept_cut)


#: An event of a camera: its time, column, row and polarity.
_PIXELS = np.dtype([("t", np.int64), ("x", np.int64), ("y", np.int64), ("p", np.int64)])


def read_events(source: str | Path | bytes, format: str) -> NDArray[Any]:
    """The events of a file, or of ``bytes``, as a structured array; see :data:`~spikewire.EVENTS`.

    `format` is one of the laptop program's: ``"es"``, ``"evt2"``, ``"evt21"``, ``"evt3"``, ``"link"``, ``"edvs:e0"`` to
    ``"edvs:e4"``, ``"eieio"`` or ``"csv"``. Events of a camera have their row in the field ``y``, after the column ``x``. Times of 32 bits that wrapped, after 71.6 minutes, go on.
    """
    data = bytes(source) if isinstance(source, (bytes, bytearray, memoryview)) else Path(source).read_bytes()
    ticks, places, rows, are_up, _ = _native.read_events(data, format)
    events = np.empty(len(ticks), dtype=EVENTS if rows is None else _PIXELS)
    if rows is not None:
        events["y"] = rows
    steps = np.diff(ticks, prepend=ticks[:1]).view(np.int32).astype(np.int64)
    events["t"] = np.cumsum(steps) + (int(ticks[0]) if len(ticks) else 0)
    events["x"], events["p"] = places, are_up
    return events


def write_events(events: NDArray[Any], format: str, path: str | Path | None = None) -> bytes:
    """Events, a structured array with ``t``, ``x`` and ``p``, as ``bytes`` of a format, and in a file if `path` is given.

    With ``y``, as ``tonic`` and ``expelliarmus`` have it, they are a camera's events, for ``"es"``, ``"evt2"``, ``"evt3"``
    and ``"csv"``; ``"evt3,width=640,height=480"`` is the size of its picture, if the events do not reach the last pixel.

    >>> import numpy as np, spikewire as sw
    >>> events = np.array([(0, 3, 1), (1000, 0, 0)], dtype=sw.EVENTS)
    >>> data = sw.write_events(events, "es")
    >>> bool((sw.read_events(data, "es") == events).all())
    True
    """
    addresses = np.asarray(events["x"])
    if len(addresses) and not (0 <= addresses.min() and addresses.max() < 1 << 16):
        raise ValueError(f"addresses must be 0 to 65535, but are {addresses.min()} to {addresses.max()}")
    ticks = (np.asarray(events["t"]).astype(np.int64) & 0xFFFF_FFFF).astype(np.uint32)
    rows = np.asarray(events["y"]) if "y" in (events.dtype.names or ()) else None
    if rows is not None:
        if len(rows) and not (0 <= rows.min() and rows.max() < 1 << 16):
            raise ValueError(f"rows must be 0 to 65535, but are {rows.min()} to {rows.max()}")
        rows = rows.astype(np.uint16)
    data, _ = _native.write_events(ticks, addresses.astype(np.uint16), rows, np.asarray(events["p"]) > 0, format)
    if path is not None:
        Path(path).write_bytes(data)
    return data
