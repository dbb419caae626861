"""What went wrong, counted and told."""

from typing import Callable


class Counters:
    """Counts by name. Tells the first of each, the tenth, the hundredth and so on, so that a log stays readable."""

    def __init__(self, tell: Callable[[str], None]) -> None:
        self.counts: dict[str, int] = {}
        self._tell = tell
        self._next: dict[str, int] = {}

    def add(self, what: str, detail: str = "", by: int = 1) -> None:
        """Counts `by` more of it."""
        count = self.counts.get(what, 0) + by
        self.counts[what] = count
        if count >= self._next.get(what, 1):
            self._next[what] = 10 ** len(str(count))
            self._tell(f"{what}: {count}" + (f" ({detail})" if detail else ""))

    def __str__(self) -> str:
        told = ", ".join(f"{count} {what}" for what, count in sorted(self.counts.items()))
        return told or "nothing lost, nothing refused"
