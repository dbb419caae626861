"""Networks out of PyTorch modules: numbers are read from the layers, rules are found by running the module."""

from __future__ import annotations

import inspect
import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from . import _native
from ._errors import Error
from ._network import numbers_of

Array = NDArray[np.float64]

#: Largest difference between potentials that counts as equal, relative to the largest: frameworks add in another order.
EQUAL = 1e-4

#: Resets of a neuron by their names in a network's file, the frequent ones first.
RESETS = ("subtract", "to-value", "subtract-late", "to-value-late", "subtract-no-delay", "to-value-held", "none")


@dataclass
class Neurons:
    """Neurons of a layer, in the numbers of one step."""

    #: Factor by which a step multiplies the potential.
    keep: Array
    #: Threshold; ``None`` for neurons that never fire.
    threshold: Array | None = None
    #: The reset that the layer's own parameters say.
    reset: str = "to-value"
    #: When the neurons fire: ``above`` or ``at`` their threshold.
    fires: str = "above"
    #: Potential after a spike, if it is set to a value.
    reset_value: Array | None = None
    #: Factor by which a step multiplies the current; ``None`` for neurons without one.
    current_keep: Array | None = None
    #: Factor of all weights that lead to the neurons.
    gain: Array | float = 1.0
    #: Weights from spikes of the layer's own neurons, and what they add in every step.
    recurrent: Array | None = None
    recurrent_bias: Array | float = 0.0
    #: Weights of the inputs, if the neurons hold them themselves.
    weights: Array | None = None
    #: The potential from which the module starts, relative to which potentials are kept.
    start: Array | float = 0.0


def numbers(value: Any, count: int) -> Array:
    """One number for each neuron, of a scalar or of as many numbers."""
    array = np.asarray(value.detach() if isinstance(value, Tensor) else value, np.float64).ravel()
    if array.size not in (1, count):
        raise Error(f"{array.size} numbers for {count} neurons")
    return np.array(np.broadcast_to(array, count))


def matrix(value: Tensor) -> Array:
    return np.asarray(value.detach(), np.float64)


def snntorch(layer: Any, count: int) -> Neurons:
    """Leaky, Synaptic, RLeaky and RSynaptic of snnTorch."""
    for name, usual in (("inhibition", False), ("state_quant", False)):
        if getattr(layer, name, usual) not in (usual, None):
            raise Error(f"snnTorch's {name} has no counterpart on the controller")
    if float(torch.as_tensor(getattr(layer, "graded_spikes_factor", 1.0)).max()) != 1.0:
        raise Error("graded spikes have no counterpart on the controller: set graded_spikes_factor to 1")
    late = getattr(layer, "reset_delay", True)
    resets = {
        "subtract": "subtract-late" if late else "subtract-no-delay",
        "zero": "to-value-late" if late else "to-value",
        "none": "none",
    }
    neurons = Neurons(
        keep=numbers(layer.beta, count).clip(0, 1),
        threshold=numbers(layer.threshold, count),
        reset=resets[layer.reset_mechanism],
    )
    if hasattr(layer, "alpha"):
        neurons.current_keep = numbers(layer.alpha, count).clip(0, 1)
    back = getattr(layer, "recurrent", None)
    if isinstance(back, nn.Linear):
        neurons.recurrent = matrix(back.weight)
        if back.bias is not None:
            neurons.recurrent_bias = matrix(back.bias)
    elif back is not None and hasattr(back, "V"):
        neurons.recurrent = np.diag(numbers(back.V, count))
    elif back is not None:
        raise Error(f"recurrent connections of {type(back).__name__} are not read")
    return neurons


