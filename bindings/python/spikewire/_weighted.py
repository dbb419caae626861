"""Decoding of what a network gives: weights in the place of spikes."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _scheme as _base
from ._arrays import codes_time_last, outer_of, row
from ._errors import Error

#: Each neuron, or each sub-timestep of a single neuron, stands for a value: the mean of these values by weight.
MEANS = ("position", "grf", "grf-prob", "grf-nonlinear", "ttfs")
#: A spike is a step: so many parts of it.
STEPS = ("tbr", "sf", "mw", "sod")
#: A spike adds a filter or its share of a mean, over time.
FILTERS = ("hsa", "t-hsa", "bsa", "sigma-delta", "if", "bernoulli")
#: Each sub-timestep is a digit.
DIGITS = ("weighted-phase",)
#: What a spike means depends on others: these have no values for weights.
WITHOUT = (
    "asf",
    "atbr",
    "lif",
    "burst-weighted",
    "grf-slots",
    "grf-nonlinear-slots",
    "rank-order",
    "latency-phase",
    "burst",
)

#: What is left of a response that fades, in parts of its largest value.
FADED = 1e-9


def decode(scheme: _base.Scheme, weights: ArrayLike, first: ArrayLike | None, axis: int | None) -> NDArray[np.float64]:
    """What :meth:`Scheme.decode_weighted` says."""
    shape = (scheme.neurons, scheme.slots)
    inner = row(shape)
    weights, axis = codes_time_last(weights, shape, axis)
    if weights.dtype.kind not in "fiub":
        raise Error(f"weights are floats or integers, not {weights.dtype}")
    weights = weights.astype(np.float64)
    outer = outer_of(weights, shape, type(scheme).__name__)
    if not np.isfinite(weights).all():
        raise Error("weights must be finite")
    channels = int(np.prod(outer[:-1]))
    weights = weights.reshape(channels, outer[-1], -1)
    if not weights.size:
        return np.zeros(weights.shape[:2]).reshape(outer)
    strict = Strict(scheme, first, channels, inner)
    if scheme.name in MEANS:
        values = mean(strict, weights)
    elif scheme.name in STEPS:
        values = steps(strict, weights)
    elif scheme.name in FILTERS:
        values = filtered(strict, weights)
    elif scheme.name in DIGITS:
        values = digits(strict, weights)
    else:
        known = ", ".join([*MEANS, *STEPS, *FILTERS, *DIGITS])
        raise Error(f"{scheme.name} has no values for weights: what a spike means depends on others; {known} have")
    return np.moveaxis(values.reshape(outer), -1, axis)


class Strict:
    """The decoder of spikes, always from its start."""

    def __init__(self, scheme: _base.Scheme, first: ArrayLike | None, channels: int, inner: tuple[int, ...]):
        self.scheme, self.channels, self.inner = scheme, channels, inner
        self.first = None if first is None else np.broadcast_to(np.ravel(first), (channels,))

    def decode(self, rows: NDArray[Any], first: ArrayLike | None = None) -> NDArray[np.float64]:
        """The values (channels, rows) of the same rows (rows, cells) in each channel."""
        decoder = self.scheme.decoder(self.first if first is None else first, self.channels)
        codes = np.broadcast_to(rows.astype(np.int8), (self.channels, *rows.shape))
        values = decoder.decode(codes.reshape(self.channels, len(rows), *self.inner))
        return values.astype(np.float64)


def mean(strict: Strict, weights: NDArray[Any]) -> NDArray[Any]:
    if (weights < 0).any():
        raise Error(f"{strict.scheme.name} takes the mean by weights, which must be 0 or more")
    cells = weights.shape[2]
    values = strict.decode(np.eye(cells))
    total = weights.sum(axis=2)
    is_known = total > 0
    means = np.einsum("ctn,cn->ct", weights, values) / np.where(is_known, total, 1)
    # Where nothing fires, the value before.
    last = np.maximum.accumulate(np.where(is_known, np.arange(weights.shape[1]), -1), axis=1)
    start = strict.decode(np.zeros((1, cells)))
    return np.where(last < 0, start, np.take_along_axis(means, np.maximum(last, 0), axis=1))


def steps(strict: Strict, weights: NDArray[Any]) -> NDArray[Any]:
    silent = np.zeros((2, weights.shape[2]))
    up = silent.copy()
    up[1, 0] = 1
    # The difference of two values near 0 is exact.
    near = None if "start" in strict.scheme.parameters else np.zeros(strict.channels)
    difference = strict.decode(up, near) - strict.decode(silent, near)
    parts = weights.sum(axis=2)
    if near is not None:
        # The first sample is where the decoder starts; its spike changes nothing.
        parts[:, 0] = 0
    return strict.decode(silent)[:, :1] + difference[:, 1:] * parts.cumsum(axis=1)


def filtered(strict: Strict, weights: NDArray[Any]) -> NDArray[Any]:
    length = weights.shape[1]
    silent = np.zeros((length, weights.shape[2]))
    impulse = silent.copy()
    impulse[0, 0] = 1
    base = strict.decode(silent)
    responses = strict.decode(impulse) - base
    for own, response, channel in zip(base, responses, weights.sum(axis=2)):
        heard = np.flatnonzero(np.abs(response) > FADED * np.abs(response).max())
        if len(heard):
            own += np.convolve(channel, response[: heard[-1] + 1])[:length]
    return base


def digits(strict: Strict, weights: NDArray[Any]) -> NDArray[Any]:
    cells = weights.shape[2]
    values = strict.decode(np.vstack([np.zeros(cells), np.eye(cells)]))
    return values[:, :1] + np.einsum("ctn,cn->ct", weights, values[:, 1:] - values[:, :1])
