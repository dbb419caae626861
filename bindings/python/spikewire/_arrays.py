"""What arrays become before the compiled half takes them, and what is said of them to the caller."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._errors import Error

#: A number, as Python, NumPy and their arrays of one number have it.
Number = Union[float, "np.floating[Any]", "np.integer[Any]"]
#: A whole number.
Whole = Union[int, "np.integer[Any]"]
#: Several numbers, such as one for each channel.
Numbers = Union[Sequence[Number], NDArray[Any]]

#: Those that are taken as they lie in memory.
TAKEN = (np.float32, np.float64, np.int16)

#: The package's own files, whose lines no warning names.
HOME = str(Path(__file__).parent)


class Signal(NamedTuple):
    """An array of NumPy, and what its container says of its axes."""

    array: NDArray[Any]
    #: The axis of time, if the container has one.
    time: int | None = None
    #: What the channels are called, if the container says it.
    names: list[str] | None = None


def read(x: Any) -> Signal:
    """An array of any library, or a table, without a mask.

    Time goes down the rows of a table, whose columns are channels, and along the dimension ``time`` of xarray.
    """
    if type(x) is np.ndarray and x.dtype.names is None:
        return Signal(x)
    if isinstance(x, np.ndarray):
        return _table(x.dtype.names, [x[name] for name in x.dtype.names]) if x.dtype.names else Signal(unmasked(x))
    for lazy in ("compute", "collect"):
        # Of Dask, of xarray on Dask's arrays, and polars' LazyFrame.
        if hasattr(x, lazy):
            x = getattr(x, lazy)()
    if hasattr(x, "data_vars"):
        x = x.to_array("channel")
    if hasattr(x, "get_axis_num"):
        return _labelled(x)
    if hasattr(x, "iloc") and hasattr(x, "columns"):
        return _table(x.columns, [x.iloc[:, place].to_numpy() for place in range(len(x.columns))])
    if hasattr(x, "get_columns"):
        return _table(x.columns, [column.to_numpy() for column in x.get_columns()])
    if hasattr(x, "column_names"):
        return _table(x.column_names, [np.asarray(column) for column in x.columns])
    if hasattr(x, "detach") and hasattr(x, "cpu"):
        # NumPy knows no numbers of torch with 16 bits or fewer but its own.
        x = x.detach().cpu()
        x = x.float() if x.is_floating_point() and x.itemsize < 4 else x
    array, name = unmasked(x), getattr(x, "name", None)
    return Signal(array, None, [name] if isinstance(name, str) and array.ndim == 1 else None)


def _labelled(x: Any) -> Signal:
    """An array of xarray."""
    time = x.dims.index("time") if "time" in x.dims else None
    names = [x.name] if isinstance(x.name, str) and x.ndim == 1 else None
    if time is not None and x.ndim == 2:
        other = x.dims[1 - time]
        names = [str(name) for name in x.coords[other].values] if other in x.coords else None
    return Signal(unmasked(x.values), time, names)


def _table(names: Any, columns: list[NDArray[Any]]) -> Signal:
    """A table, as an array (rows, columns) whose channels are not torn apart in memory."""
    names = [str(name) for name in names]
    columns = [unmasked(column) for column in columns]
    for name, column in zip(names, columns):
        if column.dtype.kind == "O":
            raise Error(f"column {name!r} holds objects, such as texts or missing values: samples are floats or integers")
        if column.dtype.kind not in "fiub":
            raise Error(f"column {name!r} holds {column.dtype}: samples are floats or integers")
    if not columns:
        raise Error("the table has no columns")
    return Signal(np.stack(columns).T, 0, names)


def unmasked(x: ArrayLike) -> NDArray[Any]:
    """An array without a mask; what is masked has no value that could be coded."""
    mask = np.ma.getmask(x)
    if np.any(mask):
        place = ", ".join(str(index[0]) for index in np.nonzero(mask))
        raise Error(f"the sample at {place} is masked; x.filled(value) gives it one, x.compressed() leaves it out")
    try:
        x = np.asarray(x)
    except (TypeError, ValueError) as error:
        raise Error(f"samples are an array of numbers: {error}") from error
    # Of ml_dtypes, as JAX has it, which f32 holds.
    return x.astype(np.float32) if x.dtype.name in ("bfloat16", "float8_e4m3fn", "float8_e5m2") else x


def samples(x: Any, axis: int | None = None) -> tuple[Signal, NDArray[Any]]:
    """Samples with their axis of time, the last one unless `axis` or the container says which; and a view whose last axis
    it is. Copied only where their type or byte order must change."""
    x, time, names = read(x)
    if x.ndim == 0:
        raise Error(f"samples are an array (samples,) or (channels, samples), not the number {x}")
    if axis is not None:
        axis = time_axis(axis, x.ndim)
        names = names if axis == time else None
    else:
        axis = x.ndim - 1 if time is None else time
    if not (x.dtype.isnative and x.dtype in TAKEN):
        if x.dtype.kind not in "fiub":
            raise Error(f"samples are floats or integers, not {x.dtype}")
        if x.dtype == np.float16 or (x.dtype.kind in "iub" and x.dtype.itemsize == 1):
            x = x.astype(np.float32)
        else:
            x = x.astype(x.dtype.newbyteorder("=") if x.dtype.newbyteorder("=") in TAKEN else np.float64)
    return Signal(x, axis, names), np.moveaxis(x, axis, -1)


def one(x: Any) -> Signal:
    """A signal of one channel, as doubles; of a table with one column, that column."""
    x, time, names = read(x)
    if x.ndim == 2 and time is not None and x.shape[1 - time] == 1:
        x = x.reshape(-1)
    if x.ndim != 1:
        raise Error(f"a signal is an array (samples,), not {x.shape}")
    if x.dtype.kind not in "fiub":
        raise Error(f"samples are floats or integers, not {x.dtype}")
    return Signal(x.astype(np.float64), 0, names)


def warn(words: str) -> None:
    """Warns the caller of the package, at the caller's line."""
    frame, level = sys._getframe(), 1
    while frame.f_back is not None and frame.f_code.co_filename.startswith(HOME):
        frame, level = frame.f_back, level + 1
    warnings.warn(words, stacklevel=level)


