"""Progress on work of some seconds."""

import sys
import time
from contextlib import contextmanager

#: Work that is shorter shows no bar.
PATIENCE = 1.0


@contextmanager
def bar(wanted, what):
    """A function of what is done and of the total, or none."""
    if callable(wanted):
        yield wanted
    elif wanted is False or (wanted is None and not sys.stderr.isatty()):
        yield None
    else:
        start, shown = time.monotonic(), False

        def tell(done, total):
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
