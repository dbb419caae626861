"""What users of networks do with the package: chance, forks, layouts, weights, threads, words."""

import functools
import multiprocessing
import os
import sys
import threading
import warnings

import numpy as np
import pytest

import spikewire as sw

CHANCE = [sw.Bernoulli, functools.partial(sw.Probabilistic, neurons=15)]


@pytest.fixture
def x():
    return np.sin(np.arange(400).reshape(2, 200) * 0.07)


# Chance.


@pytest.mark.parametrize("scheme", CHANCE)
def test_channels_and_calls_draw_apart(scheme):
    alike = np.full((4, 2000), 0.43)
    own = scheme(min=0, max=1)
    first, second = own.encode(alike).array, own.encode(alike).array
    rows = np.concatenate([first, second]).reshape(8, -1).astype(float)
    # Of samples that are equal, draws alone differ: correlated by chance, with a deviation of 1 / sqrt(2000).
    rows = rows[:, np.tile(rows.std(axis=0) > 0, 1)]
    correlated = np.corrcoef(rows - rows.mean(axis=0))
    assert np.abs(correlated[~np.eye(8, dtype=bool)] + 1 / 7).max() < 0.12


@pytest.mark.parametrize("scheme", CHANCE)
def test_a_seed_repeats_and_a_generator_goes_on(scheme, x):
    seeded = scheme(min=-1, max=1, seed=7)
    whole = seeded.encode(x).array
    assert np.array_equal(seeded.encode(x).array, whole)
    assert np.array_equal(seeded.encoder(2).encode(x), whole)
    assert np.array_equal(seeded.encode(x[0]).array, whole[0])
    drawn = [scheme(min=-1, max=1, seed=np.random.default_rng(3)) for _ in range(2)]
    twice = [[own.encode(x).array for _ in range(2)] for own in drawn]
    assert np.array_equal(twice[0], twice[1]) and not np.array_equal(*twice[0])
    with pytest.raises(ValueError, match="min takes no generator; seed does"):
        scheme(min=np.random.default_rng(3), max=1)


def test_what_flies_has_no_seed(x):
    assert "seed" not in sw.Bernoulli().fit(x).parameters
    assert sw.Bernoulli(seed=3).fit(x).parameters["seed"] == 3


# Processes.


def spikes_of(x):
    return sw.StepForward(threshold=0.01).encode(x).array


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
def test_processes_encode_after_their_parent(method):
    x = np.sin(np.arange(80_000).reshape(8, -1) * 0.01)
    expected = spikes_of(x)  # the parent's threads have started
    with multiprocessing.get_context(method).Pool(2) as pool:
        for array in pool.map_async(spikes_of, [x] * 4).get(timeout=60):
            assert np.array_equal(array, expected)


def test_a_child_of_a_child_encodes():
    x = np.sin(np.arange(80_000).reshape(8, -1) * 0.01)
    expected = spikes_of(x)
    child = os.fork()
    if not child:
        good = np.array_equal(spikes_of(x), expected)
        grandchild = os.fork()
        if not grandchild:
            os._exit(0 if np.array_equal(spikes_of(x), expected) else 1)
        os._exit(0 if good and os.waitpid(grandchild, 0)[1] == 0 else 1)
    alarm = threading.Timer(60, os.kill, (child, 9))
    alarm.start()
    assert os.waitpid(child, 0)[1] == 0
    alarm.cancel()


def test_workers_of_a_data_loader_encode():
    torch = pytest.importorskip("torch")
    x = torch.sin(torch.arange(80_000).reshape(4, -1, 4) * 0.01)
    transform = sw.ToSpikes(sw.StepForward(threshold=0.1), axis=0)

    class Data(torch.utils.data.Dataset):
        def __len__(self):
            return len(x)

        def __getitem__(self, place):
            return transform(x[place])

    expected = [transform(own) for own in x]
    for own, batch in zip(expected, torch.utils.data.DataLoader(Data(), num_workers=2, timeout=60)):
        assert torch.equal(batch[0], own)


