"""Every scheme of the catalogue: arrays, chunks, types."""

import copy
import pickle

import numpy as np
import pytest

import spikewire as sw

SAMPLES = ["f32", "i16", "q8.8", "q16.16"]


@pytest.fixture(scope="module")
def x():
    walk = np.cumsum(np.random.default_rng(1).normal(size=(2, 500)), axis=1)
    # Wide enough for centres in whole numbers.
    return (walk * 90 / np.abs(walk).max(axis=1, keepdims=True)).astype(np.float32)


def cases():
    return [pytest.param(scheme, sample, id=f"{name}-{sample}") for name, scheme in sw.schemes.items() for sample in SAMPLES]


def paper(scheme, **keywords):
    """With the paper's settings, and the same draws in each call."""
    if any(own["name"] == "seed" for own in scheme._info["parameters"]):
        keywords["seed"] = 1
    return scheme(paper=True, **keywords)


def of(scheme, sample, x):
    """With the paper's settings; the ranges that these have in counts are too narrow for some codes."""
    own = paper(scheme, sample=sample)
    try:
        return own, own.encode(x)
    except ValueError as error:
        assert sample == "i16" and "must rise strictly" in str(error), error
        pytest.skip(str(error))


@pytest.mark.parametrize("scheme, sample", cases())
def test_channels_are_coded_each_by_itself(scheme, sample, x):
    own, both = of(scheme, sample, x)
    # By chance, a channel alone draws as the first of several does.
    for channel in range(1 if "seed" in own.parameters else 2):
        alone = own.encode(x[channel])
        assert np.array_equal(alone.array, both.array[channel])
        assert np.array_equal(alone.decode(), both.decode()[channel])


@pytest.mark.parametrize("scheme, sample", cases())
def test_many_channels_with_the_same_parameters(scheme, sample, x):
    """Codecs are started anew from channel to channel, and channels that lie side by side are copied together."""
    own, _ = of(scheme, sample, x)
    own = own.fit(x)
    lanes = np.stack([np.roll(row, 7 * place)[:60] for place in range(20) for row in x]).reshape(4, 10, 60)
    both = own.encode(lanes)
    beside = own.encode(np.ascontiguousarray(np.moveaxis(lanes, -1, 0)), axis=0)
    assert np.array_equal(np.moveaxis(beside.array, 0, 2), both.array)
    again, values = pickle.loads(pickle.dumps(both)), both.decode()
    assert again.parameters == both.parameters and np.array_equal(again.decode(), values)
    for channel in range(1 if "seed" in own.parameters else 40):
        place = divmod(channel, 10)
        alone = own.encode(lanes[place])
        assert np.array_equal(alone.array, both.array[place])
        assert np.array_equal(alone.decode(), values[place])
        assert alone.parameters == [both.parameters[channel]]


@pytest.mark.parametrize("scheme, sample", cases())
def test_runs_of_channels(scheme, sample, x):
    """Channels without gaps in memory are encoded in runs, of which this is several; others one by one."""
    own, _ = of(scheme, sample, x)
    own = own.fit(x)
    many = np.stack([np.roll(x[0], 7 * place)[:20] for place in range(2100)]).reshape(3, 700, 20)
    apart = own.encode(np.repeat(many, 2, axis=-1)[..., ::2]).array
    assert np.array_equal(own.encode(many).array, apart)
    beside = own.encode(np.ascontiguousarray(np.moveaxis(many, -1, 0)), axis=0).array
    assert np.array_equal(np.moveaxis(beside, 0, 2), apart)


@pytest.mark.parametrize("name", ["tbr", "mw", "sf", "hsa", "t-hsa", "lif"])
def test_long_channels_side_by_side(name, x):
    """Channels longer than a run, several of which are encoded at once."""
    own = paper(sw.schemes[name]).fit(x)
    long = np.stack([np.resize(np.roll(x[0], 7 * place), 5000) for place in range(3)])
    assert np.array_equal(own.encode(long).array, [own.encode(row).array for row in long])


@pytest.mark.parametrize("scheme, sample", cases())
def test_chunks_are_coded_as_the_whole(scheme, sample, x):
    own, _ = of(scheme, sample, x)
    own = own.fit(x)
    whole = own.encode(x)
    encoder = own.encoder(channels=2)
    cuts = [1, 2, 5, 100, 101, 300]
    chunks = [encoder.encode(chunk) for chunk in np.split(x, cuts, axis=1)] + [encoder.finish()]
    assert np.array_equal(np.concatenate(chunks, axis=1), whole.array)
    first = x[:, 0] if scheme._info["has_first_value"] else None
    decoder = own.decoder(first=first, channels=2)
    values = [decoder.decode(codes) for codes in np.split(whole.array, cuts, axis=1)]
    assert np.array_equal(np.concatenate(values, axis=1), whole.decode())
    assert np.array_equal(own.decode(whole.array, first=first), whole.decode())


