"""The paper's figure: a bag that `roslaunch` records, as a table of input, spike and decoded value.

    figure.py DIRECTORY

SF with a threshold of 0.35 on 4 s of three sines of 1, 2 and 5 Hz with noise, 100 samples a second, at that rate.
"""

import sys
from pathlib import Path

import rosbag
from ros import Ros, stop, until


def main() -> None:
    directory = Path(sys.argv[1])
    bag = directory / "encoding.bag"
    with Ros(directory) as ros:
        arguments = ("T_max:=4", "hertz:=[1.0, 2.0, 5.0]", f"bag:={bag}")
        launched = ros.start("launch", "roslaunch", "spikewire_ros", "encode.launch", "scheme:=step_forward", *arguments)
        until(lambda: "[signal-" in ros.said("launch") and "finished cleanly" in ros.said("launch"), "the signal")
        stop(launched)
        until(bag.exists, "the bag's end")
    with rosbag.Bag(str(bag)) as opened:
        events = [message for _, message, _ in opened.read_messages(topics=["event", "/event"])]
        values = [message.value for _, message, _ in opened.read_messages(topics=["encode/decoded", "/encode/decoded"])]
    assert len(events) == len(values) == 400, (len(events), len(values))
    with open(directory / "figure.csv", "w") as table:
        table.write("input,spike,decoded\n")
        table.writelines(f"{event.input},{event.spike},{value}\n" for event, value in zip(events, values))
    print(f"{bag}: {len(events)} samples, {sum(abs(event.spike) for event in events)} spikes")


if __name__ == "__main__":
    main()