def norse(layer: Any, count: int) -> Neurons:
    """LIFBoxCell, LIFCell, LIF, LIFRecurrentCell, LIFRecurrent, LIBoxCell, LICell and LI of Norse."""
    parameters, dt = layer.p, layer.dt
    share = numbers(parameters.tau_mem_inv, count) * dt
    rest = numbers(parameters.v_leak, count)
    neurons = Neurons(keep=1 - share, gain=share, start=rest)
    # Potentials are kept relative to that at rest, from which Norse starts.
    if hasattr(parameters, "v_th"):
        neurons.threshold = numbers(parameters.v_th, count) - rest
        neurons.reset_value = numbers(parameters.v_reset, count) - rest
        reset_method = getattr(parameters, "reset_method", None)
        if getattr(reset_method, "__name__", "") == "reset_subtract":
            neurons.reset, neurons.reset_value = "subtract", numbers(parameters.v_th, count)
    if hasattr(parameters, "tau_syn_inv"):
        neurons.current_keep = 1 - numbers(parameters.tau_syn_inv, count) * dt
    if hasattr(layer, "recurrent_weights"):
        neurons.recurrent = matrix(layer.recurrent_weights)
        neurons.weights = matrix(layer.input_weights)
    return neurons


def spikingjelly(layer: Any, count: int) -> Neurons:
    """IFNode, LIFNode and ParametricLIFNode of SpikingJelly."""
    start = 0.0 if layer.v_reset is None else float(layer.v_reset)
    neurons = Neurons(
        keep=np.ones(count),
        threshold=numbers(layer.v_threshold - start, count),
        reset="subtract" if layer.v_reset is None else "to-value",
        fires="at",
    )
    if layer.v_reset is None:
        neurons.reset_value = numbers(layer.v_threshold, count)
    if hasattr(layer, "w"):
        share = float(layer.w.detach().sigmoid())
    elif hasattr(layer, "tau"):
        share = 1 / float(layer.tau)
    else:
        return neurons
    neurons.keep = np.full(count, 1 - share)
    if layer.decay_input:
        neurons.gain = share
    return neurons


#: The layers of neurons that are read: their package and class.
READERS: dict[tuple[str, str], Callable[[Any, int], Neurons]] = {
    **{("snntorch", name): snntorch for name in ("Leaky", "Synaptic", "RLeaky", "RSynaptic")},
    **{
        ("norse", name): norse
        for name in ("LIFBoxCell", "LIFCell", "LIF", "LIFRecurrentCell", "LIFRecurrent", "LIBoxCell", "LICell", "LI")
    },
    **{("spikingjelly", name): spikingjelly for name in ("IFNode", "LIFNode", "ParametricLIFNode")},
}
#: Layers that let their inputs through while a network is not being trained.
PASSING = (nn.modules.dropout._DropoutNd, nn.Identity, nn.Flatten)


def reader(layer: nn.Module) -> Callable[[Any, int], Neurons] | None:
    for kind in type(layer).__mro__:
        found = READERS.get((kind.__module__.partition(".")[0], kind.__name__))
        if found is not None:
            return found
    return None


@dataclass
class Layer:
    """A layer of the module, and what went in and came out in each call."""

    name: str
    module: nn.Module
    inputs: list[Tensor] = field(default_factory=list)
    outputs: list[Tensor] = field(default_factory=list)


@contextmanager
def watched(module: nn.Module) -> Iterator[list[Layer]]:
    """The layers in the order of their first call, with what goes in and comes out while the context lasts."""
    called: dict[int, Layer] = {}

    def watch(name: str) -> Callable[..., None]:
        def hook(layer: nn.Module, inputs: tuple[Any, ...], output: Any) -> None:
            seen = called.setdefault(id(layer), Layer(name, layer))
            seen.inputs.append(inputs[0].detach().clone())
            seen.outputs.append((output[0] if isinstance(output, tuple) else output).detach().clone())

        return hook

    def leaves(name: str, module: nn.Module) -> Iterator[tuple[str, nn.Module]]:
        children = list(module.named_children())
        if reader(module) or not children:
            yield name or type(module).__name__, module
            return
        for child, inner in children:
            yield from leaves(f"{name}.{child}" if name else child, inner)

    hooks = [leaf.register_forward_hook(watch(name)) for name, leaf in leaves("", module)]
    order: list[Layer] = []
    try:
        yield order
    finally:
        order.extend(called.values())
        for hook in hooks:
            hook.remove()


def at_rest(module: nn.Module) -> None:
    """Puts layers that keep their state themselves at rest."""
    for layer in module.modules():
        for name in ("reset_mem", "reset"):
            reset = getattr(layer, name, None)
            if reader(layer) and callable(reset):
                reset()
                break


