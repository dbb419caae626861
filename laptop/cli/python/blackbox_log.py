"""Writes Betaflight's blackbox logs in all encodings that `orangebox` reads, by "Blackbox Internals" of its documentation."""

import csv

import numpy as np

HOME = (473_977_420, 85_455_940)
VOLTAGE, LEAST_MOTOR = 1865, 188

# Name, has a sign, predictor and encoding in full frames, those in frames of changes.
MAIN = (
    [("loopIteration", 0, 0, 1, 6, 9), ("time", 0, 0, 1, 2, 0)]
    + [(f"axisI[{place}]", 1, 0, 0, 1, 7) for place in range(3)]
    + [(f"rcCommand[{place}]", 1, 0, 0, 1, 8) for place in range(4)]
    + [("vbatLatest", 0, 9, 3, 1, 6), ("amperageLatest", 1, 0, 0, 1, 6), ("rssi", 0, 0, 1, 1, 6)]
    + [(f"gyroADC[{place}]", 1, 0, 0, 3, 0) for place in range(3)]
    + [(f"accSmooth[{place}]", 1, 0, 0, 3, 0) for place in range(3)]
    + [("motor[0]", 0, 11, 1, 3, 0)]
    + [(f"motor[{place}]", 0, 5, 0, 3, 0) for place in range(1, 4)]
)
SLOW = [("flightModeFlags", 0, 0, 1), ("stateFlags", 0, 0, 1)] + [
    (name, 0, 0, 7) for name in ("failsafePhase", "rxSignalReceived", "rxFlightChannelsValid")
]
GPS = [("time", 0, 10, 1), ("GPS_numSat", 0, 0, 1), ("GPS_coord[0]", 1, 7, 0), ("GPS_coord[1]", 1, 7, 0)]
GPS += [("GPS_altitude", 0, 0, 1), ("GPS_speed", 0, 0, 1)]


def unsigned(number):
    number &= 0xFFFF_FFFF
    own = bytearray()
    while number > 127:
        own.append(number & 127 | 128)
        number >>= 7
    return bytes(own) + bytes([number])


def signed(number):
    return unsigned((number << 1) ^ (number >> 31))


def three(numbers):
    most = max(max(number, -1 - number) for number in numbers)
    one, two, last = numbers
    if most < 2:
        return bytes([(one & 3) << 4 | (two & 3) << 2 | last & 3])
    if most < 8:
        return bytes([0x40 | one & 15, (two & 15) << 4 | last & 15])
    if most < 32:
        return bytes([0x80 | one & 63, two & 63, last & 63])
    lengths = [1 + sum(not -limit <= number < limit for limit in (1 << 7, 1 << 15)) for number in numbers]
    lead = 0xC0 | sum((length - 1) << 2 * place for place, length in enumerate(lengths))
    parts = [number.to_bytes(length, "little", signed=True) for number, length in zip(numbers, lengths)]
    return bytes([lead]) + b"".join(parts)


def four(numbers):
    kinds = [0 if number == 0 else 1 + sum(not -limit <= number < limit for limit in (8, 128)) for number in numbers]
    halves = "".join(
        f"{number & (1 << 4 * count) - 1:0{count}x}"
        for number, count in zip(numbers, ((0, 1, 2, 4)[kind] for kind in kinds))
        if count
    )
    which = sum(kind << 2 * place for place, kind in enumerate(kinds))
    return bytes([which]) + bytes.fromhex(halves + "0" * (len(halves) % 2))


def eight(numbers):
    which = sum(1 << place for place, number in enumerate(numbers) if number)
    return bytes([which]) + b"".join(signed(number) for number in numbers if number)


# How many numbers are packed together (all of a run for `eight`), and how.
PACKED = {
    0: (1, lambda numbers: signed(*numbers)),
    1: (1, lambda numbers: unsigned(*numbers)),
    3: (1, lambda numbers: unsigned(-numbers[0] & 0x3FFF)),
    6: (3, eight),
    7: (3, three),
    8: (4, four),
    9: (1, lambda numbers: b""),
}


def packed(encodings, numbers):
    own, place = b"", 0
    while place < len(numbers):
        count, pack = PACKED[encodings[place]]
        own += pack(numbers[place : place + count])
        place += count
    return own


def predicted(predictor, place, frame, before):
    one, two = (own[place] for own in before)
    return {
        0: lambda: 0,
        1: lambda: one,
        2: lambda: 2 * one - two,
        3: lambda: int((one + two) / 2),
        5: lambda: frame[-4],
        6: lambda: frame[place],
        9: lambda: VOLTAGE,
        11: lambda: LEAST_MOTOR,
    }[predictor]()


def flight(recording):
    """Frames of the recorded flight; other numbers walk at random, by steps of every size."""
    chance = np.random.default_rng(1)
    walk = np.zeros(14, dtype=int)
    with open(recording, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        steps = chance.normal(size=14) * 2.0 ** chance.integers(-3, 9, size=14)
        # Back to the middle, so that all stay within 14 bits.
        walk = (walk * 0.9 + steps).astype(int)
        own = walk.tolist()
        gyro = [round(float(row[f"gyro_{axis}"]) * 1000) for axis in "xyz"]
        force = [round(float(row[f"accel_{axis}"]) * 100) for axis in "xyz"]
        battery = [VOLTAGE + own[7] // 8, own[8], abs(own[9])]
        motors = [LEAST_MOTOR + abs(number) for number in own[10:]]
        yield int(row["time_us"]), own[:3] + own[3:7] + battery + gyro + force + motors


def head(every):
    lines = ["Product:Blackbox flight data recorder by Nicholas Sherlock", "Data version:2", "I interval:32"]
    lines += [f"P interval:1/{every}", "minthrottle:1070", f"vbatref:{VOLTAGE}", f"motorOutput:{LEAST_MOTOR},1850"]
    home = [("GPS_home[0]", 1, 0, 0), ("GPS_home[1]", 1, 0, 0)]
    for kind, fields in (("I", MAIN), ("S", SLOW), ("G", GPS), ("H", home)):
        for place, what in enumerate(("name", "signed", "predictor", "encoding")):
            lines.append(f"Field {kind} {what}:" + ",".join(str(own[place]) for own in fields))
    for place, what in ((4, "predictor"), (5, "encoding")):
        lines.append(f"Field P {what}:" + ",".join(str(own[place]) for own in MAIN))
    return "".join(f"H {line}\n" for line in lines).encode()


def write(path, recording, every):
    """A log of which one iteration in so many is logged, and every 32nd in full."""
    log, before = [head(every)], None
    for sample, (time, numbers) in enumerate(flight(recording)):
        iteration = sample * every
        frame = [iteration, time] + numbers
        is_full = iteration % 32 == 0
        predictor, encoding = (2, 3) if is_full else (4, 5)
        before = before or (frame, frame)
        changes = [
            number - predicted(field[predictor], place, frame, before)
            for place, (number, field) in enumerate(zip(frame, MAIN))
        ]
        log.append((b"I" if is_full else b"P") + packed([field[encoding] for field in MAIN], changes))
        before = (frame, frame) if is_full else (frame, before[0])
        if sample % 100 == 50:
            log.append(b"S" + packed([own[3] for own in SLOW], [sample, sample // 100, sample % 3, sample // 100 % 2, 1]))
        if sample % 40 == 20:
            if sample == 20:
                log.append(b"H" + signed(HOME[0]) + signed(HOME[1]))
            log.append(b"G" + packed([own[3] for own in GPS], [0, sample % 20, sample * 7, -sample, 500, sample]))
    log.append(b"E\xffEnd of log\0")
    path.write_bytes(b"".join(log))
