"""Runs the Python of `docs/fly.md`, step by step."""

import os
import re
from pathlib import Path

HERE = Path(__file__).parent

if __name__ == "__main__":
    os.chdir(HERE)
    page = (HERE.parents[1] / "docs/fly.md").read_text()
    names: dict = {}
    blocks = re.findall(r"^\*\*(\d+)\..*?(?:```python\n(.*?)```|\Z)", page, re.M | re.S)
    if [int(number) for number, _ in blocks] != list(range(1, 11)):
        raise SystemExit("the page has not ten steps")
    for number, code in blocks:
        print(f"step {number}", flush=True)
        exec(compile(code, f"docs/fly.md, step {number}", "exec"), names)
