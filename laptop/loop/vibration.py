"""Vibration that rotors add to an inertial sensor: lines that follow each rotor's speed, and broad noise.

Each rotor has a line at its speed, at twice and three times it. A line is as strong as the square of the speed, as an
imbalance's force is, and is sampled as it is: what lies above half of the rate comes back below it. The noise is as strong
as the mean of these squares, and as broad as a sensor's own filter lets through.

Strengths are those at a sensor's output in recorded flights, so that its filter is in them:

| | turn rates, rad/s rms above 10 Hz | forces, m/s² |
|---|---|---|
| quadrotor of a public log at 1 kHz, unfiltered: lines at 115–140, 230–280 and 345–420 Hz as 1, 0.35, 0.35 | 0.04, 0.04, 0.045 | |
| 5-inch quadrotor of a public log at 250 Hz, unfiltered, cruising | 0.52, 0.47, 0.27 | |
| hexarotor of `data`, at 198 Hz, seconds 5 to 11 | 0.14, 0.08, 0.03 | 1.18, 1.17, 0.68 |
| here, in hover | 0.15, 0.15, 0.09 | 1.4, 1.4, 1.3 |
"""

from __future__ import annotations

from math import exp, pi, sqrt

import numpy as np
from numba import njit

#: The lines of all rotors together in hover, rms: rates in rad/s, then forces in m/s².
LINES = np.array([0.10, 0.10, 0.05, 1.0, 1.0, 0.6])
#: The harmonics' strengths, relative to each other.
HARMONICS = np.array([1.0, 0.35, 0.35])
#: The density of the noise in hover, a unit per √Hz: between 10 and 60 Hz the hexarotor has 0.010, 0.006, 0.002 and
#: 0.04 to 0.07, the 5-inch quadrotor 0.013 to 0.037.
NOISE = np.array([0.006, 0.006, 0.004, 0.05, 0.05, 0.06])
#: The sensor's bandwidth, Hz.
BAND = 230


class Vibration:
    """The vibration of the six channels, a sample at a time, drawn from a generator. `level` is a factor on all of it."""

    def __init__(self, random: np.random.Generator, rate: int, samples: int, hover: float, level: float = 1.0):
        self.dt, self.hover = 1 / rate, hover
        self.phases = np.zeros(4)
        self.shifts = random.uniform(0, 2 * pi, (4, 3, 6))
        share = HARMONICS / sqrt(float(np.sum(HARMONICS**2)))
        self.lines = level * sqrt(2 / 4) * share[None, :, None] * LINES
        # A first-order low-pass of white noise, at the moments of the samples.
        stay = exp(-2 * pi * BAND / rate)
        drawn = random.normal(size=(samples, 6)) * NOISE * (level * sqrt(pi / 2 * BAND))
        drawn[1:] *= sqrt(1 - stay * stay)
        for number in range(1, samples):
            drawn[number] += stay * drawn[number - 1]
        self.noise = iter(drawn)

    def next(self, rotors: np.ndarray) -> np.ndarray:
        """The next sample, at these speeds of the rotors in parts of that in hover."""
        self.phases += rotors * (self.hover * self.dt)
        return lines(self.phases, rotors, self.shifts, self.lines) + (rotors * rotors).mean() * next(self.noise)


@njit(cache=True)
def lines(phases, rotors, shifts, strengths):
    """The sum of all lines, by channel."""
    total = np.zeros(6)
    for rotor in range(4):
        square = rotors[rotor] * rotors[rotor]
        for harmonic in range(3):
            phase = phases[rotor] * (harmonic + 1)
            for channel in range(6):
                line = np.sin(phase + shifts[rotor, harmonic, channel])
                total[channel] += square * strengths[0, harmonic, channel] * line
    return total
