"""What must hold before any figure of the table means anything. Run by `cargo verify flies`."""

import json
from dataclasses import replace

import brushless
import numpy as np
import spikewire as sw
from attitude import ACCEL, ASK, FADE, FAR, GYRO, NEARBY, SET, STEP, TURN, WANTED, Layout
from banks import banks
from brushless import Brushless
from chip import Network, Plain, counted
from codes import Coded, schemes
from controllers import CONTROLLERS
from flight import Frame, LowPass, Registers, Way, fly
from line import Line, Over
from manoeuvres import ALL
from minutes import KEPT_NUMBERED, Condition, flights, ways
from network_pilot import FADES
from rivals import LEAN, VALUE, DeadBand, Samples
from table import CONTROL, VERDICTS, compared, in_rotorpy, verdicts
from third import Third
from vibration import BAND, LINES, NOISE, Vibration
from world import World, check

HOVER, STEPS = ALL[0], ALL[2]


def test_the_world_is_rotorpys():
    assert check() < 1e-12


def test_the_second_world_is_that_of_drone_models():
    assert brushless.check() < 1e-12


def test_the_third_world_is_rotorpys_drone():
    drones = World(1.2, 0.9), Third(1.2, 0.9)
    for drone in drones:
        drone.wind = (1.0, -2.0, 0.5)
        for step in range(100):
            drone.step([1900 + 50 * (step % 7), 1800, 1850, 1700], 0.002)
    ours, mujocos = (np.concatenate([drone.state, drone.feel()]) for drone in drones)
    assert np.allclose(ours, mujocos, rtol=0.01, atol=0.01), ours - mujocos


def test_the_third_world_agrees():
    """Every verdict, and errors and spikes within 20 %, here and in each setting in which no flight was lost."""
    kept = json.loads(VERDICTS.read_text())
    assert set(kept["third"]) == {CONTROL, *banks()}
    for name, own in kept["third"].items():
        first, third = verdicts(name, own, kept["banks"], kept["third"])
        assert first == third, name
        for figure in ("error", "spikes"):
            ratios = compared(in_rotorpy(kept["banks"][name]), own, figure)
            assert all(0.8 < ratio < 1.2 for ratio in ratios), (name, figure, ratios)


def test_every_controller_holds_every_shaken_drone():
    for world in (World, Brushless):
        for name, controller in CONTROLLERS.items():
            for rate in (250, 1000):
                control = controller(rate, world.drone)
                flight = fly(HOVER, Registers(), 7, control=control, world=world, vibration=1.0, rate=rate)
                assert flight.errors.mean() < 3, (world.__name__, name, rate)


def test_vibration_in_hover_is_as_strong_as_it_says():
    for rate in (250, 1000):
        shaken = Vibration(np.random.default_rng(1), rate, 10 * rate, hover=1789.0)
        rms = np.std([shaken.next(np.array([0.97, 0.99, 1.01, 1.03])) for _ in range(10 * rate)], axis=0)
        expected = np.sqrt(LINES**2 + NOISE**2 * BAND * np.pi / 2)
        assert np.allclose(rms, expected, rtol=0.1), (rate, rms, expected)


def test_registers_are_filtered_as_codes_are():
    samples = np.random.default_rng(1).normal(size=(400, 6)).astype(np.float32)
    own = LowPass(40, 500)
    filtered = np.array([own.next(sample) for sample in samples])
    assert np.allclose(filtered.T, sw.Filter.low_pass(40, 500).filter(samples.T), atol=1e-4)


def test_without_a_code_the_drone_is_steady():
    for manoeuvre in ALL:
        flight = fly(manoeuvre, Registers(), seed=7)
        assert not flight.lost, manoeuvre.name
    assert fly(HOVER, Registers(), seed=7).errors.max() < 2


def test_a_seed_repeats_a_flight_and_another_does_not():
    def errors(seed, loss):
        return fly(HOVER, Coded(schemes("sod")), seed, loss).errors

    assert np.array_equal(errors(3, 0.1), errors(3, 0.1))
    assert not np.array_equal(errors(3, 0.1), errors(4, 0.1))


