"""What the laptop program does, in Python: of the same code, so it is the arrays that are tested here."""

import json
import os
import pickle
import shutil
import subprocess
import warnings
from pathlib import Path

import numpy as np
import pytest

import spikewire as sw

FLIGHT = Path(__file__).parents[3] / "data" / "hexarotor.csv"


@pytest.fixture(scope="module")
def log():
    return sw.read(FLIGHT, "gyro_x", "gyro_y")


def test_a_recording_is_read_by_name(log):
    assert log.names == ["gyro_x", "gyro_y"] and log.x.shape == (2, 3627)
    assert log["gyro_y"][1] == 0.0034330138 and log.t[1] - log.t[0] == 5036
    assert 190 < log.rate < 200
    assert sw.read(FLIGHT).x.shape == (6, 3627)
    with pytest.raises(ValueError, match="gyro_q"):
        sw.read(FLIGHT, "gyro_q")
    with pytest.raises(ValueError, match="cannot be opened"):
        sw.read("nowhere.csv")
    with pytest.raises(sw.Error) as caught:
        sw.StepForward(threshold="half")
    error = caught.value
    assert (error.parameter, error.value, error.kind, error.file) == ("threshold", "half", "NotANumber", None)
    with pytest.raises(sw.Error) as caught:
        sw.read("nowhere.csv")
    assert (caught.value.file, caught.value.kind) == ("nowhere.csv", "Open")
    with pytest.raises(TypeError, match="colour"):
        sw.read(FLIGHT, colour="red")
    for bad, words in [
        ({"topic": "imu"}, "a CSV table takes no `topic`"),
        ({"time_unit": "hours"}, "`time_unit` hours must be `s`, `ms`, `us` or `ns`"),
        ({"rate": 0}, "`rate` 0 must be a number above 0 and finite"),
    ]:
        with pytest.raises(sw.Error, match=words) as caught:
            sw.read(FLIGHT, **bad)
        assert caught.value.parameter == next(iter(bad))


def packets(path, names="time,gyro_x"):
    """Samples at 800 Hz that arrive in packets of 8."""
    rows = (f"{at // 8 * 0.01 + at % 8 * 0.00005:.6f},{at % 7}\n" for at in range(4000))
    path.write_text(f"{names}\n" + "".join(rows))
    return path


def test_an_uneven_rate_is_never_silent(tmp_path):
    uneven = "800.00 Hz by samples through length, 20000.00 Hz by the median step"
    log = sw.read(packets(tmp_path / "b.csv"))
    assert any(uneven in note for note in log.notes)
    with pytest.warns(UserWarning, match=uneven) as warned:
        assert abs(log.rate - 800) < 0.01
    assert warned[0].filename == __file__
    # Made by hand, as after a cut.
    with pytest.warns(UserWarning, match="by the median step"):
        assert sw.Log(log.x, log.t[:800], log.names, []).rate > 700
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        given = sw.read(tmp_path / "b.csv", rate=750)
        assert given.rate == 750 and pickle.loads(pickle.dumps(given)).rate == 750
        assert not any("Hz, is not that" in note for note in given.notes)
        even = sw.Log(log.x, np.arange(4000) * 1250, log.names, [])
        assert even.rate == 800 and sw.read(FLIGHT, rate=200).rate == 200
    given = sw.read(tmp_path / "b.csv", rate=100)
    assert any("the rate that is given, 100.00 Hz, is not that of samples through length, 800.00 Hz" in own for own in given.notes)
    sw.dataset(tmp_path / "b.csv", sw.StepForward(threshold=1), tmp_path / "set", channels=["gyro_x"], test=0)
    row = json.loads((tmp_path / "set/manifest.jsonl").read_text().splitlines()[-1])
    assert row["rate"] is None and any(uneven in note for note in row["notes"])
    # A table without times has the rate that it is given.
    (tmp_path / "x.csv").write_text("x\n0\n1\n")
    assert sw.read(tmp_path / "x.csv").rate is None and sw.read(tmp_path / "x.csv", rate=50).rate == 50


def test_the_header_and_the_unit_of_time_may_be_given(tmp_path):
    path = tmp_path / "lines.csv"
    rows = "".join(f"{at * 5},{at % 3}\n" for at in range(20))
    path.write_text("gain,offset\n1,2\nvolts,more\ntime,gyro\n" + rows)
    log = sw.read(path, header=4, time_unit="ms")
    assert log.names == ["gyro"] and log.rate == 200
    with pytest.raises(sw.Error, match="`time_unit` says their unit"):
        sw.read(path, header=4, time_unit=None)
    with pytest.raises((sw.Error, TypeError)):
        sw.read(path, header="four")
    counts = sw.dataset(
        path, sw.StepForward(threshold=1), tmp_path / "set", channels=["gyro"], header=4, time_unit="ms", test=0
    )
    assert counts["samples"] == 20
    long = tmp_path / "long.csv"
    long.write_text("t_ms,x\n" + rows.replace("\n", ",7\n"))
    with pytest.raises(sw.Error, match="line 2 has 3 columns where the header has 2; `header` 1 takes its names"):
        sw.read(long)
    assert sw.read(long, header=1).names == ["x", "3"]


