"""The code of the README runs, and that of the book's pages."""

import re
import runpy
from pathlib import Path

import pytest
import spikewire as sw

README = Path(__file__).parents[1] / "README.md"
BOOK = Path(__file__).parents[3] / "docs"
PARTS = ["tutorial", "how-to", "explanation"]


def blocks(page):
    return re.findall(r"```python\n(.*?)```", page.read_text(), re.DOTALL)


BLOCKS = blocks(README)
PAGES = [page for part in PARTS for page in sorted(BOOK.glob(f"{part}/*.md")) if blocks(page)]


@pytest.mark.parametrize("code", BLOCKS, ids=range(len(BLOCKS)))
def test_block(code, tmp_path, monkeypatch):
    if "spikewire.torch" in code:
        pytest.importorskip("torch")
    monkeypatch.chdir(tmp_path)
    exec(compile(code, str(README), "exec"), {"__name__": "__main__"})


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_page(page, tmp_path, monkeypatch):
    """The blocks of a page go on from each other; `data` is the repository's."""
    (tmp_path / "data").symlink_to(BOOK.parent / "data")
    monkeypatch.chdir(tmp_path)
    exec(compile("\n".join(blocks(page)), str(page), "exec"), {"__name__": "__main__"})


@pytest.mark.parametrize("part, count", [("tutorial", 5), ("cards", len(sw.schemes))])
def test_pictures_are_those_of_the_code(part, count, tmp_path):
    runpy.run_path(str(BOOK / "pictures.py"))[f"draw_{part}"](tmp_path)
    drawn = {picture.name: picture.read_text() for picture in tmp_path.glob("*.svg")}
    assert len(drawn) == count
    place = BOOK / ("tutorial" if part == "tutorial" else "reference")
    for name, picture in drawn.items():
        assert (place / name).read_text() == picture, f"{name}: python docs/pictures.py"


def test_every_scheme_has_a_card():
    text = (BOOK / "reference/cards.md").read_text()
    assert [name for name in sw.schemes if f"(card-{name}.svg)" not in text] == []


def test_newcomer_needs_five_lines(tmp_path, monkeypatch):
    assert len(BLOCKS[0].splitlines()) == 5
