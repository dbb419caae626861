"""The link's two ends: the bits are those of the stream's encoder and decoder, and a loss is known."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

import spikewire as sw

PERIOD = 2000
TOP = Path(__file__).parents[3]


def signal(samples=400):
    time = np.arange(samples)[:, None] * 0.02
    return np.sin(time * np.arange(1, 7)) + np.arange(6) * 0.01


def flown(schemes, x, lost=()):
    """Values and exactness after each sample, with the frames of some samples lost."""
    sender, receiver = sw.Sender(schemes, PERIOD, keyframe_every=10), sw.Receiver(schemes, PERIOD)
    values, exact = [], []
    for number, sample in enumerate(x):
        for frame in sender.encode(sample):
            if number not in lost:
                receiver.hear(frame)
        receiver.advance((number + 1) * PERIOD)
        values.append(receiver.values)
        exact.append(receiver.exact)
    return np.array(values), np.array(exact), receiver


@pytest.mark.parametrize(
    "scheme",
    [
        sw.StepForward(threshold=0.1),
        sw.SendOnDelta(threshold=0.05, spikes=5),
        sw.AdaptiveStepForward(threshold=0.05, doublings=3),
        sw.Position(min=-1.2, max=1.2, neurons=25),
        sw.WeightedPhase(min=-1.2, max=1.2, slots=8),
        sw.Slots(min=-1.2, max=1.2, neurons=10, slots=8),
        sw.SigmaDelta(min=-1.2, max=1.2),
        sw.SendOnDelta(threshold=50, spikes=5, sample="i16"),
    ],
    ids=lambda scheme: f"{scheme.name}-{scheme.sample}",
)
def test_without_losses_values_are_the_streams(scheme):
    x = signal()
    x = np.round(x * 1000) if scheme.sample == "i16" else x.astype(np.float32)
    values, exact, receiver = flown(scheme, x)
    encoder = scheme.encoder(6)
    decoder = scheme.decoder(x[0] if scheme._info["has_first_value"] else None, channels=6)
    expected = decoder.decode(encoder.encode(x.T.astype(np.int16) if scheme.sample == "i16" else x.T))
    if scheme.name == "sigma-delta":  # a mean forgets how it began, and is never exact
        assert np.allclose(values[300:], expected.T[300:], atol=1e-4)
    else:
        assert np.array_equal(values[50:], expected.T[50:].astype(float))
    assert exact[50:].all() == (scheme.name != "sigma-delta")
    assert receiver.lost == 0


def test_a_loss_is_known_until_the_next_keyframe():
    x = signal()
    scheme = sw.StepForward(threshold=0.02)
    whole, _, _ = flown(scheme, x)
    values, exact, receiver = flown(scheme, x, lost={105})
    assert receiver.lost == 1
    assert exact[:105].all() and not exact[107].all() and exact[111:].all()
    assert np.array_equal(values[111:], whole[111:]) and not np.array_equal(values[107], whole[107])


@pytest.mark.parametrize("sample", ["f32", "q8.8"])
def test_a_filter_before_a_bank_is_the_filter_and_then_the_bank(sample):
    x = signal()
    scheme = sw.StepForward(threshold=0.0625, sample=sample)
    quiet = sw.Filter.notch(60, rate=500, q=2).then(sw.Filter.low_pass(40, rate=500))
    filters = [quiet] * 3 + [None, sw.Filter.first_order(20, rate=500), None]
    whole, apart = sw.Sender(scheme, PERIOD, filter=filters), sw.Sender(scheme, PERIOD)
    filtered = np.array([lane if own is None else own.filter(lane, sample) for lane, own in zip(x.T, filters)]).T
    near, far = sw.Receiver(scheme, PERIOD), sw.Receiver(scheme, PERIOD, filter=filters)
    for own, behind in zip(x, filtered):
        for frame in whole.encode(own):
            far.hear(frame)
        for frame in apart.encode(behind):
            near.hear(frame)
        assert whole.fired == apart.fired
        assert np.array_equal(far.values, near.values) and far.exact.all() and near.exact.all()
    with pytest.raises(ValueError, match="3 filters for 6 channels"):
        sw.Sender(scheme, PERIOD, filter=[quiet] * 3)
    with pytest.raises(ValueError, match="corner 300 must lie in"):
        sw.Filter.low_pass(300, rate=500)


def test_other_filters_and_labels_are_other_descriptions():
    scheme = sw.StepForward(threshold=0.1)
    low, notch = sw.Filter.low_pass(40, rate=500), sw.Filter.notch(60, rate=500, q=2)
    ends = [
        {},
        {"filter": low},
        {"filter": sw.Filter.low_pass(41, rate=500)},
        {"filter": sw.Filter.low_pass(40, rate=500, q=1)},
        {"filter": sw.Filter.first_order(40, rate=500)},
        {"filter": notch.then(low)},
        {"filter": low.then(notch)},
        {"filter": [low] * 5 + [None]},
        {"label": "roll, pitch"},
        {"label": "pitch, roll"},
    ]
    for near in ends:
        sender = sw.Sender(scheme, PERIOD, **near)
        receivers = [sw.Receiver(scheme, PERIOD, **far) for far in ends]
        for sample in signal(40):
            for frame in sender.encode(sample):
                for receiver in receivers:
                    receiver.hear(frame)
        for far, receiver in zip(ends, receivers):
            assert receiver.exact.all() == receiver.exact.any() == (near is far), (near, far)
            assert near is far or "fingerprint" in receiver.withheld[0]


@pytest.mark.parametrize("sample", ["f32", "i16", "i32", "q8.8", "q2.14", "q16.16", "q1.31"])
@pytest.mark.parametrize("channels", [1, 2, 7, 64])
def test_banks_have_any_number_of_channels_and_any_sample_type(sample, channels):
    of = 1000 if sample[0] == "i" else 1
    low = sw.Filter.low_pass(40, rate=500)
    for scheme in [
        sw.StepForward(threshold=0.125 * of, sample=sample),
        sw.SendOnDelta(threshold=0.0625 * of, spikes=4, sample=sample),
        sw.Position(min=-of * 0.99, max=of * 0.99, neurons=5, sample=sample),
    ]:
        near = sw.Sender(scheme, PERIOD, keyframe_every=10, channels=channels, filter=low)
        far = sw.Receiver(scheme, PERIOD, channels=channels, filter=low)
        x = 0.9 * of * np.sin(np.arange(60)[:, None] * 0.1 + np.arange(channels))
        for number, row in enumerate(x):
            for frame in near.encode(row):
                far.hear(frame)
            far.advance((number + 1) * PERIOD)
        assert far.values.shape == far.exact.shape == (channels,)
        assert far.exact.all(), (scheme, far.withheld)
        assert np.abs(far.values - x[-1]).max() < 0.7 * of
        with pytest.raises(ValueError, match=f"a sample has {channels} values"):
            near.encode(np.zeros(channels + 1))


def test_two_senders_on_one_line_are_told():
    scheme = sw.StepForward(threshold=0.1)
    one, other = (sw.Sender(scheme, PERIOD, session=session) for session in (3, 90))
    receiver = sw.Receiver(scheme, PERIOD)
    with pytest.warns(UserWarning, match="are there two senders"):
        for sample in signal(100):
            for frames in zip(one.encode(sample), other.encode(sample)):
                for frame in frames:
                    receiver.hear(frame)
    # Short frames of the other sender fail their checksums, and only full ones are late.
    assert receiver.late > 0 and receiver.lost == 0


def test_what_makes_no_bank_is_refused():
    sf, sod = sw.StepForward(threshold=0.1), sw.SendOnDelta(threshold=0.1, spikes=4)
    for schemes, words in [
        ([], "1 to 64 channels, not 0"),
        ([sf] * 65, "1 to 64 channels, not 65"),
        ([sf] * 3 + [sod] * 3, "one kind of scheme"),
        (sw.Position(min=0, max=1, neurons=5, sample="f32"), None),
        ([sw.Position(min=0, max=1, neurons=n) for n in (5, 5, 5, 6, 6, 6)], "same number of neurons"),
        (sw.MovingWindow(threshold=0.1, window=3, start=0), "start="),
        (sw.Gaussian(neurons=10), "needs"),
    ]:
        if words is None:
            sw.Sender(schemes, PERIOD)
        else:
            with pytest.raises(ValueError, match=words):
                sw.Sender(schemes, PERIOD)


@pytest.mark.parametrize("sample, is_exact", [("q8.8", True), ("f32", False)])
def test_lost_steps_heal_at_the_next_event(sample, is_exact):
    scheme = sw.SendOnDelta(threshold=0.0625, spikes=4, start=0, sample=sample)
    sender = sw.Sender(scheme, PERIOD, keyframe_every=200, step_bits=4, gathering=4000)
    whole, receiver = sw.Receiver(scheme, PERIOD), sw.Receiver(scheme, PERIOD)
    frames, lost, healed, off = 0, 0, 0, set()
    for x in signal(800):
        for frame in sender.encode(x):
            frames += 1
            before = whole.values
            whole.hear(frame)
            moved = set(np.flatnonzero(whole.values != before))
            if frames % 7 == 0 and len(frame) < 30:
                lost, off = lost + 1, off | moved
                continue
            receiver.hear(frame)
            for channel in moved:
                assert abs(receiver.values[channel] - whole.values[channel]) <= (0 if is_exact else 1e-5)
            healed, off = healed + len(moved & off), off - moved
    assert lost > 20 and healed > 50, (lost, healed)


def test_a_start_puts_baselines_on_a_grid():
    scheme = sw.SendOnDelta(threshold=0.25, spikes=4, start=0)
    sender, receiver = sw.Sender(scheme, PERIOD), sw.Receiver(scheme, PERIOD)
    for frame in sender.encode([0.6, -0.3, 0.1, 9.8, 0, 0]):
        receiver.hear(frame)
    assert receiver.values.tolist() == [0.5, -0.25, 0, 1, 0, 0]


def test_what_a_sender_decides_is_checked():
    scheme = sw.StepForward(threshold=0.1)
    for key, value in [("step_bits", 5), ("gathering", 1_000_001), ("full_every", 10_000_001)]:
        with pytest.raises(ValueError, match=f"{key} {value} must lie in"):
            sw.Sender(scheme, PERIOD, **{key: value})
    with pytest.raises(ValueError, match="position has no steps"):
        sw.Sender(sw.Position(min=0, max=1, neurons=5), PERIOD, step_bits=4)


def test_usage_has_the_table_of_keyframes():
    spec = importlib.util.spec_from_file_location("keyframes", TOP / "bindings" / "python" / "examples" / "keyframes.py")
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    usage = (TOP / "docs" / "usage.md").read_text(encoding="utf-8")
    for row in example.table():
        assert row in usage
