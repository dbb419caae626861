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

import functools
import itertools
import json
import math
import weakref
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np
import torch
from torch import Tensor, nn
from torch.utils.data import Dataset

from . import _native
from ._arrays import time_axis
from ._errors import Error, OutOfRange
from ._network import Network, Reset
from ._scheme import Scheme

__all__ = ["Controller", "Encode", "ReckOn", "TinyOdin", "Windows"]

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

    >>> import spikewire as sw
    >>> Encode(sw.StepForward(threshold=0.1), time=1, split=True)(torch.zeros(32, 100, 6)).shape
    torch.Size([100, 32, 12])
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
            raise Error("still samples have no axis of time: num_steps goes without time")
        if not (gradient is None or gradient == "straight" or callable(gradient)):
            raise Error(f"gradient is 'straight', a function of the samples or None, not {gradient!r}")
        if scheme._info["is_signed"] and not (split or dtype.is_signed):
            raise Error(f"{dtype} has no sign for spikes down: split=True keeps them apart")
        self.scheme: Scheme = scheme
        self.num_steps: int | None = num_steps
        self.time: int = time
        self.split: bool = split
        self.dtype: torch.dtype = dtype
        self.device: torch.device | str | None = device
        self.gradient = gradient
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
        """Encodes samples: a tensor of floats or integers.

        >>> import spikewire as sw
        >>> Encode(sw.StepForward(threshold=0.5)).forward(torch.tensor([0.0, 1.0, 2.0])).tolist()
        [[0.0], [1.0], [1.0]]
        """
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
        if x.ndim == 0:
            raise Error("samples are (time, batch, features), or have their time on another axis, and are not one number")
        return x, time_axis(self.time, x.ndim)

    def _spikes(self, x: Tensor) -> Tensor:
        x, axis = self._with_time(x)
        spikes = self.scheme.encode(x, progress=False, axis=axis)
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


#: A layer's law, in two functions. The first maps all inputs (time, batch, inputs) to the sums that reach the neurons. The second
#: maps the sums of one step, and the state before it (None at rest), to potentials, spikes and the next state.
_Law = tuple[Callable[[Tensor], Tensor], Callable[[Tensor, Any], tuple[Tensor, Tensor, Any]]]


def _run(x: Tensor, laws: Iterable[_Law]) -> list[tuple[Tensor, Tensor]]:
    """The potentials of each layer, and its spikes: (time, batch, neurons)."""
    if (x < 0).any() or (x.is_floating_point() and (x != x.trunc()).any()):
        raise Error("inputs are counts of spikes; Encode(…, split=True) gives spikes down inputs of their own")
    layers = []
    for arriving, step in laws:
        steps, state = [], None
        for driven in arriving(x):
            reached, fired, state = step(driven, state)
            steps.append((reached, fired))
        reached, x = (torch.stack(own) for own in zip(*steps))
        layers.append((reached, x))
    return layers


def _passed(value: Tensor, own: Tensor) -> Tensor:
    """`value`, whose gradients pass straight on to `own`."""
    return value.detach() + (own - own.detach())


