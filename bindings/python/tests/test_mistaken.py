"""Flights that are mistaken for one another: the receiver of one calls no value of another's sender exact, and says why."""

import os
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

import spikewire as sw

SAMPLES, LATE = 60, 10
#: A saw of six channels, within every code's range.
SAW = (np.arange(SAMPLES)[:, None] * [3, 5, 7, 9, 11, 13] % 97 - 48) / 32


def flights():
    """Name, fingerprint, kinds and flight of each line of the table; two with a common kind differ in that alone."""
    directory = Path(os.environ["FLIGHTS"])
    for line in (directory / "flights.txt").read_text().splitlines():
        name, scheme, _, fingerprint, *kinds = line.split()
        flight = sw.Flight(directory / f"{name}.toml")
        assert flight.scheme == scheme and flight.fingerprint == int(fingerprint)
        yield name, flight, set(kinds)


def sent(flight):
    """The frames of each sample; the first has the fingerprint that a firmware from the same file sends."""
    sender = flight.sender(session=7)
    frames = [sender.encode(sample) for sample in SAW]
    first = next(frame for sample in frames for frame in sample)
    assert flight.fingerprint.to_bytes(4, "little") in first
    return frames


def heard(flight, frames):
    """How many values were exact, and why the first channel's last one was not."""
    receiver, exact = flight.receiver(), 0
    for sample in frames:
        for frame in sample:
            receiver.hear(frame)
        exact += int(receiver.exact.sum())
    return exact, receiver.withheld[0]


@pytest.mark.skipif("FLIGHTS" not in os.environ, reason="FLIGHTS names the directory that the program `mistaken` has written")
def test_no_mistaken_pair_has_an_exact_value():
    senders = [(name, flight, kinds, sent(flight)) for name, flight, kinds in flights()]
    own = sum(heard(flight, frames)[0] > 20 for _, flight, _, frames in senders)
    pairs, reasons = Counter(), Counter()
    for near, sender, kinds, frames in senders:
        for far, receiver, others, _ in senders:
            if near == far or not kinds & others or sender.fingerprint == receiver.fingerprint:
                continue
            for start in (0, LATE):
                exact, why = heard(receiver, frames[start:])
                assert exact == 0, f"{far} hears {near}"
                # Who joins late waits for a full frame, which has the fingerprint: until then the reasons are others.
                if start == 0:
                    reasons[why.split(" have ")[0]] += 1
            pairs.update(kinds & others)
    assert all(count >= 30 for kind, count in pairs.items() if kind != "flown"), pairs
    assert len(pairs) == 10 and own + 8 > len(senders), own
    known = "the sender's schemes", "no fingerprint", "sub-timesteps of"
    assert all(any(words in why for words in known) for why in reasons), reasons