@pytest.mark.parametrize("scheme", sw.schemes.values())
def test_layout_changes_nothing(scheme, x):
    own = paper(scheme)
    expected = own.encode(x).array
    apart = np.zeros((4, 2 * x.shape[1]), np.float32)[::2, ::-2]
    apart[:] = x
    for same in [x.astype(np.float64), np.asfortranarray(x), apart, x.astype(">f4"), x[:, None].swapaxes(0, 1)]:
        assert np.array_equal(own.encode(same).array.reshape(expected.shape), expected)


@pytest.mark.parametrize("scheme", sw.schemes.values())
def test_a_scheme_survives_pickling(scheme, x):
    own = paper(scheme).fit(x)
    again = pickle.loads(pickle.dumps(own))
    assert again == own and np.array_equal(again.encode(x).array, own.encode(x).array)


def test_counts_are_coded_as_they_are():
    counts = np.array([0, 200, 450, 300, -32768, 32767], np.int16)
    spikes = sw.StepForward(threshold=120, sample="i16").encode(counts)
    assert spikes.decode().dtype == np.int16
    assert np.array_equal(spikes.array, [0, 1, 1, 0, -1, 1])
    assert np.array_equal(spikes.array, sw.StepForward(threshold=120).encode(counts).array)


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda: sw.StepForward(threshold=0), "threshold 0 must be above 0 and finite"),
        (lambda: sw.StepForward(threshold=float("nan")), "`threshold` NaN must be finite"),
        (lambda: sw.StepForward(threshold="high"), "`threshold` high is not a number"),
        (lambda: sw.StepForward(threshold=[0.1, 0.2]).encode([1, 2]), "`threshold` has 2 values, one a channel, for 1 channel"),
        (lambda: sw.StepForward(), "sf needs `threshold`"),
        (lambda: sw.MovingWindow(threshold=1, window=-1), "`window` -1 must be a whole number, 0 or more"),
        (lambda: sw.SendOnDelta(threshold=1, spikes=128), "spikes 128 must be a whole number in 1..=127"),
        (lambda: sw.Gaussian(neurons=2), "neurons 2 must be a whole number in 3..=1024"),
        (lambda: sw.Hough(filter="triang:0"), "the length `0` must be 1 to 4096"),
        (lambda: sw.Bernoulli(mean="median"), "`mean` median: there are average, window"),
        (lambda: sw.StepForward(threshold=1, sample="f64"), "no sample type `f64`"),
        (lambda: sw.StepForward(threshold=1).encode([1, np.nan]), "channel 0, sample 1: NaN is not finite"),
        (lambda: sw.StepForward(threshold=1).fit([[]]), "channel 0 has no samples"),
        (lambda: sw.StepForward(threshold=1).encode(1.0), r"an array \(samples,\) or \(channels, samples\)"),
        (lambda: sw.StepForward(threshold=1).encode(["a"]), "floats or integers"),
        (lambda: sw.StepForward(threshold=1).decode([0, 1]), "a first value: first="),
        (lambda: sw.StepForward(threshold=1).decode([0, 2], first=0), r"channel 0, sample 1: \[2\] is no code"),
        (lambda: sw.StepForward(threshold=1).decode([0.5], first=0), "whole numbers"),
        (lambda: sw.Hough(filter="triang:3").encoder(), r"hsa needs `shift` to begin a stream; fit\(x\) finds it"),
        (lambda: sw.Position(neurons=20).decode(np.zeros((5, 20), np.int8)), "needs `min` and `max`"),
    ],
)
def test_what_is_bad_is_named_with_its_value_and_range(call, words):
    with pytest.raises(ValueError, match=words):
        call()


