"""The nodes of ROS 2 against Eclipse Cyclone DDS, which has nothing of ours: messages, rates, faults.

    ros2.py PREFIX TABLE DEMO DIRECTORY

PREFIX is where colcon has installed the package, TABLE the recorded flight, DEMO the firmware's program. It runs in a network
namespace of its own, whose only interface is loopback, and in one of processes, which end with it.
"""

import math
import os
import signal
import statistics
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any, Callable, Optional

import flown as expected

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
SF = {"encoding_scheme": "step_forward", "threshold": 0.1, "topic": "/imu", "field": "angular_velocity.z"}
# Of one neuron, of a rate code that looks ahead, with several spikes a sample, and of a population in sub-timesteps.
FLOWN = ("sf", "t-hsa", "sod", "grf-slots")
EPOCH = 1_000_000_000
RATE = 1000


def until(is_so: Callable[[], Any], what: str, seconds: float = 30.0) -> None:
    """Waits."""
    end = time.monotonic() + seconds
    while not is_so():
        if time.monotonic() > end:
            raise TimeoutError(f"{what} took more than {seconds:.0f} s")
        time.sleep(0.02)


class Peer:
    """A participant of Cyclone DDS."""

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


def has_readers(writer: DataWriter, count: int = 1) -> bool:
    return len(writer.get_matched_subscriptions()) >= count


class Node:
    """A node with the arguments that `ros2 run` hands on."""

    def __init__(
        self, start: list[str], place: Path, parameters: dict[str, Any], *arguments: str, namespace: str = "/"
    ) -> None:
        given = [word for name, value in parameters.items() for word in ("-p", f"{name}:={value}")]
        self.command = [*start, "--ros-args", "-r", f"__ns:={namespace}", *given, *arguments]
        self._said = place / f"said-{time.monotonic_ns()}.txt"
        with open(self._said, "w") as said:
            # A group of its own, as a shell makes it: Ctrl-C goes to all of it.
            self.process = subprocess.Popen(self.command, stderr=said, stdout=said, start_new_session=True)

    def said(self) -> str:
        return self._said.read_text()

    def __enter__(self) -> "Node":
        return self

    def __exit__(self, *_: object) -> None:
        if self.process.poll() is None:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()

    def stop(self) -> str:
        """Ends it as Ctrl-C does; what it told at its end."""
        os.killpg(self.process.pid, signal.SIGINT)
        assert self.process.wait(20) == 0, self.said()
        return self.said().strip().splitlines()[-1].split("]: ", 1)[1]


def imu(stamp: int, rate: float) -> Imu:
    """A sample as an inertial sensor sends it; the stamp in nanoseconds."""
    return Imu(header=Header(Time(*divmod(stamp, 10**9))), angular_velocity=Vector3(z=rate))


def play(writer: DataWriter, messages: list[Any], take: Callable[[], Any] = lambda: None) -> None:
    """Sends at the rate, and calls `take` in between."""
    start = time.monotonic()
    for number, message in enumerate(messages):
        while time.monotonic() < start + number / RATE:
            take()
            time.sleep(0)
        writer.write(message() if callable(message) else message)


def launched(launch: Path, arguments: dict[str, str]) -> list[str]:
    """The arguments that a launch file gives its node, as `ros2 launch` reads it."""
    root = ElementTree.parse(launch).getroot()
    values = {arg.get("name"): arg.get("default") for arg in root.iter("arg")} | arguments
    assert None not in values.values(), values

    def filled(text: Optional[str]) -> str:
        for name, value in values.items():
            text = str(text).replace(f"$(var {name})", str(value))
        return str(text)

    words = ["-r", f"__node:={root.find('node').get('name')}"]
    for param in root.iter("param"):
        if param.get("from"):
            words += ["--params-file", filled(param.get("from"))]
        else:
            words += ["-p", f"{param.get('name')}:={filled(param.get('value'))}"]
    return words


