"""From samples to the messages of their spikes, without ROS."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Optional

import numpy as np

from . import schemes
from .clock import Clock
from .codec import Codec, Request
from .counters import Counters
from .settings import Settings

# Of the 32 bits that messages have.
_LARGEST = float(np.finfo(np.float32).max)

# A value, and its stamp in nanoseconds.
Sample = tuple[float, int]


@dataclass(frozen=True)
class Event:
    """What becomes of one sample: a `spyke` or a `spyke_array`, and a `spyke_value`."""

    # One, or of several neurons or sub-timesteps each.
    spikes: list[int]
    start: float
    min_input: float
    max_input: float
    threshold: float
    input: float
    scheme: str
    # Nanoseconds.
    stamp: int
    decoded: float


class Encoding:
    """Encodes samples as they come, and decodes their spikes at once.

    Nothing comes out before the scheme can start: it may need some samples first, to calibrate on or to fill its
    window. They are encoded as soon as it can. A rate code's spikes come later than their sample by its latency.
    """

    def __init__(self, settings: Settings, counters: Counters) -> None:
        """`ValueError`: a parameter is not good."""
        self._request = Request(settings)
        self._enough = self._request.enough
        self._request.check()
        self._counters = counters
        self._clock = Clock(settings.gap)
        self._codec: Optional[Codec] = None
        # Before the start.
        self._held: list[Sample] = []
        # Those whose spikes are still to come.
        self._waiting: deque[Sample] = deque()
        self._range = (float("inf"), float("-inf"))

    @property
    def is_array(self) -> bool:
        """Whether events are a `spyke_array` each."""
        return self._request.is_array

    @property
    def header(self) -> Optional[str]:
        """From the first event on, all that decoding needs, as the text of a file's header."""
        return self._codec.header if self._codec is not None else None

    def take(self, value: float, stamp: int) -> list[Event]:
        """Takes a sample. One that is not finite, in 32 bits, is counted and emits nothing."""
        wrong = self._clock.observe(stamp)
        if wrong is not None:
            self._counters.add(*wrong)
        if not abs(value) <= _LARGEST:  # nor is NaN
            self._counters.add("samples not finite", str(value))
            return []
        lowest, highest = self._range
        self._range = (min(lowest, value), max(highest, value))
        if self._codec is not None:
            return self._encode(self._codec, [(value, stamp)])
        self._held.append((value, stamp))
        return self._start() if len(self._held) >= self._enough else []

    def end(self) -> list[Event]:
        """What is left when no more samples come."""
        if self._codec is None:
            if self._held:
                what = "samples that came too few to start"
                self._counters.add(what, f"it needs {self._enough}", len(self._held))
            return []
        return self._events(self._codec, self._codec.finish())

    def _start(self) -> list[Event]:
        held, self._held = self._held, []
        self._codec = self._request.start([value for value, _ in held])
        return self._encode(self._codec, held)

    def _encode(self, codec: Codec, samples: Sequence[Sample]) -> list[Event]:
        self._waiting.extend(samples)
        return self._events(codec, codec.encode([value for value, _ in samples]))

    def _events(self, codec: Codec, rows: Sequence[Sequence[int]]) -> list[Event]:
        return [self._event(codec, cells) for cells in rows]

    def _event(self, codec: Codec, cells: Sequence[int]) -> Event:
        value, stamp = self._waiting.popleft()
        lowest, highest = codec.range(*self._range)
        return Event(
            spikes=list(cells),
            start=codec.first,
            min_input=lowest,
            max_input=highest,
            threshold=codec.threshold,
            input=value,
            scheme=schemes.published(codec.name),
            stamp=stamp,
            decoded=codec.decode(cells),
        )
