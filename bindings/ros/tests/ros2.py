"""The nodes of ROS 2 against Eclipse Cyclone DDS, which has nothing of ours: messages, rates, faults.

    ros2.py PREFIX TABLE DEMO DIRECTORY SPIKEWIRE

PREFIX is where colcon has installed the package, TABLE the recorded flight, DEMO the firmware's program, SPIKEWIRE the laptop's. It runs in a network
namespace of its own, whose only interface is loopback, and in one of processes, which end with it.
"""

import math
import os
import signal
import statistics
import subprocess
import sys
import time
from typing import Any

from ros2_nodes import EPOCH, PATIENCE, RATE, SF, Installed, loopback, main, nanoseconds, play, until, until_all

# Interfaces, peers beside multicast, and how soon a participant that says nothing is gone.
os.environ["CYCLONEDDS_URI"] = """<CycloneDDS><Domain>
<General><Interfaces><NetworkInterface name="lo" multicast="true"/></Interfaces></General>
<Discovery><ParticipantIndex>auto</ParticipantIndex><Peers><Peer Address="127.0.0.1"/></Peers>
<LeaseDuration>2s</LeaseDuration></Discovery>
</Domain></CycloneDDS>"""

from cyclonedds.core import Policy, Qos  # noqa: E402: it reads what is set above
from cyclonedds.domain import DomainParticipant  # noqa: E402
from cyclonedds.pub import DataWriter  # noqa: E402
from cyclonedds.sub import DataReader  # noqa: E402
from cyclonedds.topic import Topic  # noqa: E402
from cyclonedds.util import duration  # noqa: E402
import ros2_types  # noqa: E402
from ros2_types import (  # noqa: E402
    DiagnosticArray,
    Float64,
    Header,
    Imu,
    Spyke,
    SpykeArray,
    SpykeValue,
    String,
    Time,
    Vector3,
)

ROS = Policy.DataRepresentation(use_cdrv0_representation=True)
RELIABLE = Policy.Reliability.Reliable(duration(seconds=1))
# As rclcpp has it for sensors.
SENSOR_DATA = Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(5), ROS)
ALL = Qos(RELIABLE, Policy.History.KeepAll, ROS)
LATCHED = Qos(RELIABLE, Policy.History.KeepLast(1), Policy.Durability.TransientLocal, ROS)


def imu(stamp: int, rate: float) -> Imu:
    """A sample as an inertial sensor sends it; the stamp in nanoseconds."""
    return Imu(header=Header(Time(*divmod(stamp, 10**9))), angular_velocity=Vector3(z=rate))


def has_readers(writer: DataWriter) -> bool:
    return bool(writer.get_matched_subscriptions())


class Peer:
    """A participant of Cyclone DDS."""

    types, reliable = ros2_types, ALL
    imu = staticmethod(imu)
    has_readers = staticmethod(has_readers)

    def __init__(self) -> None:
        self.participant = DomainParticipant(0)

    def writer(self, topic: str, kind: type, qos: Qos = SENSOR_DATA) -> DataWriter:
        return DataWriter(self.participant, Topic(self.participant, f"rt{topic}", kind), qos=qos)

    def reader(self, topic: str, kind: type, qos: Qos = ALL) -> "Reader":
        return Reader(DataReader(self.participant, Topic(self.participant, f"rt{topic}", kind), qos=qos))


class Reader:
    """Keeps all that a topic had."""

    def __init__(self, reader: DataReader) -> None:
        self._reader = reader
        self._messages: list[Any] = []

    @property
    def messages(self) -> list[Any]:
        # What is disposed of has no data.
        self._messages += [one for one in self._reader.take(10_000) if one.sample_info.valid_data]
        return self._messages

    def is_matched(self) -> bool:
        return bool(self._reader.get_matched_publications())


