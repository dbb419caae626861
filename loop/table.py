"""The table: every code flown through every manoeuvre, with its seeds, by itself and with keyframes and lost frames.

`table.py [CODE]...` prints the rows of these codes, or the whole table.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass

import numpy as np
import spikewire as sw

from codes import KEYFRAME_EVERY, NEVER, Coded, instructions, schemes
from flight import Registers, fly
from manoeuvres import ALL

#: How a code is flown: samples from keyframe to keyframe, the share of lost frames, and the seeds. First by itself.
WAYS = [(NEVER, 0.0, (1, 2)), (KEYFRAME_EVERY, 0.0, (1,)), (KEYFRAME_EVERY, 0.01, (1,)), (KEYFRAME_EVERY, 0.1, (1,))]
#: A drone that strays so far on average, in degrees, flies loosely; without a code it is 5.5.
LOOSE = 8
CONTROL = "without a code"
HEADER = """\
| code | flies? | error, ° | worst, ° | lost, % | keyframes: error, ° | lost, % | 1 %: error | lost | 10 %: error | lost | spikes/s | bytes/s | instructions | latency |
|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|
"""


@dataclass
class Cell:
    """A code's flights, flown in one way."""

    #: The manoeuvres that were lost, one entry a flight.
    lost: list[str]
    #: The mean error over all manoeuvres that were not lost, for each seed.
    means: list[float]
    flights: int
    worst: float
    spikes: float
    bytes: float

    def share(self) -> float:
        """The share of flights lost, in percent."""
        return 100 * len(self.lost) / self.flights

    def mean(self) -> float | None:
        """The mean error, unless all flights were lost."""
        means = [own for own in self.means if own == own]
        return float(np.mean(means)) if means else None


def cell(name: str, keyframe_every: int, loss: float, seeds: tuple[int, ...]) -> Cell:
    """Flies a code in one way."""
    own = None if name == CONTROL else schemes(name)
    lost, means, worst, spikes, size = [], [], 0.0, [], []
    for seed in seeds:
        errors = []
        for place, manoeuvre in enumerate(ALL):
            path = Registers() if own is None else Coded(own, keyframe_every)
            flight = fly(manoeuvre, path, seed * 100 + place, loss)
            if flight.lost:
                lost.append(manoeuvre.name)
            else:
                errors.append(float(flight.errors.mean()))
                worst = max(worst, float(flight.errors.max()))
            spikes.append(flight.spikes)
            size.append(flight.bytes)
        means.append(float(np.mean(errors)) if errors else float("nan"))
    return Cell(lost, means, len(spikes), worst, float(np.mean(spikes)), float(np.mean(size)))


def verdict(alone: Cell, anchored: Cell) -> str:
    """Whether it flies by itself, and else whether keyframes help."""
    if not alone.lost:
        return "yes" if alone.mean() < LOOSE else "loosely"
    names = [own.name for own in ALL]
    shown = sorted(set(alone.lost), key=names.index)
    if len(shown) <= 3:
        return "not: " + ", ".join(shown)
    return "on keyframes" if not anchored.lost else "**no**"


def number(value: float | None, digits: int = 1) -> str:
    """A figure, or a dash where there is none."""
    return "–" if value is None else f"{value:,.{digits}f}".replace(",", " ")


def row(name: str) -> tuple[tuple, str]:
    """The row of a code, and what rows are sorted by."""
    cells = [cell(name, *way) for way in WAYS]
    whole = cells[0]
    known = [own for own in whole.means if own == own]
    spread = f" ± {max(known) - min(known):.1f}" if len(known) == len(whole.means) else ""
    own = None if name == CONTROL else schemes(name)
    latency = 0 if own is None else max(scheme._coder.latency() for scheme in own)
    columns = [
        CONTROL if own is None else f"`{name}`",
        verdict(whole, cells[1]),
        number(whole.mean()) + spread,
        number(whole.worst or None, 0),
        number(whole.share(), 0),
        *[text for each in cells[1:] for text in (number(each.mean()), number(each.share(), 0))],
        number(whole.spikes, 0),
        number(whole.bytes, 0),
        "0" if own is None else number(instructions(name), 0),
        str(latency),
    ]
    key = (own is not None, whole.share(), whole.mean() if whole.mean() is not None else 1e9)
    return key, "| " + " | ".join(columns) + " |\n"


def main() -> None:
    rows = []
    for name in sys.argv[1:] or [CONTROL, *sw.schemes]:
        rows.append(row(name))
        print(rows[-1][1], end="", file=sys.stderr, flush=True)
    print(HEADER + "".join(text for _, text in sorted(rows)), end="")


if __name__ == "__main__":
    main()