class _Chip(nn.Module):
    """Layers of neurons in a chip's arithmetic, whose weights are rounded in each call."""

    #: The least and the largest weight.
    _RANGE = (-8, 7)
    #: The amount that a weight of 1 adds to a potential.
    _unit = 1
    #: The largest potential.
    _MOST = 2047
    #: The most layers that fire.
    _DEPTH = 3

    def __init__(self, inputs: int, sizes: tuple[int, ...], threshold: int, recurrent: bool = False):
        super().__init__()
        if not 0 < threshold <= self._MOST:
            raise Error(f"a threshold is a potential from 1 to {self._MOST}, not {threshold}")
        if min(inputs, *sizes, 1) < 1:
            raise Error(f"a layer has 1 neuron or more, not {min(inputs, *sizes)}")
        self.threshold = threshold
        firing = sizes if self.readout is None else sizes[:-1]
        if not 1 <= len(firing) <= self._DEPTH:
            raise Error(f"1 to {self._DEPTH} layers fire, not {len(firing)}")
        # Most weights lie in the chip's range, however large the threshold is.
        one = min(threshold / self._unit / 16, self._RANGE[1] / 8)
        shapes = zip((inputs, *sizes), sizes)
        self.weights: nn.ParameterList = nn.ParameterList(nn.Parameter(one * (1 + 4 * torch.randn(shape))) for shape in shapes)
        own = (nn.Parameter(one * 4 * torch.randn(size, size)) for size in firing if recurrent)
        self.recurrent: nn.ParameterList = nn.ParameterList(own)

    @property
    def readout(self) -> float | None:
        """Share that a step leaves of the potentials of a last layer that never fires; ``None`` if it fires."""
        return None

    def _rounded(self, own: Tensor) -> Tensor:
        return _passed(own.round().clamp(*self._RANGE), own)

    def whole(self) -> list[Tensor]:
        """The chip's weights by layer, [from, to]; gradients pass on to those that are trained."""
        return [self._rounded(own) for own in self.weights]

    def layers(self, x: Tensor) -> list[tuple[Tensor, Tensor]]:
        """The potentials of each layer before their reset, and its spikes, or values if it never fires: (time, batch, neurons)."""

        def law(weights: Tensor, own: Tensor | None, step: Callable[..., tuple[Tensor, Tensor, Any]]) -> _Law:
            back = None if own is None else self._unit * self._rounded(own)
            return lambda x: self._counted(x).to(weights.dtype) @ (self._unit * weights), lambda *state: step(back, *state)

        # Types of 16 bits would round potentials.
        with torch.autocast(x.device.type, enabled=False):
            return _run(x, itertools.starmap(law, itertools.zip_longest(self.whole(), self.recurrent, self._steps())))

    def _counted(self, x: Tensor) -> Tensor:
        return x

    def _steps(self) -> list[Callable[..., tuple[Tensor, Tensor, Any]]]:
        return [self._step] * len(self.weights)

    def _step(self, back: Tensor | None, driven: Tensor, state: Any) -> tuple[Tensor, Tensor, Any]:
        raise NotImplementedError

    def forward(self, x: Tensor) -> Tensor:
        """The spikes of the last layer, or its values if it never fires."""
        return self.layers(x)[-1][1]

    def _rule(self) -> dict[str, Any]:
        raise NotImplementedError

    def save(self, path: str | Path) -> None:
        """Writes the network as JSON for ``spikewire network``, which makes the chip's words from it."""

        def written(own: Tensor) -> list[list[int]]:
            return (self._unit * self._rounded(own)).detach().T.int().tolist()

        # Potentials are whole numbers: above half a number less is at the threshold.
        rule = {**self._rule(), "threshold": self.threshold - 0.5}
        layers = [{"weights": written(own), **rule} for own in self.weights]
        for layer, own in zip(layers, self.recurrent):
            layer["recurrent"] = written(own)
        network: dict[str, Any] = {"layers": layers, "integers": True}
        if self.readout is not None:
            network["readout"] = {"weights": layers.pop()["weights"], "keep": self.readout}
        Path(path).write_text(json.dumps(network))


class TinyOdin(_Chip):
    """Layers of neurons in the chip tinyODIN's arithmetic, to be trained.

    The chip fires as they do if its neurons compare once a step: :meth:`save`, then ``spikewire network --compare step``.

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
        sizes: Number of neurons of each layer, three layers at most.
        threshold: Potential from which a neuron fires, 1 to 2047.
        leak: Amount by which a potential comes nearer to 0 in each step.
    """

    def __init__(self, inputs: int, *sizes: int, threshold: int = 16, leak: int = 1):
        super().__init__(inputs, sizes, threshold)
        self.leak = leak

    def _step(self, back: Tensor | None, driven: Tensor, state: Any) -> tuple[Tensor, Tensor, Any]:
        kept = 0 if state is None else state.sign() * (state.abs() - self.leak).clamp(min=0)
        reached = (kept + driven).clamp(-2048, 2047)
        fired = _Fire.apply(reached, self.threshold, True, 1.0)
        return reached, fired, reached * (1 - fired.detach())

    def _rule(self) -> dict[str, Any]:
        return {"leak": self.leak}


