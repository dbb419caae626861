"""Codes as layers of PyTorch: samples in, spikes out with time first, as snnTorch and SpikingJelly take them.

Needs ``torch``, which ``pip install spikewire[torch]`` brings.

>>> import torch, spikewire as sw
>>> from spikewire.torch import Encode
>>> windows = torch.sin(torch.linspace(0, 60, 32 * 100 * 6)).reshape(32, 100, 6)    # (batch, time, features)
>>> Encode(sw.StepForward(threshold=0.1), time=1, split=True)(windows).shape      # ups, then downs
torch.Size([100, 32, 12])
>>> Encode(sw.Bernoulli(min=-1, max=1), num_steps=25)(windows[:, 0]).shape        # still samples, drawn 25 times
torch.Size([25, 32, 6])
>>> Encode(sw.FirstSpike(min=-1, max=1, slots=8), num_steps=1)(windows[:, 0]).shape
torch.Size([8, 32, 6])
"""

from __future__ import annotations

import itertools
import json
import weakref
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal

import numpy as np
import torch
from torch import Tensor, nn
from torch.utils.data import Dataset

from ._scheme import Scheme

__all__ = ["Encode", "TinyOdin", "Windows"]

#: The layers by number: an operator of torch takes numbers and tensors only.
_LAYERS: weakref.WeakValueDictionary[int, Encode] = weakref.WeakValueDictionary()
_NUMBERS = itertools.count()


class Encode(nn.Module):
    """Encodes a batch of samples by `scheme`: a layer without weights before a network.

    The output is (time, batch, …), whatever the axis `time` of the samples is. A code with sub-timesteps takes as many
    steps a sample, and the neurons of a population come side by side in the last axis.

    Args:
        scheme: The code, such as ``StepForward(threshold=0.1)``. Its parameters that follow from the signal are found for
            each channel of each batch by itself, unless the scheme was fitted.
        num_steps: Number of times that still samples (batch, …) are encoded; they have no axis of time.
        time: The axis of time of the samples: 0 for (time, batch, features), 1 for (batch, time, features).
        split: Whether spikes up and spikes down are inputs of their own: the last axis has all ups, then all downs.
        dtype: Type of the spikes; any of torch, `torch.bfloat16` too. One without a sign, as `torch.bool`, needs `split` if the code
            has spikes down.
        device: Where the spikes go, the samples' own unless given. The code runs on the CPU: samples on another device are
            copied there, and the spikes back, in each call.
        gradient: How gradients reach the samples. Spikes have none of their own, so ``None`` stops them. ``"straight"``
            passes them on: a sample's is the sum of those of all its cells, where cells of spikes down count negative if
            `split`. A function of the samples gives factors for that sum, such as ``lambda x: 1 / (1 + x.abs()) ** 2``.

    Under `torch.compile` it is one opaque operator, `spikewire::encode`; two calls with the same samples may share their draws.
    """

    def __init__(
        self,
        scheme: Scheme,
        num_steps: int | None = None,
        *,
        time: int = 0,
        split: bool = False,
        dtype: torch.dtype = torch.float32,
        device: torch.device | str | None = None,
        gradient: Literal["straight"] | Callable[[Tensor], Tensor] | None = None,
    ):
        super().__init__()
        if num_steps is not None and time != 0:
            raise ValueError("still samples have no axis of time: num_steps goes without time")
        if not (gradient is None or gradient == "straight" or callable(gradient)):
            raise ValueError(f"gradient is 'straight', a function of the samples or None, not {gradient!r}")
        if scheme._info["is_signed"] and not (split or dtype.is_signed):
            raise ValueError(f"{dtype} has no sign for spikes down: split=True keeps them apart")
        self.scheme, self.num_steps, self.time, self.split = scheme, num_steps, time, split
        self.dtype, self.device, self.gradient = dtype, device, gradient
        self._register()

    def _register(self) -> None:
        self._number = next(_NUMBERS)
        _LAYERS[self._number] = self

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name != "_number"}

    def __setstate__(self, state: dict[str, Any]) -> None:
        super().__setstate__(state)
        self._register()

    def forward(self, x: Tensor) -> Tensor:
        """Encodes samples: a tensor of floats or integers."""
        if self.gradient is None or not x.is_floating_point():
            x = x.detach()
        return _encode(x, self._number)

    def extra_repr(self) -> str:
        """The arguments of the layer, for `print`."""
        given = {"num_steps": self.num_steps, "time": self.time or None, "split": self.split or None}
        return ", ".join([repr(self.scheme), *(f"{name}={value}" for name, value in given.items() if value is not None)])

    def _with_time(self, x: Tensor) -> tuple[Tensor, int]:
        """The samples with an axis of time, which still ones share; and that axis."""
        if self.num_steps is not None:
            return x.expand(self.num_steps, *x.shape), 0
        return x, self.time % x.ndim

    def _spikes(self, x: Tensor) -> Tensor:
        x, axis = self._with_time(x)
        values = x.detach().to("cpu", torch.float32 if x.dtype == torch.bfloat16 else None)
        spikes = self.scheme.encode(values.numpy(), progress=False, axis=axis)
        codes = torch.from_numpy(spikes.array).reshape(*x.shape, spikes.slots, spikes.neurons).movedim(axis, 0)
        codes = codes.reshape(x.shape[axis], *self._rest(x, axis), spikes.slots, spikes.neurons).movedim(-2, 1)
        if self.split:
            codes = torch.stack([codes.clamp(min=0), -codes.clamp(max=0)], -3)
        codes = codes.reshape(self._shape(x, axis)).contiguous()
        return codes.to(self.device or x.device, self.dtype)

    def _rest(self, x: Tensor, axis: int) -> tuple[int, ...]:
        """The axes without that of time: one at least."""
        return (*x.shape[:axis], *x.shape[axis + 1 :]) or (1,)

    def _shape(self, x: Tensor, axis: int) -> tuple[int, ...]:
        *outer, last = self._rest(x, axis)
        inputs = last * self.scheme.neurons * (2 if self.split else 1)
        return (x.shape[axis] * self.scheme.slots, *outer, inputs)

    def _grown(self, gradient: Tensor, x: Tensor) -> Tensor:
        """The gradient by the samples."""
        own, axis = self._with_time(x)
        steps, (*outer, last), signs = own.shape[axis], self._rest(own, axis), 2 if self.split else 1
        grown = gradient.reshape(steps, self.scheme.slots, *outer, signs, last, self.scheme.neurons)
        grown = grown.sum((1, -1), dtype=torch.promote_types(gradient.dtype, torch.float32))
        grown = grown[..., 0, :] - grown[..., 1, :] if self.split else grown[..., 0, :]
        if self.num_steps is not None:
            grown = grown.sum(0).reshape(x.shape)
        else:
            grown = grown.reshape(own.movedim(axis, 0).shape).movedim(0, axis)
        grown = grown.to(x.device, x.dtype)
        return grown * self.gradient(x) if callable(self.gradient) else grown


