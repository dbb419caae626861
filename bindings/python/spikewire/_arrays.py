"""What arrays become before the compiled half takes them."""

from __future__ import annotations

from typing import Any

import warnings

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native

#: Those that are taken as they lie in memory.
TAKEN = (np.float32, np.float64, np.int16)

#: Whole numbers up to this one are all held by ``f32``.
WHOLE = 1 << 24


def samples(x: ArrayLike, sample: str = "f32") -> NDArray[Any]:
    """An array of samples whose last axis is time; copied only where its type or byte order must change."""
    x = unmasked(x)
    if x.ndim == 0:
        raise ValueError(f"samples are an array (samples,) or (channels, samples), not the number {x}")
    if x.dtype.isnative and x.dtype in TAKEN:
        return x
    if x.dtype == np.float16 or (x.dtype.kind in "iub" and x.dtype.itemsize == 1):
        return x.astype(np.float32)
    if x.dtype.kind not in "fiub":
        raise ValueError(f"samples are floats or integers, not {x.dtype}")
    if sample == "f32" and x.dtype.kind in "iu" and x.dtype.itemsize > 2 and x.size:
        most = max(abs(int(x.min())), abs(int(x.max())))
        if most > WHOLE:
            warnings.warn(f"samples reach {most}: f32 holds whole numbers to {WHOLE}, and i32 does", stacklevel=3)
    return x.astype(x.dtype.newbyteorder("=") if x.dtype.newbyteorder("=") in TAKEN else np.float64)


def tell_cut(sample: str, *arrays: NDArray[Any]) -> None:
    """Warns the caller's caller of samples that lie outside the range of a fixed-point `sample` type."""
    for x in arrays:
        if words := _native.cut(sample, x):
            warnings.warn(words, stacklevel=3)


def unmasked(x: ArrayLike) -> NDArray[Any]:
    """An array without a mask; what is masked has no value that could be coded."""
    mask = np.ma.getmask(x)
    if np.any(mask):
        place = ", ".join(str(index[0]) for index in np.nonzero(mask))
        raise ValueError(f"the sample at {place} is masked; x.filled(value) gives it one, x.compressed() leaves it out")
    return np.asarray(x)


def cells(codes: ArrayLike, shape: tuple[int, int], rows_of: str) -> tuple[NDArray[np.int8], tuple[int, ...]]:
    """Codes as one row of cells a sample: the array, flat, and the shape of what they decode to."""
    codes = np.ascontiguousarray(codes)
    if codes.dtype != np.int8:
        narrow = codes.astype(np.int8)
        if not np.array_equal(narrow, codes):
            raise ValueError(
                f"spikes are whole numbers from -128 to 127, not of {codes.dtype}; decode_weighted takes what lies between"
            )
        codes = narrow
    return codes.reshape(-1), outer_of(codes, shape, rows_of)


def outer_of(codes: NDArray[Any], shape: tuple[int, int], rows_of: str) -> tuple[int, ...]:
    """The shape of what codes decode to."""
    inner = row(shape)
    outer = codes.shape[: codes.ndim - len(inner)]
    if codes.ndim <= len(inner) or codes.shape[len(outer) :] != inner:
        told = ", ".join(["(channels,) samples", *map(str, inner)])
        raise ValueError(f"spikes of {rows_of} are an array of {told}, not {codes.shape}")
    return outer


def row(shape: tuple[int, int]) -> tuple[int, ...]:
    """The axes of a sample's code: none, neurons, or sub-timesteps and neurons."""
    neurons, slots = shape
    if slots > 1:
        return (slots, neurons)
    return (neurons,) if neurons > 1 else ()


def time_last(x: NDArray[Any], axis: int) -> NDArray[Any]:
    """A view whose last axis is the one of time."""
    return np.moveaxis(x, time_axis(axis, x.ndim), -1)


def time_axis(axis: int, axes: int) -> int:
    """The number of the axis of time, of so many."""
    if not isinstance(axis, (int, np.integer)):
        raise ValueError(f"axis is that of time, a whole number from {-axes} to {axes - 1}, and not {axis!r}")
    if not -axes <= axis < axes:
        raise ValueError(f"axis {axis}: there are {axes} axes, without those of a sample's neurons and sub-timesteps")
    return int(axis) % axes