def test_a_name_with_a_comma_is_one_name(tmp_path):
    path = tmp_path / "quoted.csv"
    path.write_text('"rate, raw",temperature\n0,20\n1,21\n')
    log = sw.read(path)
    assert log.names == ["rate, raw", "temperature"] and log["temperature"].tolist() == [20, 21]


def test_score_is_what_spikes_decode_to(log):
    scheme = sw.StepForward(threshold=0.1)
    figures = sw.score(log.x[0], scheme, rate=log.rate)
    spikes = scheme.encode(log.x[0])
    off = spikes.decode() - log.x[0]
    assert figures["spikes"] == spikes.count
    assert figures["rmse"] == pytest.approx(np.sqrt(np.mean(off**2)), rel=1e-6)


def test_what_is_tuned_keeps_to_its_goal(log):
    tuned = sw.tune(log.x[0], "sf", max_rmse=0.3, hold_out=0, rate=log.rate, evaluations=60, name="gyro_x")
    assert sw.score(log.x[0], tuned.scheme)["rmse"] <= 0.3
    assert tuned.to_rust("ROLL").splitlines()[-1].startswith("pub static ROLL: spikewire::temporal::StepForward<f32>")
    assert 'scheme = "sf"' in tuned.to_toml()
    assert sw.Scheme.from_toml(tuned.to_toml()) == tuned.scheme
    kept = sw.tune(log.x[0], sw.SendOnDelta, spikes=3, min_efficiency=50, evaluations=40)
    assert kept.scheme.parameters["spikes"] == 3
    for keywords, words in [
        ({"hold_out": 2}, "`hold_out` 2 must be 0 or more and below 1"),
        ({"max_rmse": 0}, "`max_rmse` 0 must be above 0 and finite"),
        ({"window": 5}, "sf takes no `window`"),
        ({"max_ram": 1}, "of the settings tried none keeps to all limits: sf: none of"),
    ]:
        with pytest.raises(ValueError, match=words):
            sw.tune(log.x[0], "sf", **{"evaluations": 20, **keywords})


def test_what_the_program_tuned_is_read(log, tmp_path):
    """A file of ``spikewire tune --emit toml``, which has comments, lists and words."""
    for text, expected in [
        ('# gyro_x\nscheme = "sf"\nsample = "f32"\nthreshold = 0.35\n', sw.StepForward(threshold=0.35)),
        ('scheme = "sf"\nsample = "q8.8"\nthreshold = [1, 2.5]\n', sw.StepForward(threshold=[1, 2.5], sample="q8.8")),
        ('scheme = "hsa"\nfilter = [0.25, 1, 0.5]\nshift = -2.5\n', sw.Hough(filter=[0.25, 1, 0.5], shift=-2.5)),
        ('scheme = "tbr"\nfactor = 0.5\nmagnitudes = true\n', sw.TemporalContrast(factor=0.5, magnitudes=True)),
    ]:
        path = tmp_path / "own.toml"
        path.write_text(text)
        for read in (sw.Scheme.from_toml(text), sw.Scheme.from_toml(path)):
            assert read == expected and np.array_equal(read.encode(log.x), expected.encode(log.x))
    path.write_text('scheme = "sf"\n\nthreshold = -1\n')
    with pytest.raises(sw.Error, match=r"own.toml:3: `?threshold`? (= )?-1 must be above 0") as caught:
        sw.Scheme.from_toml(path)
    assert caught.value.parameter == "threshold" and caught.value.file == str(path)
    with pytest.raises(sw.Error, match="nowhere.toml"):
        sw.Scheme.from_toml(tmp_path / "nowhere.toml")


@pytest.mark.skipif("SPIKEWIRE" not in os.environ, reason="SPIKEWIRE names the laptop program")
def test_a_file_of_tune_is_read(log, tmp_path):
    path = tmp_path / "roll.toml"
    tune = [os.environ["SPIKEWIRE"], "tune", FLIGHT, "--column", "gyro_x", "--scheme", "sf", "--evaluations", "20"]
    subprocess.run([*tune, "--emit", "toml", "-o", path], check=True, capture_output=True)
    assert sw.Scheme.from_toml(path).encode(log.x[0]).count > 0


def test_advice_names_a_scheme(log):
    advice = sw.advise(log.x[0][2000:2600], rate=log.rate, evaluations=12, name="gyro_x")
    assert "take " in advice.page and advice.best.scheme.name in advice.page
    assert json.dumps(advice.figures)


