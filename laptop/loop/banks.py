"""Banks for a drone whose rotors turn: filter, keyframes and parameters of each code, found by flying.

`banks.py [CODE]...` flies each code behind a filter and with keyframes, on a drone that vibrates and over a link that loses
1 % of the frames, and looks for the fewest bytes a second: keyframes are in them. A bank must lose no flight, and stray no
more than `WITHIN` times as far as a drone without a code. What was found is kept in `banks.json`.

It flies what the table does not: the lesson on the cascade, manoeuvres at random and a circle on Betaflight's loop, at 250
and 500 samples a second in RotorPy's world. The LQR, 1000 samples a second and the other world are left for the table. It
climbs: one thing is changed at a time, and kept if it helps.
"""

from __future__ import annotations

import json
import sys
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
import spikewire as sw

from codes import CHANCE, GROUPS, KEPT, Coded
from control import Control
from controllers import Betaflight
from flight import Registers, fly
from manoeuvres import LESSON, Manoeuvre, at_random, circle

KEPT_BANKS = Path(__file__).with_name("banks.json")
#: The link's loss and the vibration's level.
LOSS, LEVEL = 0.01, 1.0
#: The largest error that a bank may have, over that without a code.
WITHIN = 1.1
CIRCLE = Manoeuvre("circle", 4, path=circle)
#: Manoeuvre, controller, seed and rate of what is flown.
COURSE = [
    (LESSON, Control, 5000, 250),
    (at_random(101), Betaflight, 5001, 250),
    (CIRCLE, Betaflight, 5003, 500),
]
#: The ending of banks that are found on the cascade alone.
CASCADE = "/cascade"
LOW_PASSES = [None, 80, 60, 40, 30]
#: Milliseconds from keyframe to keyframe.
KEYFRAMES = [20, 40, 100, 200, 400]
#: Parameters that the search scales; codes without them have the width of their range scaled.
THRESHOLDS = ("threshold", "step")
#: Banks flown for a code.
FLOWN = 50


