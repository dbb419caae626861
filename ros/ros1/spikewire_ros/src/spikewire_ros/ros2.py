"""The nodes in ROS 2."""

import sys
from collections.abc import Iterable
from typing import Any, Callable, Optional

import rclpy
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node as RclpyNode
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions
from rosidl_runtime_py.utilities import get_message
from spyke_msgs.msg import Spyke, SpykeArray, SpykeValue
from std_msgs.msg import Float64, String

try:
    from rclpy.event_handler import SubscriptionEventCallbacks
except ImportError:  # before Iron
    from rclpy.qos_event import SubscriptionEventCallbacks

from . import settings as parameters
from .counters import Counters
from .decoding import Decoding, Received
from .encoding import Encoding, Event
from .fields import Field
from .settings import Settings
from .wave import HERTZ, wave

# What ROS itself sets.
_OF_ROS = ("use_sim_time", "start_type_description_service")


def _all_kept(reliability: ReliabilityPolicy) -> QoSProfile:
    """Nothing is dropped when a subscriber is slow."""
    return QoSProfile(history=HistoryPolicy.KEEP_ALL, reliability=reliability)


_RELIABLE = _all_kept(ReliabilityPolicy.RELIABLE)
_LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Node(RclpyNode):
    """What the nodes share: parameters, counters that are told, and an end with a reason."""

    def __init__(self, name: str) -> None:
        super().__init__(name, allow_undeclared_parameters=True, automatically_declare_parameters_from_overrides=True)
        self.counters = Counters(self.get_logger().warning)
        # How many messages came and how many went.
        self.taken = self.given = 0
        self.failure: Optional[str] = None
        self._diagnostics = self.create_publisher(DiagnosticArray, "/diagnostics", _RELIABLE)
        self._every_second = self.create_timer(1.0, self._diagnose)

    def all_given(self) -> dict[str, Any]:
        """The parameters that were set."""
        all_of_them = self.get_parameters_by_prefix("")
        return {name: own.value for name, own in all_of_them.items() if name not in _OF_ROS and "." not in name}

    def settings(self) -> Settings:
        """The parameters, read."""
        return parameters.read(self.all_given(), {})

    def guarded(self, call: Callable) -> Callable:
        """Bad input ends the node with exit status 2."""

        def or_end(*arguments: Any) -> None:
            if self.failure is None:
                try:
                    call(*arguments)
                except ValueError as error:
                    self.failure = str(error)

        return or_end

    def end(self) -> None:
        """What is left to do when the node ends."""

    def subscribe(self, topic: str, take: Callable[[Any], None]) -> None:
        """Subscribes as soon as there is a publisher, which says of what type the topic is."""
        waiting = self.create_timer(0.05, lambda: look())

        def look() -> None:
            publishers = self.get_publishers_info_by_topic(self.resolve_topic_name(topic))
            if not publishers:
                return
            waiting.cancel()
            reliable = all(one.qos_profile.reliability == ReliabilityPolicy.RELIABLE for one in publishers)
            profile = _all_kept(ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT)
            lost = SubscriptionEventCallbacks(message_lost=self._lost)
            kind = get_message(publishers[0].topic_type)
            self.create_subscription(kind, topic, self.guarded(take), profile, event_callbacks=lost)

    def _lost(self, info: Any) -> None:
        self.counters.add("messages lost", "", info.total_count_change)

    def _diagnose(self) -> None:
        """The counts, once a second, where monitors look for them."""
        counts = self.counters.counts
        told = [("messages in", self.taken), ("messages out", self.given), *sorted(counts.items())]
        values = [KeyValue(key=name, value=str(count)) for name, count in told]
        level = DiagnosticStatus.WARN if counts else DiagnosticStatus.OK
        status = DiagnosticStatus(level=level, name=self.get_name(), message=str(self.counters), values=values)
        message = DiagnosticArray(status=[status])
        message.header.stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(message)


