"""Draws a code that crashes beside one that flies, on the same vibrating drone: an SVG that moves. `crash.py FILE`."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from banks import LEVEL, LOSS, banks, unfiltered
from codes import NEVER, Coded
from flight import Flight, fly
from manoeuvres import ALL, eight
from picture import DECODED, DOWN, SIGNAL, UP

#: The code that crashes, as tuned on its error and with no keyframe after the first; and the one that flies, by its bank.
CRASHES, FLIES = "tbr", "sod"
WIDTH, HEIGHT, PANEL = 900, 435, 430
#: Pixels a metre, and the middle of a panel's trajectory.
SCALE, ACROSS, DOWNWARDS = 170, 215, 145
SEED = 105
SLOW = 2


def seen(place) -> tuple[float, float]:
    """Projects a place in the world onto a panel, seen from above and behind."""
    x, y, z = place
    return ACROSS + SCALE * (x + 0.25 * y), DOWNWARDS - SCALE * (0.45 * y + 0.9 * z)


def line(points, colour: str, width: float, more: str = "") -> str:
    """A curve through points."""
    joined = " ".join(f"{x:.0f},{y:.1f}" for x, y in points)
    return f'<polyline points="{joined}" fill="none" stroke="{colour}" stroke-width="{width}"{more}/>'


def panel(left: float, flight: Flight, seconds: float, title: str, end: str) -> list[str]:
    """A flight's trajectory, roll rate and spikes."""
    states = np.array([shown[5] for shown in flight.trace])
    times = np.array([shown[0] for shown in flight.trace])
    wanted = [seen(eight(time)[0]) for time in np.arange(0, seconds, 0.02)]
    flown = [seen(own[:3]) for own in states[::8]]
    count = round(seconds * len(times) / times[-1] / 8) if len(times) else 1
    held = ";".join(f"{x:.0f} {y:.0f}" for x, y in (flown + [flown[-1]] * max(0, count - len(flown)))[::2])
    last = flown[-1]
    parts = [
        f'<g transform="translate({left} 0)"><text x="10" y="26" font-size="17">{title}</text>',
        line(wanted, "#ccc", 5),
        line(flown, DECODED, 1.8),
        f'<circle r="7" fill="{UP}" transform="translate({last[0]:.0f} {last[1]:.0f})"><animateTransform attributeName="transform" type="translate" dur="{SLOW * seconds}s" '
        f'repeatCount="indefinite" values="{held}"/></circle>',
    ]
    if flight.lost:
        x, y = min(max(last[0], 20), PANEL - 20), min(max(last[1], 45), 240)
        parts.append(f'<path d="M{x - 9:.0f} {y - 9:.0f}l18 18m0-18l-18 18" stroke="{DOWN}" stroke-width="3"/>')
    truth = np.array([shown[2][0] for shown in flight.trace])[::4]
    heard = np.array([shown[3][0] for shown in flight.trace])[::4]
    at = [10 + (PANEL - 30) * time / seconds for time in times[::4]]

    def height(value: float) -> float:
        return 325 - 50 * min(max(value / 6, -1), 1)

    parts.append(f'<text x="10" y="262" font-size="13">roll rate, ±6 rad/s: <tspan fill="{SIGNAL}">sensor</tspan>, ')
    parts.append(f'<tspan fill="{DECODED}">from spikes</tspan></text>')
    parts.append(line(zip(at, map(height, truth)), SIGNAL, 2))
    parts.append(line(zip(at, map(height, heard)), DECODED, 1.4))
    # A stroke says how many spikes there were in 20 ms.
    ups, downs = np.zeros(int(seconds * 50) + 1), np.zeros(int(seconds * 50) + 1)
    for time, shown in zip(times, flight.trace):
        for address, up in shown[6]:
            if address == 0:
                (ups if up else downs)[int(time * 50)] += 1
    for counts, way, colour in ((ups, -1, UP), (downs, 1, DOWN)):
        strokes = "".join(
            f"M{10 + (PANEL - 30) * number / 50 / seconds:.0f} 397v{way * min(3 * count, 18):.0f}"
            for number, count in enumerate(counts)
            if count
        )
        parts.append(f'<path d="{strokes or "M0 0"}" stroke="{colour}" stroke-width="1.5"/>')
    parts.append(f'<text x="10" y="{HEIGHT - 4}" font-size="13">{end}</text></g>')
    return parts


def draw() -> str:
    """Both flights."""
    manoeuvre = next(own for own in ALL if own.name == "eight")
    bank = banks()[FLIES]
    ways = [
        (CRASHES, Coded(unfiltered(CRASHES).schemes(), NEVER), "by itself"),
        (FLIES, bank.path(500), f"behind a low-pass of {bank.low_pass} Hz, with keyframes"),
    ]
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="14">',
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
    ]
    for number, (name, path, words) in enumerate(ways):
        flight = fly(manoeuvre, path, SEED, LOSS, trace=True, vibration=LEVEL)
        end = f"lost after {flight.seconds:.1f} s" if flight.lost else f"flies, {flight.errors.mean():.1f}° of error"
        end += f", {flight.spikes:.0f} spikes and {flight.bytes:.0f} bytes a second"
        parts += panel(10 + 450 * number, flight, manoeuvre.seconds, f"{name}, {words}", end)
        print(f"{name}: {end}")
    return "\n".join([*parts, "</svg>"]) + "\n"


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(draw())
