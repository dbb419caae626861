"""A flight's file: both ends from it have the bits of those written by hand, and what is none is told with its line."""

from pathlib import Path

import numpy as np
import pytest

import spikewire as sw

FLIGHTS = Path(__file__).parents[3] / "laptop/flight/tests/flights"

LABEL = (
    "{} us; gyro_x [rad/s] 1; gyro_y [rad/s] 1; gyro_z [rad/s] 1; "
    "accel_x [m/s²] 1; accel_y [m/s²] 1; accel_z [m/s²] 1"
)


def by_hand(flight):
    """The same sender, number by number."""
    if flight.scheme == "sod":
        rate, force = (sw.SendOnDelta(threshold=own, spikes=4) for own in (0.12, 0.5))
        return sw.Sender([rate] * 3 + [force] * 3, 2000, keyframe_every=10, session=5, label=LABEL.format(2000))
    rate, force = (sw.StepForward(threshold=own, sample="q8.8") for own in (0.1, 0.3))
    quiet = sw.Filter.low_pass(80, rate=1000)
    bank = [rate] * 3 + [force] * 3
    return sw.Sender(bank, 1000, keyframe_every=50, session=5, filter=quiet, label=LABEL.format(1000))


@pytest.mark.filterwarnings("ignore:.* is .* in q")
@pytest.mark.parametrize("name", ["sod", "sf"])
def test_both_ends_have_the_bits_of_those_by_hand(name):
    flight = sw.Flight(FLIGHTS / f"{name}.toml")
    assert flight.names[0] == flight.sources[0] == "gyro_x" and flight.units[3] == "m/s²"
    sender, known, receiver = flight.sender(session=5), by_hand(flight), flight.receiver()
    for sample in np.sin(np.arange(300)[:, None] * 0.02 * np.arange(1, 7)):
        frames = sender.encode(sample)
        assert frames == known.encode(sample)
        for frame in frames:
            receiver.hear(frame)
    assert receiver.exact.all() and np.abs(receiver.values - sample).max() < 0.8


#: What the ends of each flight said in Rust and in C: frames, bytes, exact values, and the hash of all.
FLOWN = {line.split()[0]: line for line in (FLIGHTS / "flown.txt").read_text().splitlines()}
#: The bits of a value, and the number that they have for 1.
BITS = {
    "f32": ("<f4", 1),
    "i16": ("<i2", 1),
    "q8.8": ("<i2", 2**8),
    "q2.14": ("<i2", 2**14),
    "i32": ("<i4", 1),
    "q16.16": ("<i4", 2**16),
}


def saw(sample, channel, counts):
    """The saw of laptop/flight/tests/both_ends.rs and bindings/c/tests/ends.c."""
    place = sample * (3 + 2 * channel) % 193
    value = ((place if place < 97 else 193 - place) - 48) / 32 * counts
    return float(int(value)) if counts > 1 else value


def fnv(hash, data):
    for byte in data:
        hash = (hash ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return hash


@pytest.mark.filterwarnings("ignore:.* is .* in q")
@pytest.mark.parametrize("name", FLOWN)
def test_both_ends_have_the_bits_of_rust_and_c(name):
    flight = sw.Flight(FLIGHTS / f"{name}.toml")
    sender, receiver = flight.sender(session=7), flight.receiver()
    frames = []
    for sample in range(400):
        frames += sender.encode([saw(sample, channel, own) for channel, own in enumerate(flight.counts)])
    data = b"".join(frames)
    hash, exact = fnv(0xCBF29CE484222325, data), 0
    kind, one = BITS[flight.schemes[0].sample]
    for start in range(0, len(data), 64):
        receiver.hear(data[start : start + 64])
        for channel in np.flatnonzero(receiver.exact):
            exact += 1
            bits = np.array(receiver.values[channel] * one).astype(kind).tobytes()
            hash = fnv(fnv(hash, int(channel).to_bytes(2, "little")), bits)
    assert f"{name} {len(frames)} frames, {len(data)} bytes, {exact} exact values, {hash:016x}" == FLOWN[name]


def test_a_rounded_parameter_is_told_or_refused(tmp_path):
    path = tmp_path / "flight.toml"
    text = 'version = 1\nscheme = "sf"\nsample = "{}"\nperiod = 2000\n[[channel]]\nname = "a"\nparameters = {{ threshold = {} }}\n'
    path.write_text(text.format("q8.8", 0.1))
    with pytest.warns(UserWarning, match="a: threshold 0.1 is 0.1015625 in q8.8"):
        flight = sw.Flight(path)
    assert "threshold=0.1015625" in repr(flight.schemes[0])
    # A flight of one channel has both ends.
    sender, receiver = flight.sender(), flight.receiver()
    for frame in sender.encode([0.5]):
        receiver.hear(frame)
    assert receiver.exact.all() and receiver.values.tolist() == [0.5]
    path.write_text(text.format("i16", 1.4))
    with pytest.raises(ValueError, match=r"flight\.toml:7: channel 0: threshold 1.4 would be 1 in i16"):
        sw.Flight(path)


@pytest.mark.parametrize("ppm, is_exact", [(0, True), (100_000, False)])
def test_the_far_end_knows_how_good_the_clock_is(tmp_path, ppm, is_exact):
    path = tmp_path / "flight.toml"
    text = (FLIGHTS / "grf_slots.toml").read_text()
    text = text.replace("period = 4000", f"period = 4000\nclock_ppm = {ppm}")
    path.write_text("\n".join("keyframe_every = 200" if line.startswith("keyframe_every") else line for line in text.split("\n")))
    if not is_exact:
        # A clock that is fast by 10 % leaves a sample of 4000 µs no room for sub-timesteps of 490 µs.
        with pytest.raises(sw.Error, match="slots 8 must be in"):
            sw.Flight(path)
        return
    flight = sw.Flight(path)
    assert flight.clock_ppm == ppm
    sender, receiver = flight.sender(), flight.receiver()
    for sample in 1000 * np.sin(np.arange(150)[:, None] * 0.02 * np.arange(1, 7)):
        for frame in sender.encode(np.round(sample)):
            receiver.hear(frame)
    assert receiver.exact.all(), receiver.withheld


def test_what_is_no_flight_is_told_with_its_line(tmp_path):
    path = tmp_path / "flight.toml"
    path.write_text('version = 1\nscheme = "sf"\nperiod = 2000\nkeyframe_evry = 3\n')
    with pytest.raises(ValueError, match=r"flight\.toml:4: keyframe_evry cannot be read: unknown field"):
        sw.Flight(path)
