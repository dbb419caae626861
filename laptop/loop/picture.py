"""Flies a flip on spikes, by a code's bank or as it is tuned on its error, and draws it: an SVG that moves. `picture.py FILE [CODE]`."""

from __future__ import annotations

import sys
from math import atan2, pi
from pathlib import Path

import numpy as np

from banks import LEVEL, LOSS, banks, unfiltered
from flight import RATE, fly
from manoeuvres import ALL

#: Okabe and Ito's colours, which colour-blind people tell apart.
SIGNAL, DECODED, UP, DOWN = "#a5a5a5", "#0072b2", "#d55e00", "#000000"
WIDTH, HEIGHT, LEFT, RIGHT = 900, 640, 150, 880
NAMES = ["roll rate", "pitch rate", "yaw rate", "force ahead", "force aside", "force up"]
#: The picture runs at half the flight's speed.
SLOW = 2


def draw(code: str = "sod") -> str:
    """The picture of a flip."""
    manoeuvre = next(own for own in ALL if own.name == "flip")
    bank = banks()[code] if code in banks() else unfiltered(code)
    flight = fly(manoeuvre, bank.path(RATE), 100 + ALL.index(manoeuvre), LOSS, trace=True, vibration=LEVEL)
    times = np.array([shown[0] for shown in flight.trace])
    truth = np.array([shown[2] for shown in flight.trace])
    heard = np.array([shown[3] for shown in flight.trace])
    states = np.array([shown[5] for shown in flight.trace])
    roll = np.unwrap([2 * atan2(own[6], own[9]) for own in states]) * 180 / pi
    wanted = np.unwrap([2 * atan2(shown[4][1], shown[4][0]) for shown in flight.trace]) * 180 / pi
    # Turned over, a quaternion is the same attitude.
    roll += 360 * np.round((wanted[0] - roll[0]) / 360)

    def across(time: float) -> float:
        return LEFT + (RIGHT - LEFT) * time / manoeuvre.seconds

    def curve(values: np.ndarray, top: float, height: float, low: float, high: float, colour: str, width: float) -> str:
        points = " ".join(
            f"{across(time):.1f},{top + height * (high - value) / (high - low):.1f}"
            for time, value in zip(times[::3], values[::3])
        )
        return f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="{width}"/>'

    def moving(kind: str, values: list[str]) -> str:
        seconds = manoeuvre.seconds * SLOW
        return f'<animateTransform attributeName="transform" type="{kind}" dur="{seconds}s" repeatCount="indefinite" values="{";".join(values)}"/>'

    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="14">',
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
        f'<text x="20" y="28" font-size="18">A flip on spikes: {code}{f" behind {bank.low_pass} Hz" if bank.low_pass else ""}, {flight.spikes:.0f} spikes and {flight.bytes:.0f} bytes a second, '
        f"at half its speed</text>",
    ]
    # The drone from behind, and the attitude that is wanted of it.
    scale = 18
    for angles, opacity in ((wanted, 0.25), (roll, 1)):
        turns = [f"{angle:.0f}" for angle in angles[::12]]
        rises = [f"0 {-scale * (own[2] - states[0][2]):.0f}" for own in states[::12]]
        parts.append(
            f'<g transform="translate(480 140)" opacity="{opacity}"><g>{moving("translate", rises)}<g>{moving("rotate", turns)}'
            '<rect x="-70" y="-4" width="140" height="8" rx="4" fill="#444"/><rect x="-14" y="-12" width="28" height="16" rx="4" fill="#444"/>'
            '<path d="M-70-4v-10M70-4v-10" stroke="#444" stroke-width="4"/>'
            f'<path d="M-96-15h52" stroke="{DECODED}" stroke-width="5"/><path d="M44-15h52" stroke="{UP}" stroke-width="5"/></g></g></g>'
        )
    top = 250
    low, high = float(truth[:, 0].min()) - 1, float(truth[:, 0].max()) + 1
    parts.append(f'<text x="20" y="{top + 50}">roll rate</text><text x="20" y="{top + 70}" fill="{SIGNAL}">sensor</text>')
    parts.append(f'<text x="20" y="{top + 90}" fill="{DECODED}">from spikes</text>')
    parts.append(f'<text x="{RIGHT}" y="{top - 4}" text-anchor="end">{high:.0f} to {low:.0f} rad/s, {manoeuvre.seconds:g} s</text>')
    seconds = manoeuvre.seconds * SLOW
    parts.append(
        f'<clipPath id="past"><rect x="{LEFT}" y="{top - 5}" width="{RIGHT - LEFT}" height="400"><animate attributeName="width" from="0" '
        f'to="{RIGHT - LEFT}" dur="{seconds}s" repeatCount="indefinite"/></rect></clipPath>'
    )
    parts.append(f'<rect x="{LEFT}" y="{top}" width="{RIGHT - LEFT}" height="120" fill="none" stroke="#ddd"/><g clip-path="url(#past)">')
    parts.append(curve(truth[:, 0], top, 120, low, high, SIGNAL, 4))
    parts.append(curve(heard[:, 0], top, 120, low, high, DECODED, 1.8))
    neurons = bank.schemes()[0].neurons
    rows = top + 150
    for channel in range(6):
        base = rows + 36 * channel
        strokes = {True: [], False: []}
        for time, shown in zip(times, flight.trace):
            for place, (address, up) in enumerate(shown[6]):
                if address // neurons == channel and (neurons == 1 or place % 3 == 0):
                    strokes[up].append(f"M{across(time):.1f} {base}v{-14 if up else 14}")
        for up, colour in ((True, UP), (False, DOWN)):
            drawn = "".join(dict.fromkeys(strokes[up]))
            parts.append(f'<path d="{drawn}" stroke="{colour}" stroke-width="1.3"/>')
    parts.append("</g>")
    for channel in range(6):
        base = rows + 36 * channel
        parts.append(f'<text x="20" y="{base + 5}">{NAMES[channel]}</text>')
        parts.append(f'<path d="M{LEFT} {base}H{RIGHT}" stroke="#ccc" stroke-width="0.6"/>')
    parts.append(
        f'<path d="M{LEFT} {top - 5}V{HEIGHT - 15}" stroke="#009e73" stroke-width="1.5"><animateTransform attributeName="transform" '
        f'type="translate" from="0 0" to="{RIGHT - LEFT} 0" dur="{seconds}s" repeatCount="indefinite"/></path>'
    )
    parts.append(f'<text x="{RIGHT}" y="{HEIGHT - 4}" text-anchor="end"><tspan fill="{UP}">up</tspan> and down: spikes</text></svg>')
    print(f"{code}: {'lost' if flight.lost else 'flown'}, mean error {flight.errors.mean():.1f}°, worst {flight.errors.max():.0f}°")
    return "\n".join(parts) + "\n"


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(draw(*sys.argv[2:]))
