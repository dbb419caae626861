"""What a good engineer would send instead of spikes, in frames as lean as by hand: rows to compare with, and no codes to use.

A frame takes four bytes beside its values: a byte of synchronisation and number, one that names the channels, and a
checksum of two. A value takes two bytes, as the sensor's register does. None of them asks which code stands beside it.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flight import Frame, LowPass, Registers, Way

#: Bytes of a frame beside its values, and those of a value.
LEAN, VALUE = 4, 2


class Samples(Registers):
    """Every n-th sample, all channels, behind a low-pass or not; the receiver holds the last one."""

    def __init__(self, every: int = 1, low_pass: LowPass | None = None):
        super().__init__(low_pass, LEAN)
        self.every, self.count = every, 0

    def send(self, sample: np.ndarray) -> Iterator[Frame]:
        sent = list(super().send(sample))
        if self.count % self.every == 0:
            yield from sent
        self.count += 1


class DeadBand(Way):
    """The value of a channel when it has moved by its threshold since it was last sent, and all of them every so many samples."""

    def __init__(self, thresholds: np.ndarray, all_every: int, low_pass: LowPass | None = None):
        self.thresholds, self.all_every, self.low_pass = thresholds, all_every, low_pass
        self.sent, self.held, self.count = np.zeros(6, np.float32), np.zeros(6, np.float32), 0

    def send(self, sample: np.ndarray) -> Iterator[Frame]:
        if self.low_pass:
            sample = self.low_pass.next(sample)
        moved = np.abs(sample - self.sent) > self.thresholds
        if self.count % self.all_every == 0:
            moved[:] = True
        self.count += 1
        if moved.any():
            self.sent = np.where(moved, sample, self.sent)
            yield Frame(LEAN + VALUE * int(moved.sum()), (moved, sample))

    def hear(self, frame: Frame) -> None:
        moved, sample = frame.content
        self.held = np.where(moved, sample, self.held)

    def values(self) -> np.ndarray:
        return self.held
