"""The notebooks run from top to bottom, where what they import is installed."""

import json
import re
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"


@pytest.mark.parametrize("name, frame", [("train_snntorch", "snntorch"), ("train_spikingjelly", "spikingjelly")])
def test_trainings(name, frame, monkeypatch, capsys):
    pytest.importorskip("torch")
    pytest.importorskip(frame)
    monkeypatch.chdir(EXAMPLES)
    notebook = json.loads((EXAMPLES / f"{name}.ipynb").read_text())
    names = {}
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), names)
    right, most = map(int, re.findall(r"(\d+)%", capsys.readouterr().out))
    assert right > most + 10
