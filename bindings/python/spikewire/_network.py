"""Trained networks, bit for bit as a flight controller runs them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native

Framework = Literal["snntorch", "norse", "spikingjelly", "rockpool", "sinabs", "nir"]
Reset = Literal[
    "to-value", "to-value-late", "to-value-held", "subtract", "subtract-late", "subtract-no-delay", "none"
]


class Ran(NamedTuple):
    """The spikes and potentials of a network's last layer, by step."""

    #: Whether each neuron fired: (steps, neurons).
    spikes: NDArray[np.bool_]
    #: Their potentials behind the step: (steps, neurons).
    potentials: NDArray[np.float32]


class Network:
    """A trained network in single precision: the bits of ``spikewire network --on controller`` and of `spikewire-network`
    on every core. :meth:`from_nir` reads one."""

    def __init__(self, native: _native.Network):
        self._native = native

    @classmethod
    def from_nir(
        cls,
        path: str | Path,
        framework: Framework | None = None,
        *,
        reset: Reset | Sequence[Reset] | None = None,
        fires: Literal["above", "at"] | None = None,
        decay: Literal["euler", "exponential"] | None = None,
        current: Literal["new", "old", "whole"] | None = None,
        dt: float | None = None,
    ) -> Network:
        """Reads a NIR graph, or a network in JSON.

        A file does not hold by which rule its neurons step. `framework` says some of it: what it leaves open are keywords,
        which an error lists. `reset` is one for all layers, or one for each that fires; `dt` are the seconds of a step.

        Raises `ValueError` if the file is no network, or the rule is not said as a whole.
        """
        resets = [] if reset is None else [reset] if isinstance(reset, str) else list(reset)
        return cls(_native.Network(Path(path), (framework, fires, decay, current), resets, dt))

    @property
    def inputs(self) -> int:
        """Number of inputs."""
        return self._native.inputs()

    @property
    def layers(self) -> list[int]:
        """The number of neurons of each layer."""
        return self._native.layers()

    def run(self, spikes: ArrayLike | Sequence[Sequence[int]]) -> Ran:
        """Runs the network from rest. `spikes` is an array (steps, inputs) of how often each input fires, whose spikes come by
        rising input, or a list with a list for each step: the numbers of the inputs that fire, in order."""
        self.reset()
        return Ran(*self._native.steps([_numbers(step, self.inputs) for step in spikes]))

    def step(self, spikes: ArrayLike | Sequence[int]) -> NDArray[np.float32]:
        """Takes a step from where the last one ended, and returns the last layer's potentials. `spikes` is a row of what
        :meth:`run` takes."""
        self._native.step(_numbers(spikes, self.inputs))
        return self._native.potentials()

    @property
    def fired(self) -> list[list[int]]:
        """The neurons of each layer that fired in the last step."""
        return self._native.fired()

    def reset(self) -> None:
        """Puts the network at rest."""
        self._native.reset()

    def __repr__(self) -> str:
        return f"Network of {self.inputs} inputs and layers of {', '.join(map(str, self.layers))} neurons"


def _numbers(step: ArrayLike | Sequence[int], inputs: int) -> list[int]:
    """The numbers of the inputs that fire: lists have them, arrays have counts."""
    if not isinstance(step, np.ndarray):
        return [int(own) for own in step]
    if step.shape != (inputs,) or (step < 0).any() or (step != np.trunc(step)).any():
        raise ValueError(f"a step has {inputs} counts of spikes, not {step!r}")
    return np.repeat(np.arange(inputs), step.astype(int)).tolist()
