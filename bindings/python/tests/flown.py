"""The schemes as the firmware flies them over the recorded flight, by keywords, and the hash of each.

The firmware and this read the same recording: three gyroscopes and three accelerometers. Its parameters are parts of a
channel's range, in the sample type.
"""

import numpy as np

import spikewire as sw
from flown_settings import settings

SAMPLES = ("f32", "q8.8", "q16.16", "i16")

#: Schemes whose generator is the caller's: another one on the firmware than in Python.
DRAWN = ("bernoulli", "grf-prob")

#: Counts of a usual inertial sensor at its widest ranges, ±2000 °/s and ±16 g.
UNITS = [32_768 / 2000 * 57.295_779_513_082_32] * 3 + [32_768 / 16 / 9.806_65] * 3


class Channel:
    """A channel's samples in a sample type, in which parameters are parts of their range."""

    def __init__(self, values, unit, sample):
        step = {"f32": 0.0, "q8.8": 2.0**-8, "q16.16": 2.0**-16, "i16": 1.0}[sample]
        values = values.astype(np.float64) * (unit if sample == "i16" else 1)
        half = 2.0 ** (31 if sample == "q16.16" else 15)
        whole = lambda value: np.clip(np.floor(value / step + 0.5), -half, half - 1)
        self.round = lambda value: whole(value) * step if step else np.float64(np.float32(value))
        self.x = self.round(values) if step else values.astype(np.float32)
        if sample == "i16":
            self.x = self.x.astype(np.int16)
        self.min, self.max = float(self.x.min()), float(self.x.max())

    def part(self, part):
        return float(self.round((self.max - self.min) * part))

    def schemes(self):
        """The scheme of each line that the firmware prints, and its keywords."""
        of_samples = {"tbr": {"factor": 0.5, "magnitudes": True}, "mw": {"start": float(self.x[0])}}
        flown = settings(self.part, self.min, self.max).items()
        return {
            name: (sw.schemes[scheme], {**keywords, **of_samples.get(name, {})})
            for name, (scheme, keywords) in flown
            if name not in DRAWN
        }


def channels(sample, path):
    return [Channel(x, unit, sample) for x, unit in zip(sw.read(path).x.astype(np.float32), UNITS)]


def fingerprints(sample, path):
    """The hash of each scheme over all channels, and its spikes, as the firmware counts them."""
    flown = {}
    for channel in channels(sample, path):
        for name, (scheme, keywords) in channel.schemes().items():
            own = scheme(sample=sample, **keywords)
            spikes = own.encode(channel.x)
            # The decoder on the firmware starts from the first sample, whatever the scheme.
            values = own.fit(channel.x).decode(spikes.array, first=channel.x[0])
            before, count = flown.get(name, (0xCBF29CE484222325, 0))
            flown[name] = spikes.fingerprint(before, values), count + spikes.count
    return flown


def printed(lines):
    """What a program prints of the flight: hash and spikes by scheme and sample type."""
    told = {}
    for line in lines.splitlines():
        name, sample, *fields = line.split()
        fields = dict(field.split("=") for field in fields)
        told[name, sample] = int(fields["hash"], 16), int(fields["spikes"])
    return told


def table(path, lines):
    """Prints Python's hashes beside those of Rust, and returns the names of those that differ."""
    rust = printed(lines)
    differing, python = [], {sample: fingerprints(sample, path) for sample in SAMPLES}
    names = list(dict.fromkeys(name for name, _ in rust))
    print(f"{'hash of the flight':20} " + " ".join(f"{sample:>17}" for sample in SAMPLES))
    for name in names:
        row = []
        for sample in SAMPLES:
            if name in DRAWN:
                row.append("its own generator")
                continue
            own = python[sample].get(name)
            is_same = own == rust[name, sample]
            row.append(f"{own[0] if own else 0:016x}" + ("=" if is_same else "!"))
            if not is_same:
                differing.append(f"{name} {sample}")
        print(f"{name:20} " + " ".join(f"{cell:>17}" for cell in row))
    return differing