class ReckOn(_Chip):
    """Layers of neurons in the chip ReckOn's arithmetic, to be trained as those of :class:`TinyOdin`.

    The chip fires as they do, unless the spikes of one step take a potential out of its 16 bits: :meth:`save`, then
    ``spikewire network --on reckon``, with ``--reset subtract-late`` if a spike subtracts.

    Weights are whole numbers from -128 to 127, shifted; a tick leaves a share of a potential, rounded down, in units of 1/32768
    from 0.875; a neuron that reaches its threshold fires, and starts the next step at 0. An input fires once a step at most.
    A step takes as many ticks as `keep` needs. Where it takes several, spikes neither subtract nor act on their own layer: the
    chip needs gates for that, which are not trained.

    With `readout` the last layer is the chip's outputs, and the result is what the driver's ``ReckOnSample::run`` returns, bit
    for bit, in units of the weights after the shift. If an output leaves its 16 bits within a step, the chip saturates after each
    spike, and results differ; a smaller `shift` avoids that. Each tick leaves a share of the outputs' potentials, rounded down.

    >>> network = ReckOn(12, 16, 3, recurrent=True, readout=0.9)
    >>> network(torch.ones(5, 4, 12)).shape
    torch.Size([5, 4, 3])
    >>> network.keep, network.readout
    (0.95001220703125, 0.8984375)

    Args:
        inputs: Number of inputs, 256 at most.
        sizes: Number of neurons of each layer: 16 at most of the last. At most three layers fire, with 256 neurons together; a
            layer of odd size takes one more, except the last of them.
        threshold: Potential from which a neuron fires: far below 32767, as potentials beyond that saturate in another order
            than here.
        keep: Share of a potential that a step leaves: 0.1181 to 1, or from 0.875 if `recurrent` or `subtract`.
        shift: Bits by which the chip shifts weights to the left, 0 to 7. The larger it is, the less rounding costs.
        recurrent: Whether the spikes of a layer act on itself a step later.
        subtract: Whether a spike subtracts the threshold in the next step, instead of setting the potential to 0.
        readout: Share of a potential that a step leaves in the last layer, which then never fires; ``None`` for one that fires.
            A tick leaves a multiple of 1/128. If none comes within 2 % of what a step is to lose, the error names the two
            nearest shares of a step.
    """

    _RANGE = (-128, 127)
    _MOST = 32767

    def __init__(
        self,
        inputs: int,
        *sizes: int,
        threshold: int = 1024,
        keep: float = 0.95,
        shift: int = 4,
        recurrent: bool = False,
        subtract: bool = False,
        readout: float | None = None,
    ):
        if not 0.875**16 <= keep <= 1:
            raise Error(f"a step leaves 0.1181 to 1 of a potential, not {keep}")
        self._ticks = max(math.ceil(math.log(keep, 0.875) - 1e-9), 1)
        if self._ticks > 1 and (recurrent or subtract):
            raise Error(f"recurrent layers, and those that subtract, leave 0.875 to 1 of a potential, not {keep}")
        units = keep ** (1 / self._ticks) * 32768
        # Several are rounded down: rounded up, `spikewire network` might choose a tick less.
        self._kept = (round(units) if self._ticks == 1 else math.floor(units + 1e-6)) / 32768
        self._read = None if readout is None else self._read_share(readout)
        if readout is not None and len(sizes) < 2:
            raise Error("a last layer that never fires follows another")
        if not 0 <= shift <= 7:
            raise Error(f"the chip shifts weights by 0 to 7 bits, not {shift}")
        self._unit = 1 << shift
        super().__init__(inputs, sizes, threshold, recurrent)
        # The two neurons of a pair are of the same layer.
        *before, last = sizes if readout is None else sizes[:-1]
        neurons = sum(size + size % 2 for size in before) + last
        for name, given, most in (("inputs", inputs, 256), ("neurons that fire", neurons, 256), ("outputs", sizes[-1], 16)):
            if not 1 <= given <= most:
                raise Error(f"the chip has {most} {name}, not {given}")
        self.subtract = subtract

    @property
    def keep(self) -> float:
        """Share of a potential that a step leaves, as the chip has it."""
        return self._kept**self._ticks

    @property
    def readout(self) -> float | None:
        """Share of the outputs' potentials that a step leaves, as the chip has it; ``None`` if the last layer fires."""
        return None if self._read is None else self._read**self._ticks

    def _read_share(self, asked: float) -> float:
        """The share of the outputs' potentials that a tick leaves."""
        if isinstance(asked, bool) or not 0 < asked <= 1:
            raise Error(f"readout is the share of a potential that a step leaves, above 0 up to 1, not {asked}")
        units = asked ** (1 / self._ticks) * 128
        share = max(round(units), 1) / 128
        if abs(share**self._ticks - asked) > 0.02 * (1 - asked):
            low = min(max(math.floor(units), 1), 127)
            near = " or ".join(f"{(own / 128) ** self._ticks:.4g}" for own in (low, low + 1))
            raise Error(f"with keep={self.keep:.4g} the chip leaves {near} of the outputs' potentials, not {asked}")
        return share

    def _counted(self, x: Tensor) -> Tensor:
        # `clamp` would stop gradients of single spikes: they are at its end.
        return x - (x.detach() - 1).clamp(min=0)

    def _step(self, back: Tensor | None, driven: Tensor, state: Any) -> tuple[Tensor, Tensor, Any]:
        if state is not None:
            potentials, before = state
            if back is not None:
                driven = driven + before @ back
            kept, spiked = _left(potentials, self._kept, self._ticks), before.detach()
            driven = driven + (kept - self.threshold * spiked if self.subtract else kept * (1 - spiked))
        reached = driven.clamp(-32768, 32767)
        fired = _Fire.apply(reached, self.threshold, True)
        return reached, fired, (reached, fired)

    def _steps(self) -> list[Callable[..., tuple[Tensor, Tensor, Any]]]:
        steps = super()._steps()
        return steps if self._read is None else [*steps[:-1], functools.partial(self._read_out, self._read)]

    def _read_out(self, share: float, back: None, driven: Tensor, state: Any) -> tuple[Tensor, Tensor, Any]:
        reached = (driven if state is None else state + driven).clamp(-32768, 32767)
        # The chip answers after the first tick, and the driver multiplies in single precision.
        answer = _left(reached, share, 1)
        values = (answer * float(np.float32(1 / share))).float()
        return reached, values, _left(answer, share, self._ticks - 1)

    def _rule(self) -> dict[str, Any]:
        return {"keep": self.keep}