class Encode(Node):
    """Subscribes to a topic and publishes the spikes of one of its fields."""

    def __init__(self) -> None:
        super().__init__("encode")
        settings = parameters.to_encode(self.settings())
        self._field = Field(settings.field)
        self._encoding = Encoding(settings, self.counters)
        self._event = self.create_publisher(SpykeArray if self._encoding.is_array else Spyke, "event", _RELIABLE)
        # For those who come later, too.
        self._header = self.create_publisher(String, "event_header", _LATCHED)
        self._is_header_sent = False
        self._decoded = self.create_publisher(SpykeValue, "~/decoded", _RELIABLE)
        self.subscribe(settings.topic, self._take)

    def _take(self, message: Any) -> None:
        self.taken += 1
        header = getattr(message, "header", None)
        stamp = _nanoseconds(header.stamp) if header is not None and hasattr(header, "stamp") else 0
        now = self.get_clock().now().nanoseconds
        self._publish(self._encoding.take(self._field.of(message), stamp or now))

    def end(self) -> None:
        self._publish(self._encoding.end())

    def _publish(self, events: Iterable[Event]) -> None:
        for event in events:
            if not self._is_header_sent:
                self._header.publish(String(data=self._encoding.header))
                self._is_header_sent = True
            self._event.publish(spyke_of(event))
            self._decoded.publish(SpykeValue(value=event.decoded, timestamp=_time(event.stamp)))
            self.given += 1


class Decode(Node):
    """Subscribes to spikes and publishes what they decode to."""

    def __init__(self) -> None:
        super().__init__("decode")
        self._decoding = Decoding(self.settings(), self.counters)
        self._decoded = self.create_publisher(SpykeValue, "~/decoded", _RELIABLE)
        self.subscribe("event", self._take)

    def _take(self, message: Any) -> None:
        if not isinstance(message, (Spyke, SpykeArray)):
            raise ValueError(f"the topic is of {type(message).__name__}; spikes are Spyke or SpykeArray")
        self.taken += 1
        received = received_of(message)
        value = self._decoding.take(received)
        if value is not None:
            self._decoded.publish(SpykeValue(value=value, timestamp=_time(received.stamp)))
            self.given += 1


class Signal(Node):
    """Publishes the toolbox's signal, and ends with it."""

    def __init__(self) -> None:
        super().__init__("signal")
        given = self.all_given()
        dt, t_max = given.get("dt", 0.01), given.get("T_max", 5.0)
        self._samples = wave(dt, t_max, given.get("seed", 0), given.get("hertz", HERTZ))
        self._publisher = self.create_publisher(Float64, "signal", _RELIABLE)
        self._every_sample = self.create_timer(dt, self._play)

    def _play(self) -> None:
        # The first sample would be lost on those that are still to subscribe.
        if self._publisher.get_subscription_count() == 0:
            return
        sample = next(self._samples, None)
        if sample is None:
            raise SystemExit(0)
        self._publisher.publish(Float64(data=sample))


def spyke_of(event: Event) -> Any:
    """The event as a message."""
    said = {
        "start": event.start,
        "min_input": event.min_input,
        "max_input": event.max_input,
        "threshold": event.threshold,
        "input": event.input,
        "scheme": event.scheme,
        "timestamp": _time(event.stamp),
    }
    if len(event.spikes) > 1:
        return SpykeArray(spike=event.spikes, **said)
    return Spyke(spike=event.spikes[0], **said)


def received_of(message: Any) -> Received:
    """What a message says."""
    return Received(
        spikes=list(message.spike) if hasattr(message.spike, "__len__") else [message.spike],
        start=message.start,
        min_input=message.min_input,
        max_input=message.max_input,
        threshold=message.threshold,
        input=message.input,
        scheme=message.scheme,
        stamp=_nanoseconds(message.timestamp),
    )


def _time(nanoseconds: int) -> Time:
    seconds, rest = divmod(nanoseconds, 10**9)
    return Time(sec=seconds, nanosec=rest)


def _nanoseconds(stamp: Any) -> int:
    return stamp.sec * 10**9 + stamp.nanosec


def main(make: Callable[[], Node]) -> None:
    """Runs a node. Exit status 2: a parameter or a message is not good."""
    # So that what is left can be published after Ctrl-C.
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node: Optional[Node] = None
    try:
        node = make()
        while rclpy.ok() and node.failure is None:
            rclpy.spin_once(node, timeout_sec=0.2)
        why = node.failure
    except ValueError as error:
        why = str(error)
    except (KeyboardInterrupt, ExternalShutdownException):
        why = None
    if why is not None:
        rclpy.logging.get_logger("spikewire_ros").fatal(why)
        sys.exit(2)
    if node is not None:
        node.end()
        node.get_logger().info(str(node.counters))
