"""The nodes in ROS 1."""

import sys
import threading
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Callable, Optional

import rospkg
import rospy
import yaml
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from genpy import DeserializationError
from genpy.dynamic import MsgGenerationException, generate_dynamic
from spyke_msgs.msg import spyke, spyke_array, spyke_value
from std_msgs.msg import Float64, String

from . import settings as parameters
from .counters import Counters
from .decoding import Decoding, Received
from .encoding import Encoding, Event
from .fields import Field
from .settings import Settings
from .wave import HERTZ, wave

# Of publishers: nothing is dropped when a subscriber is slow.
NO_LIMIT = 0
# Seconds that publishers have for what is left when a node ends: they send in threads of their own.
TO_SEND = 0.5


class Node:
    """What the nodes share: parameters, counters that are told, and an end with a reason."""

    def __init__(self, name: str) -> None:
        rospy.init_node(name)
        self.counters = Counters(rospy.logwarn)
        self.lock = threading.RLock()  # the end may come while it is held
        # How many messages came and how many went.
        self.taken = self.given = 0
        self._failure: Optional[str] = None
        self._diagnostics = rospy.Publisher("/diagnostics", DiagnosticArray, queue_size=NO_LIMIT)

    def settings(self, **more: Any) -> Settings:
        """The parameters: the node's own and these, and the toolbox's."""
        own = {**more, **rospy.get_param("~", {})}
        names = ("encoding_scheme", "factor", "threshold", "window", "neurons")
        shared = {name: rospy.get_param(name) for name in names if rospy.has_param(name)}
        table = Path(rospkg.RosPack().get_path("spikewire_ros")) / "config" / "defaults.yaml"
        return parameters.read(own, shared, yaml.safe_load(table.read_text()))

    def fail(self, why: str) -> None:
        """Ends the node with exit status 2."""
        self._failure = self._failure or why
        rospy.signal_shutdown(why)

    def guarded(self, call: Callable) -> Callable:
        """Callbacks one after the other; bad input ends the node."""

        def one_after_the_other(*arguments: Any) -> None:
            with self.lock:
                if self._failure is None:
                    try:
                        call(*arguments)
                    except DeserializationError as error:
                        self.counters.add("messages refused", str(error))
                    except (ValueError, MsgGenerationException) as error:
                        self.fail(str(error))

        return one_after_the_other

    def run(self) -> int:
        """Until the end; the exit status."""
        while not rospy.is_shutdown():
            self._diagnose()
            try:
                rospy.sleep(1.0)
            except rospy.ROSInterruptException:
                break
        if self._failure is not None:
            rospy.logfatal(self._failure)
            return 2
        rospy.loginfo(str(self.counters))
        return 0

    def _diagnose(self) -> None:
        """The counts, once a second, where monitors look for them."""
        with self.lock:
            counts = dict(self.counters.counts)
            flow = [KeyValue("messages in", str(self.taken)), KeyValue("messages out", str(self.given))]
        level = DiagnosticStatus.WARN if counts else DiagnosticStatus.OK
        values = flow + [KeyValue(name, str(count)) for name, count in sorted(counts.items())]
        status = DiagnosticStatus(level, rospy.get_name(), str(self.counters), "", values)
        message = DiagnosticArray(status=[status])
        message.header.stamp = rospy.get_rostime()
        self._diagnostics.publish(message)


class AnyMessage:
    """Messages of any type, by the definition that their publisher sends; nothing of it needs to be installed."""

    def __init__(self) -> None:
        self._types: dict[str, Any] = {}

    def of(self, raw: rospy.AnyMsg) -> Any:
        """The message."""
        header = raw._connection_header
        kind = self._types.get(header["md5sum"])
        if kind is None:
            kind = generate_dynamic(header["type"], header["message_definition"])[header["type"]]
            self._types[header["md5sum"]] = kind
        return kind().deserialize(raw._buff)


class Sequence:
    """The numbers that publishers give their messages, where these have a header: what is missing was lost."""

    def __init__(self, counters: Counters) -> None:
        self._counters = counters
        self._last: dict[str, int] = {}

    def observe(self, publisher: str, number: int) -> None:
        """Takes the next number of a publisher."""
        last, self._last[publisher] = self._last.get(publisher), number
        if last is None:
            return
        if number > last + 1:
            self._counters.add("messages lost", f"between {last} and {number}", number - last - 1)
        elif number <= last:
            self._counters.add("publishers that count anew or back", f"{last}, then {number}")


