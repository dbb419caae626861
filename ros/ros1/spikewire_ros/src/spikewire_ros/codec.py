"""The codecs of the package `spikewire`, a sample at a time."""

from inspect import signature
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

import numpy as np
import spikewire

from .layout import Layout
from .settings import Settings

# Of these a message has a number for each neuron.
_NEURON_BY_NEURON = ("position", "grf", "grf-prob", "grf-nonlinear")


class Codec:
    """An encoder and its decoder, as they start on a signal."""

    def __init__(self, scheme: Any, layout: Layout, first: float) -> None:
        """`first`: the first sample, where decoders that add up steps start unless `start` is given."""
        given = scheme.parameters
        self.layout = layout
        # Whether the value of the first sample is known, so that its spike changes nothing.
        self.starts_at_first = "start" in _names(scheme) and "start" not in given
        # What messages say of it.
        self.first = first if self.starts_at_first else float(given.get("start", 0.0))
        self.threshold = float(given.get("threshold", 0.0))
        self._lowest, self._highest = given.get("min", given.get("shift")), given.get("max")
        # As the package has them: of sub-timesteps and neurons, or of neurons, or none.
        neurons, slots = layout.neurons, layout.slots
        self._axes = (slots, neurons) if slots > 1 else (neurons,) if neurons > 1 else ()
        self._encoder = scheme.encoder()
        self._decoder = scheme.decoder(first=first if self.starts_at_first else None)

    def range(self, lowest: float, highest: float) -> Tuple[float, float]:
        """The range that it codes, or, where it has none, that of the samples so far."""
        return (
            lowest if self._lowest is None else float(self._lowest),
            highest if self._highest is None else float(self._highest),
        )

    def encode(self, values: Sequence[float]) -> List[List[int]]:
        """The cells of the samples that these complete, a list for each."""
        return self._rows(self._encoder.encode(np.array(values, dtype=float)))

    def finish(self) -> List[List[int]]:
        """The cells of the samples that wait for later ones."""
        return self._rows(self._encoder.finish())

    def decode(self, cells: Sequence[int]) -> float:
        """The value of the next sample. `ValueError`: no encoder makes such cells."""
        row = np.array(cells, dtype=np.int8).reshape(1, *self._axes)
        return float(self._decoder.decode(row)[0])

    def _rows(self, codes: np.ndarray) -> List[List[int]]:
        return codes.reshape(-1, self.layout.neurons * self.layout.slots).tolist()


class Request:
    """A scheme with what was given of its parameters, which samples or messages may tell the rest of."""

    def __init__(self, settings: Settings) -> None:
        """`ValueError`: a parameter is not good."""
        self._settings = settings
        self._class = spikewire.schemes.get(settings.scheme)
        if self._class is None:
            raise ValueError(f"encoding_scheme {settings.scheme}: there are {', '.join(spikewire.schemes)}")
        _check(self._class, settings.options)

    @property
    def enough(self) -> int:
        """How many samples it starts on; an encoder with a window waits for that by itself."""
        return max(self._settings.calibrate, 1)

    def layout(self) -> Layout:
        """How its spikes stand in messages. `ValueError`: a parameter is missing or not good."""
        scheme = self._made(self._settings.options)
        if not self._settings.calibrate:
            # These say what is missing, and what is not good.
            scheme.encoder()
            scheme.decoder(first=0.0)
        return _layout(scheme)

    def start(self, values: Sequence[float]) -> Codec:
        """As it starts on these samples, which stand in for what is not given where the settings say so."""
        scheme = self._made(self._settings.options)
        if self._settings.calibrate:
            scheme = scheme.fit(np.array(values, dtype=float))
        return Codec(scheme, _layout(scheme), values[0])

    def receive(self, told: Mapping[str, float], length: int, first: float) -> Codec:
        """As it decodes messages of so many numbers that tell these parameters."""
        names = _names(self._class)
        options: Dict[str, Any] = {name: value for name, value in told.items() if name in names}
        if self._settings.scheme in _NEURON_BY_NEURON:
            options["neurons"] = length
        options.update(self._settings.options)
        scheme = self._made(options)
        return Codec(scheme, _layout(scheme), first)

    def _made(self, options: Mapping[str, Any]) -> Any:
        return self._class(sample=self._settings.sample, **options)


def _layout(scheme: Any) -> Layout:
    neurons, slots = scheme._coder.shape()
    return Layout(scheme.name, neurons, slots)


def _names(scheme: Any) -> List[str]:
    """The parameters that a scheme, or its class, takes."""
    kind = scheme if isinstance(scheme, type) else type(scheme)
    return [name for name in signature(kind).parameters if name not in ("sample", "paper")]


def _check(kind: type, options: Mapping[str, Any]) -> None:
    names = _names(kind)
    for name in options:
        if name not in names:
            raise ValueError(f"{name}: no parameter of {kind.__name__}; it takes {', '.join(names)}")
