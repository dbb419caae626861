"""What the nodes do, without ROS: `python3 -m unittest core` beside the package `spikewire`."""

import math
import unittest
from pathlib import Path
from typing import Any

import numpy as np
import spikewire
import yaml
from spikewire_ros import schemes, settings
from spikewire_ros.clock import Clock
from spikewire_ros.counters import Counters
from spikewire_ros.decoding import Decoding, Received
from spikewire_ros.encoding import Encoding, Event
from spikewire_ros.fields import Field, FieldError, numeric
from spikewire_ros.wave import wave

DEFAULTS = Path(__file__).parent.parent / "ros1" / "spikewire_ros" / "config" / "defaults.yaml"
TABLE = yaml.safe_load(DEFAULTS.read_text())
CONFIGS = {name: {"encoding_scheme": name, **own} for name, own in TABLE.items()}
STEP = 10_000_000


class Vector:
    __slots__ = ["x", "y"]

    def __init__(self) -> None:
        self.x, self.y = 1.5, math.nan


class Scan:
    __slots__ = ["ranges", "name", "poses", "is_new", "bytes"]

    def __init__(self) -> None:
        self.ranges, self.name, self.poses = np.array([4.0, 5.0], dtype=np.float32), "scan", [Vector()]
        self.is_new, self.bytes = True, b"\x07"


class Fields(unittest.TestCase):
    def test_numbers(self) -> None:
        for expression, value in (
            ("ranges[1]", 5.0),
            ("poses[0].x", 1.5),
            ("poses[0]/x", 1.5),
            ("is_new", 1.0),
            ("bytes[0]", 7.0),
        ):
            self.assertEqual(Field(expression).of(Scan()), value, expression)
        self.assertTrue(math.isnan(Field("y").of(Vector())))
        self.assertEqual(numeric(Scan()), ["ranges[0]", "poses[0].x", "poses[0].y", "is_new", "bytes[0]"])

    def test_what_is_none_says_so_and_what_there_is(self) -> None:
        for expression, why in (
            ("name", "is no number, but str"),
            ("ranges", "is no number, but ndarray"),
            ("ranges[2]", "there are 2 elements, so [2] is none"),
            ("poses[0].z", "Vector has no `z`"),
            ("name[0]", "str has no [0]"),
        ):
            with self.assertRaises(FieldError) as caught:
                Field(expression).of(Scan())
            self.assertIn(why, str(caught.exception))
            self.assertIn("numbers of Scan: ranges[0], poses[0].x", str(caught.exception))

    def test_what_cannot_be_read(self) -> None:
        for expression in ("", "[0]", "a..b", "a[-1]", "a[", "a b", "__import__('os')"):
            with self.assertRaises(FieldError, msg=expression):
                Field(expression)


class Times(unittest.TestCase):
    def test_steps(self) -> None:
        clock = Clock(1.5)
        found = [clock.observe(stamp * 1000) for stamp in (0, 10, 20, 30, 40, 60, 70, 65, 75, 75, 85)]
        names = [one and one[0] for one in found]
        wanted: list[Any] = [None] * 11
        wanted[5], wanted[7], wanted[9] = "gaps", "steps back in time", "repeated stamps"
        self.assertEqual(names, wanted)

    def test_a_rate_that_changes_is_told_until_it_is_usual(self) -> None:
        clock, stamp, gaps = Clock(1.5), 0, 0
        for step in [1000] * 40 + [2000] * 40:
            stamp += step
            gaps += clock.observe(stamp) is not None
        self.assertTrue(0 < gaps <= 17, gaps)

    def test_counts_are_told_sparsely(self) -> None:
        told: list[str] = []
        counters = Counters(told.append)
        for number in range(150):
            counters.add("gaps", f"number {number}")
        counters.add("lost", by=30)
        self.assertEqual(
            told, ["gaps: 1 (number 0)", "gaps: 10 (number 9)", "gaps: 100 (number 99)", "lost: 30"]
        )
        self.assertEqual(str(counters), "150 gaps, 30 lost")


