"""Compares what `spikewire` reads of logs with what independent readers do: `rosbags`, `mcap` with `mcap-ros1-support` and
`mcap-ros2-support`, `pyulog` and `orangebox`.

Bags and MCAP files of every kind and packing are written by `rosbags` and `mcap`, blackbox logs by `blackbox_log.py`; the `ULog` is
a flight that a crate's package holds. `spikewire encode` writes the samples that it read as messages; those are read again, and
every value and time is compared. Run by `cargo verify logs`: logs_check.py SPIKEWIRE RECORDING.csv DIRECTORY
"""

import csv
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import blackbox_log
import numpy as np
from mcap.reader import make_reader
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from mcap_ros1.decoder import DecoderFactory as Ros1
from mcap_ros2.decoder import DecoderFactory as Ros2
from orangebox import Parser
from pyulog import ULog
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
    definition, _ = types.generate_msgdef(KIND, ros_version=1)
    for packing in (CompressionType.NONE, CompressionType.LZ4, CompressionType.ZSTD):
        logs.append(directory / f"ros1_{packing.name.lower()}.mcap")
        with open(logs[-1], "wb") as file:
            writer = McapWriter(file, compression=packing)
            writer.start(profile="ros1")
            schema = writer.register_schema("sensor_msgs/Imu", "ros1msg", definition.encode())
            topic = writer.register_channel("/imu", "ros1", schema)
            for time, message in messages(types, recording, True):
                writer.add_message(topic, time, bytes(types.serialize_ros1(message, KIND)), time)
            writer.finish()
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


def nearest(number):
    """As messages of the toolbox hold it."""
    return np.float32(np.float64(number))


def expected(log):
    """By rosbags or mcap: times in µs and values of all fields."""
    for time, message, _ in decoded(log, Ros1()):
        yield (time + 500) // 1000, [nearest(value(message, own)) for own in FIELDS]


def decoded(log, mcap):
    """Times in ns, messages and topics, those of an MCAP file by this decoder."""
    if log.suffix == ".mcap":
        with open(log, "rb") as file:
            for _, topic, message, data in make_reader(file, True, [mcap]).iter_decoded_messages():
                yield message.log_time, data, topic.topic
    else:
        with AnyReader([log]) as reader:
            for own, time, raw in reader.messages():
                yield time, reader.deserialize(raw, own.msgtype), own.topic


def read(spikewire, log, topic, fields, output):
    """By spikewire, out of the messages that it wrote: times in µs and values of all fields."""
    command = [spikewire, "encode", "--scheme", "sf", "--threshold", "1", "--time", "recorded", "--topic", topic]
    subprocess.run(command + ["--fields", ",".join(fields), log, "-o", output], check=True, capture_output=True)
    columns = [[] for _ in fields]
    for time, message, topic in decoded(output, Ros2()):
        if topic != "event_header":
            columns[int(topic.partition("_")[2] or 0)].append((time // 1000, np.float32(message.input)))
    for row in zip(*columns, strict=True):
        times, values = zip(*row)
        assert len(set(times)) == 1, (log, row)
        yield times[0], list(values)


def compare(spikewire, log, topic, fields, told, output):
    told, own = list(told), list(read(spikewire, log, topic, fields, output))
    assert len(own) == len(told) > 1, (log, topic, len(own), len(told))
    for ours, theirs in zip(own, told):
        assert ours == theirs, (log, topic, ours, theirs)
    return f"{len(told)} messages of {len(fields)} fields"


def flight_log():
    """The log of the recording, in the package of a crate that the tests need."""
    command = ["cargo", "metadata", "--format-version", "1", "--features", "host-tests/extract"]
    packages = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)["packages"]
    package = next(own for own in packages if own["name"] == "ulog-rs")
    return Path(package["manifest_path"]).parent / "test_data/sample-small.ulg"


def ulog(spikewire, directory):
    """Every topic's count and span, and all numbers that are finite of those that came often."""
    log = flight_log()
    info = subprocess.run([spikewire, "info", log], check=True, stdout=subprocess.PIPE, text=True).stdout
    own = {name: (int(count), time) for name, count, time in re.findall(r"^(\S+): (\d+) samples(?:, ([0-9.]+) s)?", info, re.M)}
    stamped = re.findall(r"^(\S+): [^\n]*(?:\n  [^\n]*)*?\n  times are the sensor's own", info, re.M)
    topics, numbers = ULog(str(log)).data_list, 0
    assert len(own) == len(topics) > 100
    for topic in topics:
        name = f"{topic.name}:{topic.multi_id}" if topic.multi_id else topic.name
        times = topic.data.pop("timestamp").astype(int)
        own_times = topic.data["timestamp_sample"].astype(int) if name in stamped else times
        span = f"{(own_times[-1] - own_times[0]) / 1e6:.3f}" if len(times) > 1 else ""
        assert own[name] == (len(times), span), (name, own[name], len(times), span)
        fields = [field for field, column in topic.data.items() if np.isfinite(column).all()]
        if len(times) >= 90 and fields:
            rows = zip(*(map(nearest, topic.data[field]) for field in fields))
            told = zip(times.tolist(), map(list, rows))
            compare(spikewire, log, name, fields, told, directory / "read.mcap")
            numbers += len(times) * len(fields)
    print(f"{log.name}: {len(topics)} topics, {numbers} numbers of them, every value and time agrees")


def changes(rows):
    """Those that differ from the row before."""
    before = None
    for time, row in rows:
        if row != before:
            yield time, row
        before = row


def blackbox(spikewire, recording, directory, every):
    log = directory / f"every_{every}.bbl"
    blackbox_log.write(log, recording, every)
    parser = Parser.load(str(log))
    frames = [frame.data for frame in parser.frames()]
    names = parser.field_names
    time = names.index("time")
    for topic, kind in (("main", blackbox_log.MAIN), ("slow", blackbox_log.SLOW), ("gps", blackbox_log.GPS)):
        fields = [own[0] for own in kind if topic == "main" or own[0] != "time"]
        places = [names.index(field) for field in fields]
        if topic == "main":
            told = [(frame[time], [nearest(frame[place]) for place in places]) for frame in frames]
        else:
            # It gives them with the frames that follow; they were logged at the time of the frame before.
            pairs = [(before[time], [frame[place] for place in places]) for before, frame in zip(frames, frames[1:])]
            known = (pair for pair in pairs if "" not in pair[1])
            told = [(time, list(map(nearest, row))) for time, row in changes(known)]
        print(f"{log.name}, {topic}: {compare(spikewire, log, topic, fields, told, directory / 'read.bag')} agree")


def main():
    spikewire, recording, directory = sys.argv[1], sys.argv[2], Path(sys.argv[3])
    shutil.rmtree(directory, ignore_errors=True)
    directory.mkdir(parents=True)
    for every in (1, 2):
        blackbox(spikewire, recording, directory, every)
    ulog(spikewire, directory)
    for place, log in enumerate(write(directory, recording)):
        output = directory / ("read.bag", "read.mcap")[place % 2]
        agreed = compare(spikewire, log, "imu", FIELDS, expected(log), output)
        print(f"{log.name}: {agreed}, every value and time agrees")


if __name__ == "__main__":
    main()