def run(module: nn.Module, sample: Tensor) -> list[Layer]:
    """Runs the module over `sample` (steps, inputs), and returns its layers with an entry for each step.

    A module takes all steps at once, (steps, 1, inputs), or one step after the other, (1, inputs).
    """
    steps = len(sample)
    at_rest(module)
    failed: Exception | None = None
    try:
        with watched(module) as layers:
            module(sample[:, None])
        if layers and all(len(layer.outputs) == steps for layer in layers):
            return layers
        several = [layer for layer in layers if takes_all_steps(layer.module)]
        if several:
            for layer in layers:
                layer.inputs, layer.outputs = list(layer.inputs[0]), list(layer.outputs[0])
            if all(len(layer.outputs) == steps for layer in layers):
                return layers
    except Exception as error:  # a module for single steps may fail in any way
        failed = error
    at_rest(module)
    takes_state = "state" in inspect.signature(module.forward).parameters
    state = None
    try:
        with watched(module) as layers:
            for step in sample:
                if takes_state:
                    _, state = module(step[None], state)
                else:
                    module(step[None])
    except Exception as error:
        raise Error(
            f"the module takes neither all steps (steps, 1, inputs) ({failed}) nor single ones (1, inputs) ({error})"
        ) from error
    for layer in layers:
        if len(layer.outputs) != steps:
            raise Error(f"{layer.name}: called {len(layer.outputs)} times in {steps} steps")
    return layers


def takes_all_steps(layer: nn.Module) -> bool:
    """Whether a layer of neurons takes all steps in one call."""
    names = [kind.__name__ for kind in type(layer).__mro__]
    return getattr(layer, "step_mode", "") == "m" or "SNN" in names or "SNNRecurrent" in names


def rows(tensors: list[Tensor]) -> NDArray[np.float64]:
    return np.array([np.asarray(one).ravel() for one in tensors], np.float64)


def written(name: str, weights: Array, bias: Array, neurons: Neurons, reset: str) -> dict[str, Any]:
    """A layer as a network's file has it."""
    gain = np.broadcast_to(neurons.gain, len(weights))
    layer: dict[str, Any] = {
        "name": name,
        "keep": neurons.keep.tolist(),
        "bias": (gain * (bias + neurons.recurrent_bias)).tolist(),
        "weights": (gain[:, None] * weights).tolist(),
    }
    if neurons.current_keep is not None:
        layer |= {"current": "new", "current_keep": neurons.current_keep.tolist()}
    if neurons.threshold is not None:
        layer |= {"reset": reset, "fires": neurons.fires, "threshold": neurons.threshold.tolist()}
        # The value that a reset needs is the one that the layer has for its own kind of reset.
        if neurons.reset_value is not None and reset == neurons.reset:
            layer["reset_value"] = neurons.reset_value.tolist()
        if neurons.recurrent is not None:
            layer["recurrent"] = (gain[:, None] * neurons.recurrent).tolist()
    return layer


def fitting(
    name: str, weights: Array, bias: Array, neurons: Neurons, counts: NDArray[np.float64], wanted: NDArray[np.float64]
) -> dict[str, Any]:
    """The layer by the rule that gives the outputs `wanted`."""
    inputs, fitting, furthest = numbers_of(counts), [], (0, neurons.reset)
    if neurons.threshold is None:
        layer = written(name, weights, bias, neurons, "none")
        _, potentials = _native.Network.from_json(json.dumps({"layers": [layer]})).steps(inputs)
        off = abs(potentials + neurons.start - wanted).max()
        if not off <= EQUAL * abs(wanted).max():
            raise Error(f"{name}: its potentials are {off:g} off the module's")
        return layer
    if not np.isin(wanted, (0, 1)).all():
        raise Error(f"{name}: its outputs are no spikes: it gives {wanted[~np.isin(wanted, (0, 1))][0]:g}")
    if not wanted.any():
        raise Error(f"{name}: it never fires in the sample, which therefore does not show its rule")
    for reset in (neurons.reset, *(one for one in RESETS if one != neurons.reset)):
        layer = written(name, weights, bias, neurons, reset)
        spikes, _ = _native.Network.from_json(json.dumps({"layers": [layer]})).steps(inputs)
        differing = np.flatnonzero((spikes != wanted).any(1))
        if differing.size == 0:
            if reset == neurons.reset:
                return layer
            fitting.append((reset, layer))
        else:
            furthest = max(furthest, (int(differing[0]), reset))
    if len(fitting) == 1:
        return fitting[0][1]
    if fitting:
        resets = " and ".join(reset for reset, _ in fitting)
        raise Error(f"{name}: {resets} give its spikes: a sample with more spikes would tell them apart")
    step, reset = furthest
    raise Error(f"{name}: no rule gives its spikes; {reset}, the nearest, gives others in step {step} of {len(inputs)}")


