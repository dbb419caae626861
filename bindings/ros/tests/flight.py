"""The recorded flight through an encoding and a decoding node of every scheme at once, recorded by `rosbag record`.

    flight.py TABLE DEMO SPIKEWIRE DIRECTORY

needs the packages installed by catkin in this environment, and `spikewire`. Every spike and every bit of every value
in the bag must be the firmware's, or the laptop program's where the firmware starts in another way. Stamps are the
flight's own.
"""

import sys
import time
from collections import defaultdict
from pathlib import Path
from typing import Any

import flown as expected
import rosbag
import rospy
import spikewire
from ros import Ros, stop, until
from sensor_msgs.msg import Imu

# When the flight began, as the stamps have it.
EPOCH = 1_000_000_000
# So many samples, then a wait for all nodes: `rosbag record` keeps 100 messages a topic, and drops more without a word.
AT_ONCE = 50
# Times in µs and yaw rates.
Flight = tuple[list[int], list[float]]


class Count:
    """How many messages a topic has had."""

    def __init__(self, topic: str) -> None:
        self.count = 0
        rospy.Subscriber(topic, rospy.AnyMsg, self._take)

    def _take(self, _: rospy.AnyMsg) -> None:
        self.count += 1


def place(name: str) -> str:
    """A scheme's namespace."""
    return name.replace("-", "_")


def imu(stamp: int, rate: float) -> Imu:
    """A sample as an inertial sensor sends it."""
    message = Imu()
    message.header.stamp = rospy.Time(EPOCH) + rospy.Duration(nsecs=1000 * stamp)
    message.angular_velocity.z = rate
    return message


def fly(ros: Ros, flight: Flight, schemes: dict[str, dict[str, Any]]) -> Path:
    """The flight through all schemes; the bag."""
    encoders, decoders = {}, {}
    for name, given in schemes.items():
        of_encoder = {**given, "topic": "/imu", "field": "angular_velocity.z"}
        of_decoder = {option: value for option, value in given.items() if option not in expected.IN_MESSAGES}
        encoders[name] = ros.node(place(name), "encode", of_encoder)
        decoders[name] = ros.node(place(name), "decode", of_decoder)
    topics = ("event", "encode/decoded", "decode/decoded")
    publisher = rospy.Publisher("/imu", Imu, queue_size=0)
    decoded = {name: Count(f"/{place(name)}/decode/decoded") for name in schemes}
    recorder = ros.record("flight.bag", ["/imu", *(f"/{place(name)}/{topic}" for name in schemes for topic in topics)])
    until(lambda: publisher.get_num_connections() == len(schemes) + 1, "the encoders' start")
    until(lambda: all(len(ros.subscribers(f"/{place(name)}/event")) == 2 for name in schemes), "the decoders' start")
    time.sleep(3.0)  # who has subscribed is not yet connected

    samples = list(zip(*flight))
    for first in range(0, len(samples), AT_ONCE):
        for stamp, rate in samples[first : first + AT_ONCE]:
            publisher.publish(imu(stamp, rate))
        sent = min(first + AT_ONCE, len(samples))
        for name, own in decoded.items():
            # What is left of rate codes comes at their end.
            until(lambda: own.count >= sent - expected.LOOK_AHEAD.get(name, 0), f"sample {sent} of {name}")
    for name, encoder in encoders.items():
        assert stop(encoder) == 0, ros.said(f"{place(name)}-encode")
    for name, own in decoded.items():
        until(lambda: own.count == len(samples), f"the end of {name}")
        assert stop(decoders[name]) == 0, ros.said(f"{place(name)}-decode")
    return ros.end_recording(recorder, "flight.bag")


def compare(bag: Path, flight: Flight, wanted: dict[str, expected.Flown]) -> None:
    """The bag against what was wanted."""
    times, rates = flight
    stamps = [EPOCH * 10**9 + 1000 * stamp for stamp in times]
    found: dict[str, list[Any]] = defaultdict(list)
    with rosbag.Bag(str(bag)) as opened:
        for topic, message, _ in opened.read_messages():
            found[topic].append(message)
    assert len(found["/imu"]) == len(rates)
    for name, own in wanted.items():
        events = found[f"/{place(name)}/event"]
        assert [event.timestamp.to_nsec() for event in events] == stamps, f"{name}: {len(events)} events"
        assert [event.input for event in events] == rates, name
        for sample, (event, firings) in enumerate(zip(events, own.firings)):
            assert expected.is_as_wanted(event.spike, firings, name), f"{name}, sample {sample}: {event.spike}, not {firings}"
        for topic in ("encode/decoded", "decode/decoded"):
            values = found[f"/{place(name)}/{topic}"]
            assert [value.timestamp.to_nsec() for value in values] == stamps, f"{name}: {len(values)} of {topic}"
            assert [expected.bits(value.value) for value in values] == own.values, f"{name}: {topic}"
        spikes = sum(len(firings) for firings in own.firings)
        firmware = name not in expected.BY_PROGRAM
        by_firmware = "none" if not firmware else "spikes" if name in expected.MEANS_BY_PROGRAM else "all"
        print(f"{name:20} {spikes:6} spikes, {len(events)} values: every bit agrees; by the firmware: {by_firmware}")


def main() -> None:
    table, demo, program, directory = map(Path, sys.argv[1:])
    flight = expected.flight(table)
    contrast = spikewire.TemporalContrast(factor=0.5, magnitudes=True).fit(flight[1]).parameters["threshold"]
    schemes = expected.schemes(flight[1], contrast)
    wanted = expected.by_firmware(demo)
    for name in expected.BY_PROGRAM + expected.MEANS_BY_PROGRAM:
        by_program = expected.by_program(program, table, schemes[name], len(flight[0]))
        if name in expected.MEANS_BY_PROGRAM:
            assert by_program.firings == wanted[name].firings, name
        wanted[name] = by_program
    assert set(wanted) == set(schemes), f"not both flown and here: {set(wanted) ^ set(schemes)}"
    with Ros(directory) as ros:
        rospy.init_node("flight", disable_signals=True)
        compare(fly(ros, flight, schemes), flight, wanted)


if __name__ == "__main__":
    main()