def test_a_transform_takes_tensors_without_a_copy(x):
    torch = pytest.importorskip("torch")
    spikes = sw.ToSpikes(sw.StepForward(threshold=0.1), axis=0)(torch.from_numpy(x.T))
    assert isinstance(spikes, torch.Tensor) and spikes.shape == (200, 2)


# What is refused, and how.


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda: sw.StepForward(threshold=1).encode([0.0, 1e39]), r"channel 0, sample 1: 1e39 is beyond f32"),
        (lambda: sw.StepForward(threshold=1).encoder().encode([0.0, -1e39]), r"sample 1: -1e39 is beyond f32"),
        (lambda: sw.StepForward(threshold=True), "threshold=True must be a number, not True or False"),
        (lambda: sw.StepForward(threshold=np.bool_(False)), "threshold=False must be a number, not True or False"),
        (lambda: sw.MovingWindow(threshold=1, window=True), "window=True must be a whole number, not True or False"),
        (lambda: sw.StepForward(threshold=1).encode(np.ma.array([[1.0, 2.0]], mask=[[0, 1]])), "sample at 0, 1 is masked"),
        (lambda: sw.score(np.ma.array([1.0, 2.0], mask=[0, 1]), sw.StepForward(threshold=1)), "sample at 1 is masked"),
        (lambda: sw.Position(neurons=9).encode([[0.0, 1.0], [2.0, 2.0]]), "channel 1: "),
        (lambda: sw.StepForward(threshold=1).encode(np.zeros((2, 3)), axis=2), "axis 2: there are 2 axes"),
    ],
)
def test_what_is_bad_is_named(call, words):
    with pytest.raises(ValueError, match=words):
        call()


def test_a_flag_that_is_false_is_off(x):
    plain = sw.TemporalContrast(factor=0.5)
    assert sw.TemporalContrast(factor=0.5, magnitudes=np.False_) == plain
    magnitudes = sw.TemporalContrast(factor=0.5, magnitudes=np.True_)
    assert magnitudes == sw.TemporalContrast(factor=0.5, magnitudes=True) != plain
    assert not np.array_equal(magnitudes.encode(x).parameters, plain.encode(x).parameters)


def test_a_mask_without_a_hole_is_no_matter(x):
    assert np.array_equal(spikes_of(np.ma.array(x)), spikes_of(x))


def test_whole_numbers_beyond_f32_are_told():
    degrees = 473_977_423 + np.cumsum(np.ones(100, np.int32))
    with pytest.warns(UserWarning, match="samples reach 473977523: f32 holds whole numbers to 16777216, and i32 does"):
        sw.StepForward(threshold=3).encode(degrees)
    assert sw.StepForward(threshold=3, sample="i32").encode(degrees).count > 20


FIXED = sw.StepForward(threshold=1, sample="q8.8")


@pytest.mark.parametrize(
    "call",
    [
        lambda x: FIXED.encode(x),
        lambda x: FIXED.encode(x[:, None].astype(np.float32), axis=0),
        lambda x: FIXED.encode(x.astype(np.int16)),
        lambda x: FIXED.fit(x),
        lambda x: FIXED.encoder().encode(x),
        lambda x: sw.Bank(FIXED, 2).encode([x, x[:1].repeat(6)], period=1000),
        lambda x: sw.Sender(FIXED, period=1000).encode(x),
        lambda x: sw.Sender([FIXED] * 6, period=1000).encode(x),
        lambda x: sw.ToSpikes(FIXED)(x),
        lambda x: sw.plot(x, FIXED),
        lambda x: sw.tune(x, "sf", sample="q8.8", evaluations=4, hold_out=0, anyway=True),
        lambda x: sw.advise(np.tile(x, 20), sample="q8.8", evaluations=4),
    ],
)
def test_samples_that_fixed_point_cuts_are_told(call):
    x = np.array([0.0, 127.5, 300.0, -128.0, -129.0, 1.0])
    with pytest.warns(UserWarning, match=r"\d+ samples were cut to the range of q8.8, -128 to 127.99609375"):
        call(x)


