"""The type stub says what the catalogue does."""

from pathlib import Path

from stubs import stub


def test_stub_is_fresh():
    kept = Path(__file__).parents[1] / "spikewire" / "_schemes.pyi"
    assert kept.read_text() == stub(), "run `cargo xtask write python`"
