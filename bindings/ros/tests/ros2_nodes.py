"""The nodes of ROS 2 as programs, and the network that their tests have: what both tests share."""

import csv
import os
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any, Callable, Optional

import flown as expected

SF = {"encoding_scheme": "step_forward", "threshold": 0.1, "topic": "/imu", "field": "angular_velocity.z"}
# Of one neuron, of a rate code that looks ahead, with several spikes a sample, and of a population in sub-timesteps.
FLOWN = ("sf", "t-hsa", "sod", "grf-slots")
EPOCH = 1_000_000_000
RATE = 1000
# Seconds for which a node may do nothing: one that works has answered or gone on long before, beside other programs, too.
PATIENCE = 60.0


def until(is_so: Callable[[], Any], what: str, progress: Callable[[], Any] = lambda: None) -> None:
    """Waits for as long as `progress` changes, however slowly a busy machine brings it about, and `PATIENCE` without a change."""
    seen, end = progress(), time.monotonic() + PATIENCE
    while not is_so():
        if (now := progress()) != seen:
            seen, end = now, time.monotonic() + PATIENCE
        if time.monotonic() > end:
            raise TimeoutError(f"{what}: nothing has changed for {PATIENCE:.0f} s, at {seen}")
        time.sleep(0.02)


def until_all(readers: list[Any], count: int, what: str) -> None:
    """Waits until each reader has as many messages, or more."""
    counts = lambda: [len(reader.messages) for reader in readers]  # noqa: E731
    until(lambda: all(have >= count for have in counts()), what, counts)


def nanoseconds(time: Any) -> int:
    """Those of a message's time."""
    return time.sec * 10**9 + time.nanosec


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
        assert self.process.wait(PATIENCE) == 0, self.said()
        return self.said().strip().splitlines()[-1].split("]: ", 1)[1]


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


def play(writer: Any, messages: list[Any], take: Callable[[], Any] = lambda: None) -> None:
    """Sends at the rate, and calls `take` in between."""
    start = time.monotonic()
    for number, message in enumerate(messages):
        while time.monotonic() < start + number / RATE:
            take()
            time.sleep(0)
        writer.write(message() if callable(message) else message)


