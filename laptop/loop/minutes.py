"""Rivals, bad lines and flights of a minute: the tables of `docs/loop.md` that a verdict needs beside `table.py`'s, and
`minutes.json`, which they are printed from.

`minutes.py` flies what `minutes.json` lacks and prints the tables; `minutes.py --anew` flies all; `minutes.py WAY...` flies
these ways anew; `minutes.py --print` prints what was kept; `minutes.py --list` names the ways; `minutes.py --check WAY` flies a
way once more here and compares; `minutes.py --margin WAY...` looks for the value of each condition at which the first of ten
flights is lost. A way is a bank of `banks.json`, `numbered.json` or `advised.json`, or a rival of `rivals.py`. Seeds are fixed.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from advised import KEPT_ADVISED
from banks import LEVEL, banks
from control import Control
from controllers import CONTROLLERS
from flight import Flight, LowPass, Way, fly
from line import Line, Over
from manoeuvres import ALL, MINUTES, Manoeuvre
from rivals import DeadBand, Samples
from table import EVERYWHERE, HERE, SHORT, WITHIN, WORLDS, key, number

KEPT = Path(__file__).with_name("minutes.json")
#: Send-on-delta on a grid through 0, with step numbers on the link.
KEPT_NUMBERED = Path(__file__).with_name("numbered.json")
#: The line of all flights but those whose condition says otherwise.
CHANCE = Line(loss=0.01)
#: The thresholds of the dead band, those of the bank `sod`, and the time after which all of its values are sent, s.
BAND, BAND_EVERY = np.array([0.0931, 0.0931, 0.0931, 2.56, 2.56, 8.46], np.float32), 0.5
#: World, controller and rate of the flights on bad lines, and of those of a minute.
BETAFLIGHT = ("RotorPy", "Betaflight", 500)
LINES = [HERE, BETAFLIGHT]
OTHERS = [(world, control, 500) for world in ("RotorPy", "drone-models") for control in CONTROLLERS]
OTHERS.remove(BETAFLIGHT)
#: The way that others are compared with.
RAW = "raw samples"


@dataclass(frozen=True)
class Condition:
    """What is hard about flights: where they take place, the line, how strongly rotors shake the sensor, the gains."""

    name: str
    places: list[tuple[str, str, int]]
    line: Line = CHANCE
    level: float = LEVEL
    #: A factor on the accelerations that the controller asks for.
    gain: float = 1.0
    flights: list[Manoeuvre] = field(default_factory=lambda: SHORT)
    seeds: tuple[int, ...] = (1,)

    def count(self) -> int:
        """How many flights it has at each place."""
        return len(self.seeds) * len(self.flights)


CONDITIONS = [
    Condition("here", [HERE], flights=ALL, seeds=(1, 2)),
    Condition("everywhere", EVERYWHERE),
    Condition("60 s on Betaflight's loop", [BETAFLIGHT], flights=MINUTES, seeds=(1, 2, 3)),
    Condition("10 % lost", LINES, Line(loss=0.1)),
    Condition("1 % in bursts of 50 ms", LINES, Line(loss=0.01, burst=0.05)),
    Condition("2 ms late", LINES, replace(CHANCE, delay=0.002)),
    Condition("5 ms late", LINES, replace(CHANCE, delay=0.005)),
    Condition("460 800 baud", LINES, replace(CHANCE, baud=460_800)),
    Condition("115 200 baud", LINES, replace(CHANCE, baud=115_200)),
    # 0.5 rad/s rms at the sensor.
    Condition("rotors of 0.5 rad/s", LINES, level=3.3 * LEVEL),
    Condition("60 s elsewhere", OTHERS, flights=MINUTES),
]


def low_pass(corner: float | None, rate: int) -> LowPass | None:
    """A low-pass, or none; none either where the rate is too low for it."""
    return LowPass(corner, rate) if corner and corner < rate / 2 else None


def dead_band(factor: float, corner: float | None) -> Callable[[int], Way]:
    """A dead band of the bank's thresholds times `factor`."""
    return lambda rate: DeadBand(factor * BAND, round(BAND_EVERY * rate), low_pass(corner, rate))


