"""Draws the pictures of "Your first spikes", from what the page's own code computes, and those of the schemes' cards.

`python docs/pictures.py`, with the Python package.
"""

import re
from pathlib import Path

import numpy as np
import spikewire as sw

DOCS = Path(__file__).parent
PAGE = DOCS / "tutorial/first-spikes.md"
# The colours of xtask/src/figures/drawing.rs, which stay apart for the colour-blind and in grey.
SIGNAL, DECODED, UP, DOWN, QUIET = "#a5a5a5", "#0072b2", "#d55e00", "#000000", "#e6e6e6"
LEFT, RIGHT, BOTTOM = 58, 16, 44


def blocks(page: Path) -> list[str]:
    """Returns the page's blocks of Python, which belong together."""
    return re.findall(r"```python\n(.*?)```", page.read_text(), re.DOTALL)


class Picture:
    """Curves and marks over time, as SVG on a white ground, so that it can be read on a dark page too."""

    def __init__(self, title, times, values, size=(760, 250), top=40):
        self.times, self.values, self.top = times, values, top
        self.width, self.height = size
        self.bottom = self.height - BOTTOM
        self.parts = [f'<rect width="{self.width}" height="{self.height}" fill="white"/>']
        self.text(LEFT, 24, title, size=16)
        first, last = times
        for value in range(-3, 4):
            # Below are spikes, which have no value.
            if values[0] <= value <= values[1] and (top == 40 or value >= -1):
                self.line([(first, value), (last, value)], QUIET, 1)
                self.text(LEFT - 8, self.y(value) + 4, value, anchor="end")
        ticks = 5
        for tick in range(ticks + 1):
            time = first + (last - first) * tick / ticks
            self.text(self.x(time), self.bottom + 18, f"{time:.2f}".rstrip("0").rstrip("."), anchor="middle")
        self.text(self.width - RIGHT, self.bottom + 36, "time, s", anchor="end")
        middle = (self.top + self.bottom) / 2
        self.parts.append(
            f'<text x="16" y="{middle}" transform="rotate(-90 16 {middle})" '
            'text-anchor="middle" font-size="13">roll rate, rad/s</text>'
        )

    def x(self, time):
        first, last = self.times
        return LEFT + (time - first) / (last - first) * (self.width - LEFT - RIGHT)

    def y(self, value):
        low, high = self.values
        return self.top + (high - value) / (high - low) * (self.bottom - self.top)

    def text(self, x, y, text, size=13, anchor="start", colour="#000000"):
        self.parts.append(
            f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" text-anchor="{anchor}" fill="{colour}">{text}</text>'
        )

    def note(self, time, value, text, colour):
        self.text(self.x(time), self.y(value), text, colour=colour)

    def line(self, points, colour, width):
        path = " ".join(f"{self.x(time):.1f},{self.y(value):.1f}" for time, value in points)
        self.parts.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="{width}"/>')

    def curve(self, times, values, colour, width=2):
        self.line(zip(times, values), colour, width)

    def stairs(self, times, values, colour, width=2):
        """Draws a value that stays until the next sample: only where it changes."""
        points = [(times[0], values[0])]
        for time, value in zip(times[1:], values[1:]):
            if value != points[-1][1]:
                points += [(time, points[-1][1]), (time, value)]
        self.line([*points, (times[-1], points[-1][1])], colour, width)

    def band(self, times, low, high):
        points = [*zip(times, high), *reversed(list(zip(times, low)))]
        path = " ".join(f"{self.x(time):.1f},{self.y(value):.1f}" for time, value in points)
        self.parts.append(f'<polygon points="{path}" fill="{DECODED}" fill-opacity="0.15"/>')

    def shade(self, first, last):
        self.parts.append(
            f'<rect x="{self.x(first):.1f}" y="{self.top}" width="{self.x(last) - self.x(first):.1f}" '
            f'height="{self.bottom - self.top}" fill="{UP}" fill-opacity="0.12"/>'
        )

    def spikes(self, times, spikes, base):
        for time, spike in zip(times, spikes):
            if spike:
                self.line([(time, base), (time, base + 0.8 * spike)], UP if spike > 0 else DOWN, 2)

    def save(self, path):
        head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width} {self.height}" font-family="sans-serif">'
        path.write_text("\n".join([head, *self.parts, "</svg>\n"]))


