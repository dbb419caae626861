"""What the stamps of samples tell: steps back, repeats and gaps."""

from collections import deque
from statistics import median
from typing import Optional

_STEPS = 31


class Clock:
    """Watches stamps in nanoseconds."""

    def __init__(self, gap: float) -> None:
        """A step above so many usual steps is a gap. The usual step is the median of the last 31."""
        if not gap > 1.0:
            raise ValueError(f"gap {gap}: it must be above 1, in usual steps")
        self._gap = gap
        self._steps: deque[int] = deque(maxlen=_STEPS)
        self._last: Optional[int] = None

    def observe(self, stamp: int) -> Optional[tuple[str, str]]:
        """What is wrong with the step to this stamp, if anything: what is counted, and how much it was."""
        last, self._last = self._last, stamp
        if last is None:
            return None
        step = stamp - last
        if step < 0:
            return "steps back in time", f"{-step / 1e9:.6f} s"
        if step == 0:
            return "repeated stamps", f"{stamp / 1e9:.6f} s"
        usual = median(self._steps) if len(self._steps) >= 3 else None
        self._steps.append(step)
        if usual is not None and step > self._gap * usual:
            return "gaps", f"{step / 1e9:.6f} s, usually {usual / 1e9:.6f} s"
        return None