class Parameters(unittest.TestCase):
    def test_the_toolbox_sets_them_for_all_nodes(self) -> None:
        shared = {"encoding_scheme": "moving_window", "factor": 0.0, "threshold": 0.325, "window": 3, "neurons": 0}
        read = settings.read({"topic": "/imu"}, shared)
        self.assertEqual((read.scheme, read.options), ("mw", {"threshold": 0.325, "window": 3}))
        own = settings.read({"threshold": 0.5, "encoding_scheme": "step_forward"}, {"threshold": 0.325})
        self.assertEqual((own.scheme, own.options), ("sf", {"threshold": 0.5}))

    def test_what_is_not_good_is_named(self) -> None:
        good = {"topic": "/imu", "encoding_scheme": "step_forward", "threshold": 0.1}
        for changed, why in (
            ({"encoding_scheme": "step"}, "encoding_scheme step: there are tbr,"),
            ({"encoding_scheme": None}, "encoding_scheme is missing"),
            ({"topic": None}, "topic is missing"),
            ({"treshold": 0.1}, "treshold: no parameter of StepForward; it takes threshold, start"),
            ({"threshold": 0.0}, "threshold 0 must be above 0"),
            ({"threshold": -math.inf}, "threshold"),
            ({"threshold": {"a": 1}}, "threshold {'a': 1}: it must be a number"),
            ({"gap": 1}, "gap 1: it must be a number above 1"),
            ({"calibrate": -1}, "calibrate -1: it must be a whole number"),
            ({"sample": "f16"}, "f16"),
            ({"encoding_scheme": "gaussian_fields", "threshold": 0.1}, "threshold: no parameter of Gaussian"),
        ):
            with self.assertRaises(ValueError, msg=changed) as caught:
                read = settings.to_encode(settings.read({**good, **changed}, {}))
                Encoding(read, Counters(print))
            self.assertIn(why, str(caught.exception))

    def test_what_a_signal_must_tell_is_asked_for(self) -> None:
        read = settings.read({"topic": "/imu", "encoding_scheme": "gaussian_fields", "neurons": 20}, {})
        with self.assertRaises(ValueError) as caught:
            Encoding(read, Counters(print))
        self.assertIn("min", str(caught.exception))

    def test_every_scheme_has_defaults(self) -> None:
        self.assertEqual(set(TABLE), set(spikewire.schemes))
        given = {"topic": "/imu", "encoding_scheme": "hough", "defaults": True}
        with self.assertRaises(ValueError):
            Encoding(settings.read(given, {}, TABLE), Counters(print))
        given = {"topic": "/imu", "encoding_scheme": "grf_slots", "defaults": True, "slots": 5}
        read = settings.read(given, {}, TABLE)
        self.assertEqual((read.options, read.calibrate), ({"neurons": 15, "slots": 5}, 100))
        for name in spikewire.schemes:
            self.assertEqual(schemes.of_catalogue(schemes.published(name)), name)


def encoded(given: dict[str, Any], samples: list[float], told: Counters) -> list[Event]:
    encoding = Encoding(settings.read({**given, "topic": "signal"}, {}), told)
    events: list[Event] = []
    for index, sample in enumerate(samples):
        events += encoding.take(sample, index * STEP)
    return events + encoding.end()


def message(event: Event) -> Received:
    """As a `spyke` has it: with numbers of 32 bits."""
    narrow = [float(np.float32(getattr(event, name))) for name in ("start", "min_input", "max_input", "threshold", "input")]
    return Received(event.spikes, *narrow, event.scheme, event.stamp)