def _left(potentials: Tensor, share: float, ticks: int) -> Tensor:
    """Potentials after so many ticks on ReckOn: a tick multiplies by `share`, and rounds down."""
    for _ in range(ticks):
        # Products have 31 bits, of which single precision would round some.
        down = (potentials.double() * share).floor().to(potentials.dtype)
        potentials = _passed(down, potentials * share)
    return potentials


class _Fire(torch.autograd.Function):
    """Whether potentials fire, with a surrogate gradient: `slope` / (1 + 3 |v - threshold| / |threshold|)²; `slope` is
    1 / |threshold| unless given."""

    @staticmethod
    def forward(ctx: Any, reached: Tensor, threshold: Tensor | float, at: bool, slope: float | None = None) -> Tensor:
        threshold = torch.as_tensor(threshold, dtype=reached.dtype, device=reached.device)
        ctx.save_for_backward(reached, threshold)
        ctx.slope = slope
        return (reached >= threshold if at else reached > threshold).to(reached.dtype)

    @staticmethod
    def backward(ctx: Any, gradient: Tensor) -> tuple[Tensor, Tensor | None, None, None]:
        reached, threshold = ctx.saved_tensors
        # A threshold of 0 has no size of its own.
        size = threshold.abs().where(threshold != 0, 1)
        slope = 1 / size if ctx.slope is None else ctx.slope
        gradient = gradient * slope / (1 + 3 * ((reached - threshold) / size).abs()) ** 2
        return gradient, -gradient.sum_to_size(threshold.shape) if ctx.needs_input_grad[1] else None, None, None