class Installed:
    """The nodes as colcon has installed them, and the tests that a peer of any implementation of DDS can do.

    A peer has `types` of messages, a `writer` and a `reader` of a topic and a type, `imu`, which makes a sample, and `reliable`,
    a quality of service that loses none.
    """

    def __init__(self, prefix: Path, table: Path, demo: Path, directory: Path, spikewire: Path) -> None:
        self.prefix = prefix
        self.launch = prefix / "spikewire_ros" / "share" / "spikewire_ros" / "launch" / "encode.launch.xml"
        self.table, self.demo, self.directory, self.spikewire = table, demo, directory, spikewire

    def peer(self) -> Any:
        """A participant of its own."""
        raise NotImplementedError

    def node(self, kind: str, parameters: dict[str, Any], *arguments: str, namespace: str = "/") -> Node:
        program = self.prefix / "spikewire_ros" / "lib" / "spikewire_ros" / kind
        return Node([str(program)], self.directory, parameters, *arguments, namespace=namespace)

    def run(self, package: str, kind: str, parameters: dict[str, Any]) -> Node:
        """A node by `ros2 run`, in a shell that has read the workspace's `setup.bash`."""
        shell = '. "$0/setup.bash" && exec "$@"'
        program = str(Path(__file__).with_name("ros2_run.py"))
        return Node(["bash", "-c", shell, str(self.prefix), sys.executable, program, package, kind], self.directory, parameters)

    def ros2_run(self) -> None:
        """After the README's commands `ros2 run` finds the nodes, hands on arguments and exit status, and ends by Ctrl-C."""
        peer = self.peer()
        writer, events = peer.writer("/imu", peer.types.Imu), peer.reader("/event", peer.types.Spyke)
        values = peer.reader("/decode/decoded", peer.types.SpykeValue)
        with self.run("spikewire_ros", "encode", SF) as encoder, self.run("spikewire_ros", "decode", {}) as decoder:
            until(lambda: peer.has_readers(writer) and events.is_matched() and values.is_matched(), "discovery")
            time.sleep(2.0)
            play(writer, [peer.imu(EPOCH + number * 10**6, 0.15 * number) for number in range(4)])
            until_all([values], 4, "four values")
            assert [event.spike for event in events.messages] == [0, 1, 1, 1], events.messages
            told = [node.stop() for node in (encoder, decoder)]
        with self.run("spikewire_ros", "encode", {**SF, "threshold": 0.0}) as node:
            assert node.process.wait(PATIENCE) == 2 and "threshold 0 must be above 0" in node.said(), node.said()
        with self.run("spikewire", "encode", SF) as node:
            assert node.process.wait(PATIENCE) == 1 and "Package 'spikewire' not found" in node.said(), node.said()
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
        space, topic, peer = "/" + name.replace("-", "_"), "/imu_" + name.replace("-", "_"), self.peer()
        writer = peer.writer(topic, peer.types.Imu, peer.reliable)
        file = self.params(f"{name}-encode", f"{space}/encode", {key: own[key] for key in own if key != "encoding_scheme"})
        arguments = {"scheme": own["encoding_scheme"], "topic": topic, "field": "angular_velocity.z", "params": file}
        heard = {key: value for key, value in own.items() if key not in expected.IN_MESSAGES}
        file = self.params(f"{name}-decode", "/**/decode", {"gap": 1.5, **heard})
        with (
            self.node("encode", {}, *launched(self.launch, arguments), namespace=space) as encoder,
            self.node("decode", {}, "--params-file", file, namespace=space) as decoder,
        ):
            kind = peer.types.SpykeArray if name in ("sod", "grf-slots") else peer.types.Spyke
            events = peer.reader(f"{space}/event", kind)
            values = [peer.reader(f"{space}/{node}/decoded", peer.types.SpykeValue) for node in ("encode", "decode")]
            every = [events, *values]
            until(lambda: peer.has_readers(writer) and all(reader.is_matched() for reader in every), "discovery")
            # A decoder subscribes once it knows the type of the topic.
            time.sleep(2.0)
            times, rates = flight
            stamps = [EPOCH * 10**9 + 1000 * stamp for stamp in times]
            play(writer, [peer.imu(stamp, rate) for stamp, rate in zip(stamps, rates)])
            ahead = expected.LOOK_AHEAD.get(name, 0)
            until_all(every, len(rates) - ahead, f"the flight of {name}")
            # What is left of a rate code comes at its end.
            told = encoder.stop()
            until_all(every, len(rates), f"the end of {name}")
            decoder.stop()
        # The flight's log has pauses.
        assert told == "9 gaps", told
        assert [nanoseconds(event.timestamp) for event in events.messages] == stamps, name
        for sample, (event, firings) in enumerate(zip(events.messages, wanted.firings)):
            assert expected.is_as_wanted(event.spike, firings, name), f"{name}, {sample}: {event.spike}, {firings}"
        for reader in values:
            assert [nanoseconds(value.timestamp) for value in reader.messages] == stamps, name
            assert [expected.bits(value.value) for value in reader.messages] == wanted.values, name
        print(f"{name}: {len(rates)} messages at {RATE} Hz, every spike and every bit of every value the firmware's")

    def imu(self) -> None:
        """All six channels of a flight's file at 1 kHz: the spikes and values of the laptop program."""
        own = Path(__file__).parents[3] / "examples/one-file/flight.toml"
        ask = [self.spikewire, "encode", "--flight", own, self.table]
        encoded = subprocess.run(ask, check=True, capture_output=True, text=True).stdout
        decode = [self.spikewire, "decode"]
        decoded = subprocess.run(decode, check=True, capture_output=True, text=True, input=encoded).stdout
        slots = int(next(line for line in encoded.splitlines() if line.startswith("# spikes=")).split("=")[1])
        text = own.read_text()
        for kind, field in (("gyro", "angular_velocity"), ("accel", "linear_acceleration")):
            for axis in "xyz":
                text = text.replace(f'"{kind}_{axis}"\n', f'"{kind}_{axis}"\nsource = "{field}.{axis}"\n')
        file = self.directory / "flight.toml"
        file.write_text(text)

        peer = self.peer()
        samples = []
        with open(self.table) as rows:
            for number, row in enumerate(csv.DictReader(rows)):
                sample = peer.imu(EPOCH * 10**9 + 10**6 * number, 0.0)
                sample.header.frame_id = "imu_link"
                for axis in "xyz":
                    setattr(sample.angular_velocity, axis, float(row[f"gyro_{axis}"]))
                    setattr(sample.linear_acceleration, axis, float(row[f"accel_{axis}"]))
                samples.append(sample)
        wanted: list[list[tuple[int, int, int]]] = [[] for _ in samples]
        for row in csv.DictReader(line for line in encoded.splitlines() if not line.startswith("#")):
            sample, slot = divmod(int(row["index"]), slots)
            wanted[sample].append((int(row["address"]), slot, int(row["polarity"])))

        writer = peer.writer("/imu", peer.types.Imu, peer.reliable)
        spikes = peer.reader("/six/spikes", peer.types.Spikes)
        values = [peer.reader(f"/six/{node}/decoded", peer.types.Values) for node in ("flight", "decode")]
        every = [spikes, *values]
        arguments = launched(self.launch.with_name("flight.launch.xml"), {"flight": str(file), "topic": "/imu"})
        with (
            self.node("flight", {}, *arguments, namespace="/six") as node,
            self.node("decode", {"flight": str(file)}, namespace="/six") as decoder,
        ):
            until(lambda: peer.has_readers(writer) and all(one.is_matched() for one in every), "discovery")
            # A node hears its publisher a little later than that hears the node.
            time.sleep(2.0)
            play(writer, samples)
            until_all(every, len(samples), "the flight")
            told = [node.stop(), decoder.stop()]
        assert told[0] == "nothing lost, nothing refused" and told[1] in (told[0], "1 publishers lost"), told
        for one, sent in zip(spikes.messages, samples):
            assert nanoseconds(one.header.stamp) == nanoseconds(sent.header.stamp), one.header
            assert one.header.frame_id == "imu_link", one.header
        fired = [[(one.address, one.slot, one.polarity) for one in message.spikes] for message in spikes.messages]
        assert [sorted(one) for one in fired] == [sorted(one) for one in wanted]
        for reader in values:
            for message, row in zip(reader.messages, csv.reader(decoded.splitlines()[1:])):
                shown = [expected.bits(float(value)) for value in row[1:7]]
                assert [expected.bits(value) for value in message.values] == shown, row
        print(f"six channels: {sum(map(len, fired))} spikes of {len(samples)} messages at {RATE} Hz, and their values, the laptop program's")


def loopback(state: str) -> None:
    """Switches the interface on, with multicast, or off."""
    subprocess.run(["ip", "link", "set", "lo", state, "multicast", "on"], check=True)
    if state == "up":
        subprocess.run(["ip", "route", "add", "224.0.0.0/4", "dev", "lo"], check=True)


def main(tests: type[Installed], *names: str) -> None:
    """Runs tests, with what the command line names, where loopback is the only interface."""
    loopback("up")
    links = subprocess.run(["ip", "-o", "link"], check=True, capture_output=True, text=True).stdout.splitlines()
    assert len(links) == 1, f"a network of its own has loopback alone, and no {links}"
    own = tests(*map(Path, sys.argv[1:]))
    for name in names:
        start = time.monotonic()
        getattr(own, name)()
        print(f"--- {name}: {time.monotonic() - start:.1f} s")
