"""What must hold before any figure of the table means anything. Run by `cargo verify flies`."""

import json

import brushless
import numpy as np
import spikewire as sw
from attitude import ACCEL, ASK, FADE, FAR, GYRO, NEARBY, SET, STEP, TURN, WANTED, Layout
from banks import banks
from brushless import Brushless
from chip import Network, Plain, counted
from codes import Coded, schemes
from controllers import CONTROLLERS
from flight import LowPass, Registers, fly
from manoeuvres import ALL
from network_pilot import FADES
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
    """Every verdict, and errors and bytes within 20 %, here and in each setting in which no flight was lost."""
    kept = json.loads(VERDICTS.read_text())
    assert set(kept["third"]) == {CONTROL, *banks()}
    for name, own in kept["third"].items():
        first, third = verdicts(name, own, kept["banks"], kept["third"])
        assert first == third, name
        for figure in ("error", "bytes"):
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
