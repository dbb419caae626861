"""A step of a data pipeline."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _scheme as _base
from ._errors import checked


class ToSpikes:
    """A transform from samples to spikes, as data sets of torchvision and tonic take them.

    `axis` is the one of time: 0 for (time, channels), as tonic and snnTorch lay out data, and the last one or the rows of
    a table unless given. The spikes are an array
    of `dtype`, or a tensor if the samples are one of torch; that array and tensor share their memory. `dtype` may be one of
    torch, such as ``torch.bfloat16``: then they are a tensor of it.

    >>> import numpy as np, spikewire as sw
    >>> transform = sw.ToSpikes(sw.StepForward(threshold=0.5), axis=0)
    >>> transform(np.array([[0.0, 0.0], [1.0, -1.0], [1.0, -1.0]]))
    array([[ 0,  0],
           [ 1, -1],
           [ 0,  0]], dtype=int8)
    """

    @checked
    def __init__(self, scheme: _base.Scheme, axis: int | None = None, dtype: Any = np.int8):
        self.scheme: _base.Scheme = scheme
        self.axis: int | None = axis
        #: Type of the spikes, of NumPy or of torch.
        self.dtype: Any = dtype if type(dtype).__module__ == "torch" else np.dtype(dtype)

    def __call__(self, x: Any) -> Any:
        spikes = self.scheme.encode(x, progress=False, axis=self.axis).array
        if isinstance(self.dtype, np.dtype):
            spikes = spikes.astype(self.dtype, copy=False)
            if not hasattr(x, "detach"):
                return spikes
        import torch

        tensor = torch.from_numpy(spikes)
        return tensor if isinstance(self.dtype, np.dtype) else tensor.to(self.dtype)

    def __repr__(self) -> str:
        return f"ToSpikes({self.scheme!r}, axis={self.axis}, dtype={getattr(self.dtype, 'name', self.dtype)!r})"
