"""The nodes of ROS 2 among those of a ROS 2: Python's rclpy on Fast DDS, and the messages that colcon has built.

    ros2_rclpy.py PREFIX TABLE DEMO DIRECTORY SPIKEWIRE

As `ros2.py`.
"""

import itertools
import math
import threading
from types import SimpleNamespace
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import Log
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, qos_profile_sensor_data
from ros2_nodes import EPOCH, SF, Installed, main, play, until
from sensor_msgs.msg import Imu
from spikewire_msgs.msg import Spikes, Values
from spyke_msgs.msg import Spyke, SpykeArray, SpykeValue

ALL = QoSProfile(history=HistoryPolicy.KEEP_ALL)


class Writer:
    def __init__(self, publisher: Any) -> None:
        self.publisher = publisher
        self.write = publisher.publish


class Reader:
    """Keeps all that a topic had."""

    def __init__(self) -> None:
        self.messages: list[Any] = []
        self.matched = 0

    def is_matched(self) -> bool:
        return self.matched > 0


class Peer:
    """A node of rclpy, served by a thread."""

    reliable = ALL
    types = SimpleNamespace(
        Imu=Imu, Spyke=Spyke, SpykeArray=SpykeArray, SpykeValue=SpykeValue, Spikes=Spikes, Values=Values
    )

    numbers = itertools.count()

    def __init__(self) -> None:
        self.node = rclpy.create_node(f"peer_{next(self.numbers)}")
        executor = SingleThreadedExecutor()
        executor.add_node(self.node)
        threading.Thread(target=executor.spin, daemon=True).start()

    @staticmethod
    def imu(stamp: int, rate: float) -> Imu:
        sample = Imu()
        sample.header.stamp.sec, sample.header.stamp.nanosec = divmod(stamp, 10**9)
        sample.angular_velocity.z = rate
        return sample

    @staticmethod
    def has_readers(writer: Writer) -> bool:
        return writer.publisher.get_subscription_count() > 0

    def writer(self, topic: str, kind: type, qos: QoSProfile = qos_profile_sensor_data) -> Writer:
        return Writer(self.node.create_publisher(kind, topic, qos))

    def reader(self, topic: str, kind: type, qos: QoSProfile = ALL) -> Reader:
        reader = Reader()

        def matched(status: Any) -> None:
            reader.matched = status.current_count

        callbacks = SubscriptionEventCallbacks(matched=matched)
        self.node.create_subscription(kind, topic, reader.messages.append, qos, event_callbacks=callbacks)
        return reader


class Tests(Installed):
    def peer(self) -> Peer:
        return Peer()

    def graph(self) -> None:
        """What `ros2 node`, `topic`, `param` and monitors show of a node is there."""
        peer = self.peer()
        writer, log = peer.writer("/imu", Imu), peer.reader("/rosout", Log)
        diagnostics = peer.reader("/diagnostics", DiagnosticArray)
        with self.node("encode", SF) as node:
            until(lambda: peer.has_readers(writer) and diagnostics.is_matched(), "discovery")
            until(lambda: ("encode", "/") in peer.node.get_node_names_and_namespaces(), "the node's name")
            topics = dict(peer.node.get_publisher_names_and_types_by_node("encode", "/"))
            assert topics["/event"] == ["spyke_msgs/msg/Spyke"], topics
            assert topics["/encode/decoded"] == ["spyke_msgs/msg/SpykeValue"], topics

            client = AsyncParameterClient(peer.node, "/encode")
            assert client.wait_for_services(30.0), "the services of parameters"
            shown = self.answer(client.get_parameters(list(SF))).values
            assert [value.string_value or value.double_value for value in shown] == list(SF.values()), shown
            threshold = Parameter("threshold", value=0.5)
            result = self.answer(client.set_parameters([threshold])).results[0]
            assert not result.successful and "when the node starts" in result.reason, result

            play(writer, [peer.imu(EPOCH, math.nan)])
            until(lambda: any("samples not finite: 1" in one.msg for one in log.messages), "the warning")
            until(lambda: "1 samples not finite" in [one.status[0].message for one in diagnostics.messages], "the count")
            node.stop()
        print(f"rclpy sees the node, its topics {sorted(topics)}, its parameters and its warnings")

    def quality(self) -> None:
        """A subscriber that asks for more hears nothing: ROS 2 tells it so, and the node tells its warnings."""
        peer, told = self.peer(), []
        log = peer.reader("/rosout", Log)
        with self.node("encode", SF) as node:
            until(log.is_matched, "discovery")
            callbacks = SubscriptionEventCallbacks(incompatible_qos=told.append)
            latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
            peer.node.create_subscription(Spyke, "/event", print, latched, event_callbacks=callbacks)
            until(lambda: told, "ROS 2's event")
            why = "subscribers refused: 1 (/event: the durability that is wanted is not offered)"
            until(lambda: any(one.msg == why for one in log.messages), "the node's warning")
            node.stop()
        print(f"both say why a subscriber hears nothing: {told[0].last_policy_kind!r}, {why}")

    @staticmethod
    def answer(future: Any) -> Any:
        until(future.done, "the answer")
        return future.result()


if __name__ == "__main__":
    rclpy.init()
    main(Tests, "ros2_run", "graph", "quality", "flight", "imu")