@pytest.mark.parametrize(
    "keywords, words",
    [
        ({"threshold": 1e9}, "in q8.8, threshold 1000000000 ran as 127.99609375"),
        ({"threshold": [1, 200]}, "in q8.8, threshold 200 ran as 127.99609375"),
        ({"threshold": 1, "start": -1e9}, "in q8.8, start -1000000000 ran as -128"),
    ],
)
def test_parameters_that_fixed_point_cuts_are_told(keywords, words):
    with pytest.warns(UserWarning, match=words):
        sw.StepForward(**keywords, sample="q8.8")


def test_samples_that_fixed_point_holds_are_not_told():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert FIXED.encode([0.0, 127.9, -128.0]).decode().max() <= 128
        sw.StepForward(threshold=1).encode([0.0, 1e30])
        sw.StepForward(threshold=0.1, sample="q8.8"), sw.Gaussian(neurons=9, sample="q1.15")
        sw.StepForward(threshold=1, sample="i16").encode(np.array([-32768, 32767], np.int16))
    with pytest.warns(UserWarning, match="1 samples were cut to the range of q8.8") as told:
        FIXED.encode([[0.0, 1e9], [0.0, 1.0]])
    with pytest.warns(UserWarning, match="1 samples were cut to the range of q8.8"):
        assert FIXED.decoder(first=[0, -1e9]).decode([[0], [0]]).tolist() == [[0], [-128]]
    assert told[0].filename == __file__


@pytest.mark.parametrize("scheme", sw.schemes.values())
def test_no_samples_have_no_spikes(scheme):
    own = scheme(paper=True)
    for shape in [(0,), (3, 0), (0, 5), (2, 3, 0)]:
        spikes = own.encode(np.zeros(shape))
        assert spikes.shape[: len(shape)] == shape and spikes.decode().shape == shape
        assert spikes.count == 0 and len(spikes.events()) == 0 and spikes.parameters == [] and spikes.latency >= 0


def test_a_bad_row_leaves_the_decoder_as_it_was():
    scheme = sw.StepForward(threshold=1)
    decoder = scheme.decoder(first=[0.0, 5.0], channels=2)
    decoder.decode([[0, 1], [0, -1]])
    with pytest.raises(ValueError, match=r"channel 1, sample 1: \[3\] is no code"):
        decoder.decode([[1, 1], [-1, 3]])
    assert decoder.decode([[0], [0]]).tolist() == [[1.0], [4.0]]


# Weights.


@pytest.mark.parametrize("scheme", [sw.schemes[name] for name in (
    "position", "grf", "grf-prob", "grf-nonlinear", "ttfs", "tbr", "sf", "mw", "sod", "hsa", "t-hsa", "bsa", "sigma-delta",
    "if", "bernoulli", "weighted-phase",
)])
def test_spikes_as_weights_decode_to_the_same(scheme, x):
    own = scheme(paper=True).fit(x, axis=-1)
    spikes = own.encode(x)
    first = x[:, 0] if own._info["has_first_value"] else None
    weighted = own.decode_weighted(spikes.array, first)
    assert np.allclose(weighted, spikes.decode(), rtol=0, atol=1e-5 * np.ptp(x))
    # Time first.
    by_time = np.moveaxis(spikes.array, 1, 0)
    assert np.allclose(own.decode_weighted(by_time, first, axis=0).T, weighted)
    assert np.array_equal(own.decode(by_time, first, axis=0).T, spikes.decode())


