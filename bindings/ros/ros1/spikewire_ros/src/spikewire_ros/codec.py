"""The codecs of the package `spikewire`, a sample at a time."""

from collections.abc import Mapping, Sequence
from inspect import signature
from typing import Any

import numpy as np
import spikewire

from .settings import Settings

# Of these a message has a number for each neuron.
_NEURON_BY_NEURON = ("position", "grf", "grf-prob", "grf-nonlinear")

# From these an encoder finds its threshold, which messages tell.
_OF_THRESHOLD = ("factor", "magnitudes")


class Codec:
    """An encoder and its decoder, as they start on a signal.

    The spikes of a sample are cells: a number for each neuron of each sub-timestep, sub-timestep after sub-timestep.
    """

    def __init__(self, scheme: Any, values: Sequence[float]) -> None:
        """`values`: the first samples. Decoders that add up steps start from the first, unless `start` is given."""
        given = scheme.parameters
        self.name = scheme.name
        # Whether the value of the first sample is known, so that its spike changes nothing.
        self.starts_at_first = "start" in parameters(scheme) and "start" not in given
        # What messages say of it.
        self.first = values[0] if self.starts_at_first else float(given.get("start", 0.0))
        self.threshold = float(given.get("threshold", 0.0))
        self._lowest, self._highest = given.get("min", given.get("shift")), given.get("max")
        self._neurons, self._slots = scheme.neurons, scheme.slots
        self._encoder = scheme.encoder()
        self._decoder = scheme.decoder(first=self.first if self.starts_at_first else None)
        self._told = scheme.encode(np.array(values, dtype=float)).parameters[0]
        self._sample = scheme.sample

    @property
    def header(self) -> str:
        """What a file of spikes says in its header: all that decoding needs."""
        lines = {"spikewire": "1", "scheme": self.name, "sample": self._sample, **self._told}
        return "".join(f"{key}={value}\n" for key, value in lines.items())

    def range(self, lowest: float, highest: float) -> tuple[float, float]:
        """The range that it codes, or, where it has none, that of the samples so far."""
        return (
            lowest if self._lowest is None else float(self._lowest),
            highest if self._highest is None else float(self._highest),
        )

    def encode(self, values: Sequence[float]) -> list[list[int]]:
        """The cells of the samples that these complete, a list for each."""
        return self._rows(self._encoder.encode(np.array(values, dtype=float)))

    def finish(self) -> list[list[int]]:
        """The cells of the samples that wait for later ones."""
        return self._rows(self._encoder.finish())

    def decode(self, cells: Sequence[int]) -> float:
        """The value of the next sample. `ValueError`: no encoder makes such cells."""
        if len(cells) != self._neurons * self._slots:
            raise ValueError(f"{len(cells)} numbers a message, where {self.name} has {self._neurons * self._slots}")
        # As the package has them: of sub-timesteps and neurons, or of neurons, or none.
        axes = (self._slots, self._neurons) if self._slots > 1 else (self._neurons,) if self._neurons > 1 else ()
        return float(self._decoder.decode(np.array(cells, dtype=np.int8).reshape(1, *axes))[0])

    def _rows(self, codes: np.ndarray) -> list[list[int]]:
        return codes.reshape(-1, self._neurons * self._slots).tolist()


class Request:
    """A scheme with what was given of its parameters, which samples or messages may tell the rest of."""

    def __init__(self, settings: Settings) -> None:
        """`ValueError`: a parameter is not good."""
        self._settings = settings
        taken = names(settings.scheme)
        self._class = spikewire.schemes[settings.scheme]
        for name in settings.options:
            if name not in taken:
                kind = self._class.__name__
                raise ValueError(f"{name}: no parameter of {kind}; it takes {', '.join(taken)}")

    @property
    def enough(self) -> int:
        """How many samples it starts on; an encoder with a window waits for that by itself."""
        return max(self._settings.calibrate, 1)

    def check(self) -> None:
        """`ValueError`: a parameter is missing or not good."""
        if not self._settings.calibrate:
            scheme = self._made(self._settings.options)
            # These say what is missing, and what is not good.
            scheme.encoder()
            scheme.decoder(first=0.0)

    @property
    def is_array(self) -> bool:
        """Whether a sample has several numbers: of several neurons, or of several sub-timesteps."""
        scheme = self._made(self._settings.options)
        return scheme.neurons * scheme.slots > 1

    def start(self, values: Sequence[float]) -> Codec:
        """As it starts on these samples, which stand in for what is not given where the settings say so."""
        scheme = self._made(self._settings.options)
        if self._settings.calibrate:
            scheme = scheme.fit(np.array(values, dtype=float))
        return Codec(scheme, values)

    def receive(self, told: Mapping[str, float], length: int, first: float) -> Codec:
        """As it decodes messages of so many numbers that tell these parameters."""
        names = parameters(self._class)
        options: dict[str, Any] = {name: value for name, value in told.items() if name in names}
        if self._settings.scheme in _NEURON_BY_NEURON:
            options["neurons"] = length
        given = self._settings.options.items()
        options.update((name, value) for name, value in given if name not in _OF_THRESHOLD)
        return Codec(self._made(options), [first])

    def _made(self, options: Mapping[str, Any]) -> Any:
        return self._class(sample=self._settings.sample, **options)


def names(scheme: str) -> list[str]:
    """The parameters that the scheme of this name takes. `ValueError`: there is no such scheme."""
    kind = spikewire.schemes.get(scheme)
    if kind is None:
        raise ValueError(f"encoding_scheme {scheme}: there are {', '.join(spikewire.schemes)}")
    return parameters(kind)


def parameters(scheme: Any) -> list[str]:
    """The parameters that a scheme, or its class, takes."""
    kind = scheme if isinstance(scheme, type) else type(scheme)
    return [name for name in signature(kind).parameters if name not in ("sample", "paper")]