def test_frames_carry_what_encoders_and_decoders_alone_have():
    """Without losses the link's values are those of the stream's decoder, bit for bit, once both have a full past."""
    for name in ("sod", "asf", "weighted-phase", "sigma-delta"):
        scheme = schemes(name)
        flight = fly(STEPS, Coded(scheme), seed=5, trace=True)
        sent = np.array([shown[2] for shown in flight.trace]).T
        heard = np.array([shown[3] for shown in flight.trace]).T
        for channel in range(6):
            codes = scheme[channel].encoder().encode(sent[channel])
            decoder = scheme[channel].decoder(first=sent[channel][0])
            assert np.array_equal(decoder.decode(codes)[50:], heard[channel][50:]), (name, channel)


def test_the_bank_that_the_page_takes_holds_the_flip():
    bank, flip = banks()["sod"], ALL[-1]
    for world in (World, Brushless):
        for name, controller in CONTROLLERS.items():
            control = controller(500, world.drone)
            flight = fly(flip, bank.path(500), 7, 0.01, control=control, world=world, vibration=1.0)
            assert not flight.lost and flight.errors.mean() < 9, (world.__name__, name, flight.errors.mean())
            assert flight.bytes < 17_000


class Counting(Way):
    """Sends its samples' numbers in frames of one size; its value is the last that arrived."""

    def __init__(self, size: int):
        self.size, self.count, self.latest = size, 0, -1

    def send(self, sample):
        yield Frame(self.size, self.count)
        self.count += 1

    def hear(self, frame):
        self.latest = frame.content

    def values(self):
        return self.latest


def arrivals(line: Line, samples: int, size: int = 10, rate: int = 500) -> list[int]:
    """The number of the last frame that has arrived, sample by sample."""
    way = Over(Counting(size), line, rate, seed=1)
    return [way.carry(np.zeros(6), None) for _ in range(samples)]


def test_a_line_without_faults_hands_on_at_once():
    assert arrivals(Line(), 100) == list(range(100))


def test_a_line_loses_by_chance_what_a_flight_loses():
    for make in (Registers, lambda: Coded(schemes("sod"))):
        through = fly(HOVER, Over(make(), Line(loss=0.1), 500, 3), 3)
        plain = fly(HOVER, make(), 3, 0.1)
        assert np.array_equal(through.errors, plain.errors) and through.bytes == plain.bytes


def test_a_late_line_is_late_by_whole_samples():
    assert arrivals(Line(delay=0.002), 50) == [-1, *range(49)]
    assert arrivals(Line(delay=0.005), 50) == [-1] * 3 + list(range(47))


def test_a_slow_line_queues():
    """500 frames of 10 bytes a second are 50 000 bits: 100 000 baud carry each within a sample, 25 000 every second one."""
    assert arrivals(Line(baud=100_000), 50) == [-1, *range(49)]
    # After 398 ms, at the last sample, 99 frames of 4 ms have arrived.
    assert arrivals(Line(baud=25_000), 200)[-1] == 98


def test_bursts_are_as_long_and_as_frequent_as_they_say():
    heard = arrivals(Line(loss=0.05, burst=0.05), 500_000)
    is_lost = np.array([latest != number for number, latest in enumerate(heard)])
    begins = np.count_nonzero(is_lost[1:] & ~is_lost[:-1])
    assert abs(is_lost.mean() - 0.05) < 0.01
    # Bursts that fall between two samples are not seen.
    assert abs(is_lost.sum() / begins / 500 - 0.05) < 0.01


def test_rivals_hold_what_they_say():
    samples = np.random.default_rng(1).normal(size=(400, 6)).astype(np.float32)
    thresholds = np.full(6, 0.5, np.float32)
    band, every_third = DeadBand(thresholds, 100), Samples(3)
    for number, sample in enumerate(samples):
        heard = band.carry(sample, lambda: False)
        assert (np.abs(heard - sample) <= thresholds).all()
        assert np.array_equal(every_third.carry(sample, lambda: False), samples[number - number % 3])
    assert every_third.bytes == 134 * (LEAN + 6 * VALUE)


def test_short_frames_are_as_long_as_the_specification_has_them():
    bank, random = banks(KEPT_NUMBERED)["sod/numbered"], np.random.default_rng(1)
    way, kinds = bank.path(500), {"full": 0, "short": 0}
    for _ in range(2000):
        for frame in way.send(random.normal(size=6).astype(np.float32)):
            content = frame.content
            assert frame.size == len(content)
            if content[0] == 0xA5:
                kinds["full"] += 1
                assert len(content) == 24 + content[23] + 4 and content[18] == 4
            else:
                kinds["short"] += 1
                low = content[0] & 15
                head, payload = (3, content[1]) if low == 15 else (2, low + 1)
                assert content[0] >> 4 == 6 and len(content) == head + payload + 4
    # The first four, and those of the keyframes after 0.5 s, 1 s and so on to 3.5 s.
    assert kinds["full"] == 4 + 7 and kinds["short"] > 1000, kinds