def linear(layer: nn.Module, weights: Array | None, bias: Array, width: int) -> tuple[Array, Array]:
    """The weights and biases behind a layer without neurons; `weights` is ``None`` in front of the first."""
    before = np.eye(width) if weights is None else weights
    if isinstance(layer, nn.Linear):
        own = matrix(layer.weight)
        more = 0.0 if layer.bias is None else matrix(layer.bias)
        # The weights of the first layer are taken as they are: a product would round them.
        return own if weights is None else own @ before, own @ bias + more
    if isinstance(layer, nn.BatchNorm1d):
        if layer.running_mean is None or layer.running_var is None:
            raise Error("a BatchNorm1d without running statistics depends on its batch")
        scale = 1 / np.sqrt(matrix(layer.running_var) + layer.eps)
        shift = -matrix(layer.running_mean) * scale
        if layer.affine:
            scale, shift = scale * matrix(layer.weight), shift * matrix(layer.weight) + matrix(layer.bias)
        return scale[:, None] * before, scale * bias + shift
    readable = ", ".join(sorted({name for _, name in READERS}))
    raise Error(
        f"{type(layer).__name__} is not read: Linear, BatchNorm1d, Dropout and Flatten are, and the neurons {readable}"
    )


def layers_of(module: nn.Module, sample: NDArray[np.float64]) -> list[dict[str, Any]]:
    """The layers of a network's file: numbers out of the module, rules by what it does with `sample` (steps, inputs)."""
    if len(sample) < 2:
        raise Error(f"a sample has steps down its rows, 2 or more, not {len(sample)}")
    was_training = module.training
    parameter = next(module.parameters(), None)
    dtype = torch.float32 if parameter is None else parameter.dtype
    module.eval()
    try:
        with torch.no_grad():
            called = run(module, torch.as_tensor(sample, dtype=dtype))
    finally:
        module.train(was_training)
    layers: list[dict[str, Any]] = []
    counts, before = sample, sample
    weights: Array | None = None
    bias = np.zeros(sample.shape[1])
    for layer in called:
        inputs, outputs = rows(layer.inputs), rows(layer.outputs)
        if inputs.shape != before.shape or not np.allclose(inputs, before, rtol=1e-5, atol=1e-6):
            raise Error(
                f"{layer.name}: it takes something else than the layer before gives: only chains are read, without "
                "skips, branches or functions in between"
            )
        before = outputs
        try:
            read = reader(layer.module)
            if read is None:
                # SpikingJelly's dropout, which draws once for all steps, is no subclass of torch's.
                if not isinstance(layer.module, PASSING) and type(layer.module).__name__ != "Dropout":
                    weights, bias = linear(layer.module, weights, bias, inputs.shape[1])
                continue
            neurons = read(layer.module, outputs.shape[1])
            if neurons.weights is not None:
                weights, bias = neurons.weights, np.zeros(outputs.shape[1])
        except Error as error:
            raise Error(f"{layer.name}: {error}") from None
        if weights is None:
            weights = np.eye(inputs.shape[1])
        layers.append(fitting(layer.name, weights, bias, neurons, counts, outputs))
        counts, weights, bias = outputs, None, np.zeros(outputs.shape[1])
    if weights is not None:
        # Outputs are weighted sums of the last neurons' spikes.
        layers.append(fitting("sums", weights, bias, Neurons(keep=np.zeros(len(weights))), counts, before))
    if not layers:
        raise Error("the module has no layers of neurons")
    return layers