def test_weights_lie_between_values():
    fields = sw.Gaussian(min=0, max=10, neurons=13)
    two = np.zeros((3, 13))
    two[1, [6, 7]] = 0.5
    low, middle, again = fields.decode_weighted(two)
    each = [float(fields.decode_weighted(np.eye(13)[[place]])[0]) for place in (6, 7)]
    assert middle == pytest.approx(np.mean(each)) and again == middle and np.isfinite(low)
    steps = sw.StepForward(threshold=0.5, start=2.0)
    assert steps.decode_weighted([0.5, -1.0, 0.25]).tolist() == pytest.approx([2.25, 1.75, 1.875])
    digits = sw.WeightedPhase(min=0, max=1, slots=4)
    half = digits.decode_weighted(np.full((1, 4, 1), 0.5))[0]
    assert half == pytest.approx(np.mean(digits.decode(np.array([np.zeros((4, 1)), np.ones((4, 1))]))), abs=1e-6)


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda: sw.Position(min=0, max=1, neurons=3).decode_weighted([[1, -1, 0]]), "must be 0 or more"),
        (lambda: sw.StepForward(threshold=1, start=0).decode_weighted([np.nan]), "weights must be finite"),
        (lambda: sw.RankOrder(min=0, max=1, neurons=9, spikes=4).decode_weighted(np.zeros((1, 4, 9))), "rank-order has no values for weights"),
        (lambda: sw.StepForward(threshold=1, start=0).decode([0.5]), "decode_weighted takes what lies between"),
        (lambda: sw.StepForward(threshold=1).decode_weighted([0.5]), "decodes from a first value"),
    ],
)
def test_weights_that_mean_nothing_are_refused(call, words):
    with pytest.raises(ValueError, match=words):
        call()


# Layouts and channels.


@pytest.mark.parametrize("scheme", [sw.StepForward(threshold=0.1), sw.Gaussian(min=-1, max=1, neurons=7), sw.SendOnDelta(threshold=0.1, spikes=3)])
def test_time_may_be_the_first_axis(scheme):
    x = np.sin(np.arange(600).reshape(100, 3, 2) * 0.05)
    last = scheme.encode(np.moveaxis(x, 0, -1))
    first = scheme.encode(x, axis=0)
    assert first.shape[:3] == (100, 3, 2)
    assert np.array_equal(np.moveaxis(first.array, 0, 2), last.array)
    assert np.array_equal(np.moveaxis(first.decode(), 0, -1), last.decode())
    assert np.array_equal(first.events(1000), last.events(1000)) and first.fingerprint() == last.fingerprint()


def test_each_channel_may_have_what_it_tells(x):
    x = x * [[1.0], [10.0]]
    own = sw.Hough(filter="triang:5,sum=1").fit(x, per_channel=True)
    assert own.parameters["shift"] == pytest.approx(x.min(axis=1))
    assert np.array_equal(own.encode(x).array, sw.Hough(filter="triang:5,sum=1").encode(x).array)
    with pytest.raises(ValueError, match="channels differ in centres, which has one value for all"):
        sw.NonLinearGaussian(neurons=9, centres="quantiles").fit(x**3, per_channel=True)


def test_a_filter_passes_half_the_power_at_its_cut_off():
    rate, cut_off = 1000, 30
    taps = sw.low_pass(cut_off, rate, sum=2)
    assert len(taps) % 2 == 1 and taps.min() > 0 and taps.sum() == pytest.approx(2)
    turns = np.exp(-2j * np.pi * cut_off / rate * np.arange(len(taps)))
    assert abs(taps @ turns) / 2 == pytest.approx(np.sqrt(0.5), abs=0.005)
    assert sw.Hough(filter=taps, shift=-1).encode(np.sin(np.arange(300) / 30)).count > 0
    for bad in [0, 500, np.nan]:
        with pytest.raises(ValueError, match="cut_off"):
            sw.low_pass(bad, rate)


def test_a_transform_is_a_step_of_a_pipeline(x):
    import pickle

    transform = sw.ToSpikes(sw.StepForward(threshold=0.1), axis=0, dtype=np.float32)
    again = pickle.loads(pickle.dumps(transform))
    assert again(x.T).dtype == np.float32 and again(x.T).shape == (200, 2)
    assert np.array_equal(again(x.T).T, sw.StepForward(threshold=0.1).encode(x).array)
    assert repr(again) == "ToSpikes(StepForward(threshold=0.1), axis=0, dtype='float32')"


