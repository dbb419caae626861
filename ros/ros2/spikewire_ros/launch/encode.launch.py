"""Encodes a topic: `ros2 launch spikewire_ros encode.launch.py scheme:=step_forward topic:=/imu field:=angular_velocity.x`."""

from pathlib import Path

import yaml
from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

PACKAGE = "spikewire_ros"
CONFIG = Path(__file__).parent.parent / "config"


def nodes(context: LaunchContext) -> list:
    given = {name: LaunchConfiguration(name).perform(context) for name in ("scheme", "config", "topic", "field")}
    config = Path(given["config"] or CONFIG / f"{given['scheme']}.yaml")
    parameters = yaml.safe_load(config.read_text())
    parameters.update(topic=given["topic"], field=given["field"])
    all_nodes = [Node(package=PACKAGE, executable="encode", parameters=[parameters], output="screen")]
    if given["topic"] == "signal":
        all_nodes.append(Node(package=PACKAGE, executable="signal"))
    return all_nodes


def generate_launch_description() -> LaunchDescription:
    arguments = (
        ("scheme", "step_forward", "a file of config, without .yaml"),
        ("config", "", "a file of parameters in its place"),
        ("topic", "signal", "what to encode; `signal` is the toolbox's own, which a node plays"),
        ("field", "data", "which number of its messages, such as angular_velocity.x"),
    )
    declared = [DeclareLaunchArgument(name, default_value=value, description=what) for name, value, what in arguments]
    return LaunchDescription([*declared, OpaqueFunction(function=nodes)])
