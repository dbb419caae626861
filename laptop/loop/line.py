"""A line between sender and receiver: frames lost by chance or in bursts, a delay, and so many bits a second.

`Line` says what the line does, `Over` sends a way's frames over it. A serial line takes ten bits a byte and one frame after
the other, so that frames wait where they come faster than they go.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from flight import Way


@dataclass(frozen=True)
class Line:
    """Settings of a line; by default it loses no frame and takes no time."""

    #: The share of frames that are lost; in bursts, the share of time in which all are.
    loss: float = 0.0
    #: The mean length of a burst of losses, s; 0 where each frame is lost by itself.
    burst: float = 0.0
    #: The time that each frame takes beside its bytes, s.
    delay: float = 0.0
    #: Bits a second; 0 for no limit.
    baud: int = 0


class Over(Way):
    """A way whose frames take a line; the same seed loses the same frames."""

    def __init__(self, way: Way, line: Line, rate: int, seed: int):
        self.way, self.line, self.dt = way, line, 1 / rate
        self.dice = np.random.default_rng([seed, 1])
        self.samples, self.free_at, self.flying = 0, 0.0, deque()
        self.is_down, self.changes_at = True, 0.0

    def __getattr__(self, name: str):
        return getattr(self.way, name)

    def carry(self, sample: np.ndarray, is_lost) -> np.ndarray:
        """Sends a sample; returns what the controller gets, from the frames that have arrived by now."""
        now = self.samples * self.dt
        self.samples += 1
        for frame in self.way.send(sample):
            self.bytes += frame.size
            begun = max(now, self.free_at)
            self.free_at = begun + (10 * frame.size / self.line.baud if self.line.baud else 0.0)
            if not self._loses(begun):
                self.flying.append((self.free_at + self.line.delay, frame))
        # A frame that arrives with the sample is in time: the line's own time is what counts.
        while self.flying and self.flying[0][0] <= now + 1e-9:
            self.way.hear(self.flying.popleft()[1])
        values = self.way.values()
        self.spikes, self.exact, self.fired = self.way.spikes, self.way.exact, self.way.fired
        return values

    def _loses(self, time: float) -> bool:
        """Whether a frame that begins at this time is lost."""
        if not self.line.burst:
            return bool(self.line.loss) and bool(self.dice.random() < self.line.loss)
        # Bursts and the pauses between them are exponentially long.
        while self.changes_at <= time:
            self.is_down = not self.is_down
            up = self.line.burst * (1 / self.line.loss - 1)
            self.changes_at += self.dice.exponential(self.line.burst if self.is_down else up)
        return self.is_down
