"""Runs the Python of `docs/fly.md`, step by step: each must say the figures that the page has behind it."""

import contextlib
import io
import os
import re
from pathlib import Path

HERE = Path(__file__).parent
FIGURE = re.compile(r"\d+(?:\.\d+)?")


def run(code: str, number: str, names: dict) -> str:
    """Runs a step, and returns what it prints."""
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        exec(compile(code, f"docs/fly.md, step {number}", "exec"), names)
    return said.getvalue()


if __name__ == "__main__":
    os.chdir(HERE)
    page = (HERE.parents[1] / "docs/fly.md").read_text()
    names: dict = {}
    blocks = re.findall(r"^\*\*(\d+)\..*?(?:```python\n(.*?)```|\Z)", page, re.M | re.S)
    if [int(number) for number, _ in blocks] != list(range(1, 11)):
        raise SystemExit("the page has not ten steps")
    for number, code in blocks:
        print(f"step {number}", flush=True)
        said = run(code, number, names)
        print(said, flush=True)
        for told in re.findall(r"^print\(.*\)  # (.+)$", code, re.M):
            lines = [FIGURE.findall(line) for line in said.splitlines()]
            if not any(set(FIGURE.findall(told)) <= set(line) for line in lines):
                raise SystemExit(f"step {number}: the page has {told}, the step said\n{said}")