class Encode(Node):
    """Subscribes to a topic and publishes the spikes of one of its fields."""

    def __init__(self) -> None:
        super().__init__("encode")
        settings = parameters.to_encode(self.settings())
        self._field = Field(settings.field)
        self._any = AnyMessage()
        self._numbers = Sequence(self.counters)
        self._encoding = Encoding(settings, self.counters)
        kind = spyke_array if self._encoding.is_array else spyke
        self._event = rospy.Publisher("event", kind, queue_size=NO_LIMIT)
        # For those who come later, too.
        self._header = rospy.Publisher("event_header", String, queue_size=NO_LIMIT, latch=True)
        self._is_header_sent = False
        self._decoded = rospy.Publisher("~decoded", spyke_value, queue_size=NO_LIMIT)
        rospy.on_shutdown(self.guarded(self._end))
        self._topic = rospy.Subscriber(settings.topic, rospy.AnyMsg, self.guarded(self._take))

    def _take(self, raw: rospy.AnyMsg) -> None:
        self.taken += 1
        message = self._any.of(raw)
        stamp = rospy.get_rostime()
        header = getattr(message, "header", None)
        if header is not None and hasattr(header, "stamp"):
            self._numbers.observe(raw._connection_header["callerid"], header.seq)
            stamp = header.stamp or stamp
        self._publish(self._encoding.take(self._field.of(message), stamp.to_nsec()))

    def _end(self) -> None:
        self._publish(self._encoding.end())
        time.sleep(TO_SEND)

    def _publish(self, events: Iterable[Event]) -> None:
        for event in events:
            if not self._is_header_sent:
                self._header.publish(self._encoding.header)
                self._is_header_sent = True
            self._event.publish(spyke_of(event))
            self._decoded.publish(spyke_value(event.decoded, _time(event.stamp)))
            self.given += 1


class Decode(Node):
    """Subscribes to spikes and publishes what they decode to."""

    def __init__(self) -> None:
        super().__init__("decode")
        self._any = AnyMessage()
        self._decoding = Decoding(self.settings(), self.counters)
        self._decoded = rospy.Publisher("~decoded", spyke_value, queue_size=NO_LIMIT)
        self._topic = rospy.Subscriber("event", rospy.AnyMsg, self.guarded(self._take))

    def _take(self, raw: rospy.AnyMsg) -> None:
        kind = raw._connection_header["type"]
        if kind not in (spyke._type, spyke_array._type):
            raise ValueError(f"the topic is of {kind}; spikes are {spyke._type} or {spyke_array._type}")
        self.taken += 1
        received = received_of(self._any.of(raw))
        value = self._decoding.take(received)
        if value is not None:
            self._decoded.publish(spyke_value(value, _time(received.stamp)))
            self.given += 1


class Signal(Node):
    """Publishes the toolbox's signal once there are as many subscribers as wanted, and ends with it."""

    def __init__(self) -> None:
        super().__init__("signal")
        dt, t_max = rospy.get_param("dt", 0.01), rospy.get_param("T_max", 5.0)
        self._samples = wave(dt, t_max, rospy.get_param("~seed", 0), rospy.get_param("~hertz", HERTZ))
        self._subscribers = rospy.get_param("~subscribers", 1)
        self._rate = rospy.Rate(1.0 / dt)
        self._publisher = rospy.Publisher("signal", Float64, queue_size=NO_LIMIT)

    def run(self) -> int:
        # The first samples would be lost on those that are still to subscribe, or to record the spikes.
        while self._publisher.get_num_connections() < self._subscribers and not rospy.is_shutdown():
            rospy.sleep(0.01)
        rospy.sleep(1.0)
        for sample in self._samples:
            if rospy.is_shutdown():
                break
            self._publisher.publish(Float64(sample))
            self._rate.sleep()
        return 0


def spyke_of(event: Event) -> Any:
    """The event as a message."""
    is_array = len(event.spikes) > 1
    message = spyke_array(spike=event.spikes) if is_array else spyke(spike=event.spikes[0])
    message.start, message.min_input, message.max_input = event.start, event.min_input, event.max_input
    message.threshold, message.input, message.scheme = event.threshold, event.input, event.scheme
    message.timestamp = _time(event.stamp)
    return message


def received_of(message: Any) -> Received:
    """What a message says."""
    spikes: list[int] = message.spike if hasattr(message.spike, "__len__") else [message.spike]
    return Received(
        spikes,
        message.start,
        message.min_input,
        message.max_input,
        message.threshold,
        message.input,
        message.scheme,
        message.timestamp.to_nsec(),
    )


def _time(nanoseconds: int) -> rospy.Time:
    return rospy.Time(nsecs=nanoseconds)


def main(node: Callable[[], Node]) -> None:
    """Runs a node. Exit status 2: a parameter or a message is not good."""
    try:
        sys.exit(node().run())
    except ValueError as error:
        rospy.logfatal(str(error))
        sys.exit(2)
    except rospy.ROSInterruptException:
        sys.exit(0)
