"""Draws an eight that is flown by the network on the chip, with the spikes of all its neurons: `chip_picture.py FILE`.

The network is the graph in whole numbers, whose spikes `chip.py` compares with the chip's.
"""

from __future__ import annotations

import sys
from math import atan2, pi
from pathlib import Path

import numpy as np

from attitude import DIGITS
from banks import LEVEL
from chip import Held, Network, Plain
from crash import PANEL, SEED, SLOW, line, seen
from flight import Registers, fly
from manoeuvres import ALL, eight
from picture import DECODED, DOWN, SIGNAL, UP

WIDTH, HEIGHT, LEFT, TOP = 900, 435, 460, 40
#: Seconds of a column of the raster.
COLUMN = 0.02


def roll(w: float, x: float, y: float, z: float) -> float:
    """Degrees."""
    return atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)) * 180 / pi


def draw() -> str:
    """The picture."""
    manoeuvre = next(own for own in ALL if own.name == "eight")
    held = Held(Plain(Network()))
    flight = fly(manoeuvre, Registers(), SEED, control=held, vibration=LEVEL, trace=True)
    states = np.array([shown[5] for shown in flight.trace])
    fired = np.array(held.fired)
    seconds, neurons = manoeuvre.seconds, fired.shape[1]

    places = [seen(own[:3]) for own in states[::8]]
    moves = ";".join(f"{x:.0f} {y:.0f}" for x, y in places[::2])
    timing = f'dur="{SLOW * seconds}s" repeatCount="indefinite"'
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="13">',
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
        f'<text x="20" y="26" font-size="17">An eight flown by {neurons} neurons of tinyODIN: {flight.errors.mean():.1f}° of error</text>',
        f'<g transform="translate(10 15)">{line([seen(eight(time)[0]) for time in np.arange(0, seconds, 0.02)], "#ccc", 5)}',
        line(places, DECODED, 1.8),
        f'<circle r="7" fill="{UP}"><animateTransform attributeName="transform" type="translate" values="{moves}" {timing}/></circle></g>',
        f'<text x="20" y="292">roll, ±25°: <tspan fill="{SIGNAL}">wanted</tspan>, <tspan fill="{DECODED}">true</tspan></text>',
    ]
    wanted = [roll(*shown[4]) for shown in flight.trace]
    true = [roll(own[9], *own[6:9]) for own in states]
    for angles, colour, width in ((wanted, SIGNAL, 3), (true, DECODED, 1.4)):
        points = ((20 + (PANEL - 30) * number / len(angles), 360 - 2.2 * angles[number]) for number in range(0, len(angles), 4))
        parts.append(line(points, colour, width))

    # The neurons of each number stand together, the highest digit on top; the relays, the outputs of rates, below.
    groups, first = [], 1
    for name, digits in zip(("roll", "pitch", "yaw"), DIGITS):
        groups.append((f"{name} that is left", range(first, first + 8 * digits)))
        first += 8 * digits
    groups.append(("relays", [0, *range(first, neurons)]))
    across, y = (WIDTH - LEFT - 20) / seconds, TOP
    bins = round(COLUMN * len(fired) / seconds)
    active = np.add.reduceat(fired, range(0, len(fired), bins)) > 0
    row = (HEIGHT - 15 - TOP - 20 * len(groups)) / np.count_nonzero(active.any(axis=0))
    for (name, members), colour in zip(groups, (UP, DECODED, "#009e73", DOWN)):
        strokes = []
        parts.append(f'<text x="{LEFT}" y="{y + 12}">{name}</text>')
        y += 17
        for member in reversed(members):
            at = np.flatnonzero(active[:, member])
            strokes += [f"M{LEFT + across * COLUMN * column:.0f} {y:.1f}h4" for column in at]
            y += row * bool(len(at))
        parts.append(f'<path d="{"".join(strokes)}" stroke="{colour}" stroke-width="1.6"/>')
        y += 3
    parts.append(
        f'<path d="M{LEFT} {TOP}V{HEIGHT - 12}" stroke="{DOWN}"><animateTransform attributeName="transform" type="translate" '
        f'from="0 0" to="{WIDTH - LEFT - 20} 0" {timing}/></path>'
    )
    spikes = fired.sum() / seconds
    parts.append(f'<text x="20" y="{HEIGHT - 6}">{sum(held.heard) / seconds:.0f} events in, {spikes:.0f} spikes a second</text></svg>')
    return "\n".join(parts) + "\n"


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(draw())
