"""Tunes every code of the catalogue on one flight, and keeps what was found in `codes.json`."""

from __future__ import annotations

import json
import sys

import spikewire as sw

from codes import KEPT, lesson, tuned


def main() -> None:
    flight = lesson()
    kept = json.loads(KEPT.read_text()) if KEPT.exists() else {}
    for name in sys.argv[1:] or sw.schemes:
        kept[name] = tuned(name, flight)
        print(name, kept[name], flush=True)
        ordered = {name: kept[name] for name in sw.schemes if name in kept}
        lines = ",\n".join(f'  "{name}": {json.dumps(groups)}' for name, groups in ordered.items())
        KEPT.write_text(f"{{\n{lines}\n}}\n")


if __name__ == "__main__":
    main()
