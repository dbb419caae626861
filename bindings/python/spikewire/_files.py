"""Recordings and events from and to files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple, Optional

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._arrays import Number, Whole
from ._arrays import read as as_array
from ._arrays import warn
from ._bank import EVENTS
from ._errors import Error, Unknown, checked
from ._times import ticks


class _Channels(NamedTuple):
    #: The samples, ``float64`` (channels, samples), perhaps not finite.
    x: NDArray[Any]
    #: Their times in µs, ``int64``; none where a table has no time.
    t: Optional[NDArray[Any]]
    #: What the channels are called.
    names: list[str]
    #: How it was read, in sentences.
    notes: list[str]


class Log(_Channels):
    """Channels of a recording: samples `x`, times `t`, `names` and `notes`.

    >>> import numpy as np, spikewire as sw
    >>> log = sw.Log(np.array([[0.0, 0.5], [9.8, 9.7]]), np.array([0, 5000]), ["gyro_x", "accel_z"], [])
    >>> log, log["accel_z"].tolist(), log.rate
    (Log of gyro_x, accel_z: (2, 2), [9.8, 9.7], 200.0)
    """

    #: The rate that :func:`read` was given.
    _given_rate: float | None = None

    @property
    def rate(self) -> float | None:
        """Samples a second: those given to :func:`read`, or the samples through the length without gaps.

        ``None`` where there are neither times nor a given rate. Warns if the usual step in time contradicts it by a fifth
        or more, as where samples arrive in bursts.
        """
        if self._given_rate is not None:
            return self._given_rate
        if self.t is None or len(self.t) < 2:
            return None
        rate, uncertain = _native.rate_of(np.ascontiguousarray(self.t, dtype=np.int64))
        if uncertain:
            warn(f"the rate is uncertain: {uncertain}; rate= says how many samples a second are taken")
        return rate

    def __repr__(self) -> str:
        return f"Log of {', '.join(self.names)}: {self.x.shape}"

    def __getitem__(self, place: Any) -> Any:
        if not isinstance(place, str):
            return tuple.__getitem__(self, place)
        if place not in self.names:
            raise Unknown(f"there is no channel {place!r}; there are {', '.join(self.names)}")
        return self.x[self.names.index(place)]


@checked
def read(
    path: str | Path,
    *channels: str | int,
    topic: str | None = None,
    field: str | Sequence[str] = (),
    time: str | None = None,
    time_unit: str | None = None,
    delimiter: str | None = None,
    header: Whole | None = None,
    rate: Number | None = None,
    gap: Number | None = None,
    skip_non_finite: bool = False,
    accept_cut: bool = False,
) -> Log:
    """Channels of a flight log or table, by name: :class:`Log`. Unless some are named, all of a table, and of a log the
    gyroscope and the accelerometer that flew.

    Names may be patterns such as ``"gyro_*"``. Those of a log are ``"sensor_combined.gyro_rad[0]"``, or `topic` and one
    `field` of it or several. `time` is the column of times and `time_unit` ``"s"``, ``"ms"``,
    ``"us"`` or ``"ns"``, both found unless given; `header` is the line of a table that names its columns, from 1, where it
    is not found. `rate` says how many samples a second there are, where the times do not. Steps in time above `gap` usual
    ones are noted. `skip_non_finite` goes on over values that are missing, and `accept_cut`
    over what is damaged.

    >>> import pathlib, tempfile, spikewire as sw
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "flight.csv"
    >>> _ = path.write_text("time,gyro_x,accel_z\\n0.000,0.0,9.8\\n0.005,0.5,9.7\\n")
    >>> sw.read(path), sw.read(path, "gyro_x").x.tolist()
    (Log of gyro_x, accel_z: (2, 2), [[0.0, 0.5]])
    """
    keywords = {
        "columns": [str(name) for name in channels],
        "fields": [field] if isinstance(field, str) else list(field),
        "topic": topic,
        "time": None if time is None else str(time),
        "time_unit": time_unit,
        "delimiter": delimiter,
        "header": header,
        "rate": rate,
        "gap": gap,
        "skip_non_finite": skip_non_finite,
        "accept_cut": accept_cut,
    }
    names, columns, times, notes = _native.read(str(Path(path)), keywords)
    log = Log(np.array(columns), times if len(times) else None, names, notes)
    log._given_rate = None if rate is None else float(rate)
    return log


def read_ulog(path: str | Path, topic: str, *fields: str, accept_cut: bool = False) -> Log:
    """Fields of a topic of a PX4 flight log: :class:`Log`.

    ``read_ulog("flight.ulg", "sensor_combined", "gyro_rad[0]")``; ``topic`` with ``:1`` is its second instance.

    >>> import spikewire as sw
    >>> sw.read_ulog("nowhere.ulg", "sensor_combined", "gyro_rad[0]")
    Traceback (most recent call last):
        ...
    spikewire.Error: nowhere.ulg: cannot be opened: No such file or directory (os error 2)
    """
    return read(path, topic=topic, field=fields, accept_cut=accept_cut)


#: An event of a camera: its time, column, row and polarity.
_PIXELS = np.dtype([("t", np.int64), ("x", np.int64), ("y", np.int64), ("p", np.int64)])


@checked
def read_events(source: str | Path | bytes | bytearray | memoryview, format: str) -> NDArray[Any]:
    """The events of a file, or of ``bytes``, as a structured array; see :data:`~spikewire.EVENTS`.

    `format` is one of the laptop program's: ``"es"``, ``"evt2"``, ``"evt21"``, ``"evt3"``, ``"link"``, ``"edvs:e0"`` to
    ``"edvs:e4"``, ``"eieio"`` or ``"csv"``. Events of a camera have their row in the field ``y``, after the column ``x``.
    Times of 32 bits that wrapped, after 71.6 minutes, go on.

    >>> import spikewire as sw
    >>> sw.read_events(b"tick,address,polarity\\n1000,3,1\\n", "csv").tolist()
    [(1000, 3, 1)]
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


