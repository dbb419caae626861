"""A BMI088, as the Crazyflie has it: what the drone feels, as its registers say it.

The figures are those of its data sheet: ±2000 °/s and ±24 g, noise of 0.014 °/s and 175 µg (z: 190 µg) per √Hz, an
offset of 20 mg. The gyroscope's offset is what remains after a calibration on the ground: 0.1 °/s. What rotors add is in
`vibration.py`.
"""

from __future__ import annotations

from math import pi, sqrt

import numpy as np

DEGREE = pi / 180
G = 9.80665
#: What one count of each channel is, in rad/s and m/s².
UNIT = np.array([2000 / 32768 * DEGREE] * 3 + [24 / 32768 * G] * 3)
DENSITY = np.array([0.014 * DEGREE] * 3 + [175e-6 * G] * 2 + [190e-6 * G])
OFFSET = np.array([0.1 * DEGREE] * 3 + [0.02 * G] * 3)


class Sensor:
    """The six channels of a sensor that is read `rate` times a second, drawn from a generator."""

    def __init__(self, random: np.random.Generator, rate: int, samples: int):
        offset = random.uniform(-1, 1, 6) * OFFSET
        noise = random.normal(size=(samples, 6)) * DENSITY * sqrt(rate / 2)
        self._added = iter(offset + noise)

    def read(self, felt: list[float]) -> np.ndarray:
        """The registers, in counts."""
        counts = np.rint((felt + next(self._added)) / UNIT)
        return np.minimum(np.maximum(counts, -32768), 32767).astype(np.int16)


def physical(counts: np.ndarray) -> np.ndarray:
    """Counts in rad/s and m/s²: single precision, as the firmware has them."""
    return (counts * UNIT).astype(np.float32)
