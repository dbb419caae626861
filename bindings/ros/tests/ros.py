"""A ROS 1 of its own for the tests: a core, nodes and recorders, all ended at the end."""

import os
import signal
import socket
import subprocess
import time
from pathlib import Path
from typing import Callable
from xmlrpc.client import ServerProxy


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Ros:
    """`with Ros(directory) as ros:` has a core; logs and recordings go below the directory."""

    def __init__(self, directory: Path) -> None:
        self.directory = directory
        for old in directory.glob("*.bag*"):
            old.unlink()
        port = _free_port()
        # This process talks to the core as well.
        os.environ["ROS_MASTER_URI"] = f"http://127.0.0.1:{port}"
        os.environ["ROS_IP"] = "127.0.0.1"
        os.environ["ROS_HOME"] = str(directory)
        os.environ["ROS_LOG_DIR"] = str(directory / "log")
        os.environ["PYTHONUNBUFFERED"] = "1"  # what they say is read while they run
        self._port = port
        self._all: list[subprocess.Popen] = []

    def __enter__(self) -> "Ros":
        self.start("core", "roscore", "-p", str(self._port))
        until(self._is_up, "the core's start")
        return self

    def __exit__(self, *_: object) -> None:
        for process in reversed(self._all):
            stop(process)

    def start(self, name: str, *command: str) -> subprocess.Popen:
        """A program; what it says goes into a file of its name."""
        with open(self.directory / f"{name}.txt", "w") as said:
            process = subprocess.Popen(command, stdout=said, stderr=subprocess.STDOUT)
        self._all.append(process)
        return process

    def node(self, place: str, kind: str, parameters: dict[str, object], *remaps: str) -> subprocess.Popen:
        """A node of the package in a namespace, with its own parameters."""
        given = [f"_{name}:={value}" for name, value in parameters.items()]
        return self.start(f"{place}-{kind}", node_path(kind), f"__ns:=/{place}", *given, *remaps)

    def record(self, file: str, topics: list[str]) -> subprocess.Popen:
        """The distribution's `rosbag record`."""
        process = self.start(f"{file}-record", "rosbag", "record", "-O", str(self.directory / file), *topics)
        until(lambda: all(self.subscribers(topic) for topic in topics), "the recorder")
        return process

    def end_recording(self, recorder: subprocess.Popen, file: str) -> Path:
        """Ends a recorder; the bag is whole when it has its name, which may be after the command has ended."""
        path = self.directory / file
        stop(recorder)
        until(path.exists, "the bag's end")
        return path

    def subscribers(self, topic: str) -> list[str]:
        """The nodes that subscribe to it."""
        _, _, (_, subscribers, _) = self._master().getSystemState("/test")
        return dict(subscribers).get(topic, [])

    def said(self, name: str) -> str:
        """What a program has said."""
        return (self.directory / f"{name}.txt").read_text()

    def _is_up(self) -> bool:
        try:
            return "/rosout" in self.subscribers_of_all()
        except OSError:
            return False

    def subscribers_of_all(self) -> list[str]:
        """The topics that have a subscriber."""
        _, _, (_, subscribers, _) = self._master().getSystemState("/test")
        return [topic for topic, _ in subscribers]

    def _master(self) -> ServerProxy:
        return ServerProxy(os.environ["ROS_MASTER_URI"])


def node_path(kind: str) -> str:
    """Where catkin has installed a node."""
    first = os.environ["CMAKE_PREFIX_PATH"].split(":")[0]
    return str(Path(first) / "lib" / "spikewire_ros" / kind)


def stop(process: subprocess.Popen) -> int:
    """Ends a program as Ctrl-C does; its exit status."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    try:
        return process.wait(60)
    except subprocess.TimeoutExpired:
        process.kill()
        raise


def until(is_so: Callable[[], bool], what: str, seconds: float = 120.0) -> None:
    """Waits."""
    end = time.monotonic() + seconds
    while not is_so():
        if time.monotonic() > end:
            raise TimeoutError(f"{what} took more than {seconds:.0f} s")
        time.sleep(0.05)