def remark(sample: str, *arrays: NDArray[Any]) -> None:
    """Warns of what the `sample` type does to samples: that it clamps some, or is too coarse for their steps."""
    for x in arrays:
        if sample == "f32" and x.dtype != np.float64:
            continue
        for words in _native.remarks(sample, x):
            warn(words)


def remark_outside(ranges: list[tuple[float, float]], sample: str, x: NDArray[Any]) -> None:
    """Warns of samples outside the range of their code: one for all channels, or one for each."""
    if ranges and x.size and (words := _native.outside(sample, ranges, x)):
        warn(words)


def cells(codes: Any, shape: tuple[int, int], rows_of: str) -> tuple[NDArray[np.int8], tuple[int, ...]]:
    """Codes as one row of cells a sample: the array, flat, and the shape of what they decode to."""
    codes = np.ascontiguousarray(codes)
    if codes.dtype != np.int8:
        narrow = codes.astype(np.int8) if codes.dtype.kind in "fiub" else np.zeros(0)
        if not np.array_equal(narrow, codes):
            raise Error(
                f"spikes are whole numbers from -128 to 127, not of {codes.dtype}; decode_weighted takes what lies between"
            )
        codes = narrow
    return codes.reshape(-1), outer_of(codes, shape, rows_of)


def codes_time_last(codes: Any, shape: tuple[int, int], axis: int | None) -> tuple[NDArray[Any], int]:
    """Codes, or weights in their place, with time before the axes of a sample's cells; and where it was."""
    codes, time, _ = read(codes)
    axes = codes.ndim - len(row(shape))
    if axes <= 0:
        return codes, 0
    axis = time_axis(axis, axes) if axis is not None else axes - 1 if time is None or time >= axes else time
    return np.moveaxis(codes, axis, axes - 1), axis


def outer_of(codes: NDArray[Any], shape: tuple[int, int], rows_of: str) -> tuple[int, ...]:
    """The shape of what codes decode to."""
    inner = row(shape)
    outer = codes.shape[: codes.ndim - len(inner)]
    if codes.ndim <= len(inner) or codes.shape[len(outer) :] != inner:
        told = ", ".join(["(channels,) samples", *map(str, inner)])
        raise Error(f"spikes of {rows_of} are an array of {told}, not {codes.shape}")
    return outer


def row(shape: tuple[int, int]) -> tuple[int, ...]:
    """The axes of a sample's code: none, neurons, or sub-timesteps and neurons."""
    neurons, slots = shape
    if slots > 1:
        return (slots, neurons)
    return (neurons,) if neurons > 1 else ()


def time_axis(axis: int, axes: int) -> int:
    """The number of the axis of time, of so many."""
    if not isinstance(axis, (int, np.integer)) or isinstance(axis, bool):
        raise Error(f"axis is that of time, a whole number from {-axes} to {axes - 1}, and not {axis!r}")
    if not -axes <= axis < axes:
        raise Error(f"axis {axis}: there are {axes} axes, without those of a sample's neurons and sub-timesteps")
    return int(axis) % axes
