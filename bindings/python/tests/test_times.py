"""Times and periods: seconds, µs and what NumPy has with units; never a wrong one without a word."""

import datetime
import warnings

import numpy as np
import pytest

import spikewire as sw

X = [0.0, 1.0, 2.0]
SPIKES = sw.StepForward(threshold=0.5, start=-1.0).encode(X)


def written(times):
    """Times of three events, written and read again."""
    events = {"t": times, "x": np.zeros(3, np.int64), "p": np.ones(3, np.int64)}
    return sw.read_events(sw.write_events(events, "csv"), "csv")["t"].tolist()


def of_spikes(times):
    return SPIKES.events(times=times)["t"].tolist()


START = np.datetime64("1970-01-01T00:00:01", "ns")
NANOSECONDS = np.arange(3) * np.timedelta64(2_000_500, "ns")


@pytest.mark.parametrize("taken", [written, of_spikes])
@pytest.mark.parametrize(
    "times, micros",
    [
        ([0, 5, 10], [0, 5, 10]),
        (np.array([0, 5, 10], np.uint32), [0, 5, 10]),
        ([0.0, 0.5, 1.0], [0, 500_000, 1_000_000]),
        (np.array([0, 0.5, 1], np.float32), [0, 500_000, 1_000_000]),
        (NANOSECONDS, [0, 2000, 4001]),
        (START + NANOSECONDS, [1_000_000, 1_002_000, 1_004_001]),
        ((START + NANOSECONDS).astype("datetime64[ms]"), [1_000_000, 1_002_000, 1_004_000]),
    ],
)
def test_times_have_their_unit(taken, times, micros):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert taken(times) == micros


@pytest.mark.parametrize("taken", [written, of_spikes])
@pytest.mark.parametrize(
    "times, words",
    [
        ([0.0, np.nan, 1.0], "time nan is not finite"),
        ([0.0, np.inf, 1.0], "time inf is not finite"),
        ([-5, 0, 5], "time -5 µs is negative"),
        ([-0.5, 0.0, 0.5], "time -500000 µs is negative"),
        ([0.0, 1000.0, 2000.0], "floats are seconds, and these are whole numbers"),
        (np.array(["NaT", 1, 2], "datetime64[ns]"), "missing"),
        (["a", "b", "c"], "times are whole µs"),
        ([True, False, True], "times are whole µs"),
        ([0.0, 0.5, 1e300], "too large"),
        (np.array([0, 1, 2**64 - 1], np.uint64), "too large"),
    ],
)
def test_times_that_mean_nothing_are_refused(taken, times, words):
    with pytest.raises(sw.Error, match=words):
        taken(times)


def test_events_come_in_tables_too():
    pandas = pytest.importorskip("pandas")
    events = np.array([(5, 1, 3, 1), (9, 2, 4, 0)], dtype=[("t", np.int64), ("x", np.int64), ("y", np.int64), ("p", np.int64)])
    data = sw.write_events(events, "evt2")
    assert data == sw.write_events(pandas.DataFrame(events), "evt2")
    assert sw.write_events(pandas.DataFrame(events).drop(columns="y"), "evt2") == sw.write_events(events[["t", "x", "p"]], "evt2") != data
    for name in ("x", "y"):
        for bad in (1.5, np.nan, -1, 1 << 16):
            with pytest.raises(sw.Error, match="addresses must be|rows must be"):
                sw.write_events(pandas.DataFrame(events).assign(**{name: bad}), "evt2")


def test_a_gap_that_no_format_holds_is_refused():
    with pytest.raises(sw.Error, match="2147 s lie between events 0 and 1"):
        written([0, 2**31, 2**31 + 1])
    assert written([0, 2**31 - 1, 2**32 - 2]) == [0, 2**31 - 1, 2**32 - 2]
    with pytest.warns(UserWarning, match="the first time, 4294967301 µs, has more than 32 bits: it is written as 5 µs"):
        assert written([2**32 + 5, 2**32 + 6, 2**32 + 7]) == [5, 6, 7]
    with pytest.raises(sw.Error, match="times go back after sample 1"):
        SPIKES.events(times=[0, 10, 5])
    with pytest.raises(sw.Error, match=r"times are \(2,\), but there are 3 samples"):
        SPIKES.events(times=[0, 10])


@pytest.mark.parametrize(
    "period, micros",
    [
        (2000, [0, 2000, 4000]),
        (976.5625, [0, 976, 1953]),
        (np.float32(500), [0, 500, 1000]),
        (np.timedelta64(2, "ms"), [0, 2000, 4000]),
        (datetime.timedelta(milliseconds=2), [0, 2000, 4000]),
    ],
)
def test_a_period_is_in_micros_or_has_a_unit(period, micros):
    assert SPIKES.events(period=period)["t"].tolist() == micros
    bank = sw.Bank(sw.StepForward(threshold=0.5, start=-1.0), 1)
    assert bank.encode([X], period=period)["t"].tolist() == micros


@pytest.mark.parametrize("period", [0.002, 0, -5, np.nan, np.inf, "1", None, True])
def test_a_period_that_is_none_is_refused(period):
    bank = sw.Bank(sw.StepForward(threshold=0.5), 1)
    for call in (lambda: SPIKES.events(period=period), lambda: bank.encode([X], period=period)):
        with pytest.raises(sw.Error, match="period"):
            call()