def test_pictures(log, tmp_path):
    picture = sw.plot(log.x[0], sw.StepForward(threshold=0.1), rate=log.rate, samples=(2000, 2400))
    picture.save(tmp_path / "flight.png")
    assert (tmp_path / "flight.png").read_bytes().startswith(b"\x89PNG")
    assert picture._repr_svg_().startswith("<svg")
    with pytest.raises(ValueError, match="a picture ends in .svg or .png"):
        picture.save(tmp_path / "flight.gif")
    with pytest.raises(ValueError, match=r"within 0\.\.3627"):
        sw.plot(log.x[0], sw.StepForward(threshold=0.1), samples=(0, 4000))


@pytest.mark.parametrize("scheme", sw.schemes.values())
def test_every_scheme_has_a_constant_and_a_file(scheme, log):
    own = scheme(paper=True).fit(log.x[0])
    if any(known["name"] == "seed" for known in own._info["parameters"]):
        with pytest.raises(ValueError, match="has no constant"):
            own.to_rust("ROLL")
    else:
        assert own.to_rust("ROLL").startswith("pub static ROLL: spikewire::")
    assert f'scheme = "{own.name}"' in own.to_toml()
    again = sw.Scheme.from_toml(own.to_toml())
    assert type(again) is scheme and again.to_toml() == own.to_toml()


@pytest.mark.parametrize("name", ["es", "evt2", "link,period=1000,channels=4", "eieio,signed=1", "csv"])
def test_events_there_and_back(name, tmp_path):
    x = np.sin(np.linspace(0, 40, 4000)).reshape(4, 1000)
    events = sw.Bank(sw.StepForward(threshold=0.1), channels=4).encode(x, period=1000)
    data = sw.write_events(events, name, tmp_path / "events")
    assert data == (tmp_path / "events").read_bytes()
    again = sw.read_events(tmp_path / "events", name)
    assert np.array_equal(again, events), name
    with pytest.raises(ValueError, match="addresses must be 0 to 65535"):
        sw.write_events(np.array([(0, 1 << 16, 1)], dtype=sw.EVENTS), name)


@pytest.mark.parametrize("name", ["es", "evt2", "evt3", "csv"])
def test_events_of_a_camera_keep_their_rows(name):
    # Names and types as those of tonic and of expelliarmus.
    for fields in ("<i2 <i2 <i8 u1", "<i8 <i8 <i8 ?"):
        x, y, t, p = fields.split()
        events = np.zeros(1000, dtype=[("x", x), ("y", y), ("t", t), ("p", p)])
        at = np.arange(1000)
        events["x"], events["y"], events["t"], events["p"] = at * 7919 % 640, at % 480, at // 4 * 977, at % 3 == 0
        again = sw.read_events(sw.write_events(events, name), name)
        assert again.dtype.names == ("t", "x", "y", "p")
        for field in again.dtype.names:
            assert np.array_equal(again[field], events[field]), (name, field)
    with pytest.raises(ValueError, match="events of a camera have columns and rows"):
        sw.write_events(events, "link")
    words = np.array([8 << 28, 1 << 28 | 3 << 11 | 32], dtype="<u4").tobytes()
    with pytest.raises(ValueError, match="rows from 32 on: 1"):
        sw.read_events(words, "evt2")


def test_times_go_on_where_they_wrap():
    events = np.array([(2**32 - 1000, 1, 1), (2**32 + 1000, 1, 0)], dtype=sw.EVENTS)
    assert np.array_equal(sw.read_events(sw.write_events(events, "csv"), "csv"), events)
    with pytest.raises(ValueError, match="no format `aedat`"):
        sw.read_events(b"", "aedat")


def test_a_flight_log_of_px4(tmp_path):
    logs = list(Path.home().glob(".cargo/registry/src/*/ulog-rs-0.0.4/test_data/sample-small.ulg"))
    if not logs:
        pytest.skip("no flight log here; the laptop program's tests bring one")
    path = shutil.copy(logs[0], tmp_path)
    flight = sw.read_ulog(path, "sensor_combined", "gyro_rad[0]", "gyro_rad[1]")
    table = sw.read(FLIGHT, "gyro_x", "gyro_y")
    assert np.array_equal(flight.x.astype(np.float32), table.x.astype(np.float32))


def test_a_library_for_c(tmp_path):
    sw.StepForward(threshold=0.35).to_c(tmp_path / "roll", name="roll")
    assert "roll: spikewire::temporal::StepForward<f32>" in (tmp_path / "roll/src/codecs.rs").read_text()
    with pytest.raises(ValueError, match="roll: cannot be written"):
        sw.StepForward(threshold=0.35).to_c(tmp_path / "roll", name="roll")
    with pytest.raises(ValueError, match="draws from a generator"):
        sw.Bernoulli(min=0, max=1).to_c(tmp_path / "chance")
