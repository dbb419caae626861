"""Compares what `spikewire` reads of logs with what independent readers do: `rosbags`, and `mcap` with `mcap-ros2-support`.

Logs of every kind and packing are written by `rosbags`. `spikewire encode` writes the samples that it read as messages; those are read
again, and every value and time is compared. Run by `cargo verify logs`: logs_check.py SPIKEWIRE RECORDING.csv DIRECTORY
"""

import csv
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

FIELDS = (
    [f"orientation.{own}" for own in "xyzw"]
    + [f"orientation_covariance[{place}]" for place in range(9)]
    + [f"angular_velocity.{own}" for own in "xyz"]
    + [f"linear_acceleration.{own}" for own in "xyz"]
)
KIND = "sensor_msgs/msg/Imu"


def messages(types, recording, is_ros1):
    own = types.types
    vector, quaternion = own["geometry_msgs/msg/Vector3"], own["geometry_msgs/msg/Quaternion"]
    with open(recording, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for place, row in enumerate(rows):
        time = 1_700_000_000_000_000_000 + int(row["time_us"]) * 1000 + place % 7
        stamp = own["builtin_interfaces/msg/Time"](sec=time // 10**9, nanosec=time % 10**9)
        count = {"seq": place} if is_ros1 else {}
        # Texts of every length, so that what is behind them is aligned in every way.
        header = own["std_msgs/msg/Header"](stamp=stamp, frame_id="imu" * (place % 5), **count)
        covariance = np.arange(9.0) * place
        rate = vector(*(float(row[f"gyro_{axis}"]) for axis in "xyz"))
        force = vector(*(float(row[f"accel_{axis}"]) for axis in "xyz"))
        attitude = quaternion(x=0.5, y=-1.0, z=float(place), w=1.0 / (1 + place))
        yield time, own[KIND](header, attitude, covariance, rate, covariance, force, covariance)


def write(directory, recording):
    """Logs of every kind and packing."""
    logs = []
    types = get_typestore(Stores.ROS1_NOETIC)
    packings = {"none": None, "bz2": Writer1.CompressionFormat.BZ2, "lz4": Writer1.CompressionFormat.LZ4}
    for name, packing in packings.items():
        logs.append(directory / f"{name}.bag")
        writer = Writer1(logs[-1])
        if packing:
            writer.set_compression(packing)
        with writer:
            topic = writer.add_connection("/imu", KIND, typestore=types)
            for time, message in messages(types, recording, True):
                writer.write(topic, time, types.serialize_ros1(message, KIND))
    types = get_typestore(Stores.ROS2_HUMBLE)
    for storage in (StoragePlugin.SQLITE3, StoragePlugin.MCAP):
        modes = [None, CompressionMode.MESSAGE]
        modes.append(CompressionMode.FILE if storage is StoragePlugin.SQLITE3 else CompressionMode.STORAGE)
        for mode in modes:
            logs.append(directory / f"{storage.name}_{mode.name if mode else 'none'}".lower())
            writer = Writer2(logs[-1], version=9, storage_plugin=storage)
            if mode:
                writer.set_compression(mode, CompressionFormat.ZSTD)
            with writer:
                topic = writer.add_connection("/imu", KIND, typestore=types)
                for time, message in messages(types, recording, False):
                    writer.write(topic, time, types.serialize_cdr(message, KIND))
    return logs


def value(message, field):
    for part in field.split("."):
        name, _, place = part.partition("[")
        message = getattr(message, name)
        if place:
            message = message[int(place[:-1])]
    return message


def expected(log):
    """By rosbags: times in µs and values of all fields."""
    with AnyReader([log]) as reader:
        for _, time, raw in reader.messages():
            message = reader.deserialize(raw, KIND)
            yield (time + 500) // 1000, [np.float32(value(message, own)) for own in FIELDS]


def read(spikewire, log, output):
    """By spikewire, out of the messages that it wrote."""
    command = [spikewire, "encode", "--scheme", "sf", "--threshold", "1", "--topic", "imu"]
    subprocess.run(command + ["--fields", ",".join(FIELDS), log, "-o", output], check=True, capture_output=True)
    rows = {}
    if output.suffix == ".bag":
        with AnyReader([output]) as reader:
            found = [(own.topic, time, reader.deserialize(raw, own.msgtype)) for own, time, raw in reader.messages()]
    else:
        with open(output, "rb") as file:
            reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
            found = [(own.topic, message.log_time, data) for _, own, message, data in reader.iter_decoded_messages()]
    for topic, time, message in found:
        if topic != "event_header":
            place = int(topic.partition("_")[2] or 0)
            rows.setdefault(time // 1000, [None] * len(FIELDS))[place] = np.float32(message.input)
    return sorted(rows.items())


def main():
    spikewire, recording, directory = sys.argv[1], sys.argv[2], Path(sys.argv[3])
    shutil.rmtree(directory, ignore_errors=True)
    directory.mkdir(parents=True)
    for log in write(directory, recording):
        told = list(expected(log))
        for name in ("read.bag", "read.mcap"):
            own = read(spikewire, log, directory / name)
            assert len(own) == len(told) > 1000, (log, len(own), len(told))
            for ours, theirs in zip(own, told):
                assert ours == theirs, (log, ours, theirs)
        print(f"{log.name}: {len(told)} messages of {len(FIELDS)} fields, every value and time agrees")


if __name__ == "__main__":
    main()
