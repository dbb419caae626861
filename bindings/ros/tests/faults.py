"""Launch files, and what is not as it should be: bad parameters and fields end a node, bad samples are counted.

    faults.py DIRECTORY
"""

import math
import sys
import time
from pathlib import Path

import rospy
import spikewire
import yaml
from diagnostic_msgs.msg import DiagnosticArray
from ros import Ros, node_path, stop, until
from roslaunch.config import load_config_default
from sensor_msgs.msg import Imu
from spikewire_ros import settings
from spikewire_ros.counters import Counters
from spikewire_ros.encoding import Encoding
from std_msgs.msg import String

# Parameters besides good ones, and what the node must say.
BAD = (
    ({"encoding_scheme": "step"}, "encoding_scheme step: there are tbr, atbr, mw,"),
    ({"threshold": 0.0}, "threshold 0 must be above 0"),
    ({"treshold": 0.1}, "treshold: no parameter of StepForward; it takes threshold, start"),
    ({"encoding_scheme": "gaussian_fields"}, "threshold: no parameter of Gaussian; it takes neurons, min, max"),
    ({"field": "angular_velocity.w"}, "has no `w`; numbers of sensor_msgs/Imu: header.seq, "),
    ({"field": "orientation"}, "is no number"),
    ({"field": "angular_velocity["}, "cannot be read from `[` on"),
    ({"topic": "/words"}, "is no number, but str; numbers of std_msgs/String: none"),
)
GOOD = {"topic": "/imu", "field": "angular_velocity.x", "encoding_scheme": "step_forward", "threshold": 0.1}


def launch_files() -> None:
    """With any scheme it starts the toolbox's signal and a node with parameters that are good, and records if asked to."""
    share = Path(node_path("encode")).parents[2] / "share/spikewire_ros"
    table = yaml.safe_load((share / "config/defaults.yaml").read_text())
    for scheme in spikewire.schemes:
        arguments = [f"scheme:={scheme}", "parameters:={gap: 2.5}", "bag:=spikes.bag"]
        config = load_config_default([(str(share / "launch/encode.launch"), arguments)], None)
        assert sorted(node.type for node in config.nodes) == ["encode", "record", "signal"], scheme
        own = {name.rsplit("/", 1)[1]: one.value for name, one in config.params.items() if name.startswith("/encode/")}
        read = settings.to_encode(settings.read(own, {}, table))
        assert read.gap == 2.5
        Encoding(read, Counters(print))
    print(f"encode.launch with {len(spikewire.schemes)} schemes")


def bad_parameters(ros: Ros, imu: rospy.Publisher, words: rospy.Publisher) -> None:
    """Each ends its node with exit status 2, and is told."""
    nodes = []
    for number, (changed, _) in enumerate(BAD):
        given = {**GOOD, **changed}
        if given["topic"] == "/words":
            given["field"] = "data"
        nodes.append(ros.node(f"bad{number}", "encode", given))

    def all_ended() -> bool:
        imu.publish(Imu())
        words.publish(String("seven"))
        time.sleep(0.2)
        return all(node.poll() is not None for node in nodes)

    until(all_ended, "the end of nodes with bad parameters")
    for number, (node, (changed, text)) in enumerate(zip(nodes, BAD)):
        said = ros.said(f"bad{number}-encode")
        assert node.returncode == 2, f"{changed}: exit status {node.returncode}: {said}"
        assert text in said, f"{changed}: {said}"
        assert "Traceback" not in said, f"{changed}: {said}"
        print(f"{changed}: exit status 2, {said.strip().splitlines()[-1].split(': ', 1)[1][:100]}")


def bad_samples(ros: Ros, imu: rospy.Publisher) -> None:
    """They are counted, and told to monitors."""
    counts: dict[str, int] = {}

    def take(message: DiagnosticArray) -> None:
        for status in message.status:
            if status.name == "/count/encode":
                counts.update({pair.key: int(pair.value) for pair in status.values})

    rospy.Subscriber("/diagnostics", DiagnosticArray, take)
    node = ros.node("count", "encode", GOOD)
    until(lambda: imu.get_num_connections() == 1, "the encoder's start")
    started = imu.impl.seq  # the publisher numbers its messages itself
    for step in range(100):
        message = Imu()
        message.header.stamp = rospy.Time(1000 + step)
        message.angular_velocity.x = step
        if step == 20:
            message.angular_velocity.x = math.nan
        if step == 30:
            imu.impl.seq += 7
        if step == 40:
            message.header.stamp = rospy.Time(900)
        if step == 50:
            message.header.stamp = rospy.Time(1049)
        imu.publish(message)
    wanted = {
        "messages in": 100,
        "messages out": 99,
        "messages lost": 7,
        "samples not finite": 1,
        "steps back in time": 1,
        "repeated stamps": 1,
        "gaps": 2,  # back from the step back, and beyond the repeated one
    }
    until(lambda: counts.get("messages in") == 100, "the count")
    assert counts == wanted, counts
    assert imu.impl.seq == started + 107
    assert stop(node) == 0
    print(f"counted: {counts}")


def main() -> None:
    with Ros(Path(sys.argv[1])) as ros:
        rospy.init_node("faults", disable_signals=True)
        imu = rospy.Publisher("/imu", Imu, queue_size=0)
        launch_files()
        bad_parameters(ros, imu, rospy.Publisher("/words", String, queue_size=0))
        bad_samples(ros, imu)


if __name__ == "__main__":
    main()
