"""A bag in the toolbox's format, decoded by the node and by the laptop program, against the toolbox's reconstruction.

    toolbox.py SPIKEWIRE DIRECTORY

What the toolbox does is written down here from its `generate_spikes.py`, `EncodingSchemes.py`, `DecodingSchemes.py` and
`process_rosbags.py`, index by index.
"""

import csv
import subprocess
import sys
from pathlib import Path
from typing import Callable

import numpy as np
import rosbag
import rospy
from flight import Count
from ros import Ros, stop, until
from spikewire_ros.wave import wave
from spyke_msgs.msg import spyke, spyke_array

DT, T_MAX = 0.01, 5.0
SIGNAL = np.array(list(wave(DT, T_MAX, 0)))
BUFFER = int(1 / DT)
THRESHOLD, WINDOW, NEURONS = 0.35, 3, 20


def step_forward(data: np.ndarray) -> float:
    """The last spike of a buffer."""
    spikes = np.zeros(len(data))
    base = data[0]
    for i in range(1, len(data)):
        if data[i] > base + THRESHOLD:
            spikes[i] = 1
            base = base + THRESHOLD
        elif data[i] < base - THRESHOLD:
            spikes[i] = -1
            base = base - THRESHOLD
    return spikes[-1]


def moving_window(data: np.ndarray) -> float:
    """The last spike of a buffer."""
    i = len(data) - 1
    base = np.mean(data[(i - WINDOW - 1) : (i - 1)])
    return float(data[i] > base + THRESHOLD) - float(data[i] < base - THRESHOLD)


def gaussian_fields(x: float) -> np.ndarray:
    """Which of the neurons fires."""
    low, high, m = min(SIGNAL), max(SIGNAL), NEURONS
    sigma = (high - low) / (m - 2)
    responses = [np.exp(-((x - (low + (2 * i - 3) / 2 * sigma)) ** 2) / (2 * sigma**2)) for i in range(m)]
    spikes = np.zeros(m)
    spikes[np.argmax(responses)] = 1
    return spikes


def events(scheme: str) -> list[object]:
    """The messages of the toolbox's node."""
    messages = []
    buffer = SIGNAL[:BUFFER].copy()
    for t in range(len(SIGNAL)):
        if scheme == "gaussian_fields":
            message = spyke_array(spike=[int(one) for one in gaussian_fields(SIGNAL[t])])
        else:
            if t < BUFFER:
                continue
            buffer = np.roll(buffer, -1)
            buffer[-1] = SIGNAL[t]
            message = spyke(spike=int({"step_forward": step_forward, "moving_window": moving_window}[scheme](buffer)))
        message.start, message.threshold = SIGNAL[BUFFER - 1], THRESHOLD
        message.min_input, message.max_input = min(SIGNAL), max(SIGNAL)
        message.input, message.scheme = SIGNAL[t], scheme
        message.timestamp = rospy.Time(1000, 0) + rospy.Duration(t * DT)
        messages.append(message)
    return messages


def step_decode(messages: list[object]) -> list[float]:
    """`DecodingSchemes.step_forward`, which `moving_window` equals, as `process_rosbags.py` calls it."""
    threshold = np.mean([message.threshold for message in messages])
    signal = [messages[0].start]
    for message in messages[1:]:
        signal.append(signal[-1] + threshold * np.sign(message.spike))
    return signal


def field_decode(messages: list[object]) -> list[float]:
    """`DecodingSchemes.grf_spike`."""
    low, high, m = messages[0].min_input, messages[0].max_input, len(messages[0].spike)
    return [low + (2 * np.argmax(message.spike) - 3) / 2 * (high - low) / (m - 2) for message in messages]


# How the toolbox decodes, and what the node must be given besides.
SCHEMES: dict[str, tuple[Callable, dict[str, float]]] = {
    "step_forward": (step_decode, {}),
    "moving_window": (step_decode, {"window": WINDOW}),
    "gaussian_fields": (field_decode, {}),
}


def decoded(ros: Ros, scheme: str, parameters: dict[str, float]) -> tuple[list[object], list[float]]:
    """What the bag holds, and what the node makes of it."""
    bag = ros.directory / f"toolbox-{scheme}.bag"
    messages = events(scheme)
    with rosbag.Bag(str(bag), "w") as opened:
        for message in messages:
            opened.write("event", message, message.timestamp)
    node = ros.node(scheme, "decode", parameters, "event:=/event")
    values = Count(f"/{scheme}/decode/decoded")
    recorder = ros.record(f"{scheme}.bag", [f"/{scheme}/decode/decoded"])
    until(lambda: bool(ros.subscribers("/event")), "the decoder's start")
    player = ros.start(f"{scheme}-play", "rosbag", "play", "--wait-for-subscribers", "--rate", "4", str(bag))
    until(lambda: values.count == len(messages), f"the play of {bag}")
    stop(player)
    assert stop(node) == 0, ros.said(f"{scheme}-decode")
    recorded = ros.end_recording(recorder, f"{scheme}.bag")
    with rosbag.Bag(str(recorded)) as opened:
        read = [message for _, message, _ in opened.read_messages()]
    assert [message.timestamp for message in read] == [message.timestamp for message in messages]
    # As a reader of the bag has them: with numbers of 32 bits.
    with rosbag.Bag(str(bag)) as opened:
        return [message for _, message, _ in opened.read_messages()], [message.value for message in read]


def by_program(program: Path, bag: Path) -> list[float]:
    """What `spikewire decode` makes of it."""
    decoded = subprocess.run([program, "decode", bag], check=True, capture_output=True, text=True).stdout
    return [float(row["value"]) for row in csv.DictReader(decoded.splitlines())]


def main() -> None:
    program, directory = map(Path, sys.argv[1:])
    with Ros(directory) as ros:
        rospy.init_node("toolbox", disable_signals=True)
        for scheme, (decode, parameters) in SCHEMES.items():
            messages, values = decoded(ros, scheme, parameters)
            own = by_program(program, directory / f"toolbox-{scheme}.bag")
            for who, found in (("the node", values), ("spikewire decode", own)):
                off = np.max(np.abs(np.array(found) - np.array(decode(messages))))
                print(f"{scheme}: {len(found)} values of {who}, {off:.1e} from the toolbox's at most, in f32")
                assert off < 1e-4, scheme


if __name__ == "__main__":
    main()
