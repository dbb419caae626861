"""The tables of `docs/loop.md`, and `verdicts.json`, which they are printed from.

`table.py` flies everything and prints the tables; `table.py CODE...` flies these codes anew and prints them;
`table.py --print` prints what `verdicts.json` holds; `table.py --filters CODE` flies and prints a row of the second table,
`table.py --third CODE` one of the third.
`--no-vibration` flies and prints these codes on a drone whose rotors do not shake it, and keeps nothing.
"""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import spikewire as sw

from advised import KEPT_ADVISED
from banks import LEVEL, LOSS, Bank, banks, unfiltered
from brushless import Brushless
from codes import instructions
from controllers import CONTROLLERS
from flight import LowPass, Registers, fly
from manoeuvres import ALL
from third import Third
from world import World

VERDICTS = Path(__file__).with_name("verdicts.json")
CONTROL = "without a code"
#: Worlds, and rates in samples a second, in which a code must hold.
WORLDS = {"RotorPy": World, "drone-models": Brushless, "MuJoCo": Third}
RATES = (250, 500, 1000)


def settings(*worlds: str) -> list[tuple[str, str, int]]:
    """All controllers and rates in these worlds."""
    return [(world, control, rate) for world in worlds for control in CONTROLLERS for rate in RATES]


EVERYWHERE = settings("RotorPy", "drone-models")
HERE = ("RotorPy", "cascade", 500)
#: The manoeuvres of the flights everywhere, and of the second table.
SHORT = [own for own in ALL if own.name in ("hover", "steps of 30°", "eight", "motor 10 % weak", "flip")]
#: The largest mean error over that without a code at which a code flies; beyond it, it flies loosely.
WITHIN = 1.2


def cell(make, where=HERE, loss: float = LOSS, level: float = LEVEL, seeds: tuple[int, ...] = (1,), flights=ALL) -> dict:
    """Flies manoeuvres in one way: what was lost, and means over all flights."""
    world, controller, rate = WORLDS[where[0]], CONTROLLERS[where[1]], where[2]
    lost, errors, flown = [], [], []
    for seed in seeds:
        for manoeuvre in flights:
            control = controller(rate, world.drone)
            drawn = seed * 100 + ALL.index(manoeuvre)
            own = fly(manoeuvre, make(rate), drawn, loss, False, control, world, level, rate)
            flown.append(own)
            if own.lost:
                lost.append(manoeuvre.name)
            else:
                errors.append(float(own.errors.mean()))
    return {
        "lost": lost,
        "flights": len(flown),
        "error": float(np.mean(errors)) if errors else None,
        "spikes": float(np.mean([own.spikes for own in flown])),
    }


def registers(low_pass: float | None):
    """A way without a code."""
    return lambda rate: Registers(low_pass and LowPass(low_pass, rate))


def filtered(name: str) -> dict:
    """A code as tuned on its error: on a still drone, and on one that vibrates behind each filter."""
    cells = {}
    for key, low_pass, level in (("still", None, 0.0), ("none", None, LEVEL), ("80", 80, LEVEL), ("40", 40, LEVEL)):
        if name == CONTROL:
            make = registers(low_pass)
        else:
            make = replace(unfiltered(name), low_pass=low_pass).path
        cells[key] = cell(make, level=level, flights=SHORT)
    return cells


def flown(name: str, bank: Bank | None) -> dict:
    """A code, or none, with its bank: here, with every tenth frame lost, on a still drone, and everywhere."""
    make = bank.path if bank else registers(None)
    own: dict = {"low_pass": bank and bank.low_pass, "keyframe_ms": bank and bank.keyframe_ms}
    if bank:
        delay = 1000 * sw.Filter.low_pass(bank.low_pass, 500).delay / 500 if bank.low_pass else 0.0
        schemes = bank.schemes()
        late = max(scheme._coder.latency() for scheme in schemes)
        own |= {"filter_delay_ms": round(delay, 1), "latency_samples": late, "instructions": instructions(bank.name)}
        if bank.name == "sf":
            # A threshold a sample is the most that it climbs: rad/s² at 500 samples a second.
            own["slope_at_500_hz"] = 500 * bank.groups[0]["threshold"]
    own["here"] = cell(make, seeds=(1, 2))
    own["every tenth frame lost"] = cell(make, loss=0.1)
    own["still"] = cell(make, level=0.0)
    own["everywhere"] = {key(where): cell(make, where, flights=SHORT) for where in EVERYWHERE}
    return own