@dataclass(frozen=True)
class Bank:
    """A code as it flies: the corner of a low-pass before it, Hz, its keyframes, the parameters of each group, or of
    each channel, and the bits of a step number that an event carries on the link."""

    name: str
    low_pass: float | None
    keyframe_ms: int
    groups: tuple[dict, ...]
    step_bits: int = 0

    def schemes(self) -> list[sw.Scheme]:
        """The scheme of each channel."""
        found: list = [None] * 6
        places = [channels for channels, _ in GROUPS] if len(self.groups) == 3 else [[channel] for channel in range(6)]
        for channels, parameters in zip(places, self.groups):
            given = parameters | ({"seed": 1} if self.name in CHANCE else {})
            for channel in channels:
                found[channel] = sw.schemes[self.name](**given)
        return found

    def path(self, rate: int) -> Coded:
        """The way of samples by it."""
        keyframe_every = max(1, self.keyframe_ms * rate // 1000)
        return Coded(self.schemes(), keyframe_every, self.corner(rate), rate, self.step_bits)

    def corner(self, rate: int) -> float | None:
        """The low-pass's corner at this rate: none where the rate is too low for it."""
        return self.low_pass if self.low_pass and self.low_pass < rate / 2 else None

    def scaled(self, group: int, factor: float) -> Bank:
        """With thresholds or a range of other size."""
        own = dict(self.groups[group])
        if factor == 1:
            return self
        if any(name in own for name in THRESHOLDS):
            own |= {name: own[name] * factor for name in THRESHOLDS if name in own}
        else:
            middle, half = (own["max"] + own["min"]) / 2, (own["max"] - own["min"]) / 2 * factor
            own |= {"min": middle - half, "max": middle + half}
        return replace(self, groups=tuple(own if at == group else each for at, each in enumerate(self.groups)))

    def changed(self, part: str, way: int, factor: float) -> Bank:
        """With one thing changed this way; the same where it cannot."""
        if part in ("low_pass", "keyframe_ms"):
            values = LOW_PASSES if part == "low_pass" else KEYFRAMES
            at = values.index(getattr(self, part)) + way
            return replace(self, **{part: values[at]}) if 0 <= at < len(values) else self
        return self.scaled(int(part), factor**way)


def banks(path: Path = KEPT_BANKS) -> dict[str, Bank]:
    """All that were found."""
    kept = json.loads(path.read_text()) if path.exists() else {}
    found = {}
    for name, own in kept.items():
        groups = tuple(own["groups"])
        found[name] = Bank(name.split("/")[0], own["low_pass"], own["keyframe_ms"], groups, own.get("step_bits", 0))
    return found


def written(kept: dict[str, Bank]) -> str:
    """Banks as they are kept, one a line."""
    lines = []
    for name, bank in kept.items():
        own = asdict(bank)
        own.pop("name")
        if not bank.step_bits:
            own.pop("step_bits")
        lines.append(f'  "{name}": {json.dumps(own)}')
    return "{\n" + ",\n".join(lines) + "\n}\n"


def unfiltered(name: str) -> Bank:
    """A code as it was tuned on its error, without a filter."""
    return Bank(name, None, 100, tuple(json.loads(KEPT.read_text())[name]))


def course(make, alone: bool = False) -> tuple[float, np.ndarray, float]:
    """The parts of flights that were not flown, the error of each and bytes a second of a way, by rate, over the course."""
    flights = []
    for what, control, seed, rate in COURSE:
        control = Control if alone else control
        flights.append(fly(what, make(rate), seed, LOSS, control=control(rate), vibration=LEVEL, rate=rate))
    errors = np.array([own.errors.mean() for own in flights])
    missing = sum(1 - own.seconds / what.seconds for own, (what, *_) in zip(flights, COURSE))
    return missing, errors, float(np.mean([own.bytes for own in flights]))


def worth(bank: Bank, free: np.ndarray, alone: bool) -> tuple:
    """The search's goal, smallest first: the parts of flights not flown, the error beyond `WITHIN`, the bytes a second."""
    try:
        missing, errors, size = course(bank.path, alone)
    except ValueError:  # no bank, or out of a parameter's range
        return 9, 9.0, 9.0
    return missing, max(0.0, float(np.mean(errors / free)) - WITHIN), size


def climbed(bank: Bank, alone: bool) -> Bank:
    """The best that is found by single changes, large ones first, from the best of some places."""
    free = course(lambda rate: Registers(), alone)[1]
    places = [replace(bank.scaled(0, size), low_pass=corner) for size in (1.0, 2.0, 4.0) for corner in (40, 80)]
    best, _, bank = min((worth(own, free, alone), at, own) for at, own in enumerate(places))
    flown, changes = len(places), [(part, way) for part in ("0", "1", "2", "keyframe_ms", "low_pass") for way in (1, -1)]
    for factor in (2.0, 1.4):
        still = 0
        while still < len(changes) and flown < FLOWN:
            part, way = changes[0]
            other = bank.changed(part, way, factor)
            flown += other != bank
            own = worth(other, free, alone) if other != bank else best
            if own < best:
                best, bank, still = own, other, 0
                print("  ", flown, best, bank.low_pass, bank.keyframe_ms, flush=True)
            else:
                still += 1
                changes.append(changes.pop(0))
    return bank


def main() -> None:
    kept = banks()
    for name in sys.argv[1:] or kept:
        kept[name] = climbed(unfiltered(name.removesuffix(CASCADE)), name.endswith(CASCADE))
        print(name, kept[name], flush=True)
        ordered = {name: kept[name] for one in sw.schemes for name in (one, one + CASCADE) if name in kept}
        KEPT_BANKS.write_text(written(ordered))


if __name__ == "__main__":
    main()