class Tests:
    def __init__(self, prefix: Path, table: Path, demo: Path, directory: Path) -> None:
        self.prefix = prefix
        self.launch = prefix / "spikewire_ros" / "share" / "spikewire_ros" / "launch" / "encode.launch.xml"
        self.table, self.demo, self.directory = table, demo, directory

    def node(self, kind: str, parameters: dict[str, Any], *arguments: str, namespace: str = "/") -> Node:
        program = self.prefix / "spikewire_ros" / "lib" / "spikewire_ros" / kind
        return Node([str(program)], self.directory, parameters, *arguments, namespace=namespace)

    def run(self, package: str, kind: str, parameters: dict[str, Any]) -> Node:
        """A node by `ros2 run`, in a shell that has read the workspace's `setup.bash`."""
        shell = '. "$0/setup.bash" && unset PYTHONPATH && exec /usr/bin/python3 "$@"'
        program = str(Path(__file__).with_name("ros2_run.py"))
        return Node(["bash", "-c", shell, str(self.prefix), program, package, kind], self.directory, parameters)

    def ros2_run(self) -> None:
        """After the README's commands `ros2 run` finds the nodes, hands on arguments and exit status, and ends by Ctrl-C."""
        peer = Peer()
        writer, events = peer.writer("/imu", Imu), peer.reader("/event", Spyke)
        values = peer.reader("/decode/decoded", SpykeValue)
        with self.run("spikewire_ros", "encode", SF) as encoder, self.run("spikewire_ros", "decode", {}) as decoder:
            until(lambda: has_readers(writer) and events.is_matched() and values.is_matched(), "discovery")
            time.sleep(2.0)
            play(writer, [imu(EPOCH + number * 10**6, 0.15 * number) for number in range(4)])
            until(lambda: len(values.messages) == 4, "four values")
            assert [event.spike for event in events.messages] == [0, 1, 1, 1], events.messages
            told = [node.stop() for node in (encoder, decoder)]
        with self.run("spikewire_ros", "encode", {**SF, "threshold": 0.0}) as node:
            assert node.process.wait(20) == 2 and "threshold 0 must be above 0" in node.said(), node.said()
        with self.run("spikewire", "encode", SF) as node:
            assert node.process.wait(20) == 1 and "Package 'spikewire' not found" in node.said(), node.said()
        print(f"ros2 run: encoder and decoder started, {len(values.messages)} values, ended: {told}")

    def params(self, name: str, node: str, parameters: dict[str, Any]) -> str:
        """A file as ROS 2 reads it."""
        lines = [f"{node}:", "  ros__parameters:", *(f"    {key}: {value!r}" for key, value in parameters.items())]
        file = self.directory / f"{name}.yaml"
        file.write_text("\n".join(lines) + "\n")
        return str(file)

    def flight(self) -> None:
        """A recorded flight at 1 kHz through an encoder and its decoder: the firmware's spikes and values."""
        flight = expected.flight(self.table)
        wanted, schemes = expected.by_firmware(self.demo), expected.schemes(flight[1], contrast=0.0)
        for name in FLOWN:
            self.fly(name, schemes[name], wanted[name], flight)

    def fly(self, name: str, own: dict[str, Any], wanted: expected.Flown, flight: tuple[list[int], list[float]]) -> None:
        """The encoder as the launch file starts it; parameters out of files."""
        space, topic, peer = "/" + name.replace("-", "_"), "/imu_" + name.replace("-", "_"), Peer()
        writer = peer.writer(topic, Imu)
        file = self.params(f"{name}-encode", f"{space}/encode", {key: own[key] for key in own if key != "encoding_scheme"})
        arguments = {"scheme": own["encoding_scheme"], "topic": topic, "field": "angular_velocity.z", "params": file}
        heard = {key: value for key, value in own.items() if key not in expected.IN_MESSAGES}
        file = self.params(f"{name}-decode", "/**/decode", {"gap": 1.5, **heard})
        with (
            self.node("encode", {}, *launched(self.launch, arguments), namespace=space) as encoder,
            self.node("decode", {}, "--params-file", file, namespace=space) as decoder,
        ):
            kind = SpykeArray if name in ("sod", "grf-slots") else Spyke
            events = peer.reader(f"{space}/event", kind)
            values = [peer.reader(f"{space}/{node}/decoded", SpykeValue) for node in ("encode", "decode")]
            every = [events, *values]
            until(lambda: has_readers(writer) and all(reader.is_matched() for reader in every), "discovery")
            # A decoder subscribes once it knows the type of the topic.
            time.sleep(2.0)
            times, rates = flight
            stamps = [EPOCH * 10**9 + 1000 * stamp for stamp in times]
            play(writer, [imu(stamp, rate) for stamp, rate in zip(stamps, rates)])
            ahead = expected.LOOK_AHEAD.get(name, 0)
            until(lambda: all(len(one.messages) >= len(rates) - ahead for one in every), f"the flight of {name}")
            # What is left of a rate code comes at its end.
            told = encoder.stop()
            until(lambda: all(len(one.messages) == len(rates) for one in every), f"the end of {name}")
            decoder.stop()
        # The flight's log has pauses.
        assert told == "9 gaps", told
        assert [event.timestamp.nanoseconds for event in events.messages] == stamps, name
        for sample, (event, firings) in enumerate(zip(events.messages, wanted.firings)):
            assert expected.is_as_wanted(event.spike, firings, name), f"{name}, {sample}: {event.spike}, {firings}"
        for reader in values:
            assert [value.timestamp.nanoseconds for value in reader.messages] == stamps, name
            assert [expected.bits(value.value) for value in reader.messages] == wanted.values, name
        print(f"{name}: {len(rates)} messages at {RATE} Hz, every spike and every bit of every value the firmware's")

    def latency(self) -> None:
        """From a sample's write to its spike's arrival, both in this process."""
        peer, samples = Peer(), 3000
        writer, events = peer.writer("/imu", Imu), peer.reader("/event", Spyke)
        arrived: dict[int, int] = {}

        def take() -> None:
            before = len(arrived)
            for event in events.messages[before:]:
                arrived[event.timestamp.nanoseconds] = time.time_ns()

        with self.node("encode", SF) as node:
            until(lambda: has_readers(writer) and events.is_matched(), "discovery")
            play(writer, [lambda: imu(time.time_ns(), 0.0)] * samples, take)
            until(lambda: (take(), len(arrived) == samples)[1], "all events")
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
            until(lambda: len(events.messages) == 3, "three events")
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
            until(lambda: counts()["messages in"] + counts().get("messages lost", 0) == before + 1000, "all counted")
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

    def comers(self) -> None:
        """A subscriber and a decoder that come late, and an encoder that starts again."""
        peer = Peer()
        writer, events = peer.writer("/imu", Imu), peer.reader("/event", Spyke)
        encoder = self.node("encode", SF)
        with encoder:
            until(lambda: has_readers(writer) and events.is_matched(), "discovery")
            play(writer, [imu(EPOCH + number * 10**6, 1.5 + 0.07 * number) for number in range(50)])
            until(lambda: len(events.messages) == 50, "the first events")
            header = peer.reader("/event_header", String, LATCHED)
            until(lambda: header.messages, "the header, for one who comes late")
            lines = header.messages[0].data.splitlines()
            assert {"spikewire=1", "scheme=sf", "threshold=0.1", "first=1.5"} <= set(lines), lines
            with self.node("decode", {}) as decoder:
                values = peer.reader("/decode/decoded", SpykeValue)
                until(values.is_matched, "a late decoder")
                time.sleep(1.5)
                play(writer, [imu(2 * EPOCH, 5.0)])
                until(lambda: len(values.messages) == 1, "its first value")
                encoder.stop()
                with self.node("encode", SF) as again:
                    until(lambda: has_readers(writer), "the encoder again")
                    time.sleep(1.5)
                    play(writer, [imu(3 * EPOCH, -2.0)])
                    until(lambda: len(values.messages) == 2, "its first value again")
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
                assert node.process.wait(20) == 2, node.said()
                assert text in node.said() and "panicked" not in node.said(), node.said()
                print(f"{changed or arguments[1]}: exit status 2, {node.said().strip()[:120]}")
        with self.node("decode", {}, "-r", "event:=/number") as node:
            assert node.process.wait(20) == 2 and "the topic is of std_msgs/Float64" in node.said(), node.said()
        # RustDDS does not go on after this; its node says so, and ends.
        with self.node("encode", {**SF, "topic": "/number", "field": "data"}) as node:
            until(lambda: has_readers(writers[-1]), "discovery")
            node.process.send_signal(signal.SIGSTOP)
            time.sleep(0.2)
            node.process.send_signal(signal.SIGCONT)
            assert node.process.wait(20) == 2 and "DDS has stopped" in node.said(), node.said()


def publish() -> None:
    """A publisher that is to be killed."""
    writer = Peer().writer("/imu", Imu)
    for number in range(60 * RATE // 10):
        writer.write(imu(8 * EPOCH + number * 10**7, 1.0))
        time.sleep(0.01)


def loopback(state: str) -> None:
    """Switches the interface on, with multicast, or off."""
    subprocess.run(["ip", "link", "set", "lo", state, "multicast", "on"], check=True)
    if state == "up":
        subprocess.run(["ip", "route", "add", "224.0.0.0/4", "dev", "lo"], check=True)


def main() -> None:
    prefix, table, demo, directory = map(Path, sys.argv[1:])
    loopback("up")
    links = subprocess.run(["ip", "-o", "link"], check=True, capture_output=True, text=True).stdout.splitlines()
    assert len(links) == 1, f"a network of its own has loopback alone, and no {links}"
    tests = Tests(prefix, table, demo, directory)
    for test in (tests.ros2_run, tests.refused, tests.faults, tests.comers, tests.latency, tests.flight):
        start = time.monotonic()
        test()
        print(f"--- {test.__name__}: {time.monotonic() - start:.1f} s")


if __name__ == "__main__":
    publish() if sys.argv[1:] == ["--publish"] else main()