def samples(per_second: int, corner: float | None) -> Callable[[int], Way]:
    """So many samples a second, behind a low-pass or not; all where there are fewer."""
    return lambda rate: Samples(max(1, rate // per_second), low_pass(corner, rate))


def ways() -> dict[str, Callable[[int], Way]]:
    """How a sample comes to the controller, by name."""
    found: dict[str, Callable[[int], Way]] = {
        RAW: lambda rate: Samples(),
        "125 samples/s behind 80 Hz": samples(125, 80),
        "125 samples/s behind 160 Hz": samples(125, 160),
        "250 samples/s behind 160 Hz": samples(250, 160),
        "dead band behind 80 Hz": dead_band(1, 80),
        "dead band x 2 behind 80 Hz": dead_band(2, 80),
        "dead band x 2 behind 200 Hz": dead_band(2, 200),
    }
    for path in (KEPT_NUMBERED, None, KEPT_ADVISED):
        found |= {name: bank.path for name, bank in (banks(path) if path else banks()).items()}
    return found


#: The ways that the tables have, in the order in which they are flown.
SHOWN = [
    RAW,
    "sod/numbered",
    "sod",
    "250 samples/s behind 160 Hz",
    "sod/numbered-unfiltered",
    "125 samples/s behind 80 Hz",
    "dead band x 2 behind 200 Hz",
    "dead band x 2 behind 80 Hz",
    "sod/numbered-cascade",
    "sod/numbered-fine",
    "sod/numbered-blind",
    "dead band behind 80 Hz",
]


def eager(control: Control, gain: float) -> Control:
    """The controller with the accelerations that it asks for multiplied."""
    if gain != 1:
        wishes = control._wishes
        control._wishes = lambda rates, turns: [np.float32(gain) * wish for wish in wishes(rates, turns)]
    return control


def flown(make: Callable[[int], Way], condition: Condition, place: tuple[str, str, int], number: int) -> Flight:
    """A flight of a condition at a place, by its number, with the seed that `table.py` has for the same."""
    name, controller, rate = place
    world = WORLDS[name]
    round_, which = divmod(number, len(condition.flights))
    manoeuvre = condition.flights[which]
    drawn = condition.seeds[round_] * 100 + (ALL + MINUTES).index(manoeuvre)
    way = Over(make(rate), condition.line, rate, drawn)
    control = eager(CONTROLLERS[controller](rate, world.drone), condition.gain)
    return fly(manoeuvre, way, drawn, control=control, world=world, vibration=condition.level, rate=rate)


def flights(make: Callable[[int], Way], condition: Condition, place: tuple[str, str, int]) -> Iterator[Flight]:
    """All flights of a condition at a place."""
    for at in range(condition.count()):
        yield flown(make, condition, place, at)


@dataclass
class Cell:
    """What became of the flights of a condition at a place, in their order: those of the first seed come first."""

    #: Degrees; `None` if the flight was lost.
    errors: list[float | None] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    bytes: list[float] = field(default_factory=list)

    def add(self, flight: Flight) -> None:
        """Adds a flight."""
        self.errors.append(None if flight.lost else round(float(flight.errors.mean()), 3))
        self.seconds.append(round(flight.seconds, 3))
        self.bytes.append(round(flight.bytes, 1))

    def lost(self) -> int:
        """How many were lost."""
        return self.errors.count(None)

    def first(self) -> float | None:
        """After how many seconds the first of them was lost."""
        return min((own for own, error in zip(self.seconds, self.errors) if error is None), default=None)


#: What was flown, by way, condition and place.
Kept = dict[str, dict[str, dict[str, Cell]]]


def read() -> Kept:
    """What was kept."""
    if not KEPT.exists():
        return {}
    found = json.loads(KEPT.read_text())
    return {
        name: {condition: {place: Cell(**cell) for place, cell in cells.items()} for condition, cells in own.items()}
        for name, own in found.items()
    }


def keep(kept: Kept) -> None:
    """Writes what was flown. Cells in which another process has flown more stay as they are."""
    for name, own in read().items():
        for condition, cells in own.items():
            mine = kept.setdefault(name, {}).setdefault(condition, {})
            for place, cell in cells.items():
                if place not in mine or len(mine[place].errors) < len(cell.errors):
                    mine[place] = cell
    KEPT.write_text(written(kept))


def written(kept: Kept) -> str:
    """What was flown as it is kept, a condition a line."""
    ways = []
    for name, own in kept.items():
        lines = [f'    "{condition}": {json.dumps({place: vars(cell) for place, cell in cells.items()})}' for condition, cells in own.items()]
        ways.append(f'  "{name}": {{\n' + ",\n".join(lines) + "\n  }")
    return "{\n" + ",\n".join(ways) + "\n}\n"


def fly_all(kept: Kept, names: list[str], conditions: list[Condition]) -> None:
    """Flies what is missing of these ways in these conditions, and keeps each flight; all ways fly a seed before the next."""
    known = ways()
    for condition in conditions:
        for round_ in range(1, len(condition.seeds) + 1):
            for name in names:
                cells = kept.setdefault(name, {}).setdefault(condition.name, {})
                for place in condition.places:
                    cell = cells.setdefault(key(place), Cell())
                    while len(cell.errors) < round_ * len(condition.flights):
                        cell.add(flown(known[name], condition, place, len(cell.errors)))
                        keep(kept)
                counts = [f"{cell.lost()} of {len(cell.errors)}" for cell in cells.values()]
                print(name, condition.name, *counts, file=sys.stderr, flush=True)


#: The quantities of a margin: a condition with this value of each, and the range in which it is looked for.
MARGINS: dict[str, tuple[Callable[[float], Condition], float, float]] = {
    "frames lost, share": (lambda value: Condition("", LINES, Line(loss=value), seeds=(1, 2)), 0.0, 0.9),
    "bursts of 1 %, s": (lambda value: Condition("", LINES, Line(loss=0.01, burst=value), seeds=(1, 2)), 0.002, 1.0),
    "delay, s": (lambda value: Condition("", LINES, replace(CHANCE, delay=value), seeds=(1, 2)), 0.0, 0.05),
    "vibration, rad/s": (lambda value: Condition("", LINES, level=value / 0.15 * LEVEL, seeds=(1, 2)), 0.0, 3.0),
    "gain": (lambda value: Condition("", LINES, gain=value, seeds=(1, 2)), 1.0, 4.0),
}


def margin(make: Callable[[int], Way], quantity: str, place: tuple[str, str, int], steps: int = 5) -> float | None:
    """The least value found at which the first of ten flights is lost, by bisection; `None` if none is at the largest."""
    condition, low, high = MARGINS[quantity]
    if not any(flight.lost for flight in flights(make, condition(high), place)):
        return None
    for _ in range(steps):
        middle = (low + high) / 2
        if any(flight.lost for flight in flights(make, condition(middle), place)):
            high = middle
        else:
            low = middle
    return high


def error(cell: Cell) -> float | None:
    """The mean error of the flights that were not lost."""
    errors = [own for own in cell.errors if own is not None]
    return float(np.mean(errors)) if errors else None


def beside(cells: dict[str, Cell], raw: dict[str, Cell]) -> float | None:
    """The mean over places of the ratio of the error to that of raw samples, on the flights that neither lost."""
    ratios = []
    for place, cell in cells.items():
        pairs = list(zip(cell.errors, raw[place].errors if place in raw else []))
        both = [(own, other) for own, other in pairs if own is not None and other is not None]
        if both:
            ratios.append(sum(own for own, _ in both) / sum(other for _, other in both))
    return float(np.mean(ratios)) if ratios else None


def lost(cells: dict[str, Cell] | None) -> str:
    """How many flights of all were lost."""
    if not cells:
        return "–"
    return f"{sum(cell.lost() for cell in cells.values())} of {sum(len(cell.errors) for cell in cells.values())}"


def is_whole(condition: Condition, cells: dict[str, Cell]) -> bool:
    """Whether all of its flights were flown."""
    return len(cells) == len(condition.places) and all(len(cell.errors) == condition.count() for cell in cells.values())


def verdict(own: dict, raw: dict) -> str:
    """Whether a way flies: in no condition does it lose more flights than raw samples, or stray over `WITHIN` times as far."""
    bad, missing = [], False
    for condition in CONDITIONS:
        cells, others = own.get(condition.name, {}), raw.get(condition.name, {})
        if not cells or not others:
            missing = True
            continue
        more = any(cell.lost() > others[place].lost() for place, cell in cells.items() if place in others)
        ratio = beside(cells, others)
        if more or ratio is None or ratio > WITHIN:
            bad.append(condition.name)
        missing |= not is_whole(condition, cells)
    if bad:
        return "not: " + ", ".join(bad)
    return "not flown everywhere" if missing else "**yes**"


def label(name: str) -> str:
    """A way's name in the tables."""
    return {
        RAW: "raw samples",
        "sod": "`sod` behind 80 Hz, without step numbers",
        "sod/numbered": "**`sod` with step numbers, behind 200 Hz**",
        "sod/numbered-unfiltered": "`sod` with step numbers, without a filter",
        "sod/numbered-cascade": "`sod` with step numbers, behind 80 Hz, for the cascade",
        "sod/numbered-fine": "`sod` with step numbers, behind 80 Hz, thresholds half as large",
        "sod/numbered-blind": "`sod` with step numbers, behind 200 Hz, deaf to gravity",
    }.get(name, name)


RIVALS = """\
| what is sent | here: error, ° | bytes/s | 18 settings: lost | beside raw | Betaflight's loop: bytes/s | second world: bytes/s, most | lean raw: least share, % |
|---|---:|---:|---:|---:|---:|---:|---:|
"""
MINUTE = """\
| what is sent | flies? | Betaflight's loop, lost | first after, s | error, ° | bytes/s | elsewhere: lost | error, ° |
|---|---|---:|---:|---:|---:|---:|---:|
"""
BAD = """\
| lost | 10 % lost | 1 % in bursts of 50 ms | 2 ms late | 5 ms late | 460 800 baud | 115 200 baud | rotors of 0.5 rad/s |
|---|---:|---:|---:|---:|---:|---:|---:|
"""


def row(columns: list[str]) -> str:
    """A row of a table."""
    return "| " + " | ".join(columns) + " |\n"


def tables(kept: Kept) -> str:
    """The three tables, with a line between each two."""
    raw, rivals, minute, bad = kept[RAW], "", "", ""
    lines = [condition for condition in CONDITIONS if condition.places == LINES]
    for name in SHOWN:
        own = kept.get(name, {})
        here, everywhere = own.get("here", {}).get(key(HERE)), own.get("everywhere", {})
        if here:
            second = [np.mean(cell.bytes) for place, cell in everywhere.items() if "drone-models" in place and place.endswith(" 500")]
            plain = raw.get("everywhere", {})
            shares = [100 * np.mean(cell.bytes) / np.mean(plain[place].bytes) for place, cell in everywhere.items() if place in plain]
            betaflights = everywhere.get(key(BETAFLIGHT))
            rivals += row([
                label(name),
                number(error(here), 2) + (f", {here.lost()} lost" if here.lost() else ""),
                number(np.mean(here.bytes)),
                lost(everywhere),
                number(beside(everywhere, plain), 2),
                number(betaflights and np.mean(betaflights.bytes)),
                number(max(second, default=None)),
                f"{number(min(shares))}–{number(max(shares))}" if shares else "–",
            ])
        cell = own.get("60 s on Betaflight's loop", {}).get(key(BETAFLIGHT))
        others = own.get("60 s elsewhere", {})
        if cell:
            errors = [error(one) for one in others.values() if error(one) is not None]
            minute += row([
                label(name),
                verdict(own, raw),
                f"{cell.lost()} of {len(cell.errors)}",
                number(cell.first(), 1),
                number(error(cell), 2),
                number(np.mean(cell.bytes)),
                lost(others),
                number(float(np.mean(errors)) if errors else None, 2),
            ])
        if any(own.get(condition.name) for condition in lines):
            bad += row([label(name), *(lost(own.get(condition.name)) for condition in lines)])
    return "\n".join((RIVALS + rivals, MINUTE + minute, BAD + bad))


def main(arguments: list[str]) -> None:
    options = {own for own in arguments if own.startswith("--")}
    names = [own for own in arguments if own not in options]
    if "--list" in options:
        print("\n".join(ways()))
        return
    if "--margin" in options:
        known = ways()
        for name in names:
            for quantity in MARGINS:
                values = [number(margin(known[name], quantity, place), 3) for place in LINES]
                print(row([name, quantity, *values]), end="", flush=True)
        return
    kept = read()
    if "--check" in options:
        for name in names:
            again = Cell()
            for flight in flights(ways()[name], CONDITIONS[0], HERE):
                again.add(flight)
            if again != kept[name]["here"][key(HERE)]:
                raise SystemExit(f"{name} flies otherwise than {KEPT.name} has it: {again}")
        return
    if "--print" not in options:
        if names or "--anew" in options:
            dropped = names or list(kept)
            KEPT.write_text(written({name: own for name, own in kept.items() if name not in dropped}))
            kept = read()
        fly_all(kept, names or SHOWN, CONDITIONS)
    print(tables(kept), end="")


if __name__ == "__main__":
    main(sys.argv[1:])
