"""As much of a ROS 2 as the nodes use, in one process: what they publish is kept, what they hear is handed to them.

Message classes come from the definitions: ROS's own from the package `rosbags`, `spyke_msgs` from this repository.
They take keywords and check the kinds of values as those of `rclpy` do.
"""

import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any, Callable

import numpy as np
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

DEFINITIONS = Path(__file__).parent.parent / "ros2" / "spyke_msgs" / "msg"
STORE = get_typestore(Stores.ROS2_HUMBLE)
for _file in sorted(DEFINITIONS.glob("*.msg")):
    STORE.register(get_types_from_msg(_file.read_text(), f"spyke_msgs/msg/{_file.stem}"))

# Of `rosbags`: a number or a text, a message, an array, a list.
_BASE, _NAME, _ARRAY, _SEQUENCE = 1, 2, 3, 4
_MADE: dict[str, type] = {}


def message(name: str) -> type:
    """The class of a message, such as `sensor_msgs/msg/Imu`."""
    if name not in _MADE:
        _MADE[name] = _made(name)
    return _MADE[name]


def _made(name: str) -> type:
    fields = dict(STORE.fielddefs[name][1])

    def __init__(self: Any, **given: Any) -> None:
        unknown = set(given) - set(fields)
        assert not unknown, f"{name} has no {unknown}"
        for field, kind in fields.items():
            object.__setattr__(self, field, _value(kind, given[field]) if field in given else _default(kind))

    return type(
        name.rsplit("/", 1)[1],
        (STORE.types[name],),
        {"__init__": __init__, "__slots__": [f"_{field}" for field in fields]},
    )


def _default(kind: Any) -> Any:
    sort, of = kind
    if sort == _BASE:
        return {"string": "", "bool": False, "float32": 0.0, "float64": 0.0}.get(of[0], 0)
    if sort == _NAME:
        return message(of)()
    count = of[1] if sort == _ARRAY else 0
    inner = of[0]
    return np.zeros(count, dtype=inner[1][0]) if inner[0] == _BASE and inner[1][0] != "string" else []


def _value(kind: Any, value: Any) -> Any:
    sort, of = kind
    if sort == _BASE:
        wanted = {"string": str, "bool": bool, "float32": float, "float64": float, "octet": bytes, "byte": bytes}.get(
            of[0], int
        )
        assert type(value) is wanted, f"{value!r} is no {of[0]}"
    elif sort == _SEQUENCE and of[0][0] == _BASE:
        assert all(type(one) is int for one in value), value
        return np.array(value, dtype=of[0][1][0])
    return value


class Publisher:
    def __init__(self, kind: type) -> None:
        self.kind, self.published = kind, []  # type: type, List[Any]

    def publish(self, one: Any) -> None:
        assert isinstance(one, self.kind)
        self.published.append(one)


class Node:
    """A node with these parameters, in a graph with these topics."""

    parameters: dict[str, Any] = {}
    # A topic's type, and whether it is reliable.
    topics: dict[str, Any] = {}

    def __init__(self, name: str, **_: Any) -> None:
        self.name, self.publishers, self.subscriptions, self.timers = name, {}, {}, []
        self.told: list[str] = []

    def get_parameters_by_prefix(self, _: str) -> dict[str, Any]:
        return {name: SimpleNamespace(value=value) for name, value in self.parameters.items()}

    def get_logger(self) -> Any:
        return SimpleNamespace(warning=self.told.append, info=self.told.append)

    def get_name(self) -> str:
        return self.name

    def get_clock(self) -> Any:
        now = SimpleNamespace(nanoseconds=5, to_msg=lambda: message("builtin_interfaces/msg/Time")(sec=0, nanosec=5))
        return SimpleNamespace(now=lambda: now)

    def create_timer(self, _: float, call: Callable) -> Any:
        timer = SimpleNamespace(call=call, cancel=lambda: self.timers.remove(timer))
        self.timers.append(timer)
        return timer

    def create_publisher(self, kind: type, topic: str, _: Any) -> Publisher:
        self.publishers[topic] = Publisher(kind)
        return self.publishers[topic]

    def create_subscription(self, kind: type, topic: str, call: Callable, profile: Any, event_callbacks: Any) -> None:
        self.subscriptions[topic] = SimpleNamespace(kind=kind, call=call, profile=profile, events=event_callbacks)

    def resolve_topic_name(self, topic: str) -> str:
        return topic if topic.startswith("/") else f"/{topic}"

    def get_publishers_info_by_topic(self, topic: str) -> list[Any]:
        if topic not in self.topics:
            return []
        kind, reliability = self.topics[topic]
        return [SimpleNamespace(topic_type=kind, qos_profile=SimpleNamespace(reliability=reliability))]

    def tick(self) -> None:
        """All timers once."""
        for timer in list(self.timers):
            timer.call()


def install() -> None:
    """Puts it where the nodes import from."""
    reliability = SimpleNamespace(RELIABLE="reliable", BEST_EFFORT="best effort")
    modules: dict[str, dict[str, Any]] = {
        "rclpy": {},
        "rclpy.executors": {"ExternalShutdownException": type("ExternalShutdownException", (Exception,), {})},
        "rclpy.node": {"Node": Node},
        "rclpy.qos": {
            "DurabilityPolicy": SimpleNamespace(TRANSIENT_LOCAL="latched"),
            "HistoryPolicy": SimpleNamespace(KEEP_ALL="all"),
            "QoSProfile": SimpleNamespace,
            "ReliabilityPolicy": reliability,
        },
        "rclpy.signals": {"SignalHandlerOptions": SimpleNamespace(NO=0)},
        "rclpy.event_handler": {"SubscriptionEventCallbacks": SimpleNamespace},
        "rosidl_runtime_py": {},
        "rosidl_runtime_py.utilities": {"get_message": message},
    }
    for package, names in {
        "builtin_interfaces": ["Time"],
        "diagnostic_msgs": ["DiagnosticArray", "DiagnosticStatus", "KeyValue"],
        "spyke_msgs": ["Spyke", "SpykeArray", "SpykeValue"],
        "std_msgs": ["Float64", "String"],
    }.items():
        modules[package] = {}
        modules[f"{package}.msg"] = {name: message(f"{package}/msg/{name}") for name in names}
    status = modules["diagnostic_msgs.msg"]["DiagnosticStatus"]
    status.OK, status.WARN = b"\0", b"\1"
    for name, members in modules.items():
        module = ModuleType(name)
        module.__dict__.update(members)
        sys.modules[name] = module
