"""Flights of a minute, bad lines and margins: what a verdict on a bank needs beside `table.py`'s short flights.

`minutes.py WAY...` flies ways through all conditions and keeps the figures in `minutes.json`; `minutes.py --print` prints the
tables of it; `minutes.py --margin WAY` looks for the value of each condition at which the first of twenty flights is lost;
`minutes.py --list` names the ways. A way is a bank of `banks.json` or `advised.json`, no code, or a rival of `rivals.py`.

Each condition is flown under all controllers in both worlds, short flights first. Minutes are only flown by ways that lose no
short flight, as most others would be lost within seconds. Seeds are fixed.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from advised import KEPT_ADVISED
from banks import LEVEL, banks
from control import Control
from controllers import CONTROLLERS
from flight import Flight, LowPass, Way, fly
from line import Line, Over
from manoeuvres import MINUTES, Manoeuvre
from rivals import DeadBand, Samples
from table import SHORT, WORLDS, number, rounded

KEPT = Path(__file__).with_name("minutes.json")
#: Short flights of a condition: five manoeuvres with so many seeds. Minutes: four manoeuvres with so many.
SEEDS, MINUTE_SEEDS = 4, 5
#: The second and the first world; the third has the first one's drone.
PLACES = [(world, control) for world in ("RotorPy", "drone-models") for control in CONTROLLERS]
#: The line of all flights but those whose condition says otherwise.
CHANCE = Line(loss=0.01)
#: The thresholds that the dead band has, those of the bank `sod`, and a step between all of its values, s.
BAND, BAND_EVERY = np.array([0.0933, 0.0933, 0.0933, 2.6, 2.6, 8.5], np.float32), 0.2


@dataclass(frozen=True)
class Condition:
    """What is hard about a flight: the line, how strongly rotors shake it, its rate, gains and manoeuvres."""

    name: str
    line: Line = CHANCE
    level: float = LEVEL
    rate: int = 500
    #: A factor on the controller's gains.
    gain: float = 1.0
    flights: list[Manoeuvre] = field(default_factory=lambda: SHORT)
    seeds: int = SEEDS


CONDITIONS = [
    Condition("1 % lost"),
    Condition("10 % lost", Line(loss=0.1)),
    Condition("1 % in bursts of 50 ms", Line(loss=0.01, burst=0.05)),
    Condition("5 % in bursts of 50 ms", Line(loss=0.05, burst=0.05)),
    Condition("2 ms late", replace(CHANCE, delay=0.002)),
    Condition("5 ms late", replace(CHANCE, delay=0.005)),
    Condition("460 800 baud", replace(CHANCE, baud=460_800)),
    Condition("115 200 baud", replace(CHANCE, baud=115_200)),
    # 0.5 rad/s rms at the sensor.
    Condition("rotors of 0.5 rad/s", level=3.3 * LEVEL),
    Condition("250 Hz", rate=250),
    Condition("1 kHz", rate=1000, seeds=2),
    Condition("2 kHz", rate=2000, seeds=1),
    Condition("4 kHz", rate=4000, seeds=1),
    Condition("60 s", flights=MINUTES, seeds=MINUTE_SEEDS),
]


def behind(corner: float | None, rate: int) -> LowPass | None:
    """A low-pass, or none."""
    return LowPass(corner, rate) if corner else None


def dead_band(factor: float, corner: float | None) -> Callable[[int], Way]:
    """A dead band of the bank's thresholds times `factor`."""
    return lambda rate: DeadBand(factor * BAND, round(BAND_EVERY * rate), behind(corner, rate))