@checked
def write_events(events: Any, format: str, path: str | Path | None = None) -> bytes:
    """Events, a structured array or a table with ``t``, ``x`` and ``p``, as ``bytes`` of a format, and in a file if `path` is
    given.

    With ``y``, as ``tonic`` and ``expelliarmus`` have it, they are a camera's events, for ``"es"``, ``"evt2"``, ``"evt3"``
    and ``"csv"``; ``"evt3,width=640,height=480"`` is the size of its picture, if the events do not reach the last pixel.
    ``t`` is in whole µs, in seconds as floats, or ``datetime64`` or ``timedelta64``. Gaps of more than 35 minutes, which no
    format holds, are an error.

    >>> import numpy as np, spikewire as sw
    >>> events = np.array([(0, 3, 1), (1000, 0, 0)], dtype=sw.EVENTS)
    >>> data = sw.write_events(events, "es")
    >>> bool((sw.read_events(data, "es") == events).all())
    True
    """
    fields = events if getattr(events, "dtype", None) is None else events.dtype.names
    rows = _places(events["y"], "rows") if "y" in fields else None
    are_up = as_array(events["p"]).array > 0
    data, _ = _native.write_events(ticks(events["t"]), _places(events["x"], "addresses"), rows, are_up, format)
    if path is not None:
        Path(path).write_bytes(data)
    return data


def _places(values: Any, name: str) -> NDArray[np.uint16]:
    """Addresses, or rows of a picture, in the 16 bits that formats have for them."""
    values = as_array(values).array
    if values.dtype.kind not in "iuf" or (values != np.trunc(values)).any():
        raise Error(f"{name} must be whole numbers")
    if len(values) and not (0 <= values.min() and values.max() < 1 << 16):
        raise Error(f"{name} must be 0 to 65535, but are {values.min()} to {values.max()}")
    return values.astype(np.uint16)