class Tests(Installed):
    def peer(self) -> Peer:
        return Peer()

    def latency(self) -> None:
        """From a sample's write to its spike's arrival, both in this process."""
        peer, samples = Peer(), 3000
        writer, events = peer.writer("/imu", Imu), peer.reader("/event", Spyke)
        arrived: dict[int, int] = {}

        def take() -> None:
            before = len(arrived)
            for event in events.messages[before:]:
                arrived[nanoseconds(event.timestamp)] = time.time_ns()

        with self.node("encode", SF) as node:
            until(lambda: has_readers(writer) and events.is_matched(), "discovery")
            play(writer, [lambda: imu(time.time_ns(), 0.0)] * samples, take)
            until(lambda: (take(), len(arrived) == samples)[1], "all events", lambda: len(arrived))
            late = sorted((now - stamp) / 1e6 for stamp, now in arrived.items())
            node.stop()
        parts = statistics.quantiles(late, n=100)
        said = f"median {parts[49]:.2f} ms, 99 of 100 within {parts[98]:.2f} ms, worst {late[-1]:.2f} ms"
        print(f"latency of {samples} samples at {RATE} Hz, none lost: {said}")

    def faults(self) -> None:
        """NaN, a publisher of another type, one that is too slow to be heard, one that dies: counted and told."""
        peer, other = Peer(), Peer()
        writer, events = peer.writer("/imu", Imu), peer.reader("/event", Spyke)
        diagnostics = peer.reader("/diagnostics", DiagnosticArray)

        def counts() -> dict[str, int]:
            if not diagnostics.messages:
                return {}
            return {pair.key: int(pair.value) for pair in diagnostics.messages[-1].status[0].values}

        with self.node("encode", SF) as node:
            until(lambda: has_readers(writer) and events.is_matched() and diagnostics.is_matched(), "discovery")
            rates = [0.0, math.nan, 0.5, math.inf, -1e39, 1.0]
            play(writer, [imu(EPOCH + number * 10**6, rate) for number, rate in enumerate(rates)])
            until_all([events], 3, "three events")
            assert [event.input for event in events.messages] == [0.0, 0.5, 1.0]
            until(lambda: counts().get("samples not finite") == 3, "the count")

            words = other.writer("/imu", String)
            until(lambda: counts().get("publishers refused") == 1, "the refusal of a publisher of text")
            assert not has_readers(words), "Cyclone DDS refuses the node for its type, too"

            # While the interface is down, best effort loses all.
            before = counts()["messages in"]
            loopback("down")
            play(writer, [imu(2 * EPOCH + number * 10**6, 0.0) for number in range(500)])
            loopback("up")
            play(writer, [imu(2 * EPOCH + number * 10**6, 0.0) for number in range(500, 1000)])
            until(lambda: counts()["messages in"] + counts().get("messages lost", 0) == before + 1000, "all counted", counts)
            assert 0 < counts()["messages lost"] < 1000, counts()

            dying = subprocess.Popen([sys.executable, __file__, "--publish"])
            try:
                before = counts()["messages in"]
                until(lambda: counts()["messages in"] > before, "another publisher")
            finally:
                dying.kill()
                dying.wait()
            until(lambda: counts().get("publishers lost") == 1, "the loss of a publisher")
            before = counts()["messages in"]
            play(writer, [imu(9 * EPOCH, 2.0)])
            until(lambda: counts()["messages in"] == before + 1, "the first publisher, still heard")
            told = node.stop()
            print(f"counted: {counts()}")
            print(f"told at the end: {told}")

    def quality(self) -> None:
        """Whoever asks for another quality of service hears nothing, and the node says of each what does not match."""
        peer, others = Peer(), Peer()
        writer, diagnostics = peer.writer("/imu", Imu), peer.reader("/diagnostics", DiagnosticArray)
        # RustDDS 0.15 does not see the ownership of one who names no strength, as subscribers and a publisher of strength 0.
        exclusive = Qos(ROS, Policy.Ownership.Exclusive, Policy.OwnershipStrength(1))
        with self.node("encode", SF) as node:
            until(lambda: has_readers(writer) and diagnostics.is_matched(), "discovery")
            asking = {
                "durability": LATCHED,
                "deadline": Qos(ROS, Policy.Deadline(duration(milliseconds=10))),
            }
            readers = [others.reader("/event", Spyke, qos) for qos in asking.values()]
            other = others.writer("/imu", Imu, exclusive)

            def counts() -> dict[str, str]:
                return {pair.key: pair.value for one in diagnostics.messages for pair in one.status[0].values}

            refused = {"subscribers refused": "2", "publishers refused": "1"}
            until(lambda: refused.items() <= counts().items(), "the counts")
            assert not has_readers(other) and not any(reader.is_matched() for reader in readers)
            node.stop()
            for policy in asking:
                assert f"(/event: the {policy} that is wanted is not offered)" in node.said(), node.said()
            assert "publishers refused: 1 (the ownership that is wanted is not offered)" in node.said(), node.said()
        print(f"told of {', '.join(asking)} and exclusive ownership")

    def comers(self) -> None:
        """A subscriber and a decoder that come late, and an encoder that starts again."""
        peer = Peer()
        writer, events = peer.writer("/imu", Imu), peer.reader("/event", Spyke)
        encoder = self.node("encode", SF)
        with encoder:
            until(lambda: has_readers(writer) and events.is_matched(), "discovery")
            play(writer, [imu(EPOCH + number * 10**6, 1.5 + 0.07 * number) for number in range(50)])
            until_all([events], 50, "the first events")
            header = peer.reader("/event_header", String, LATCHED)
            until(lambda: header.messages, "the header, for one who comes late")
            lines = header.messages[0].data.splitlines()
            assert {"spikewire=1", "scheme=sf", "threshold=0.1", "first=1.5"} <= set(lines), lines
            with self.node("decode", {}) as decoder:
                values = peer.reader("/decode/decoded", SpykeValue)
                until(values.is_matched, "a late decoder")
                time.sleep(1.5)
                play(writer, [imu(2 * EPOCH, 5.0)])
                until_all([values], 1, "its first value")
                encoder.stop()
                with self.node("encode", SF) as again:
                    until(lambda: has_readers(writer), "the encoder again")
                    time.sleep(1.5)
                    play(writer, [imu(3 * EPOCH, -2.0)])
                    until_all([values], 2, "its first value again")
                    assert values.messages[1].value == -2.0, values.messages[1]
                    again.stop()
                told = decoder.stop()
        assert "1 new starts of the encoder" in told and "1 starts in the middle" in told, told
        assert "1 publishers lost" in told, told
        print(f"a late decoder, and an encoder that starts again: {told}")

    def refused(self) -> None:
        """Bad parameters, files and fields end a node with exit status 2, and a text that says which."""
        peer = Peer()
        writers = [peer.writer("/imu", Imu), peer.writer("/words", String), peer.writer("/number", Float64)]
        file = self.directory / "bad.yaml"
        file.write_text("encode: [1]\n")
        for changed, arguments, text in (
            ({"encoding_scheme": "step"}, (), "encoding_scheme step: there are tbr, atbr, mw,"),
            ({"threshold": 0.0}, (), "threshold 0 must be above 0"),
            ({"treshold": 0.1}, (), "sf takes no treshold"),
            ({"calibrate": -1}, (), "calibrate: -1: it must be a whole number"),
            ({"field": "angular_velocity.w"}, (), "numbers of sensor_msgs/Imu: header.stamp.sec, "),
            ({"topic": "/words", "field": "data"}, (), "numbers of std_msgs/String: none"),
            ({}, ("--params-file", str(file)), "nothing is below"),
            ({}, ("--params-file", "none.yaml"), "none.yaml"),
        ):
            with self.node("encode", {**SF, **changed}, *arguments) as node:
                assert node.process.wait(PATIENCE) == 2, node.said()
                assert text in node.said() and "panicked" not in node.said(), node.said()
                print(f"{changed or arguments[1]}: exit status 2, {node.said().strip()[:120]}")
        with self.node("decode", {}, "-r", "event:=/number") as node:
            assert node.process.wait(PATIENCE) == 2 and "the topic is of std_msgs/Float64" in node.said(), node.said()
        for parameters, text in (
            ({"topic": "/imu"}, "flight is missing"),
            ({"topic": "/imu", "flight": "none.toml"}, "none.toml: No such file"),
            ({"topic": "/imu", "flight": "none.toml", "threshold": 1.0}, "threshold: it stands in the flight's file"),
        ):
            with self.node("flight", parameters) as node:
                assert node.process.wait(PATIENCE) == 2 and text in node.said(), node.said()
        # RustDDS does not go on after this; its node says so, and ends.
        with self.node("encode", {**SF, "topic": "/number", "field": "data"}) as node:
            until(lambda: has_readers(writers[-1]), "discovery")
            node.process.send_signal(signal.SIGSTOP)
            time.sleep(0.2)
            node.process.send_signal(signal.SIGCONT)
            assert node.process.wait(PATIENCE) == 2 and "DDS has stopped" in node.said(), node.said()


def publish() -> None:
    """A publisher that is to be killed."""
    writer = Peer().writer("/imu", Imu)
    for number in range(60 * RATE // 10):
        writer.write(imu(8 * EPOCH + number * 10**7, 1.0))
        time.sleep(0.01)


if __name__ == "__main__":
    if sys.argv[1:] == ["--publish"]:
        publish()
    else:
        main(Tests, "ros2_run", "refused", "faults", "quality", "comers", "latency", "flight", "imu")
