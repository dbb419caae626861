"""The banks that `spikewire advise` takes from two logs, for the table to fly: the text of `advised.json`.

`advised.py SPIKEWIRE` asks that program about the hexarotor's flight in `data`, and about the lesson flown by the simulated
drone, whose rotors shake it: another drone's log, and its own.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

import numpy as np

from banks import LEVEL, Bank, written
from codes import lesson
from flight import RATE

KEPT_ADVISED = Path(__file__).with_name("advised.json")
CHANNELS = ("gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z")
HEXAROTOR = Path(__file__).parents[2] / "data/hexarotor.csv"
#: The loop's bandwidth that `advise` is told, Hz.
BANDWIDTH = 4


def advised(spikewire: str, log: Path) -> Bank:
    """The bank that the program takes."""
    with tempfile.TemporaryDirectory() as place:
        file = Path(place) / "flight.toml"
        command = [spikewire, "advise", str(log), "--loop-bandwidth", str(BANDWIDTH), "-o", str(file)]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        own = tomllib.loads(file.read_text())
    filter_ = own.get("filter")
    if filter_ and filter_["kind"] != "low-pass":
        raise ValueError(f"only a low-pass is flown, not {filter_}")
    shared = own.get("parameters", {})
    taken = {channel["name"]: shared | channel.get("parameters", {}) for channel in own["channel"]}
    groups = tuple(taken[name] for name in CHANNELS)
    keyframe_ms = round(own["keyframe_every"] * own["period"] / 1000)
    return Bank(own["scheme"], filter_ and filter_["corner"], keyframe_ms, groups, own.get("step_bits", 0))


def main(spikewire: str) -> None:
    with tempfile.TemporaryDirectory() as place:
        log = Path(place) / "lesson.csv"
        flight = lesson(LEVEL).T
        times = np.arange(len(flight))[:, None] * (1_000_000 // RATE)
        np.savetxt(log, np.hstack([times, flight]), "%.9g", ",", header=",".join(("time_us", *CHANNELS)), comments="")
        found = {}
        for key, path in (("hexarotor", HEXAROTOR), ("own", log)):
            bank = advised(spikewire, path)
            found[f"{bank.name}/{key}"] = bank
    print(written(found), end="")


if __name__ == "__main__":
    main(sys.argv[1])