@pytest.mark.parametrize(
    "scheme",
    [
        sw.StepForward(threshold=0.1),
        sw.TemporalContrast(factor=1.0),
        sw.Hough(filter="triang:3"),
        sw.Bernoulli(min=0, max=1),
    ],
)
@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_the_first_bad_sample_is_named_wherever_it_is(scheme, kind):
    x = np.random.default_rng(1).random((4, 70_000)).astype(kind)
    x[2, 69_000], x[3, 5] = np.inf if kind is np.float32 else 1e39, np.nan
    words = "channel 2, sample 69000: (inf is not finite|1e39 is beyond f32)"
    # Time last and first, with gaps, and channels so short that they are encoded side by side.
    for array, axis in [(x, -1), (x.T.copy(), 0), (np.repeat(x, 2, 0)[::2], -1)]:
        for call in (scheme.encode, scheme.fit, lambda x, axis: scheme.fit(x, per_channel=True, axis=axis)):
            with pytest.raises(ValueError, match=words):
                call(array, axis=axis)
    short = x[:, -1100:].copy()
    short[3, 5] = np.nan
    with pytest.raises(ValueError, match="channel 2, sample 100: "):
        scheme.encode(short)


@pytest.mark.parametrize("shape", [(0,), (0, 0), (0, 5), (5, 0), (2, 0, 3)])
def test_an_array_without_samples_has_no_spikes_and_tells_nothing(shape):
    scheme = sw.Hough(filter="triang:3")
    assert scheme.encode(np.zeros(shape)).array.size == 0
    for per_channel in (False, True):
        with pytest.raises(ValueError, match="no samples|no channel"):
            scheme.fit(np.zeros(shape), per_channel)


def test_a_parameter_may_have_a_value_for_each_channel():
    x = np.sin(np.arange(400).reshape(2, 200) * 0.1)
    both = sw.StepForward(threshold=[0.1, 0.3])
    each = [sw.StepForward(threshold=threshold).encode(own) for threshold, own in zip([0.1, 0.3], x)]
    codes = np.stack([own.array for own in each])
    assert np.array_equal(both.encode(x).array, codes)
    assert np.array_equal(both.encoder(2).encode(x), codes)
    assert np.array_equal(both.encode(x).decode(), [own.decode() for own in each])


@pytest.mark.parametrize(
    "scheme",
    [
        sw.Position(centres=[0, 1, 3]),
        sw.Position(centres=np.array([0.0, 1.0, 3.0])),
        sw.NonLinearGaussian(centres=[0, 1, 3], widths=[1, 1, 2]),
        sw.FirstSpike(edges=[0.5, 1, 3], min=0, max=4),
        sw.Hough(filter=[2], shift=0),
    ],
)
def test_lists_are_values(scheme):
    x = np.array([0.2, 1.1, 2.9, 0.9])
    assert np.abs(scheme.decode(scheme.encode(x)) - x).max() < 1.5


def test_events_are_in_the_order_of_time():
    x = np.array([[0, 1, 1, 3], [0, 0, -1, -1.0]])
    bank = sw.Bank(sw.SendOnDelta(threshold=0.5, spikes=2), channels=2)
    events = np.concatenate([bank.encode(x[:, :3], period=1000), bank.encode(x[:, 3:], period=1000)])
    assert events.dtype == sw.EVENTS
    assert np.all(np.diff(events["t"]) >= 0)
    whole = sw.SendOnDelta(threshold=0.5, spikes=2).encode(x)
    assert np.array_equal(events, whole.events(period=1000))
    assert np.array_equal(events, whole.events(times=[0, 1000, 2000, 3000]))
    assert whole.count == len(events)


def streams(own, x):
    first = x[:, 0] if own._info["has_first_value"] else None
    return own.encoder(channels=2), own.decoder(first=first, channels=2)


@pytest.mark.parametrize("scheme, sample", cases())
def test_streams_survive_pickling_between_any_chunks(scheme, sample, x):
    own, _ = of(scheme, sample, x)
    own = own.fit(x)
    spikes = own.encode(x)
    encoder, decoder = streams(own, x)
    cuts = [0, 1, 2, 5, 100, 101, 300]
    codes, values = [], []
    for chunk, row in zip(np.split(x, cuts, axis=1), np.split(spikes.array, cuts, axis=1)):
        encoder, decoder = pickle.loads(pickle.dumps((encoder, decoder)))
        codes.append(encoder.encode(chunk)), values.append(decoder.decode(row))
    codes.append(pickle.loads(pickle.dumps(encoder)).finish())
    assert np.array_equal(np.concatenate(codes, axis=1), spikes.array)
    assert np.array_equal(np.concatenate(values, axis=1), spikes.decode())
    assert np.array_equal(pickle.loads(pickle.dumps(spikes)).decode(), spikes.decode())


