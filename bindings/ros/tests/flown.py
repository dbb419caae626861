"""What the nodes must make of a recorded flight: the firmware's own spikes and values, and the laptop program's.

The program `demo` is the firmware of `cargo demo`, here built for the host: every scheme of the catalogue as a
constant, in `f32`, without the catalogue's options and without Python. `cargo verify` compares it with emulated boards.
"""

import csv
import importlib.util
import struct
import subprocess
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

from spikewire_ros.schemes import of_catalogue

# Neuron, sub-timestep, sign.
NeuronSpike = tuple[int, int, int]


@dataclass
class Flown:
    """What became of each sample."""

    firings: list[list[NeuronSpike]] = field(default_factory=list)
    # The bits of an f32.
    values: list[int] = field(default_factory=list)


def f32(value: float) -> float:
    """The nearest number of 32 bits."""
    return struct.unpack("f", struct.pack("f", value))[0]


def bits(value: float) -> int:
    """Its bits as an f32."""
    return struct.unpack("I", struct.pack("f", value))[0]


def flight(table: Path) -> tuple[list[int], list[float]]:
    """Times in µs and yaw rates in rad/s."""
    with open(table) as rows:
        read = [(int(row["time_us"]), f32(float(row["gyro_z"]))) for row in csv.DictReader(rows)]
    return [time for time, _ in read], [rate for _, rate in read]


def _settings() -> ModuleType:
    """Those of the Python package's checks."""
    path = Path(__file__).parents[2] / "python/tests/flown_settings.py"
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


# The names that the toolbox's nodes have for some.
OF_TOOLBOX = {
    "tbr": "temporal_contrast",
    "mw": "moving_window",
    "sf": "step_forward",
    "t-hsa": "threshold_hsa",
    "grf": "gaussian_fields",
}


def schemes(rates: list[float], contrast: float) -> dict[str, dict[str, Any]]:
    """The nodes' parameters by the names that the firmware has: parts of the signal's range, as its constants are.

    `contrast`: the threshold of `tbr`, which differences tell.
    """
    low, high = min(rates), max(rates)

    def part(of_range: float) -> float:
        return f32((high - low) * of_range)

    flown = _settings().settings(part, low, high)
    flown["tbr"][1]["threshold"] = contrast
    return {
        name: {"encoding_scheme": OF_TOOLBOX.get(scheme, scheme), **keywords}
        for name, (scheme, keywords) in flown.items()
    }


# How many neurons lie side by side in an array.
NEURONS = {
    "position": 20,
    "position-gauss": 20,
    "grf": 20,
    "grf-nonlinear": 20,
    "grf-slots": 15,
    "grf-prob": 15,
    "grf-nonlinear-slots": 15,
    "rank-order": 15,
    "latency-phase": 4,
}
# What the decoding node finds in the messages.
IN_MESSAGES = ("encoding_scheme", "min", "max", "shift")
# Those that the firmware starts in another way: with another generator, or a window that is still empty.
BY_PROGRAM = ("mw", "bernoulli", "grf-prob")
# Those whose means it starts from the first sample, which neither the program nor the node knows of.
MEANS_BY_PROGRAM = ("if", "lif", "sigma-delta", "burst-weighted")
# In samples, where it is not 0.
LOOK_AHEAD = {"bsa": 23, "bsa-mul": 23, "bsa-toolbox": 9, "hsa": 14, "t-hsa": 14}


def is_as_wanted(spike: Any, firings: list[NeuronSpike], name: str) -> bool:
    """A number of `spyke`, or those of `spyke_array`: sub-timestep after sub-timestep, in each neuron by neuron."""
    found = list(spike) if hasattr(spike, "__len__") else [spike]
    row = [0] * len(found)
    for neuron, slot, sign in firings:
        row[slot * NEURONS.get(name, 1) + neuron] += sign
    return found == row


def by_firmware(program: Path) -> dict[str, Flown]:
    """What the firmware prints: a scheme's name and latency, then a line a sample."""
    printed = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    flown: dict[str, Flown] = {}
    for line in printed.splitlines():
        left, right = line.split(" ")
        if left[:1].isalpha():
            own = flown[left] = Flown()
        else:
            own.firings.append(_firings(left))
            own.values.append(int(right, 16))
    return flown


def _firings(text: str) -> list[NeuronSpike]:
    """`+3.0-4.1`"""
    spaced = text.replace("+", " +").replace("-", " -").split()
    places = [(one[0], *one[1:].split(".")) for one in spaced]
    return [(int(neuron), int(slot), 1 if sign == "+" else -1) for sign, neuron, slot in places]


def by_program(program: Path, table: Path, parameters: dict[str, Any], samples: int) -> Flown:
    """What the laptop program makes of it, of schemes with one spike at a time."""
    slots = parameters.get("spikes", 1)
    options = {**parameters, "scheme": of_catalogue(parameters["encoding_scheme"])}
    del options["encoding_scheme"]
    given = [f"--{name}={value}" for name, value in options.items()]
    command = [program, "encode", *given, "--column=gyro_z", table]
    spikes = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    decoded = subprocess.run([program, "decode"], input=spikes, check=True, capture_output=True, text=True).stdout
    flown = Flown([[] for _ in range(samples)])
    rows = csv.DictReader(line for line in spikes.splitlines() if not line.startswith("#"))
    for row in rows:
        sample, slot = divmod(int(row["index"]), slots)
        flown.firings[sample].append((int(row["address"]), slot, int(row["polarity"])))
    flown.values = [bits(float(row["value"])) for row in csv.DictReader(decoded.splitlines())]
    return flown
