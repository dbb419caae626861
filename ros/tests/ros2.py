"""The ROS 2 nodes against a stand-in of `rclpy`, and their messages on the wire: `python3 -m unittest ros2`.

Needs the packages of `ros2.txt` and `spikewire`. A ROS 2 itself is not there.
"""

import math
import unittest
from dataclasses import dataclass
from typing import Any

import ros2_stand_in as ros
from cyclonedds.idl import IdlStruct, types
from mcap.records import Schema
from mcap_ros2.decoder import DecoderFactory

ros.install()

from spikewire_ros import encoding, ros2, settings  # noqa: E402: they import what is installed above
from spikewire_ros.counters import Counters  # noqa: E402


@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: types.int32
    nanosec: types.uint32


@dataclass
class Spyke(IdlStruct, typename="spyke_msgs::msg::dds_::Spyke_"):
    spike: types.int8
    start: types.float32
    min_input: types.float32
    max_input: types.float32
    threshold: types.float32
    input: types.float32
    scheme: str
    timestamp: Time


@dataclass
class SpykeArray(IdlStruct, typename="spyke_msgs::msg::dds_::SpykeArray_"):
    spike: types.sequence[types.int8]
    start: types.float32
    min_input: types.float32
    max_input: types.float32
    threshold: types.float32
    input: types.float32
    scheme: str
    timestamp: Time


@dataclass
class SpykeValue(IdlStruct, typename="spyke_msgs::msg::dds_::SpykeValue_"):
    value: types.float64
    timestamp: Time


SF = {"encoding_scheme": "step_forward", "threshold": 0.35, "topic": "/imu", "field": "angular_velocity.x"}
GRF = {
    "encoding_scheme": "grf-slots",
    "neurons": 4,
    "slots": 3,
    "min": -1.0,
    "max": 1.0,
    **{key: SF[key] for key in ("topic", "field")},
}


def imu(step: int, rate: float) -> Any:
    message = ros.message("sensor_msgs/msg/Imu")()
    message.header.stamp = ros.message("builtin_interfaces/msg/Time")(sec=100 + step, nanosec=7)
    message.angular_velocity.x = rate
    return message


def rates() -> list[float]:
    return [math.sin(step / 5.0) for step in range(100)]


def node(kind: type, parameters: dict[str, Any], topics: dict[str, Any]) -> Any:
    ros.Node.parameters, ros.Node.topics = parameters, topics
    made = kind()
    made.tick()
    return made


def encoded(parameters: dict[str, Any]) -> Any:
    made = node(ros2.Encode, parameters, {"/imu": ("sensor_msgs/msg/Imu", "best effort")})
    for step, rate in enumerate(rates()):
        made.subscriptions["/imu"].call(imu(step, rate))
    made.end()
    return made


class Nodes(unittest.TestCase):
    def test_encodes_as_the_body_does(self) -> None:
        for parameters in (SF, GRF):
            made = encoded(parameters)
            body = encoding.Encoding(settings.read(parameters, {}), Counters(print))
            events = [event for step, rate in enumerate(rates()) for event in body.take(rate, (100 + step) * 10**9 + 7)]
            published = made.publishers["event"].published
            self.assertEqual([ros2.received_of(one).spikes for one in published], [event.spikes for event in events])
            stamps = [ros2.received_of(one).stamp for one in published]
            self.assertEqual(stamps, [event.stamp for event in events])
            values = [one.value for one in made.publishers["~/decoded"].published]
            self.assertEqual(values, [event.decoded for event in events])
            [header] = made.publishers["event_header"].published
            self.assertIn(
                f"spikewire=1\nscheme={'grf-slots' if parameters is GRF else 'sf'}\nsample=f32\n", header.data
            )
            self.assertEqual(made.subscriptions["/imu"].profile.reliability, "best effort")

    def test_decodes_what_it_encodes(self) -> None:
        for parameters in (SF, GRF):
            sent = encoded(parameters)
            kind = sent.publishers["event"].kind
            given = {key: value for key, value in parameters.items() if key not in ("topic", "field", "min", "max")}
            made = node(ros2.Decode, given, {"/event": (f"spyke_msgs/msg/{kind.__name__}", "reliable")})
            for one in sent.publishers["event"].published:
                made.subscriptions["event"].call(one)
            values = [one.value for one in made.publishers["~/decoded"].published]
            self.assertEqual(values, [one.value for one in sent.publishers["~/decoded"].published])

    def test_what_is_lost_is_counted_and_told_to_monitors(self) -> None:
        made = encoded(SF)
        made.subscriptions["/imu"].events.message_lost(ros.SimpleNamespace(total_count_change=3))
        made.subscriptions["/imu"].call(imu(100, math.nan))
        made.tick()
        status = made.publishers["/diagnostics"].published[-1].status[0]
        told = {pair.key: pair.value for pair in status.values}
        self.assertEqual(
            told, {"messages in": "101", "messages out": "100", "messages lost": "3", "samples not finite": "1"}
        )
        self.assertEqual(status.level, b"\1")

    def test_bad_input_ends_the_node(self) -> None:
        made = node(ros2.Encode, {**SF, "field": "angular_velocity.w"}, {"/imu": ("sensor_msgs/msg/Imu", "reliable")})
        made.subscriptions["/imu"].call(imu(0, 0.0))
        self.assertIn("has no `w`; numbers of Imu: header.stamp.sec, ", made.failure)
        with self.assertRaises(ValueError):
            node(ros2.Encode, {**SF, "threshold": 0.0}, {})


class Wire(unittest.TestCase):
    """The bytes of CDR, from `rosbags` by our definitions, are those of Cyclone DDS by the types above."""

    def test_bytes(self) -> None:
        for parameters in (SF, GRF):
            made = encoded(parameters)
            for topic in ("event", "~/decoded"):
                name = made.publishers[topic].kind.__name__
                for message in made.publishers[topic].published:
                    ours = bytes(ros.STORE.serialize_cdr(message, f"spyke_msgs/msg/{name}"))
                    # Cyclone rounds the length up to 4, as DDS does on the wire.
                    theirs = cyclone(name, message).serialize()
                    self.assertEqual(ours[4:], theirs[4 : len(ours)])

    def test_readers_of_mcap(self) -> None:
        message = encoded(GRF).publishers["event"].published[7]
        text = (ros.DEFINITIONS / "SpykeArray.msg").read_text() + TIME
        schema = Schema(1, text.encode(), "ros2msg", "spyke_msgs/msg/SpykeArray")
        data = bytes(ros.STORE.serialize_cdr(message, "spyke_msgs/msg/SpykeArray"))
        read = DecoderFactory().decoder_for("cdr", schema)(data)
        self.assertEqual(list(read.spike), message.spike.tolist())
        self.assertEqual((read.scheme, read.timestamp.sec, read.timestamp.nanosec), ("grf-slots", 107, 7))


TIME = "\n" + "=" * 80 + "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"


def cyclone(name: str, message: Any) -> Any:
    """The message as Cyclone DDS has it."""
    time = Time(message.timestamp.sec, message.timestamp.nanosec)
    if name == "SpykeValue":
        return SpykeValue(message.value, time)
    said = [message.start, message.min_input, message.max_input, message.threshold, message.input, message.scheme, time]
    if name == "SpykeArray":
        return SpykeArray(message.spike.tolist(), *said)
    return Spyke(message.spike, *said)


if __name__ == "__main__":
    unittest.main()