@pytest.mark.parametrize("scheme", sw.schemes.values())
@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy])
def test_a_copy_goes_its_own_way(scheme, copied, x):
    own = paper(scheme).fit(x)
    spikes = own.encode(x)
    encoder, decoder = streams(own, x)
    encoder.encode(x[:, :200]), decoder.decode(spikes.array[:, :200])
    again, decoded_again = copied(encoder), copied(decoder)
    again.encode(-x), decoded_again.decode(spikes.array[:, ::-1])
    rest = np.concatenate([encoder.encode(x[:, 200:]), encoder.finish()], axis=1)
    assert np.array_equal(rest, spikes.array[:, -rest.shape[1] :])
    assert np.array_equal(decoder.decode(spikes.array[:, 200:]), spikes.decode()[:, 200:])


@pytest.mark.parametrize("scheme", sw.schemes.values())
def test_a_pickle_does_not_grow_with_what_went_before(scheme, x):
    own = paper(scheme).fit(x)
    encoder, decoder = streams(own, x)
    sizes = []
    for _ in range(20):
        decoder.decode(encoder.encode(x))
        sizes.append(len(pickle.dumps((encoder, decoder))))
    # Numbers take as many bytes as they need.
    assert max(sizes) < 1.1 * sizes[0] < 3000


def coded(encoder, x):
    return encoder.encode(x), encoder


def test_streams_go_through_a_pool_of_processes(x):
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    schemes = [sw.Hough(filter="triang:9", shift=-90), sw.MovingWindow(threshold=2, window=9), sw.Bernoulli(min=-90, max=90, seed=1)]
    encoders = [scheme.encoder(channels=2) for scheme in schemes]
    codes = [[] for _ in schemes]
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        for chunk in np.split(x, 4, axis=1):
            done = list(pool.map(coded, encoders, [chunk] * len(schemes)))
            encoders = [encoder for _, encoder in done]
            for own, (code, _) in zip(codes, done):
                own.append(code)
    for scheme, encoder, own in zip(schemes, encoders, codes):
        assert np.array_equal(np.concatenate([*own, encoder.finish()], axis=1), scheme.encode(x).array)


@pytest.mark.parametrize(
    "change, words",
    [
        (lambda version, waiting, states: ("0.0.9", waiting, states), "pickled by spikewire 0.0.9, and this is"),
        (lambda version, waiting, states: (version, waiting, states[:1]), "the states are of 1 channels"),
        (lambda version, waiting, states: (version, waiting[:1], states), "the stream has 1 channels"),
        (lambda version, waiting, states: (version, waiting, [states[0], states[1][:-1]]), "channel 1: the state is damaged"),
        (lambda version, waiting, states: (version, waiting, [states[0] + b"0", states[1]]), "channel 0: the state is damaged"),
    ],
)
def test_a_state_that_is_damaged_is_refused(change, words, x):
    encoder = sw.Hough(filter="triang:9", shift=-90).encoder(channels=2)
    before = encoder.encode(x)
    state = encoder.__reduce__()[2]
    with pytest.raises(ValueError, match=words):
        encoder.__setstate__(change(*state))
    other = sw.Hough(filter="triang:8", shift=-90).encoder(channels=2)
    with pytest.raises(ValueError, match="channel 0: the state is damaged, or another scheme's"):
        other.__setstate__(state)
    encoder.__setstate__(state)
    assert np.array_equal(encoder.finish().shape[1] + before.shape[1], x.shape[1])


def test_a_bank_survives_pickling(x):
    bank = sw.Bank(sw.StepForward(threshold=2), channels=2)
    whole = sw.StepForward(threshold=2).encode(x).events(period=1000)
    early = bank.encode(x[:, :200], period=1000)
    late = pickle.loads(pickle.dumps(bank)).encode(x[:, 200:], period=1000)
    assert np.array_equal(np.concatenate([early, late]), whole)


def test_threads_share_what_is_encoded(x):
    from concurrent.futures import ThreadPoolExecutor

    encoders = [sw.StepForward(threshold=1).encoder() for _ in range(8)]
    with ThreadPoolExecutor(4) as pool:
        for _ in range(3):
            codes = list(pool.map(lambda encoder: encoder.encode(x[0]), encoders))
    assert all(np.array_equal(own, codes[0]) for own in codes)


def test_progress_and_an_end_to_long_work():
    told = []
    long = np.zeros(1 << 21, np.float32)
    sw.Gaussian(neurons=20, min=-1, max=1).encode(long, progress=lambda *done: told.append(done))
    assert told[-1] == (len(long), len(long)) and sorted(told) == told

    def stop(done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sw.Gaussian(neurons=20, min=-1, max=1).encode(long, progress=stop)