def third(bank: Bank | None) -> dict:
    """A code, or none, with its bank, in the third world."""
    make = bank.path if bank else registers(None)
    here = cell(make, ("MuJoCo", *HERE[1:]), seeds=(1, 2))
    return {"here": here, "everywhere": {key(where): cell(make, where, flights=SHORT) for where in settings("MuJoCo")}}


def key(where: tuple[str, str, int]) -> str:
    """World, controller and rate as one word."""
    return " ".join(map(str, where))


def verdict(own: dict, control: dict) -> str:
    """The verdict on a code: yes, loosely, or the places where it loses flights."""
    cells = own["everywhere"]
    lost = [where for where, cell in cells.items() if cell["lost"]]
    if not lost and not own["here"]["lost"]:
        return "**yes**" if far(own, control) <= WITHIN else "loosely"
    if not own["here"]["lost"] and all("Betaflight" in where for where in lost):
        return "not: Betaflight"
    return f"not in {len(lost)} of {len(cells)}" if len(lost) < len(cells) else "**no**"


def far(own: dict, control: dict) -> float:
    """The error over that without a code: the mean over all places where a flight was not lost."""
    pairs = [(cell["error"], control["everywhere"][where]["error"]) for where, cell in own["everywhere"].items()]
    return float(np.mean([one / other for one, other in pairs if one is not None]))


def number(value: float | None, digits: int = 0) -> str:
    """A figure, or a dash where there is none."""
    return "–" if value is None else f"{value:,.{digits}f}".replace(",", " ")


FLOWN = """\
| code | 4 s | low-pass, Hz | keyframes, ms | error, ° | spikes/s | everywhere: beside none | lost, % |
|---|---|---:|---:|---:|---:|---:|---:|
"""
FILTERED = """\
| code | error, °, and lost: still | vibration | behind 80 Hz | behind 40 Hz | spikes/s: vibration | behind 80 Hz | behind 40 Hz |
|---|---:|---:|---:|---:|---:|---:|---:|
"""


#: Which bank of a code it is: what stands behind the slash of its name.
WHICH = {
    "cascade": ", for the cascade",
    "hexarotor": ", as `advise` takes it from the hexarotor's log",
    "own": ", as `advise` takes it from this drone's log",
}

THIRD = """\
| code | 4 s | error, °: RotorPy | MuJoCo | lost: RotorPy | MuJoCo | ratios of error |
|---|---|---:|---:|---:|---:|---:|
"""


def label(name: str) -> str:
    """A bank's name in the tables."""
    code, _, which = name.partition("/")
    return name if name == CONTROL else f"`{code}`" + WHICH.get(which, "")


def flown_row(name: str, own: dict, control: dict) -> tuple:
    """A row of the first table, and what rows are sorted by."""
    here, everywhere = own["here"], own["everywhere"].values()
    lost = sum(len(cell["lost"]) for cell in everywhere) / sum(cell["flights"] for cell in everywhere)
    is_code = name != CONTROL
    columns = [
        label(name),
        verdict(own, control),
        number(own["low_pass"]) if is_code else "–",
        number(own["keyframe_ms"]) if is_code else "–",
        number(here["error"], 1),
        number(here["spikes"]) if is_code else "–",
        number(far(own, control), 2) if any(cell["error"] is not None for cell in everywhere) else "–",
        number(100 * lost, 1),
    ]
    return (is_code, lost > 0, lost, here["spikes"]), "| " + " | ".join(columns) + " |\n"


def filtered_row(name: str, own: dict) -> str:
    """A row of the second table."""
    columns = [label(name)]
    columns += [f"{number(own[way]['error'], 1)}, {len(own[way]['lost'])}" for way in ("still", "none", "80", "40")]
    columns += [number(own[way]["spikes"]) if name != CONTROL else "–" for way in ("none", "80", "40")]
    return "| " + " | ".join(columns) + " |\n"


def is_held(own: dict | None) -> bool:
    """Whether a code loses no flight behind one of the filters."""
    return own is not None and not all(own[corner]["lost"] for corner in ("80", "40"))


def third_row(name: str, own: dict, flown: dict, thirds: dict) -> str:
    """A row of the third table: the verdict with MuJoCo's flights, and RotorPy's flights beside MuJoCo's."""
    theirs = in_rotorpy(flown[name])
    columns = [label(name), verdicts(name, own, flown, thirds)[1]]
    columns += [number(theirs["here"]["error"], 1), number(own["here"]["error"], 1), crashes(theirs), crashes(own)]
    ratios = compared(theirs, own, "error")
    columns.append(f"{min(ratios):.2f}–{max(ratios):.2f}" if ratios else "–")
    return "| " + " | ".join(columns) + " |\n"


