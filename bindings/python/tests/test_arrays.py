"""Arrays and tables of other libraries are treated by their axes, and masks are not ignored."""

import json

import numpy as np
import pytest

import spikewire as sw

STEP = sw.StepForward(threshold=0.5)
#: Four samples of two channels, as a table has them, and their spikes.
ROWS = np.array([[0.0, 5.0], [1.0, 5.0], [2.0, 5.0], [3.0, 5.0]])
SPIKES = [[0, 0], [1, 0], [1, 0], [1, 0]]


def tables():
    """Makers of a table with the columns gx and gy, by library."""

    def pandas(rows):
        return pytest.importorskip("pandas").DataFrame(rows, columns=["gx", "gy"])

    def polars(rows):
        return pytest.importorskip("polars").DataFrame(rows, schema=["gx", "gy"], orient="row")

    def lazy(rows):
        return polars(rows).lazy()

    def pyarrow(rows):
        return pytest.importorskip("pyarrow").table({"gx": rows[:, 0], "gy": rows[:, 1]})

    def xarray(rows):
        labels = {"channel": ["gx", "gy"]}
        return pytest.importorskip("xarray").DataArray(rows, dims=["time", "channel"], coords=labels)

    def xarray_time_last(rows):
        return xarray(rows).transpose()

    def xarray_set(rows):
        xarray = pytest.importorskip("xarray")
        return xarray.Dataset({"gx": ("time", rows[:, 0]), "gy": ("time", rows[:, 1])})

    def records(rows):
        return np.array([tuple(row) for row in rows], dtype=[("gx", rows.dtype), ("gy", rows.dtype)])

    return [pandas, polars, lazy, pyarrow, xarray, xarray_time_last, xarray_set, records]


@pytest.mark.parametrize("table", tables())
def test_time_goes_down_the_rows_of_a_table(table):
    spikes = STEP.encode(table(ROWS))
    across = table.__name__ in ("xarray_time_last", "xarray_set")
    assert (spikes.array.T if across else spikes.array).tolist() == SPIKES
    assert spikes.names == ["gx", "gy"] and spikes.decode().shape == spikes.shape
    assert STEP.decode(spikes.array, first=[0, 5], axis=1 if across else 0).tolist() == spikes.decode().tolist()
    assert np.array_equal(STEP.encoder(2).encode(table(ROWS)).T, SPIKES)
    assert sw.Bank(STEP, 2).encode(table(ROWS), period=1000).tolist() == [(1000, 0, 1), (2000, 0, 1), (3000, 0, 1)]
    assert np.array_equal(sw.ToSpikes(STEP)(table(ROWS)), spikes.array)
    fitted = sw.Hough(filter="triang:3").fit(table(ROWS), per_channel=True)
    assert fitted.parameters["shift"] == [0.0, 5.0]
    # The other axis only if it is asked for.
    given = STEP.encode(table(ROWS), axis=0 if across else 1)
    assert given.names is None and not np.array_equal(given, spikes)


@pytest.mark.parametrize("table", tables())
def test_a_filter_and_advice_take_tables(table):
    rows = np.sin(np.arange(800).reshape(400, 2) * 0.05)
    filtered = sw.Filter.low_pass(40, rate=500).filter(table(rows))
    across = table.__name__ in ("xarray_time_last", "xarray_set")
    expected = [sw.Filter.low_pass(40, rate=500).filter(column) for column in rows.T]
    assert np.array_equal(filtered if across else filtered.T, expected)
    advice = sw.advise(table(rows), rate=500, evaluations=4)
    assert [own.page.splitlines()[0].split(":")[0] for own in advice] == ["gx", "gy"]


def test_a_column_that_is_no_signal_is_named():
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"gx": [0.0, 1.0], "who": ["a", "b"]})
    with pytest.raises(sw.Error, match="column 'who' holds"):
        STEP.encode(frame)
    frame = pandas.DataFrame({"gx": [0.0, 1.0], "t": pandas.to_datetime(["2026-01-01", "2026-01-02"])})
    with pytest.raises(sw.Error, match=r"column 't' holds datetime64"):
        STEP.encode(frame)
    with pytest.raises(sw.Error, match="no columns"):
        STEP.encode(pandas.DataFrame())
    assert sw.advise(pandas.Series(np.sin(np.arange(300) / 9), name="gz"), evaluations=4).page.startswith("gz")
    with pytest.raises(sw.Error, match="sample 1: NaN is not finite"):
        STEP.encode(pandas.DataFrame({"gx": [0.0, None]}))


def arrays():
    """Makers of an array of another library."""

    def torch(x):
        return pytest.importorskip("torch").tensor(x)

    def trained(x):
        return torch(np.asarray(x, float)).requires_grad_()

    def jax(x):
        return pytest.importorskip("jax").numpy.array(x)

    def dask(x):
        return pytest.importorskip("dask.array").from_array(np.asarray(x))

    def xarray(x):
        return pytest.importorskip("xarray").DataArray(x, dims=["time", "input"])

    def xarray_time_last(x):
        return xarray(x).transpose()

    def polars(x):
        return pytest.importorskip("polars").DataFrame(np.asarray(x), schema=["a", "b"], orient="row")

    def pandas(x):
        return pytest.importorskip("pandas").DataFrame(x)

    def pyarrow(x):
        x = np.asarray(x)
        return pytest.importorskip("pyarrow").table({"a": x[:, 0], "b": x[:, 1]})

    return [np.asarray, torch, trained, jax, dask, xarray, xarray_time_last, polars, pandas, pyarrow]


