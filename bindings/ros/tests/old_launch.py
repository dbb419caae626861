"""An old launch file of the toolbox, as a user has it, starts our node, which leaves the toolbox's bag; so do its seven.

    old_launch.py DIRECTORY
"""

import sys
from pathlib import Path

import numpy as np
import rosbag
import toolbox
from ros import Ros, node_path, until
from roslaunch.config import load_config_default

# What the toolbox's files set for all nodes.
PARAMETERS = {"dt": 0.01, "T_max": 1.5, "factor": 0.0, "threshold": 0.0, "window": 0, "neurons": 0}
OLD = {
    "bsa": {},
    "gaussian_fields": {"neurons": 20},
    "hsa": {},
    "moving_window": {"threshold": 0.325, "window": 3},
    "step_forward": {"threshold": 0.35},
    "temporal_contrast": {"factor": 1.005},
    "threshold_hsa": {},
}
FILES = {"hsa": "hough", "threshold_hsa": "threshold_hough"}
# How the toolbox's script for bags decodes, where it can.
DECODERS = {
    "gaussian_fields": toolbox.field_decode,
    "moving_window": toolbox.step_decode,
    "step_forward": toolbox.step_decode,
}


def launch_file(scheme: str) -> str:
    """As the toolbox writes them."""
    lines = ['<node name="spikes_publisher" pkg="spyke_coding" type="generate_spikes.py"></node>']
    given = {**PARAMETERS, **OLD[scheme], "encoding_scheme": scheme}
    lines += [f'<param name="{name}" value="{value}" />' for name, value in given.items()]
    return "<launch>\n" + "\n".join(lines) + "\n</launch>\n"


def own_files() -> None:
    """Those of the alias set what the toolbox's set."""
    share = Path(node_path("encode")).parents[2] / "share/spyke_coding/launch"
    for scheme, own in OLD.items():
        file = share / f"encode_{FILES.get(scheme, scheme)}.launch"
        config = load_config_default([(str(file), [])], None)
        (node,) = config.nodes
        assert (node.name, node.package, node.type) == ("spikes_publisher", "spyke_coding", "generate_spikes.py")
        found = {name[1:]: one.value for name, one in config.params.items() if name[1:] in (*PARAMETERS, "encoding_scheme")}
        assert found == {**PARAMETERS, "T_max": 5, **own, "encoding_scheme": scheme}, (file, found)
    print(f"{len(OLD)} launch files by the toolbox's names")


def run(ros: Ros, scheme: str) -> None:
    """Launches, and decodes the bag as the toolbox does."""
    file, bag = ros.directory / f"{scheme}.launch", ros.directory / "encoding.bag"
    bag.unlink(missing_ok=True)
    file.write_text(launch_file(scheme))
    launched = ros.start(f"old-{scheme}", "roslaunch", str(file))
    until(lambda: launched.poll() is not None, f"the end of {file}")
    assert launched.returncode == 0, ros.said(f"old-{scheme}")
    with rosbag.Bag(str(bag)) as opened:
        read = list(opened.read_messages())
    messages = [message for _, message, _ in read]
    assert {topic for topic, _, _ in read} == {"event"} and len(messages) == 150, (scheme, len(messages))
    assert {message.scheme for message in messages} == {scheme}
    assert any(np.any(message.spike) for message in messages), scheme
    said = "no decoder of the toolbox's"
    if scheme in DECODERS:
        inputs = np.array([message.input for message in messages])
        off = np.sqrt(np.mean((np.array(DECODERS[scheme](messages)) - inputs) ** 2))
        # Steps of 0.35 and neurons 0.3 apart follow it; a moving window drifts.
        assert off < (0.5 if scheme != "moving_window" else 5.0), (scheme, off)
        said = f"decoded by the toolbox's rule: RMSE {off:.3f}"
    print(f"{scheme}: an old launch file gives {len(messages)} messages; {said}")


def main() -> None:
    with Ros(Path(sys.argv[1])) as ros:
        own_files()
        for scheme in OLD:
            run(ros, scheme)


if __name__ == "__main__":
    main()