class Coding(unittest.TestCase):
    def setUp(self) -> None:
        self.samples = [float(np.float32(sample)) for sample in wave(0.01, 4.0, 0)]
        self.told = Counters(lambda text: None)

    def test_every_scheme_as_in_the_package(self) -> None:
        for name, given in CONFIGS.items():
            events = encoded(given, self.samples, self.told)
            options = {key: value for key, value in given.items() if key not in ("encoding_scheme", "calibrate")}
            scheme = spikewire.schemes[schemes.of_catalogue(given["encoding_scheme"])](**options)
            if "calibrate" in given:
                scheme = scheme.fit(self.samples[: given["calibrate"]])
            spikes = scheme.encode(self.samples)
            self.assertEqual([event.stamp for event in events], [index * STEP for index in range(400)], name)
            self.assertEqual([event.input for event in events], self.samples, name)
            for event, row in zip(events, np.asarray(spikes).reshape(400, -1)):
                self.assertEqual(event.spikes, list(row), name)
            decoded = np.array([event.decoded for event in events])
            np.testing.assert_array_equal(decoded, spikes.decode(), name)

    def test_messages_decode_to_what_the_encoder_decoded(self) -> None:
        for name, given in CONFIGS.items():
            events = encoded(given, self.samples, self.told)
            decoding = Decoding(settings.read(given, {}), self.told)
            values = [decoding.take(message(event)) for event in events]
            self.assertEqual(values, [event.decoded for event in events], name)
        self.assertEqual(self.told.counts, {})

    def test_what_is_not_finite_emits_nothing_and_is_counted(self) -> None:
        samples = self.samples[:100] + [math.nan, math.inf, -1e39] + self.samples[100:]
        events = encoded(CONFIGS["sf"], samples, self.told)
        without = encoded(CONFIGS["sf"], self.samples, Counters(lambda text: None))
        self.assertEqual([event.spikes for event in events], [event.spikes for event in without])
        self.assertEqual(self.told.counts, {"samples not finite": 3})

    def test_a_signal_too_short_to_start_is_told(self) -> None:
        self.assertEqual(encoded(CONFIGS["grf"], self.samples[:99], self.told), [])
        self.assertEqual(self.told.counts, {"samples that came too few to start": 99})
        self.assertEqual(len(encoded(CONFIGS["mw"], self.samples[:3], self.told)), 3)

    def test_the_toolbox_numbers_its_fields_from_0(self) -> None:
        row = [0] * 20
        row[7] = 1
        said = {"start": 0.0, "min_input": -1.0, "max_input": 1.0, "threshold": 0.0, "input": 0.0, "stamp": 0}
        toolbox = Decoding(settings.read({}, {}), self.told).take(Received(row, scheme="gaussian_fields", **said))
        ours = Decoding(settings.read({}, {}), self.told).take(Received(row, scheme="grf", **said))
        self.assertAlmostEqual(toolbox, -1.0 + (2 * 7 - 3) / 2 * 2.0 / 18, places=6)
        self.assertAlmostEqual(ours, -1.0 + (2 * 8 - 3) / 2 * 2.0 / 18, places=6)

    def test_messages_of_another_scheme_are_refused_and_counted(self) -> None:
        events = [message(event) for event in encoded(CONFIGS["sf"], self.samples, self.told)]
        decoding = Decoding(settings.read({}, {}), self.told)
        self.assertIsNotNone(decoding.take(events[0]))
        before = decoding.take(events[1])
        bad = Received([0, 1], *(getattr(events[2], name) for name in _SAID))
        self.assertIsNone(decoding.take(bad))
        self.assertEqual(self.told.counts, {"messages refused": 1})
        self.assertEqual(decoding.take(Received([0], *(getattr(events[3], name) for name in _SAID))), before)

    def test_an_encoder_that_starts_anew(self) -> None:
        decoding = Decoding(settings.read({}, {}), self.told)
        for part in (self.samples, self.samples[50:]):
            events = encoded(CONFIGS["sf"], part, self.told)
            last = [decoding.take(message(event)) for event in events]
            self.assertEqual(last, [event.decoded for event in events])
        self.assertEqual(self.told.counts, {"steps back in time": 1, "new starts of the encoder": 1})

    def test_a_decoder_that_starts_late_says_so(self) -> None:
        events = [message(event) for event in encoded(CONFIGS["sf"], self.samples, self.told)]
        Decoding(settings.read({}, {}), self.told).take(events[50])
        self.assertEqual(self.told.counts, {"starts in the middle": 1})


_SAID = ("start", "min_input", "max_input", "threshold", "input", "scheme", "stamp")


if __name__ == "__main__":
    unittest.main()
