"""Compares what `flight-logs` reads of ArduPilot's logs and of telemetry logs with what `pymavlink` does: every message, time and value.

Writes a DataFlash log with every format letter and instances of a sensor, the same as text, and a telemetry log of both versions of
MAVLink; other logs may be named behind. Run by `cargo verify logs`: ardupilot_check.py NUMBERS DIRECTORY [LOG...], where NUMBERS is the
example of that name of `flight-logs`.
"""

import array
import os
import random
import struct
import subprocess
import sys
from pathlib import Path

os.environ["MAVLINK20"] = "1"
os.environ["MAVLINK_DIALECT"] = "ardupilotmega"

from pymavlink import DFReader, mavutil  # noqa: E402
from pymavlink.dialects.v20 import ardupilotmega as dialect  # noqa: E402

FORMATS = [
    (128, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns", ""),
    (129, "FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds", "s---"),
    (130, "UNIT", "QbZ", "TimeUS,Id,Label", "s--"),
    (131, "MULT", "Qbd", "TimeUS,Id,Mult", "s--"),
    (132, "IMU", "QBffffff", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ", "s#EEEooo"),
    (133, "ALL", "QbBhHiIfdqcCeELM", "TimeUS,b,B,h,H,i,I,f,d,q,c,C,e,E,L,M", "s" + "-" * 15),
    (137, "TXT", "QgnNZ", "TimeUS,g,n,N,Z", "s----"),
    (134, "ISBD", "Qaa", "TimeUS,x,y", "s--"),
    (135, "OLD", "If", "TimeMS,Value", "s-"),
    (136, "NOW", "h", "Count", "-"),
]
LAYOUT = {"Q": "Q", "q": "q", "d": "d", "f": "f", "g": "e", "M": "b", "c": "h", "C": "H", "e": "i", "E": "I", "L": "i"}
LAYOUT |= {letter: letter for letter in "bBhHiI"} | {"n": "4s", "N": "16s", "Z": "64s", "a": "64s"}
RANGES = {"b": 7, "B": 8, "h": 15, "H": 16, "i": 31, "I": 32, "q": 52, "Q": 52}


def drawn(draw, code):
    """A value of this code of `struct`, at its ends now and then."""
    if code in "fde":
        return draw.choice([0.0, -1.5, float("nan"), draw.gauss(0, 100)])
    bits = RANGES[code]
    low = 0 if code.isupper() else -(2**bits)
    return draw.choice([low, 2**bits - 1, draw.randrange(low, 2**bits)])


def message(kind, *values):
    letters = next(letters for own, _, letters, _, _ in FORMATS if own == kind)
    layout = "<BBB" + "".join(LAYOUT[letter] for letter in letters)
    return struct.pack(layout, 0xA3, 0x95, kind, *values)


def dataflash(path):
    draw = random.Random(1)
    log = b""
    for kind, name, letters, columns, _ in FORMATS:
        length = 3 + struct.calcsize("<" + "".join(LAYOUT[letter] for letter in letters))
        log += message(128, kind, length, name.encode(), letters.encode(), columns.encode())
    log += message(130, 1, ord("s"), b"s") + message(131, 1, ord("F"), 1e-6)
    for kind, *_, units in FORMATS:
        log += message(129, 2, kind, units.encode(), b"F-")
    for place in range(2000):
        time = 1000 + place * 2500
        for sensor in range(3):
            log += message(132, time, sensor, *(drawn(draw, "f") for _ in range(6)))
        if place % 5 == 0:
            numbers = [drawn(draw, LAYOUT[letter]) for letter in FORMATS[5][2][1:]]
            log += message(133, time, *numbers)
            log += message(137, time, drawn(draw, "e"), b"word", b"sixteen letters!", b"text, with a comma")
            axes = [array.array("h", [drawn(draw, "h") for _ in range(32)]).tobytes() for _ in range(2)]
            log += message(134, time, *axes) + message(136, place)
        if place % 8 == 0:
            log += message(135, time // 1000, drawn(draw, "f"))
    path.write_bytes(log)


def as_text(log, path):
    """The log as ground stations write it; they leave out arrays."""
    reader = DFReader.DFReader_binary(str(log), zero_time_base=True)
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n ArduCopter V4.5\n")
        while own := reader.recv_msg():
            if "a" not in own.fmt.format:
                words = [str(getattr(own, column)) or "-" for column in own.get_fieldnames()]
                file.write(", ".join([own.get_type(), *words]) + "\n")


def telemetry(path, known):
    """Packets of both versions, from two systems, and some that `flight-logs` does not know."""
    draw = random.Random(1)
    kinds = [own for own in dialect.mavlink_map.values() if own.msgname in known | {"STATUSTEXT", "REQUEST_DATA_STREAM"}]
    ranges = {f"{sign}int{bits}_t": sign and code.upper() or code for code, bits in (("b", 8), ("h", 16), ("i", 32), ("q", 64)) for sign in ("u", "")}
    with open(path, "wb") as file:
        for place in range(4000):
            kind = draw.choice(kinds)
            counts = dict(zip(kind.ordered_fieldnames, kind.array_lengths))
            values = []
            for field, of in zip(kind.fieldnames, kind.fieldtypes):
                code = "f" if of == "float" else ranges.get(of)
                several = [drawn(draw, code) if code and draw.random() < 0.7 else 0 for _ in range(counts[field] or 1)]
                values.append(b"words" if of == "char" else several if counts[field] else several[0])
            sender = dialect.MAVLink(None, srcSystem=draw.choice([1, 1, 1, 255]), srcComponent=1)
            sender.seq = place % 256
            packed = kind(*values).pack(sender, force_mavlink1=place % 3 == 0 and kind.id < 256)
            file.write(struct.pack(">Q", 1_700_000_000_000_000 + place * 2500) + packed)


def theirs(log):
    """Topic, time in µs and numbers of each message."""
    text = log.suffix == ".log"
    if log.suffix == ".tlog":
        reader, senders = mavutil.mavlogfile(str(log)), {}
    else:
        reader = (DFReader.DFReader_text if text else DFReader.DFReader_binary)(str(log), zero_time_base=True)
    while own := reader.recv_msg():
        name, instance = own.get_type(), 0
        if log.suffix == ".tlog":
            own_senders = senders.setdefault(name, [])
            if own.get_srcSystem() not in own_senders:
                own_senders.append(own.get_srcSystem())
            instance = own_senders.index(own.get_srcSystem())
        elif own.fmt.instance_field:
            instance = int(getattr(own, own.fmt.instance_field))
        numbers = {}
        for field in own.get_fieldnames():
            value = getattr(own, field)
            if isinstance(value, (list, tuple, array.array)):
                numbers |= {f"{field}[{place}]": float(item) for place, item in enumerate(value)}
            elif not isinstance(value, (str, bytes)):
                numbers[field] = float(value)
        yield f"{name}:{instance}" if instance else name, round(own._timestamp * 1e6), numbers


def ours(numbers, log):
    ran = subprocess.run([numbers, log], check=True, stdout=subprocess.PIPE, text=True)
    for line in ran.stdout.splitlines():
        topic, time, *fields = line.split(" ")
        pairs = (field.split("=") for field in fields)
        yield topic, int(time), {name: float(value) for name, value in pairs}


def compare(numbers, log, known=None):
    messages = values = 0
    read = ours(numbers, log)
    for topic, time, fields in theirs(log):
        if known is None or topic.split(":")[0] in known:
            own = next(read)
            # All numbers in words, so that one that is none equals itself.
            assert own[:2] == (topic, time) and repr(sorted(own[2].items())) == repr(sorted(fields.items())), (log, own, topic, time, fields)
            messages, values = messages + 1, values + len(fields)
    assert next(read, None) is None and values, log
    print(f"{log.name}: {messages} messages, {values} values, every value and time agrees")


def main():
    numbers, directory = sys.argv[1], Path(sys.argv[2])
    directory.mkdir(parents=True, exist_ok=True)
    binary, text, tlog = (directory / f"made.{ending}" for ending in ("bin", "log", "tlog"))
    dataflash(binary)
    as_text(binary, text)
    listed = Path(__file__).parents[3] / "flight-logs/src/mavlink/messages.rs"
    known = {line.split('"')[1] for line in listed.read_text().splitlines() if line.startswith("    (")}
    telemetry(tlog, known)
    for log in [binary, text, *map(Path, sys.argv[3:])]:
        compare(numbers, log)
    compare(numbers, tlog, known)


if __name__ == "__main__":
    main()