@pytest.fixture
def network(tmp_path):
    layers = [{"weights": [[1, 0], [0, 1]], "keep": 0.5, "threshold": 10}]
    (tmp_path / "n.json").write_text(json.dumps({"layers": layers}))
    return sw.Network.from_nir(tmp_path / "n.json")


@pytest.mark.parametrize("array", arrays())
def test_counts_are_counts_in_arrays_of_every_library(array, network):
    counts = [[0, 1], [1, 1]]
    assert network.run(array(counts)).potentials.tolist() == [[0.0, 1.0], [1.0, 1.5]]
    rust = network.to_rust(array(counts * 5))
    assert rust == network.to_rust([[1], [0, 1]] * 5) != network.to_rust(counts * 5)
    network.reset()
    if array.__name__ not in ("xarray", "xarray_time_last", "polars", "pandas", "pyarrow"):
        assert [network.step(row).tolist() for row in array(counts)] == [[0.0, 1.0], [1.0, 1.5]]


def test_lists_have_the_numbers_of_inputs(network):
    assert network.run([[0, 1], [1, 1]]).potentials.tolist() == [[1.0, 1.0], [0.5, 2.5]]
    assert network.run([np.array([1, 1]), (1,)]).potentials.tolist() == [[1.0, 1.0], [0.5, 1.5]]
    for bad, words in [
        ([[0.5]], "cannot be interpreted as an integer"),
        ([[True, False]], "numbers of the inputs that fire, and not True"),
        ([[-1]], "input -1: the network has inputs 0 to 1"),
        ([[1 << 20]], "the network has inputs 0 to 1"),
        (np.ones((2, 2, 2)), r"an array \(steps, inputs\) of counts, not \(2, 2, 2\)"),
        (np.array([[0.0, np.nan]]), "2 counts"),
        (np.array([[0.0, np.inf]]), "2 counts"),
        (np.array([[0.0, -1.0]]), "2 counts"),
        (np.array([["a", "b"]]), "2 counts"),
    ]:
        with pytest.raises(sw.Error, match=words):
            network.run(bad)


def test_spikes_run_by_their_own_axis_of_time(network):
    x = np.array([[0.0, 1.0], [0.0, 0.0]])
    for spikes in (STEP.encode(x), STEP.encode(x.T.copy(), axis=0)):
        assert network.run(spikes).potentials.tolist() == [[0.0, 0.0], [1.0, 0.0]]


def test_numbers_of_16_bits_that_numpy_lacks():
    x = np.array([0.0, 1.0, 1.5, -2.0], np.float32)
    torch = pytest.importorskip("torch")
    for kind in (torch.bfloat16, torch.float16):
        assert np.array_equal(STEP.encode(torch.tensor(x, dtype=kind)), STEP.encode(x))
        assert sw.ToSpikes(STEP)(torch.tensor(x, dtype=kind)).tolist() == STEP.encode(x).tolist()
        made = sw.ToSpikes(STEP, dtype=kind)
        for same in (made(torch.tensor(x)), made(x)):
            assert same.dtype == kind and same.tolist() == STEP.encode(x).tolist()
        assert sw.score(torch.tensor(x, dtype=kind), STEP)["spikes"] == STEP.encode(x).count


HOLE = np.ma.array([[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]] * 2, mask=[[0] * 6, [0, 1, 0, 0, 0, 0]])


@pytest.mark.parametrize(
    "call",
    [
        lambda: STEP.encode(HOLE),
        lambda: STEP.fit(HOLE),
        lambda: STEP.encoder(2).encode(HOLE),
        lambda: sw.advise(HOLE),
        lambda: sw.advise(HOLE[1]),
        lambda: sw.tune([HOLE[0], HOLE[1]], "sf"),
        lambda: sw.plot(HOLE[1], STEP),
        lambda: sw.Filter.low_pass(40, rate=500).filter(HOLE),
        lambda: sw.Sender(STEP, period=1000).encode(HOLE[1]),
        lambda: STEP.decode(HOLE.astype(np.int8), first=0),
        lambda: STEP.decode([0, 1], first=np.ma.array([0.0], mask=[1])),
        lambda: STEP.decode_weighted(HOLE, first=0),
        lambda: STEP.encode([0.0] * 6).events(times=HOLE[1].astype(np.int64)),
        lambda: sw.Network.from_toml(
            '[[layers]]\nname = "one"\nkeep = [0.9]\nweights = [[0.5, 0.5, 0.5, 0.5, 0.5, 0.5]]\n'
        ).run(HOLE),
        lambda: sw.write_events({"t": HOLE[1].astype(np.int64), "x": np.zeros(6), "p": np.ones(6)}, "csv"),
    ],
)
def test_what_is_masked_is_refused_everywhere(call):
    with pytest.raises(sw.Error, match="the sample at .* is masked"):
        call()