def test_step_numbers_heal():
    """With them, a lost frame leaves a channel wrong until its next event, and without them until the next keyframe."""
    bank, random = banks(KEPT_NUMBERED)["sod/numbered"], np.random.default_rng(2)
    samples = np.cumsum(random.normal(size=(4000, 6)), axis=0).astype(np.float32) * 0.05
    wrong = {}
    for step_bits in (4, 0):
        sent, heard = replace(bank, step_bits=step_bits).path(500), replace(bank, step_bits=step_bits).path(500)
        dice = np.random.default_rng(3)
        values = [(sent.carry(sample, lambda: False), heard.carry(sample, lambda: dice.random() < 0.1)) for sample in samples]
        wrong[step_bits] = np.mean([np.abs(one - other) > 0.01 for one, other in values])
    assert wrong[4] < 0.35 * wrong[0], wrong


def test_the_bank_for_every_loop_holds_the_flip_and_is_leaner_than_raw():
    make = ways()["sod/numbered"]
    for world in ("RotorPy", "drone-models"):
        for name in CONTROLLERS:
            (flight,) = flights(make, Condition("", [], flights=ALL[-1:]), (world, name, 500))
            assert not flight.lost and flight.bytes < 500 * (LEAN + 6 * VALUE), (world, name, flight.lost, flight.bytes)


def test_a_lost_frame_is_noticed():
    path = Coded(schemes("sf"))
    fly(STEPS, path, seed=5, loss=0.1)
    assert path.receiver.lost > 0 and 0.3 < path.exact < 1


def test_the_chips_network_counts():
    """Whatever comes in, each digit has one value, and the answers' worth is the sum of what has come in. Products move the yaw."""
    random, layout, plain = np.random.default_rng(1), Layout(), Plain(Network())
    moves = np.zeros((ASK, 3), int)
    for axis in range(3):
        moves[GYRO + 2 * axis, axis], moves[WANTED + 2 * axis, axis] = -1, 1
    for axis in range(2):
        moves[ACCEL + 2 * (1 - axis), axis], moves[FAR + 2 * axis, axis] = 2 * axis - 1, NEARBY
    moves[1::2] = -moves[::2]
    numbers, yawed = np.zeros(3, int), 0
    for event in random.integers(ASK, size=20_000):
        expected = numbers + moves[event]
        if (abs(expected) > [900, 900, 38]).any():
            continue
        plain.event(event)
        own = told(plain)
        assert np.array_equal(own[:2], expected[:2]) and abs(own[2] - expected[2]) <= 1, (event, own, expected)
        numbers, yawed = own, yawed + int(own[2] != expected[2])
        for up, down, answer in (digit for axis in layout.digits for digit in axis):
            value = plain.potentials[up : up + 3]
            assert sorted(value) == [0, 0, SET] and np.array_equal(value, plain.potentials[down : down + 3])
            assert np.array_equal(value[::-2], plain.potentials[answer : answer + 2])
    assert yawed > 20


def test_the_chips_network_corrects_the_yaw_and_fades():
    """A pitch on top of a roll turns the yaw, by its sign. Within 1 / FADES samples a number comes about half the way to 0."""
    roll, pitch, pitch_down = [WANTED] * 46, [WANTED + 2] * 81, [WANTED + 3] * 81
    for own, expected in (
        (roll + pitch, [46, 81, 3]),
        (roll + pitch_down, [46, -81, -3]),
        (pitch + roll, [46, 81, -1]),
        ([FAR] * 10, [270, 0, 0]),
        ([FAR] * 10 + [ASK, FADE, FADE + 1] * round(1 / FADES), [140, 0, 0]),
        ([FAR + 1] * 10 + [ASK, FADE, FADE + 1] * round(1 / FADES), [-140, 0, 0]),
    ):
        plain = Plain(Network())
        for event in own:
            plain.event(event)
        assert np.array_equal(told(plain), expected), (told(plain), expected)


def told(plain: Plain) -> np.ndarray:
    """What the chip's network answers, as numbers of steps."""
    answers = counted([plain.event(ASK)], len(plain.potentials))
    return np.rint(plain.network.worth @ answers / (np.array(TURN) * STEP)).astype(int)


if __name__ == "__main__":
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
            print(f"{name}: ok", flush=True)