class _Sum(torch.autograd.Function):
    """``start + x @ weights`` with the bits of the controller, which adds a spike's weights in the order of the inputs."""

    @staticmethod
    def forward(ctx: Any, start: Tensor, x: Tensor, weights: Tensor) -> Tensor:
        ctx.save_for_backward(x, weights)
        ctx.shape, total = start.shape, start.expand(*x.shape[:-1], -1).clone()
        most = x.flatten(0, -2).amax(0).tolist() if x.numel() else []
        for spikes, row, count in zip(x.unbind(-1), weights, most):
            for before in range(int(count)):
                total += (spikes > before).unsqueeze(-1) * row
        return total

    @staticmethod
    def backward(ctx: Any, gradient: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        x, weights = ctx.saved_tensors
        grown = x.flatten(0, -2).T @ gradient.flatten(0, -2)
        return gradient.sum_to_size(ctx.shape), gradient @ weights.T, grown


class Controller(nn.Module):
    """Layers of neurons in the flight controller's arithmetic, to be trained: bit for bit :class:`spikewire.Network`.

    A step multiplies a potential by `keep`, and adds the bias and the weights of the spikes that arrive, in single precision in
    the controller's order, or in integers. Gradients pass through the step with which a neuron fires by a smooth slope, as those of
    :class:`TinyOdin`, and not through the reset. All that is trained is a parameter of `neurons`, a module for each layer:
    ``weights`` and ``recurrent`` [from, to], ``bias``, ``inner``, ``keep``, ``current_keep`` and ``threshold``, where a layer
    has them; ``requires_grad_(False)`` leaves one as it is.

    Inputs are (time, batch, inputs), counts of spikes as those of :class:`Encode` with ``split``. The output is that of the last
    layer: its spikes, or its potentials if it never fires.

    >>> network = Controller(12, 16, 3, recurrent=True, readout=True)
    >>> network(torch.ones(5, 4, 12)).shape
    torch.Size([5, 4, 3])
    >>> network.network()
    Network of 12 inputs and layers of 16, 3 neurons

    Args:
        inputs: Number of inputs.
        sizes: Number of neurons of each layer.
        keep: Share of its potential that a neuron keeps in a step.
        threshold: Potential above which a neuron fires.
        reset: What a spike does to its neuron's potential.
        at: Whether neurons fire at their threshold, too.
        current_keep: Share that a step leaves of the current through which spikes act on the potential; ``None`` for neurons
            without a current.
        recurrent: Whether the spikes of a layer act on itself a step later.
        readout: Whether the last layer never fires.
        numbers: ``"i8"`` trains in weights of 8 bits and potentials of 32, for cores without a floating-point unit:
            ``network().to_rust(…, numbers="i8")`` writes just these.
    """

    def __init__(
        self,
        inputs: int,
        *sizes: int,
        keep: float = 0.9,
        threshold: float = 1.0,
        reset: Reset = "to-value",
        at: bool = False,
        current_keep: float | None = None,
        recurrent: bool = False,
        readout: bool = False,
        numbers: Literal["f32", "i8"] = "f32",
    ):
        super().__init__()
        if reset not in get_args(Reset):
            raise Error(f"reset is one of {', '.join(get_args(Reset))}, not {reset!r}")
        for name, share in (("keep", keep), ("current_keep", current_keep)):
            if share is not None and not 0 <= share <= 1:
                raise Error(f"{name} is a share from 0 to 1, not {share}")
        layers = []
        for number, (before, count) in enumerate(zip((inputs, *sizes), sizes), 1):
            fires = not (readout and number == len(sizes))
            layer: dict[str, Any] = {"name": f"layer {number}", "keep": [keep] * count, "bias": [0.0] * count}
            layer["weights"] = threshold * torch.randn(count, before) / before**0.5
            if fires:
                layer.update(reset=reset, fires="at" if at else "above", threshold=[threshold] * count)
                if recurrent:
                    layer["recurrent"] = threshold * torch.randn(count, count) / count**0.5
            if current_keep is not None:
                layer.update(current="new", current_keep=[current_keep] * count)
            layers.append(layer)
        self.neurons: nn.ModuleList = nn.ModuleList(_Layer(own, numbers) for own in layers)

    @classmethod
    def from_network(cls, network: Network, numbers: Literal["f32", "i8"] = "f32") -> Controller:
        """The layers of a network, which may have been trained elsewhere.

        >>> import spikewire as sw
        >>> network = sw.Network.from_toml('[[layers]]\\nname = "one"\\nkeep = [0.5]\\nweights = [[0.6, 0.3]]\\n')
        >>> Controller.from_network(network)(torch.tensor([[[1.0, 0.0]], [[1.0, 1.0]]])).flatten().tolist()
        [0.6000000238418579, 1.2000000476837158]
        """
        own = cls(1)
        own.neurons = nn.ModuleList(_Layer(layer, numbers) for layer in json.loads(network._native.json())["layers"])
        return own

    def network(self) -> Network:
        """The network as it is now, for the controller: its ``to_rust``, ``to_toml`` and ``to_nir`` write it.

        Raises `spikewire.Error` if a parameter is not finite.

        >>> Controller(12, 3).network().layers
        [3]
        """
        for name, own in self.named_parameters():
            if not own.isfinite().all():
                raise Error(f"{name} is not finite: training has diverged")
        return Network(_native.Network.from_json(json.dumps({"layers": [own.written() for own in self.neurons]})))

    def layers(self, x: Tensor) -> list[tuple[Tensor, Tensor]]:
        """The potentials of each layer behind each step, and its spikes: (time, batch, neurons); of `i8` in the layer's integers.

        >>> potentials, spikes = Controller(12, 16, 3).layers(torch.ones(5, 4, 12))[0]
        >>> potentials.shape, spikes.shape
        (torch.Size([5, 4, 16]), torch.Size([5, 4, 16]))
        """
        return _run(x, [own.law() for own in self.neurons])

    def forward(self, x: Tensor) -> Tensor:
        """The spikes of the last layer, or its potentials if it never fires.

        >>> Controller(12, 3, readout=True).forward(torch.ones(5, 4, 12)).shape
        torch.Size([5, 4, 3])
        """
        potentials, fired = self.layers(x)[-1]
        last = self.neurons[-1]
        if "reset" in last.rule:
            return fired.float()
        scale, finer = last.unit()
        return (potentials / (scale * finer)).float()


class _Layer(nn.Module):
    """A layer of the controller, out of what its file holds."""

    def __init__(self, layer: dict[str, Any], numbers: str):
        super().__init__()
        self.numbers = numbers
        self.rule = {name: layer[name] for name in ("name", "reset", "fires", "current") if name in layer}
        for name in ("weights", "recurrent", "bias", "inner", "keep", "current_keep", "threshold", "reset_value"):
            if name in layer:
                own = torch.as_tensor(layer[name], dtype=torch.float32)
                setattr(self, name, nn.Parameter(own.t().contiguous(), name != "reset_value"))
        if not hasattr(self, "bias"):
            self.bias = nn.Parameter(torch.zeros(self.weights.shape[1]))

    def unit(self) -> tuple[Tensor, int]:
        """The scales that `spikewire network` chooses: the integer of a weight of 1, for each neuron, and the factor by which
        potentials are finer than weights."""
        if self.numbers == "f32":
            return torch.ones_like(self.keep), 1
        own = {name: own.detach().double().abs() for name, own in self.named_parameters()}
        weights = torch.cat([own[name] for name in ("weights", "recurrent") if name in own]).amax(0)
        most = torch.stack([own[name] for name in ("bias", "inner", "threshold", "reset_value") if name in own]).amax(0)
        largest = weights.where(weights > 0, most)
        scale = 127 / largest.where(largest > 0, 127)
        shift = next((shift for shift in range(8, 0, -1) if (most * scale).max() * 2**shift <= 2**27), 0)
        return torch.minimum(scale, 2.0 ** (27 - shift) / most.clamp(min=1e-300)), 2**shift

    def held(self) -> dict[str, Tensor]:
        """The numbers in which the controller calculates; gradients pass on to those that are trained."""
        held: dict[str, Tensor] = dict(self.named_parameters())
        scale, finer = self.unit()
        for name, own in held.items():
            is_share, is_weight = name.endswith("keep"), name in ("weights", "recurrent")
            if is_share:
                own = _passed(own.clamp(0, 1), own)
            if self.numbers == "i8":
                own = own.double() * (65536 if is_share else scale * (1 if is_weight else finer))
                own = _passed(own.round().clamp(-127, 127) if is_weight else own.round(), own) * (finer if is_weight else 1)
            held[name] = own
        return held

    def written(self) -> dict[str, Any]:
        """The layer in the form of a network's file."""
        scale, finer = self.unit()
        numbers = {name: own.detach().double() for name, own in self.held().items()}
        for name, own in numbers.items():
            if self.numbers == "i8":
                numbers[name] = own / (65536 if name.endswith("keep") else scale * finer)
        return {**self.rule, **{name: own.t().tolist() for name, own in numbers.items()}}

    def law(self) -> _Law:
        held, reset, at = self.held(), self.rule.get("reset"), self.rule.get("fires") == "at"
        bias, weights, threshold = held["bias"], held["weights"], held.get("threshold")
        value = held.get("reset_value", threshold.detach() if reset and reset.startswith("subtract") else 0.0)
        is_whole = self.numbers == "i8"

        def summed(start: Tensor, x: Tensor, weights: Tensor) -> Tensor:
            # Sums of integers do not depend on their order.
            return start + x @ weights if is_whole else _Sum.apply(start, x, weights)

        def share(v: Tensor, keep: Tensor) -> Tensor:
            return _passed((v * keep / 65536).floor(), v * keep / 65536) if is_whole else v * keep

        def bounded(v: Tensor) -> Tensor:
            return v.clamp(-(2**29), 2**29 - 1) if is_whole else v

        def step(driven: Tensor, state: Any) -> tuple[Tensor, Tensor, Any]:
            rest = torch.zeros_like(driven)
            v, current, before = state or (rest, rest, rest)
            if "recurrent" in held:
                driven = summed(driven, before, held["recurrent"])
            if "current_keep" in held:
                taken, current = current, share(current, held["current_keep"]) + driven
                driven = taken if self.rule["current"] == "old" else current
                current = bounded(current)
                if "inner" in held:
                    driven = driven + held["inner"]

            def integrated(v: Tensor) -> Tensor:
                return share(v, held["keep"]) + driven

            if threshold is None:
                v = bounded(integrated(v))
                return v, torch.zeros_like(v), (v, current, before)
            over = (v >= threshold if at else v > threshold).detach()
            if reset == "to-value-late":
                reached = integrated(torch.where(over, value, v))
            elif reset == "to-value-held":
                reached = torch.where(over, value, integrated(v))
            else:
                reached = integrated(v)
            less = reached - value
            compared = torch.where(over, less, reached) if reset in ("subtract-late", "subtract-no-delay") else reached
            fired = _Fire.apply(compared, threshold, at)
            has_fired = fired.detach() > 0
            if reset == "to-value":
                v = torch.where(has_fired, value, reached)
            elif reset in ("subtract", "subtract-no-delay"):
                v = torch.where(has_fired, less, reached)
            else:
                v = compared
            v = bounded(v)
            return v, fired, (v, current, fired)

        return lambda x: summed(bias, x.to(bias.dtype), weights), step


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
        self.samples: Tensor = torch.as_tensor(samples)
        self.labels: Tensor = torch.as_tensor(labels)
        if len(self.samples) != len(self.labels):
            raise Error(f"{len(self.samples)} samples have {len(self.labels)} labels")
        self.length: int = length
        self.stride: int = stride

    def __len__(self) -> int:
        return max((len(self.samples) - self.length) // self.stride + 1, 0)

    def __getitem__(self, place: int) -> tuple[Tensor, Tensor]:
        if not 0 <= place < len(self):
            raise OutOfRange(f"window {place} of {len(self)}")
        start = place * self.stride
        return self.samples[start : start + self.length], self.labels[start + self.length - 1]
