"""What arrays become before the compiled half takes them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

#: Those that are taken as they lie in memory.
TAKEN = (np.float32, np.float64, np.int16)


def samples(x: ArrayLike) -> NDArray:
    """An array of samples whose last axis is time; copied only where its type or byte order must change."""
    x = np.asarray(x)
    if x.ndim == 0:
        raise ValueError(f"samples are an array (samples,) or (channels, samples), not the number {x}")
    if x.dtype.isnative and x.dtype in TAKEN:
        return x
    if x.dtype == np.float16:
        return x.astype(np.float32)
    if x.dtype.kind not in "fiub":
        raise ValueError(f"samples are floats or integers, not {x.dtype}")
    return x.astype(x.dtype.newbyteorder("=") if x.dtype.newbyteorder("=") in TAKEN else np.float64)


def cells(codes: ArrayLike, shape: tuple[int, int], rows_of: str) -> tuple[NDArray[np.int8], tuple[int, ...]]:
    """Codes as one row of cells a sample: the array, flat, and the shape of what they decode to."""
    codes = np.ascontiguousarray(codes)
    if codes.dtype != np.int8:
        narrow = codes.astype(np.int8)
        if not np.array_equal(narrow, codes):
            raise ValueError(f"spikes are whole numbers from -128 to 127, not of {codes.dtype}")
        codes = narrow
    inner = row(shape)
    outer = codes.shape[: codes.ndim - len(inner)]
    if codes.ndim <= len(inner) or codes.shape[len(outer) :] != inner:
        told = ", ".join(["(channels,) samples", *map(str, inner)])
        raise ValueError(f"spikes of {rows_of} are an array of {told}, not {codes.shape}")
    return codes.reshape(-1), outer


def row(shape: tuple[int, int]) -> tuple[int, ...]:
    """The axes of a sample's code: none, neurons, or sub-timesteps and neurons."""
    neurons, slots = shape
    if slots > 1:
        return (slots, neurons)
    return (neurons,) if neurons > 1 else ()