# With its schema: not every torch from 2.4 reads one from annotations that are texts.
@torch.library.custom_op("spikewire::encode", mutates_args=(), schema="(Tensor x, int layer) -> Tensor")
def _encode(x: Tensor, layer: int) -> Tensor:
    return _LAYERS[layer]._spikes(x)


@_encode.register_fake
def _(x: Tensor, layer: int) -> Tensor:
    own = _LAYERS[layer]
    return x.new_empty(own._shape(*own._with_time(x)), dtype=own.dtype, device=own.device or x.device)


def _keep(ctx: Any, inputs: tuple[Any, ...], output: Tensor) -> None:
    x, number = inputs
    # It must live until its gradient is asked for.
    ctx.layer = _LAYERS[number]
    ctx.save_for_backward(x)


def _backward(ctx: Any, gradient: Tensor) -> tuple[Tensor, None]:
    with torch.no_grad():
        return ctx.layer._grown(gradient, *ctx.saved_tensors), None


_encode.register_autograd(_backward, setup_context=_keep)


class TinyOdin(nn.Module):
    """Layers of neurons in the chip tinyODIN's arithmetic, to be trained.

    The chip fires as they do if its neurons compare once a step: ``spikewire network --compare step``.

    Weights are whole numbers from -8 to 7, potentials from -2048 to 2047; a leak is an amount, and a neuron that reaches its
    threshold fires and starts again at 0. What is trained are real numbers, of which the chip's weights are the nearest: gradients
    pass straight through the rounding, and through the step with which a neuron fires by a smooth slope (Neftci, Mostafa and
    Zenke, 2019). They do not pass through the reset.

    Inputs are (time, batch, inputs), counts of spikes as those of :class:`Encode`; the output is that of the last layer.

    >>> network = TinyOdin(12, 16, 3)
    >>> network(torch.ones(5, 4, 12)).shape
    torch.Size([5, 4, 3])

    Args:
        inputs: Number of inputs.
        sizes: Number of neurons of each layer.
        threshold: Potential from which a neuron fires.
        leak: Amount by which a potential comes nearer to 0 in each step.
    """

    def __init__(self, inputs: int, *sizes: int, threshold: int = 16, leak: int = 1):
        super().__init__()
        self.threshold, self.leak = threshold, leak
        shapes = zip((inputs, *sizes), sizes)
        self.weights = nn.ParameterList(nn.Parameter(1 + 4 * torch.randn(shape)) for shape in shapes)

    def whole(self) -> list[Tensor]:
        """The chip's weights by layer, [from, to]; gradients pass on to those that are trained."""
        return [own + (own.detach().round().clamp(-8, 7) - own.detach()) for own in self.weights]

    def layers(self, x: Tensor) -> list[tuple[Tensor, Tensor]]:
        """The potentials of each layer before their reset, and its spikes: (time, batch, neurons)."""
        layers = []
        for weights in self.whole():
            potentials, steps = x.new_zeros(x.shape[1], weights.shape[1], dtype=weights.dtype), []
            for driven in x.to(weights.dtype) @ weights:
                kept = potentials.sign() * (potentials.abs() - self.leak).clamp(min=0)
                reached = (kept + driven).clamp(-2048, 2047)
                fired = _Fire.apply(reached, self.threshold)
                potentials = reached * (1 - fired.detach())
                steps.append((reached, fired))
            reached, x = (torch.stack(own) for own in zip(*steps))
            layers.append((reached, x))
        return layers

    def forward(self, x: Tensor) -> Tensor:
        """The spikes of the last layer."""
        return self.layers(x)[-1][1]

    def save(self, path: str | Path) -> None:
        """Writes a network for ``spikewire network FILE --compare step``: the chip's words, constants in Rust, and its model."""
        # Potentials are whole numbers: above half a number less is at the threshold.
        rule = {"leak": self.leak, "threshold": self.threshold - 0.5}
        layers = [{"weights": own.detach().T.int().tolist(), **rule} for own in self.whole()]
        Path(path).write_text(json.dumps({"layers": layers}))


