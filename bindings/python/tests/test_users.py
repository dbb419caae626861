"""What users of networks do with the package: chance, forks, layouts, weights, threads, words."""

import copy
import functools
import inspect
import multiprocessing
import os
import pickle
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
        (lambda: sw.Filter.low_pass(40, rate=500).filter([0.0, np.inf]), "channel 0, sample 1: inf is not finite"),
        (lambda: sw.Filter.low_pass(40, rate=500).filter([[0.0], [1e39]]), "channel 1, sample 0: 1e39 is beyond f32"),
        (lambda: sw.Filter.low_pass(40, rate=500).filter(3.0), "samples are an array"),
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


def only_warning(call):
    """The one warning of a call, which names the caller's line."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        call()
    assert len(told) == 1 and told[0].filename == __file__, [str(own.message) for own in told]
    return str(told[0].message)


def test_whole_numbers_beyond_f32_are_told():
    degrees = 473_977_423 + np.cumsum(np.ones(100, np.int32))
    words = only_warning(lambda: sw.StepForward(threshold=3).encode(degrees))
    assert words.startswith("f32 loses the column's own steps: they are 1 on average") and "; i32 hold" in words
    assert sw.StepForward(threshold=3, sample="i32").encode(degrees).count > 20


@pytest.mark.parametrize(
    "call",
    [
        lambda step, x: step.encode(x),
        lambda step, x: step.encode(x[:, None], axis=0),
        lambda step, x: step.fit(x),
        lambda step, x: step.encoder().encode(x),
        lambda step, x: sw.Filter.low_pass(40, rate=500).filter(x),
        lambda step, x: sw.plot(x, step),
        lambda step, x: sw.tune(x, "sf", max_rmse=1e4, evaluations=4, hold_out=0, anyway=True),
    ],
)
@pytest.mark.parametrize("times", [1, 40])
def test_steps_that_the_type_loses_are_told(call, times):
    walk = np.cumsum(np.random.default_rng(1).normal(size=1000 * times))
    call = functools.partial(call, sw.StepForward(threshold=1))
    assert "f32 loses the column's own steps" in only_warning(lambda: call(walk + 1e9))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        call(walk), call(np.tile(walk, 50) + 300), call(walk.astype(np.float32) + np.float32(1e9))


def test_the_first_channel_that_loses_its_steps_is_named():
    x = np.array([[0.0, 1.0, 0.0], [1e9, 1e9 + 1, 1e9]])
    assert only_warning(lambda: sw.StepForward(threshold=0.5).encode(x)).startswith("channel 1: f32 loses")
    words = only_warning(lambda: sw.StepForward(threshold=0.5, sample="q8.8").encode([0.0, 1e-4, 2e-4]))
    assert words.startswith("q8.8 loses the column's own steps")


RANGED = [scheme for scheme in sw.schemes.values() if {"min", "max"} <= {own["name"] for own in scheme._info["parameters"]}]


def test_fourteen_codes_have_a_range():
    assert len(RANGED) == 14


@pytest.mark.parametrize("scheme", RANGED)
@pytest.mark.parametrize("kind", [np.float32, np.float64, np.int16])
def test_samples_outside_the_range_are_told_with_their_share(scheme, kind):
    inside = np.tile(np.array([-100, 0, 50, 100], kind), (3, 25))
    outside = inside.copy()
    outside[1, ::4] += 250
    outside[2, 3::4] -= 300
    own = scheme(paper=True, min=-100, max=100)
    words = "50 of 300 samples, 16.6667 %, lie outside the code's range, min -100 to max 100"
    for x, axis in [(outside, -1), (outside.T.copy(), 0), (np.repeat(outside, 2, 1)[:, ::2], -1)]:
        assert only_warning(lambda: own.encode(x, axis=axis)).startswith(words)
    fitted = own.fit(inside)
    assert only_warning(lambda: fitted.encoder(3).encode(outside)).startswith(words)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        own.encode(inside), fitted.encoder(3).encode(inside), scheme(paper=True).encode(outside)
        scheme(paper=True).fit(outside).encode(outside)


def test_a_range_is_as_coarse_as_the_sample_type():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        third = np.array([0.1, 1 / 3, 0.7])
        for sample in ["f32", "q8.8", "q16.16"]:
            own = sw.WeightedPhase(min=0.1, max=0.7, sample=sample)
            own.encode(third), own.encoder().encode(third)
        sw.WeightedPhase(min=[0, -5], max=[1, 5]).encode([[0.0, 1.0], [-5.0, 5.0]])
    words = only_warning(lambda: sw.WeightedPhase(min=[0, -5], max=[1, 5]).encode([[0.0, 1.0], [-5.0, 6.0]]))
    assert words.startswith("1 of 4 samples, 25 %, lie outside the code's range, min -5 to max 5")
    sender = sw.Sender(sw.WeightedPhase(min=-1, max=1, slots=8), period=1000)
    assert only_warning(lambda: sender.encode([0, 0, 0, 0, 0, 9.8])).startswith("1 of 6 samples")
    assert only_warning(lambda: sw.plot([0.0, 1.0, 2.0], sw.WeightedPhase(min=0, max=1))).startswith("1 of 3 samples")
    assert any("lie outside" in note for note in sw.score([0.0, 1.0, 2.0], sw.WeightedPhase(min=0, max=1))["notes"])


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
        lambda x: sw.Filter.first_order(40, rate=500).filter(x, sample="q8.8"),
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


def test_spikes_go_where_arrays_go(x):
    spikes = sw.SendOnDelta(threshold=0.05, spikes=4).encode(x)
    array = spikes.array
    assert isinstance(spikes, np.ndarray) and type(array) is np.ndarray and np.shares_memory(spikes, array)
    assert spikes.max() == array.max() and max(spikes.flat) == max(array.flat)
    assert spikes.tolist() == array.tolist() and [row.tolist() for row in spikes] == array.tolist()
    for own, same in [
        (spikes.reshape(-1), array.reshape(-1)),
        (spikes.flatten(), array.flatten()),
        (spikes.copy(), array),
        (spikes.real, array),
        (spikes[:, 3:9], array[:, 3:9]),
        (np.concatenate([spikes, spikes]), np.concatenate([array, array])),
        (np.stack([spikes, spikes]), np.stack([array, array])),
        (np.where(spikes > 0, spikes, 0), np.where(array > 0, array, 0)),
        (np.moveaxis(spikes, 0, 1), array.swapaxes(0, 1)),
        (np.split(spikes, 2)[1], array[1:]),
        (np.asarray(spikes), array),
        (np.array(spikes), array),
        (next(iter(spikes)), array[0]),
    ]:
        assert np.array_equal(own, same) and type(own) is type(same)
    for again in (pickle.loads(pickle.dumps(spikes)), copy.copy(spikes), copy.deepcopy(spikes)):
        assert repr(again) == repr(spikes) == str(spikes) and np.array_equal(again.decode(), spikes.decode())
    assert repr(np.array(spikes, subok=True)) == repr(array)
    with pytest.raises(TypeError, match="spikes are not written to"):
        spikes[0] = 1
    with pytest.raises(sw.Error, match="spikes are not written to"):
        spikes += 1


def test_spikes_are_tables_and_tensors(x):
    spikes = sw.StepForward(threshold=0.1).encode(x.T, axis=0)
    pandas = pytest.importorskip("pandas")
    assert np.array_equal(pandas.DataFrame(spikes, columns=spikes.names), spikes.array)
    assert type(pandas.DataFrame(spikes).to_numpy()) is np.ndarray
    torch = pytest.importorskip("torch")
    for tensor in (torch.from_numpy(spikes), torch.as_tensor(spikes), torch.tensor(spikes), torch.from_dlpack(spikes)):
        assert tensor.dtype == torch.int8 and np.array_equal(tensor.numpy(), spikes.array)


# Pickles.


def test_ends_and_filters_pickle(x):
    quiet = sw.Filter.notch(60, rate=500, q=2).then(sw.Filter.low_pass(40, rate=500)).then(sw.Filter.first_order(9, rate=500))
    again = pickle.loads(pickle.dumps(quiet))
    assert again == quiet and repr(again) == repr(quiet) and hash(again) == hash(quiet) and again.delay == quiet.delay
    assert np.array_equal(again.filter(x), quiet.filter(x)) and again != sw.Filter.low_pass(40, rate=500)
    step = sw.StepForward(threshold=0.1)
    sender, receiver = sw.Sender(step, 1000, filter=quiet, label="a"), sw.Receiver([step] * 6, 1000, filter=quiet, label="a")
    ends = [(sender, receiver), pickle.loads(pickle.dumps((sender, receiver))), copy.deepcopy((sender, receiver))]
    frames = [near.encode([1, 0, 0, 0, 0, 9.8]) for near, _ in ends]
    assert frames[0] and frames[1] == frames[2] == frames[0]
    for (_, far), sent in zip(ends, frames):
        for kind in (bytes, bytearray, memoryview):
            far.hear(kind(sent[0]))
        assert far.values[5] != 0
    for end in (sender, receiver):
        with pytest.raises(sw.Error, match="is at work: a pickle has what it was made of"):
            pickle.dumps(end)


def test_a_network_pickles_with_its_state():
    layers = '[[layers]]\nname = "one"\nkeep = [0.9, 0.3]\nweights = [[0.1, 0.7], [0.3, 0.9]]\n'
    network = sw.Network.from_toml(layers)
    network.step([0]), network.step([1])
    again = pickle.loads(pickle.dumps(network))
    assert np.array_equal(again.step([0]), network.step([0])) and again.fired == network.fired
    with pytest.raises(sw.Error, match="another network's"):
        again.__setstate__([([0.0], [0.0], [])])


# One kind of error.


@pytest.mark.parametrize(
    "call, kind",
    [
        (lambda: sw.StepForward(0.1), TypeError),
        (lambda: sw.StepForward(treshold=0.1), TypeError),
        (lambda: sw.StepForward(threshold={}), TypeError),
        (lambda: sw.StepForward(threshold=0.1).encode("abc"), ValueError),
        (lambda: sw.StepForward(threshold=0.1).encode([[1], [1, 2]]), ValueError),
        (lambda: sw.StepForward(threshold=0.1).encoder(-1), ValueError),
        (lambda: sw.StepForward(threshold=0.1).encoder("two"), TypeError),
        (lambda: sw.schemes["x"], KeyError),
        (lambda: sw.Sender(sw.StepForward(threshold=1), period=2**32), OverflowError),
        (lambda: sw.Sender(sw.StepForward(threshold=1), period=2.5), TypeError),
        (lambda: sw.Sender(sw.StepForward(threshold=1), 1000).encode([1, 2]), ValueError),
        (lambda: sw.Receiver(sw.StepForward(threshold=1), 1000).hear(5), TypeError),
        (lambda: sw.Receiver(sw.StepForward(threshold=1), 1000).advance(-1), OverflowError),
        (lambda: sw.tune([1.0, 2.0], "sf", evaluations=-3), ValueError),
        (lambda: sw.tune([1.0, 2.0], "nothing"), ValueError),
        (lambda: sw.score([1.0, 2.0], sw.StepForward(threshold=1), rate="fast"), ValueError),
        (lambda: sw.Filter.low_pass("low", rate=500), ValueError),
        (lambda: sw.low_pass(None, 500), TypeError),
        (lambda: sw.Network.from_nir("nowhere.nir"), ValueError),
        (lambda: sw.Network.from_nir("nowhere.nir", reset=3), TypeError),
        (lambda: sw.Flight("nowhere.toml"), ValueError),
        (lambda: sw.read("nowhere.csv", colour="red"), TypeError),
        (lambda: sw.read_events("nowhere.raw", "evt2"), OSError),
        (lambda: sw.Log(np.zeros((1, 2)), None, ["a"], [])["b"], KeyError),
        (lambda: sw.Scheme.from_toml("scheme = 3"), ValueError),
        (lambda: sw.dataset("nowhere*.ulg", "nowhere.toml", "spikes"), ValueError),
    ],
)
def test_all_that_is_raised_is_an_error_of_the_package(call, kind):
    with pytest.raises(sw.Error) as caught:
        call()
    error = caught.value
    assert isinstance(error, ValueError) and isinstance(error, kind) and str(error)
    assert all(hasattr(error, name) for name in ["parameter", "value", "file", "kind", "remedy"])
    assert str(pickle.loads(pickle.dumps(error))) == str(error)


def test_hints_of_types_can_be_read():
    """Of all that is public; some tools, such as those of validation, read them while a program runs."""
    from typing import get_type_hints

    count = 0
    for name in sw.__all__:
        own = getattr(sw, name)
        if not callable(own):
            continue
        get_type_hints(own)
        for member in vars(own).values() if isinstance(own, type) else [own]:
            member = getattr(member, "fget", None) or getattr(member, "__func__", member)
            if inspect.isfunction(member):
                get_type_hints(member)
                count += 1
    assert count > 150


def test_words_for_a_wrong_scheme_or_axis(x):
    with pytest.raises(KeyError, match="there is no scheme 'x'; there are tbr, "):
        sw.schemes["x"]
    step = sw.StepForward(threshold=0.1)
    spikes = step.encode(x).array
    for call in (step.encode, lambda x, axis: step.decode(spikes, 0, axis), lambda x, axis: step.decode_weighted(spikes, 0, axis)):
        with pytest.raises(ValueError, match="axis is that of time, a whole number from -2 to 1, and not 1.5"):
            call(x, axis=1.5)
        with pytest.raises(ValueError, match="axis 2: there are 2 axes"):
            call(x, axis=2)
    with pytest.raises(ValueError, match="axis 7: there are 1 axes"):
        step.decode(step.encode(x[0]).array, 0, 7)
    assert "x" not in sw.schemes and sw.schemes.get("x") is None


def test_each_function_and_class_has_an_example():
    # Of schemes, which have one text each, the stub's example stands for all; a module's class is documented as a whole.
    without = []
    for name in sw.__all__:
        thing = getattr(sw, name)
        if isinstance(thing, type) and issubclass(thing, Exception):
            continue
        if not callable(thing) or thing in sw.schemes.values() or not getattr(thing, "__module__", "").startswith("spikewire"):
            continue
        if ">>>" not in (thing.__doc__ or ""):
            without.append(name)
    assert not without, without
