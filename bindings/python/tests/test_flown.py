"""Spikes and decoded bits of the recorded flight are those of Rust, on the host and on every core."""

import os
from pathlib import Path

import pytest

from flown import table

FLIGHT = Path(__file__).parents[3] / "data" / "hexarotor.csv"


@pytest.mark.skipif("FLIGHT_LOG" not in os.environ, reason="FLIGHT_LOG names what the program flight-log has printed")
def test_every_scheme_has_the_hash_of_rust():
    assert table(FLIGHT, Path(os.environ["FLIGHT_LOG"]).read_text()) == []