def draw_tutorial(place: Path) -> None:
    """Runs the page's code, and draws the five pictures into a directory."""
    run = {}
    exec(compile("\n".join(blocks(PAGE)), str(PAGE), "exec"), run)
    time, roll, decoded = run["time"], run["roll"], run["decoded"]
    spikes = run["spikes"].array
    threshold = run["code"].parameters["threshold"]
    whole = (0, 2)

    picture = Picture("A roll to one side and back", whole, (-3.5, 3.5))
    picture.curve(time, roll, SIGNAL, 3)
    picture.save(place / "first-1-signal.svg")

    picture = Picture("The band of one threshold around the baseline", (0.3, 0.5), (-0.6, 3.5))
    part = slice(150, 251)
    edges, levels = [], []
    for at, level in zip(time[part], decoded[part]):
        if levels and level != levels[-1]:
            edges, levels = [*edges, at], [*levels, levels[-1]]
        edges, levels = [*edges, at], [*levels, level]
    picture.band(edges, [level - threshold for level in levels], [level + threshold for level in levels])
    picture.stairs(time[part], decoded[part], DECODED)
    picture.curve(time[part], roll[part], SIGNAL, 3)
    for number in range(150, 251):
        if spikes[number]:
            picture.line([(time[number], -0.5), (time[number], decoded[number])], UP, 1)
    picture.note(0.302, 0.95, "signal (grey), baseline (blue)", DECODED)
    picture.note(0.302, -0.45, "spikes up", UP)
    picture.save(place / "first-2-threshold.svg")

    picture = Picture("The signal, and its spikes: up and down", whole, (-5.5, 3.5))
    picture.curve(time, roll, SIGNAL, 3)
    picture.spikes(time, spikes, -4.5)
    picture.save(place / "first-3-spikes.svg")

    picture = Picture("Decoded from the spikes alone", whole, (-3.5, 3.5))
    picture.curve(time, roll, SIGNAL, 4)
    picture.stairs(time, decoded, DECODED)
    picture.note(0.75, 2.5, "decoded", DECODED)
    picture.save(place / "first-4-decoded.svg")

    picture = Picture("A frame is lost; the next keyframe mends the value", (0.3, 0.7), (-0.6, 3.9))
    part = slice(150, 351)
    values, exact = run["values"], run["exact"]
    withheld = [at for at, is_exact in zip(time, exact) if not is_exact]
    picture.shade(withheld[0], withheld[-1] + time[1])
    picture.curve(time[part], roll[part], SIGNAL, 4)
    picture.stairs(time[part], decoded[part], "#000000", 1)
    picture.stairs(time[part], values[part], DECODED, 3)
    picture.note(withheld[0] + 0.004, 3.55, "withheld", UP)
    picture.note(0.302, 2.1, "black: nothing lost", "#000000")
    picture.note(0.302, 1.6, "blue: the receiver's value", DECODED)
    picture.save(place / "first-5-lost.svg")


SECOND = slice(2120, 2319)  # of the recorded flight, 198.5 samples a second


def draw_cards(place: Path) -> None:
    """Draws a second of a recorded flight in every scheme, with the paper's settings for that second."""
    log = sw.read(DOCS.parent / "data/hexarotor.csv")
    part = np.ascontiguousarray(log["gyro_x"][SECOND])
    for name, kind in sw.schemes.items():
        seeded = {"seed": 1} if name in ("bernoulli", "grf-prob") else {}
        scheme = kind(paper=True, **seeded).fit(part)
        spikes = scheme.encode(part)
        card(part, spikes).save(place / f"card-{name}.svg")


def card(samples, spikes) -> Picture:
    """Draws samples, what they decode to, and their spikes, a row for each neuron."""
    times = np.arange(samples.size) / samples.size
    picture = Picture("", (0, 1), (-3.2, 1.2), size=(560, 200), top=8)
    picture.curve(times, samples, SIGNAL, 3)
    picture.stairs(times, np.clip(spikes.decode(), -2, 1.2), DECODED, 1.5)
    array = spikes.array.reshape(samples.size, -1, 1) if spikes.array.ndim < 3 else spikes.array
    if spikes.array.ndim == 2:  # neurons without sub-timesteps
        array = spikes.array[:, None, :]
    _, slots, neurons = array.shape
    height = 1 / neurons
    for sign, colour in ((1, UP), (-1, DOWN)):
        marks = []
        for sample, slot, neuron in np.argwhere(array == sign):
            time = (sample + slot / slots) / samples.size
            base = -3.1 + neuron * height
            top = picture.y(base + 0.8 * height)
            marks.append(f"M{picture.x(time):.1f},{picture.y(base):.1f}V{top:.1f}")
        if marks:
            picture.parts.append(f'<path d="{"".join(marks)}" stroke="{colour}" stroke-width="1"/>')
    return picture


if __name__ == "__main__":
    draw_tutorial(DOCS / "tutorial")
    draw_cards(DOCS / "reference")