def samples(per_second: int, corner: float | None) -> Callable[[int], Way]:
    """So many samples a second, behind a low-pass or not; all where there are fewer."""
    return lambda rate: Samples(max(1, rate // per_second), behind(corner, rate))


def ways() -> dict[str, Callable[[int], Way]]:
    """How a sample comes to the controller, by name."""
    rivals = {
        "raw samples": lambda rate: Samples(),
        "125 samples/s behind 80 Hz": samples(125, 80),
        "250 samples/s behind 160 Hz": samples(250, 160),
        "dead band behind 80 Hz": dead_band(1, 80),
        "dead band x 2 behind 200 Hz": dead_band(2, 200),
    }
    return rivals | {name: bank.path for name, bank in (banks() | banks(KEPT_ADVISED)).items()}


def eager(control: Control, gain: float) -> Control:
    """The controller with its rate gains multiplied."""
    if gain != 1:
        wishes = control._wishes
        control._wishes = lambda rates, turns: [np.float32(gain) * wish for wish in wishes(rates, turns)]
    return control


def flights(make: Callable[[int], Way], condition: Condition, place: tuple[str, str]) -> list[Flight]:
    """All flights of a condition at a place, each with a seed of its own."""
    (name, controller), flown = place, []
    world = WORLDS[name]
    for seed in range(1, condition.seeds + 1):
        for index, manoeuvre in enumerate(condition.flights):
            drawn = 1000 + 100 * seed + index
            way = Over(make(condition.rate), condition.line, condition.rate, drawn)
            control = eager(CONTROLLERS[controller](condition.rate, world.drone), condition.gain)
            flown.append(
                fly(manoeuvre, way, drawn, 0.0, control=control, world=world, vibration=condition.level, rate=condition.rate)
            )
    return flown


def figures(flown: list[Flight]) -> dict:
    """How many flights were lost, the first of them after how long, and means over the others."""
    held = [flight.errors.mean() for flight in flown if not flight.lost]
    lost = [flight.seconds for flight in flown if flight.lost]
    return {
        "flights": len(flown),
        "lost": len(lost),
        "first": min(lost, default=None),
        "error": float(np.mean(held)) if held else None,
        "bytes": float(np.mean([flight.bytes for flight in flown])),
        "most": max(flight.bytes for flight in flown),
    }


def flown(make: Callable[[int], Way], name: str) -> dict:
    """A way through all conditions, by condition and place."""
    found: dict = {}
    for condition in CONDITIONS:
        # Flights of a minute last as long as all others together.
        is_hopeless = any(cell["lost"] for cell in found.get("1 % lost", {}).values())
        if condition.flights is MINUTES and is_hopeless:
            continue
        found[condition.name] = {" ".join(place): figures(flights(make, condition, place)) for place in PLACES}
        lost = sum(cell["lost"] for cell in found[condition.name].values())
        print(name, condition.name, f"{lost} lost", file=sys.stderr, flush=True)
    return found


#: The quantities of a margin: a condition with this value of each, and the range in which it is looked for.
MARGINS: dict[str, tuple[Callable[[float], Condition], float, float]] = {
    "frames lost, share": (lambda value: Condition("", Line(loss=value)), 0.0, 0.9),
    "bursts of 1 %, s": (lambda value: Condition("", Line(loss=0.01, burst=value)), 0.002, 1.0),
    "delay, s": (lambda value: Condition("", replace(CHANCE, delay=value)), 0.0, 0.05),
    "vibration, rad/s": (lambda value: Condition("", level=value / 0.15 * LEVEL), 0.0, 3.0),
    "gain": (lambda value: Condition("", gain=value), 1.0, 4.0),
}


def margin(make: Callable[[int], Way], of: str, place: tuple[str, str], steps: int = 6) -> float | None:
    """The least value found at which the first of twenty flights is lost, by bisection; `None` if none is at the largest."""
    condition, low, high = MARGINS[of]
    if not any(flight.lost for flight in flights(make, condition(high), place)):
        return None
    for _ in range(steps):
        middle = (low + high) / 2
        if any(flight.lost for flight in flights(make, condition(middle), place)):
            high = middle
        else:
            low = middle
    return high


HEAD = "| what is sent | lost | beside raw | bytes/s: here | Betaflight's loop | second world | 60 s: lost | first after, s |\n"
LINE = "|---|---:|---:|---:|---:|---:|---:|---:|\n"


def beside(own: dict, raw: dict) -> float | None:
    """The mean ratio of the error to that of raw samples, over conditions and places in which neither lost all."""
    ratios = []
    for name, cells in own.items():
        for place, cell in cells.items():
            other = raw.get(name, {}).get(place)
            if other and cell["error"] and other["error"]:
                ratios.append(cell["error"] / other["error"])
    return float(np.mean(ratios)) if ratios else None


def row(name: str, own: dict, raw: dict) -> str:
    """A row of the table."""
    cells = [cell for condition, places in own.items() if condition != "60 s" for cell in places.values()]
    minutes = list(own.get("60 s", {}).values())
    plain = own["1 % lost"]
    first = min((cell["first"] for cell in minutes if cell["first"] is not None), default=None)
    columns = [
        name,
        f"{sum(cell['lost'] for cell in cells)} of {sum(cell['flights'] for cell in cells)}",
        number(beside(own, raw), 2),
        number(plain["RotorPy cascade"]["bytes"]),
        number(plain["RotorPy Betaflight"]["bytes"]),
        number(max(cell["bytes"] for place, cell in plain.items() if "RotorPy" not in place)),
        f"{sum(cell['lost'] for cell in minutes)} of {sum(cell['flights'] for cell in minutes)}" if minutes else "not flown",
        number(first, 1),
    ]
    return "| " + " | ".join(columns) + " |\n"


def main(arguments: list[str]) -> None:
    known = ways()
    if "--list" in arguments:
        print("\n".join(known))
        return
    kept = json.loads(KEPT.read_text()) if KEPT.exists() else {}
    if "--margin" in arguments:
        for name in arguments[1:]:
            for of in MARGINS:
                values = [number(margin(known[name], of, place), 3) for place in PLACES]
                print(f"| {name} | {of} | " + " | ".join(values) + " |", flush=True)
        return
    for name in [] if "--print" in arguments else arguments or known:
        kept[name] = rounded(flown(known[name], name))
        KEPT.write_text("{\n" + ",\n".join(f'  "{own}": {json.dumps(cells)}' for own, cells in kept.items()) + "\n}\n")
    rows = [row(name, own, kept["raw samples"]) for name, own in kept.items()]
    print(HEAD + LINE + "".join(rows), end="")


if __name__ == "__main__":
    main(sys.argv[1:])
