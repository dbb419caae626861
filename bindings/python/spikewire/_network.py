"""Trained networks, bit for bit as a flight controller runs them."""

from __future__ import annotations

import json
import operator
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import Number, read
from ._errors import Error, checked
from ._spikes import Spikes

Framework = Literal["snntorch", "norse", "spikingjelly", "rockpool", "sinabs", "nir"]
Reset = Literal[
    "to-value", "to-value-late", "to-value-held", "subtract", "subtract-late", "subtract-no-delay", "none"
]


class Ran(NamedTuple):
    """The spikes and potentials of a network's last layer, by step.

    >>> import spikewire as sw
    >>> one = '{name = "a", reset = "to-value", fires = "at", keep = [0.5], threshold = [1.0], weights = [[0.75, 0.25]]}'
    >>> network = sw.Network.from_toml(f"layers = [{one}]")
    >>> ran = network.run([[0], [0, 1]])
    >>> ran.spikes.tolist(), ran.potentials.tolist()
    ([[False], [True]], [[0.75], [0.0]])
    """

    #: Whether each neuron fired: (steps, neurons).
    spikes: NDArray[np.bool_]
    #: Their potentials behind the step: (steps, neurons).
    potentials: NDArray[np.float32]


class Network:
    """A trained network in single precision: the bits of ``spikewire network --on controller`` and of `spikewire-network`
    on every core. :meth:`from_nir` reads one; `spikewire.torch.Controller` trains one.

    >>> import spikewire as sw
    >>> one = '{name = "a", reset = "to-value", fires = "at", keep = [0.5], threshold = [1.0], weights = [[0.75, 0.25]]}'
    >>> network = sw.Network.from_toml(f"layers = [{one}]")
    >>> network
    Network of 2 inputs and layers of 1 neurons
    """

    def __init__(self, native: _native.Network):
        self._native = native

    @classmethod
    @checked
    def from_nir(
        cls,
        path: str | Path,
        framework: Framework | None = None,
        *,
        reset: Reset | Sequence[Reset] | None = None,
        fires: Literal["above", "at"] | None = None,
        decay: Literal["euler", "exponential"] | None = None,
        current: Literal["new", "old", "whole"] | None = None,
        dt: Number | None = None,
        sample: ArrayLike | None = None,
        spikes: ArrayLike | None = None,
    ) -> Network:
        """Reads a NIR graph, or a network in JSON or TOML.

        A graph does not hold by which rule its neurons step. `framework` says some of it: what it leaves open are keywords,
        which an error lists. `reset` is one for all layers, or one for each that fires; `dt` are the seconds of a step.
        `spikes` (steps, outputs) are those that the framework gave for `sample` (steps, inputs): the rule that gives the
        same is found, and nothing else need be said.

        Raises `spikewire.Error` if the file is no network, or the rule is not said as a whole; if no rule gives `spikes`, or
        several do.

        >>> import pathlib, tempfile, spikewire as sw
        >>> path = pathlib.Path(tempfile.mkdtemp()) / "one.json"
        >>> _ = path.write_text('{"layers": [{"weights": [[0.6, 0.3]], "keep": 0.5, "threshold": 1.0}]}')
        >>> sw.Network.from_nir(path)
        Network of 2 inputs and layers of 1 neurons
        """
        resets = [] if reset is None else [reset] if isinstance(reset, str) else list(reset)
        recorded = None
        if sample is not None or spikes is not None:
            if sample is None or spikes is None:
                raise Error("sample and spikes go together: what went into the network, and what it fired")
            recorded = numbers_of(_counts(sample)), numbers_of(_counts(spikes))
        return cls(_native.Network(Path(path), (framework, fires, decay, current), resets, dt, recorded))

    @classmethod
    @checked
    def from_torch(cls, module: Any, sample: ArrayLike) -> Network:
        """Reads a network of snnTorch, Norse or SpikingJelly as its module stands, without a file.

        The numbers come from the module's layers: chains of `Linear`, `BatchNorm1d`, `Dropout` and neurons. The rule by which
        neurons decay, fire and reset is found by running the module on `sample` (steps, inputs), counts of spikes: each
        layer takes the rule that gives all its spikes. The module takes all steps at once, (steps, 1, inputs), or one after
        the other, (1, inputs). Needs the package ``torch``.

        Raises `spikewire.Error` if a layer is none of these or never fires, if no rule gives its spikes, or if several do.

        Example::

            module = torch.nn.Sequential(torch.nn.Linear(2, 3), snntorch.Leaky(beta=0.9, init_hidden=True))
            network = sw.Network.from_torch(module, sample)
            Path("src/network.rs").write_text(network.to_rust(sample))
        """
        from . import _from_torch

        layers = _from_torch.layers_of(module, _counts(sample).astype(np.float64))
        return cls(_native.Network.from_json(json.dumps({"layers": layers})))

    @classmethod
    @checked
    def from_toml(cls, text: str) -> Network:
        """Reads what :meth:`to_toml` wrote.

        >>> import spikewire as sw
        >>> one = '{name = "a", reset = "to-value", fires = "at", keep = [0.5], threshold = [1.0], weights = [[0.75, 0.25]]}'
        >>> network = sw.Network.from_toml(f"layers = [{one}]")
        >>> sw.Network.from_toml(network.to_toml()).layers
        [1]
        """
        return cls(_native.Network.from_toml(text))

    def to_toml(self) -> str:
        """The network with the whole rule of its neurons; :meth:`from_nir` and ``spikewire network`` read it from a file
        whose name ends in ``.toml``.

        >>> import spikewire as sw
        >>> one = '{name = "a", reset = "to-value", fires = "at", keep = [0.5], threshold = [1.0], weights = [[0.75, 0.25]]}'
        >>> network = sw.Network.from_toml(f"layers = [{one}]")
        >>> print(network.to_toml().splitlines()[0])
        [[layers]]
        """
        text: str = self._native.toml()
        return text

    @checked
    def to_rust(
        self,
        spikes: ArrayLike | Sequence[Sequence[int]],
        *,
        numbers: Literal["f32", "i8"] = "f32",
        source: str = "a network",
    ) -> str:
        """The Rust module for the flight controller, as ``spikewire network --on controller`` writes it.

        `spikes` is a recording as :meth:`run` takes it. The module's self-test runs its liveliest ten steps, and for `numbers` of
        8 bits the scales are searched on it. `source` is what the module's first line names.

        >>> import spikewire as sw
        >>> one = '{name = "a", reset = "to-value", fires = "at", keep = [0.5], threshold = [1.0], weights = [[0.75, 0.25]]}'
        >>> network = sw.Network.from_toml(f"layers = [{one}]")
        >>> rust = network.to_rust([[0], [0, 1], [1]], source="one.toml")
        >>> "pub fn is_intact() -> bool" in rust
        True
        """
        text: str = self._native.rust(self._steps(spikes), numbers, source)
        return text

    @checked
    def to_nir(self, path: str | Path) -> dict[str, Any]:
        """Writes a NIR graph, with times in steps. Returns the keywords with which :meth:`from_nir` gives the same network
        again. Needs the package ``nir``.

        Raises `spikewire.Error` if neurons with a constant input beside their current do not leak, if a spike subtracts another
        amount than the threshold, or if layers differ in when they fire or which current they take: no graph has these.

        >>> import pathlib, tempfile, spikewire as sw
        >>> one = '{name = "a", reset = "to-value", fires = "at", keep = [0.5], threshold = [1.0], weights = [[0.75, 0.25]]}'
        >>> network = sw.Network.from_toml(f"layers = [{one}]")
        >>> keywords = network.to_nir(pathlib.Path(tempfile.mkdtemp()) / "one.nir")
        >>> keywords["reset"]
        ['to-value']
        """
        import nir

        layers = json.loads(self._native.json())["layers"]
        each = {name: {own[name] for own in layers if name in own} for name in ("fires", "current")}
        if any(len(own) > 1 for own in each.values()):
            raise Error(f"layers have rules of their own, of which a graph's reader takes one: {each}")
        nodes, edges, last = {"input": nir.Input({"input": np.array([self.inputs])})}, [], "input"
        for number, layer in enumerate(layers, 1):
            zeros = np.zeros(len(layer["weights"]))
            own = {name: np.array(layer.get(name, zeros)) for name in ("keep", "current_keep", "bias", "inner")}
            weights, neurons = f"weights_{number}", f"neurons_{number}"
            nodes[weights] = nir.Affine(np.array(layer["weights"]), own["bias"])
            # A step takes 1 / tau of the potential; where it takes nothing, time constants are so long that it is 0.
            tau, tau_syn = (1 / np.maximum(1 - own[name], 2.0**-60) for name in ("keep", "current_keep"))
            if (own["inner"] != 0)[own["keep"] == 1].any():
                raise Error(f"{layer['name']}: a constant input beside the current needs a leak in a graph")
            leak = {"r": tau, "v_leak": own["inner"] * np.where(own["keep"] < 1, tau, 0)}
            fires = {}
            if "threshold" in layer:
                subtracts = layer["reset"].startswith("subtract")
                # A file leaves out what a spike subtracts if it is the threshold.
                if subtracts and layer.get("reset_value", layer["threshold"]) != layer["threshold"]:
                    raise Error(f"{layer['name']}: a spike subtracts the threshold in a graph, and no other amount")
                reset = zeros if subtracts else np.array(layer.get("reset_value", zeros))
                fires = {"v_threshold": np.array(layer["threshold"]), "v_reset": reset}
            if "current" in layer:
                kind = nir.CubaLIF if fires else nir.CubaLI
                nodes[neurons] = kind(tau_syn=tau_syn, tau_mem=tau, w_in=tau_syn, **leak, **fires)
            else:
                nodes[neurons] = (nir.LIF if fires else nir.LI)(tau=tau, **leak, **fires)
            edges += [(last, weights), (weights, neurons)]
            if "recurrent" in layer:
                nodes[f"recurrent_{number}"] = nir.Linear(np.array(layer["recurrent"]))
                edges += [(neurons, f"recurrent_{number}"), (f"recurrent_{number}", neurons)]
            last = neurons
        nodes["output"] = nir.Output({"output": np.array([self.layers[-1]])})
        nir.write(path, nir.NIRGraph(nodes, [*edges, (last, "output")]))
        resets = [layer["reset"] for layer in layers if "reset" in layer]
        return {"reset": resets, "decay": "euler", "dt": 1.0, **{name: own.pop() for name, own in each.items() if own}}

    @property
    def inputs(self) -> int:
        """Number of inputs."""
        return self._native.inputs()

    @property
    def layers(self) -> list[int]:
        """The number of neurons of each layer."""
        return self._native.layers()

    @checked
    def run(self, spikes: ArrayLike | Sequence[Sequence[int]], *, numbers: Literal["f32", "i8"] = "f32") -> Ran:
        """Runs the network from rest, in `numbers` as :meth:`to_rust` writes them out of the same spikes.

        `spikes` is an array (steps, inputs) of how often each input fires, whose spikes come by rising input: of any library,
        or a table with steps down its rows. Or it is a list with a list for each step: the numbers of the inputs that fire,
        in order.

        >>> import numpy as np, spikewire as sw
        >>> one = '{name = "a", reset = "to-value", fires = "at", keep = [0.5], threshold = [1.0], weights = [[0.75, 0.25]]}'
        >>> network = sw.Network.from_toml(f"layers = [{one}]")
        >>> counts = network.run(np.array([[1, 0], [1, 1]]))
        >>> numbers = network.run([[0], [0, 1]])
        >>> counts.spikes.tolist(), bool((counts.potentials == numbers.potentials).all())
        ([[False], [True]], True)
        """
        steps = self._steps(spikes)
        self.reset()
        if numbers == "f32":
            return Ran(*self._native.steps(steps))
        fired, potentials = self._native.ran(steps, numbers)
        spiked = np.zeros(potentials.shape, np.bool_)
        for row, neurons in zip(spiked, fired):
            row[neurons] = True
        return Ran(spiked, potentials.astype(np.float32))

    def _steps(self, spikes: Any) -> list[list[int]]:
        if not _is_array(spikes):
            return [self._step(step) for step in spikes]
        if isinstance(spikes, Spikes):
            counts, time = spikes.array, spikes._axis
        else:
            counts, time, _ = read(spikes)
        if counts.ndim != 2:
            raise Error(f"spikes are an array (steps, inputs) of counts, not {counts.shape}")
        return self._numbers(np.moveaxis(counts, time or 0, 0))

    def _step(self, spikes: Any) -> list[int]:
        """The numbers of the inputs that fire in a step."""
        if _is_array(spikes):
            return self._numbers(read(spikes).array[None])[0]
        numbers = []
        for own in spikes:
            if isinstance(own, (bool, np.bool_)):
                raise Error(f"a list has the numbers of the inputs that fire, and not {own}; an array has counts")
            number = operator.index(own)
            if not 0 <= number < self.inputs:
                raise Error(f"input {number}: the network has inputs 0 to {self.inputs - 1}")
            numbers.append(number)
        return numbers

    def _numbers(self, counts: NDArray[Any]) -> list[list[int]]:
        """The numbers of the inputs that fire, of counts (steps, inputs)."""
        inputs = np.arange(self.inputs)
        for step in counts:
            if step.shape != inputs.shape or step.dtype.kind not in "fiub" or not _are_counts(step):
                raise Error(f"a step has {self.inputs} counts of spikes, not {step!r}")
        return numbers_of(counts)

    @checked
    def step(self, spikes: ArrayLike | Sequence[int]) -> NDArray[np.float32]:
        """Takes a step from where the last one ended, and returns the last layer's potentials. `spikes` is a row of what
        :meth:`run` takes.

        >>> import numpy as np, spikewire as sw
        >>> one = '{name = "a", reset = "to-value", fires = "at", keep = [0.5], threshold = [1.0], weights = [[0.75, 0.25]]}'
        >>> network = sw.Network.from_toml(f"layers = [{one}]")
        >>> network.step([0]).tolist(), network.step(np.array([0, 1])).tolist()
        ([0.75], [0.625])
        """
        self._native.step(self._step(spikes))
        return self._native.potentials()

    @property
    def fired(self) -> list[list[int]]:
        """The neurons of each layer that fired in the last step."""
        return self._native.fired()

    def reset(self) -> None:
        """Puts the network at rest.

        >>> import spikewire as sw
        >>> one = '{name = "a", reset = "to-value", fires = "at", keep = [0.5], threshold = [1.0], weights = [[0.75, 0.25]]}'
        >>> network = sw.Network.from_toml(f"layers = [{one}]")
        >>> first = network.step([0])
        >>> network.reset()
        >>> bool(network.step([0]) == first)
        True
        """
        self._native.reset()

    def __reduce__(self) -> Any:
        return _again, (self.to_toml(),), self._native.state()

    def __setstate__(self, state: Any) -> None:
        self._native.set_state(state)

    def __repr__(self) -> str:
        return f"Network of {self.inputs} inputs and layers of {', '.join(map(str, self.layers))} neurons"


def _is_array(spikes: Any) -> bool:
    """Whether spikes come as counts, in an array or a table of any library: lists have the numbers of inputs."""
    return hasattr(spikes, "shape") or hasattr(spikes, "__array__") or hasattr(spikes, "collect")


def _counts(spikes: ArrayLike) -> NDArray[Any]:
    """Counts of spikes (steps, inputs), of an array or a table."""
    counts, _, _ = read(spikes)
    if counts.ndim != 2:
        raise Error(f"spikes are an array (steps, inputs) of counts, not {counts.shape}")
    if not _are_counts(counts):
        raise Error("spikes are counts of spikes, 0 and above: values, as some networks take them, are not read yet")
    return counts


def numbers_of(counts: NDArray[Any]) -> list[list[int]]:
    """The numbers of the inputs or neurons that fire in each step, of counts (steps, inputs)."""
    numbers = np.arange(counts.shape[1])
    return [np.repeat(numbers, step.astype(int)).tolist() for step in counts]


def _are_counts(step: NDArray[Any]) -> bool:
    return bool(np.isfinite(step).all() and (step >= 0).all() and (step == np.trunc(step)).all())


def _again(toml: str) -> Network:
    return Network.from_toml(toml)