def test_a_raster_has_a_mark_for_each_spike(x):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    from matplotlib.figure import Figure

    for scheme in [sw.StepForward(threshold=0.1), sw.Gaussian(min=-1, max=1, neurons=7)]:
        spikes = scheme.encode(x)
        axes = Figure().subplots()
        assert spikes.raster(axes, rate=100) is axes
        marks = axes.collections[0].get_offsets()
        events = spikes.events(period=10_000)
        order = np.lexsort((marks[:, 1], marks[:, 0]))
        assert np.allclose(marks[order], np.stack([events["t"] / 1e6, events["x"]], axis=1))


# Words.


def test_things_say_what_they_are(x):
    scheme = sw.StepForward(threshold=0.1)
    for thing, words in [
        (scheme.encoder(), "StepForward(threshold=0.1).encoder()"),
        (scheme.decoder(first=[0.0, 0.0]), "StepForward(threshold=0.1).decoder(channels=2)"),
        (sw.Bank(scheme, 2), "Bank(StepForward(threshold=0.1), channels=2)"),
        (sw.plot(x[0], scheme), "Picture of x by StepForward(threshold=0.1)"),
        (sw.Log(x, None, ["a", "b"], []), "Log of a, b: (2, 200)"),
    ]:
        assert repr(thing) == words
    assert sw.__version__.count(".") == 2


def test_an_encoder_at_work_says_so():
    scheme = sw.Gaussian(min=-1, max=1, neurons=64)
    encoder, x = scheme.encoder(), np.zeros(200_000, np.float32)
    told = []

    def work():
        for _ in range(20):
            try:
                encoder.encode(x)
            except RuntimeError as error:
                told.append(str(error))

    threads = [threading.Thread(target=work) for _ in range(4)]
    [thread.start() for thread in threads], [thread.join() for thread in threads]
    assert told and all("this encoder is at work in another thread" in words for words in told)


# Arrays.


def test_spikes_are_an_array(x):
    spikes = sw.SendOnDelta(threshold=0.05, spikes=4).encode(x)
    array = spikes.array
    assert np.count_nonzero(spikes == 1) == np.count_nonzero(array == 1) > 0
    for own, same in [
        (spikes != 0, array != 0),
        (spikes > array, array > array),
        (spikes * 2 - spikes, array),
        (abs(spikes), abs(array)),
        (np.add.reduce(spikes, axis=1), array.sum(1)),
        (spikes.sum(), array.sum()),
        (spikes.sum(axis=0), array.sum(0)),
        (np.mean(spikes, axis=0), array.mean(0)),
        (spikes.T, array.T),
        (spikes.astype(np.float32), array.astype(np.float32)),
        (np.from_dlpack(spikes), array),
    ]:
        assert np.array_equal(own, same) and type(own) is type(same)
    assert all(getattr(spikes, name) == getattr(array, name) for name in ["ndim", "size", "dtype", "shape"])
    total = np.zeros(array.shape)
    np.add(total, spikes, out=total)
    assert np.array_equal(total, array)
    if sys.version_info >= (3, 12):
        assert np.array_equal(memoryview(spikes), array)
    with pytest.raises(TypeError, match="spikes are not written to"):
        np.add(total, 1, out=spikes)
    assert spikes.count == np.abs(array.astype(int)).sum()


def test_words_for_a_wrong_scheme_or_axis(x):
    with pytest.raises(KeyError, match="there is no scheme 'x'; there are tbr, "):
        sw.schemes["x"]
    step = sw.StepForward(threshold=0.1)
    spikes = step.encode(x).array
    for call in (step.encode, lambda x, axis: step.decode(spikes, 0, axis), lambda x, axis: step.decode_weighted(spikes, 0, axis)):
        with pytest.raises(ValueError, match="axis is that of time, a whole number from -2 to 1, and not None"):
            call(x, axis=None)
        with pytest.raises(ValueError, match="axis 2: there are 2 axes"):
            call(x, axis=2)
    with pytest.raises(ValueError, match="axis 7: there are 1 axes"):
        step.decode(step.encode(x[0]).array, 0, 7)
    assert "x" not in sw.schemes and sw.schemes.get("x") is None