class _Fire(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, reached: Tensor, threshold: int) -> Tensor:
        ctx.save_for_backward(reached)
        ctx.threshold = threshold
        return (reached >= threshold).to(reached.dtype)

    @staticmethod
    def backward(ctx: Any, gradient: Tensor) -> tuple[Tensor, None]:
        (reached,) = ctx.saved_tensors
        return gradient / (1 + 3 * (reached / ctx.threshold - 1).abs()) ** 2, None


class Windows(Dataset[tuple[Tensor, Tensor]]):
    """Windows of a recording (time, features), each with the label of its last sample, for a `DataLoader`.

    A batch of them is (batch, time, features): ``Encode(scheme, time=1)`` takes it.

    Args:
        samples: The recording, as an array or a tensor.
        labels: A label for each sample.
        length: Number of samples of a window.
        stride: Number of samples from the start of a window to that of the next.

    >>> windows = Windows(np.zeros((100, 6), np.float32), np.arange(100), length=20, stride=10)
    >>> len(windows), windows[1][0].shape, int(windows[1][1])
    (9, torch.Size([20, 6]), 29)
    """

    def __init__(self, samples: Any, labels: Any, length: int, stride: int = 1):
        self.samples, self.labels = torch.as_tensor(samples), torch.as_tensor(labels)
        if len(self.samples) != len(self.labels):
            raise ValueError(f"{len(self.samples)} samples have {len(self.labels)} labels")
        self.length, self.stride = length, stride

    def __len__(self) -> int:
        return max((len(self.samples) - self.length) // self.stride + 1, 0)

    def __getitem__(self, place: int) -> tuple[Tensor, Tensor]:
        if not 0 <= place < len(self):
            raise IndexError(f"window {place} of {len(self)}")
        start = place * self.stride
        return self.samples[start : start + self.length], self.labels[start + self.length - 1]