def verdicts(name: str, own: dict, flown: dict, thirds: dict) -> tuple[str, str]:
    """The first table's verdict on a code, and the same with MuJoCo's flights in the place of RotorPy's."""

    def moved(third: dict, first: dict) -> dict:
        others = {where: cell for where, cell in first["everywhere"].items() if "RotorPy" not in where}
        return third | {"everywhere": third["everywhere"] | others}

    control = moved(thirds[CONTROL], flown[CONTROL])
    return verdict(flown[name], flown[CONTROL]), verdict(moved(own, flown[name]), control)


def in_rotorpy(own: dict) -> dict:
    """What was flown in RotorPy's world, with keys as of MuJoCo's."""
    cells = {key_.replace("RotorPy", "MuJoCo"): cell for key_, cell in own["everywhere"].items() if "RotorPy" in key_}
    return {"here": own["here"], "everywhere": cells}


def crashes(own: dict) -> str:
    """How many flights of all were lost."""
    cells = [own["here"], *own["everywhere"].values()]
    return f"{sum(len(cell['lost']) for cell in cells)} of {sum(cell['flights'] for cell in cells)}"


def compared(one: dict, other: dict, figure: str) -> list[float]:
    """The ratio of a figure in the other world to that in the one, in each setting in which neither lost a flight."""
    cells = [(one["here"], other["here"])]
    cells += [(cell, other["everywhere"][where]) for where, cell in one["everywhere"].items()]
    pairs = [(own[figure], theirs[figure]) for own, theirs in cells if not own["lost"] and not theirs["lost"]]
    return [one / other for other, one in pairs if other]


def rounded(own):
    """Figures as they are kept."""
    if isinstance(own, dict):
        return {key: rounded(value) for key, value in own.items()}
    return round(own, 3) if isinstance(own, float) else own


def keep(kept: dict) -> None:
    """Writes what was flown, a code a line."""
    parts = []
    for kind, rows in kept.items():
        lines = ",\n".join(f'  "{name}": {json.dumps(rounded(own))}' for name, own in rows.items())
        parts.append(f'"{kind}": {{\n{lines}\n}}')
    VERDICTS.write_text("{\n" + ",\n".join(parts) + "\n}\n")


def printed(kept: dict) -> str:
    """The three tables, with a line between each two."""
    control = kept["banks"][CONTROL]
    rows = sorted((*flown_row(name, own, control), name) for name, own in kept["banks"].items())
    order = [CONTROL, *sw.schemes]
    others = [filtered_row(name, kept["filters"][name]) for name in order if is_held(kept["filters"].get(name))]
    thirds = [third_row(name, kept["third"][name], kept["banks"], kept["third"]) for *_, name in rows if name in kept["third"]]
    tables = (FLOWN, [text for _, text, _ in rows]), (FILTERED, others), (THIRD, thirds)
    return "\n".join(head + "".join(rows) for head, rows in tables)


def main(arguments: list[str]) -> None:
    options = {own for own in arguments if own.startswith("--")}
    names = [own for own in arguments if own not in options]
    if "--filters" in options:
        for name in names:
            print(filtered_row(name, rounded(filtered(name))), end="")
        return
    found = banks()
    all_banks = found | banks(KEPT_ADVISED)
    kept = json.loads(VERDICTS.read_text()) if VERDICTS.exists() else {}
    if "--third" in options:
        for name in names:
            print(third_row(name, rounded(third(found[name] if name != CONTROL else None)), kept["banks"], kept["third"]), end="")
        return
    if "--no-vibration" in options:
        for name in names or all_banks:
            print(name, json.dumps(rounded(cell(all_banks[name].path, level=0.0))), flush=True)
        return
    whole = [CONTROL, *all_banks, *(name for name in sw.schemes if name not in all_banks)]
    kept = {kind: kept.get(kind, {}) for kind in ("banks", "filters", "third")}
    for kind, rows in kept.items():  # what is flown no longer goes
        kept[kind] = {name: own for name, own in rows.items() if name in whole}
    for name in [] if "--print" in options else names or whole:
        if name == CONTROL or name in all_banks:
            kept["banks"][name] = flown(name, all_banks.get(name))
        if name == CONTROL or name in found:
            kept["third"][name] = third(found.get(name))
        if "/" not in name:
            kept["filters"][name] = filtered(name)
        keep(kept)
        print(name, "flown", file=sys.stderr, flush=True)
    print(printed(json.loads(VERDICTS.read_text())), end="")


if __name__ == "__main__":
    main(sys.argv[1:])
