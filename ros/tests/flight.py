"""The recorded flight through an encoding and a decoding node of every scheme, recorded by `rosbag record`.

    flight.py TABLE DEMO SPIKEWIRE DIRECTORY

needs the packages installed by catkin in this environment, and `spikewire`. Every spike and every bit of every value
in the bag must be the firmware's, or the laptop program's where the firmware starts in another way.
"""

import sys
import time
from collections import defaultdict
from pathlib import Path
from typing import Any, Dict, List

import flown as expected
import rosbag
import rospy
from diagnostic_msgs.msg import DiagnosticArray
from ros import Ros, stop, until
from sensor_msgs.msg import Imu

# Times the flight's own rate; stamps are the flight's.
SPEED = 4.0
# When it took off, as the stamps have it.
EPOCH = 1_000_000_000
# Nodes at once: so many that two cores keep up.
AT_ONCE = 8
# What the decoding node does not find in messages.
_OF_ENCODER = ("encoding_scheme", "calibrate", "factor", "magnitudes", "min", "max", "shift")


class Flow:
    """How many messages each node has taken and given, as it tells monitors."""

    def __init__(self) -> None:
        self.counts: Dict[str, Dict[str, int]] = defaultdict(dict)
        rospy.Subscriber("/diagnostics", DiagnosticArray, self._take)

    def _take(self, message: DiagnosticArray) -> None:
        for status in message.status:
            self.counts[status.name] = {pair.key: int(pair.value) for pair in status.values}

    def of(self, name: str, what: str) -> int:
        return self.counts[name].get(what, 0)


def fly(ros: Ros, flow: Flow, publisher: rospy.Publisher, names: List[str], all_of_them: Dict[str, Any]) -> Path:
    """One flight through some of the schemes; the bag."""
    place = {name: name.replace("-", "_") for name in names}
    encoders, decoders = {}, {}
    for name in names:
        given = all_of_them[name]
        encoder = {**given, "topic": "/imu", "field": "angular_velocity.z"}
        decoder = {option: value for option, value in given.items() if option not in _OF_ENCODER}
        encoders[name] = ros.node(place[name], "encode", encoder)
        decoders[name] = ros.node(place[name], "decode", decoder)
    topics = [f"/{place[name]}/{topic}" for name in names for topic in ("event", "encode/decoded", "decode/decoded")]
    recorder = ros.record(f"{names[0]}.bag", ["/imu", *topics])
    until(lambda: publisher.get_num_connections() == len(names) + 1, "the encoders' start")
    events = [f"/{place[name]}/event" for name in names]
    until(lambda: all(len(ros.subscribers(event)) == 2 for event in events), "the decoders' start")
    time.sleep(2.0)  # subscribed is not yet connected

    start = time.monotonic()
    for number, (stamp, rate) in enumerate(zip(*FLIGHT)):
        message = Imu()
        message.header.stamp = rospy.Time(EPOCH) + rospy.Duration(nsecs=1000 * stamp)
        message.angular_velocity.z = rate
        time.sleep(max(0.0, start + stamp / 1e6 / SPEED - time.monotonic()))
        publisher.publish(message)
    samples = number + 1
    for name in names:
        until(lambda: flow.of(f"/{place[name]}/encode", "messages in") == samples, f"{name}'s encoder")
    # What is left of rate codes comes at their end.
    assert all(stop(encoder) == 0 for encoder in encoders.values())
    for name in names:
        until(lambda: flow.of(f"/{place[name]}/decode", "messages out") == samples, f"{name}'s decoder")
    assert all(stop(decoder) == 0 for decoder in decoders.values())
    bag = ros.end_recording(recorder, f"{names[0]}.bag")
    for name in names:
        last = ros.said(f"{place[name]}-encode").strip().splitlines()[-1]
        print(f"  {name}: {last.split(': ', 1)[1]}")
    return bag


def compare(path: Path, names: List[str], wanted: Dict[str, expected.Flown]) -> None:
    """The bag against what was wanted."""
    times, rates = FLIGHT
    stamps = [EPOCH * 10**9 + 1000 * stamp for stamp in times]
    found: Dict[str, List[Any]] = defaultdict(list)
    with rosbag.Bag(str(path)) as bag:
        for topic, message, _ in bag.read_messages():
            found[topic].append(message)
    assert len(found["/imu"]) == len(rates)
    for name in names:
        place, own = name.replace("-", "_"), wanted[name]
        events = found[f"/{place}/event"]
        assert [event.timestamp.to_nsec() for event in events] == stamps, name
        assert [event.input for event in events] == rates, name
        for sample, (event, firings) in enumerate(zip(events, own.firings)):
            assert _as_wanted(event.spike, firings, name), f"{name}, sample {sample}: {event.spike}, wanted {firings}"
        for topic in ("encode/decoded", "decode/decoded"):
            values = found[f"/{place}/{topic}"]
            assert [value.timestamp.to_nsec() for value in values] == stamps, name
            assert [expected.bits(value.value) for value in values] == own.values, f"{name}: {topic}"
        spikes = sum(len(firings) for firings in own.firings)
        print(f"{name:20} {spikes:6} spikes, {len(values)} values: every bit agrees")


def _as_wanted(spike: Any, firings: List[expected.Firing], name: str) -> bool:
    """A number of `spyke`, or those of `spyke_array`: sub-timestep after sub-timestep, in each neuron by neuron."""
    if not hasattr(spike, "__len__"):
        return spike == sum(sign for _, _, sign in firings)
    neurons = NEURONS.get(name, 1)
    row = [0] * len(spike)
    for neuron, slot, sign in firings:
        row[slot * neurons + neuron] = sign
    return list(spike) == row


# Of arrays.
NEURONS = {
    "position": 20,
    "position-gauss": 20,
    "grf": 20,
    "grf-nonlinear": 20,
    "grf-slots": 15,
    "grf-prob": 15,
    "grf-nonlinear-slots": 15,
    "rank-order": 15,
    "latency-phase": 4,
}


def main() -> None:
    table, demo, program, directory = map(Path, sys.argv[1:])
    global FLIGHT
    FLIGHT = expected.flight(table)
    all_of_them = expected.schemes(FLIGHT[1])
    wanted = expected.by_firmware(demo)
    for name in expected.BY_PROGRAM:
        wanted[name] = expected.by_program(program, table, all_of_them[name], 1, len(FLIGHT[0]))
    assert set(wanted) == set(all_of_them), set(wanted) ^ set(all_of_them)
    names = list(all_of_them)
    with Ros(directory) as ros:
        rospy.init_node("flight", disable_signals=True)
        flow = Flow()
        publisher = rospy.Publisher("/imu", Imu, queue_size=0)
        for first in range(0, len(names), AT_ONCE):
            part = names[first : first + AT_ONCE]
            compare(fly(ros, flow, publisher, part, all_of_them), part, wanted)


if __name__ == "__main__":
    main()
