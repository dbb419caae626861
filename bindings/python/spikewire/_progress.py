"""Progress on work of some seconds."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

#: Work that is shorter shows no bar.
PATIENCE = 1.0


@contextmanager
def bar(wanted: bool | Callable[[int, int], object] | None, what: str) -> Iterator[Callable[[int, int], object] | None]:
    """A function of what is done and of the total, or none."""
    if callable(wanted):
        yield wanted
    elif wanted is False or (wanted is None and not sys.stderr.isatty()):
        yield None
    else:
        start, shown = time.monotonic(), False

        def tell(done: int, total: int) -> None:
            nonlocal shown
            if time.monotonic() - start >= PATIENCE and total:
                shown = True
                filled = "#" * int(40 * done / total)
                print(f"\r{what} [{filled:<40}] {100 * done / total:3.0f} %", end="", file=sys.stderr, flush=True)

        try:
            yield tell
        finally:
            if shown:
                print(file=sys.stderr)
