"""Reads and writes event files with other people's programs.

    peers.py read  es|evt2|evt3 FILE   prints a line for each event: time, address, polarity
    peers.py write es|evt2|evt3 FILE   writes the events of such lines on standard input
"""

import sys

import event_stream
import numpy
from expelliarmus import Wizard


def read_es(path):
    with event_stream.Decoder(path) as decoder:
        assert decoder.type == "generic", decoder.type
        for chunk in decoder:
            for time, payload in chunk:
                low, high, polarity = payload
                yield time, high << 8 | low, polarity


def write_es(path, events):
    chunk = numpy.empty(len(events), event_stream.generic_dtype)
    for index, (time, address, polarity) in enumerate(events):
        chunk[index] = (time, bytes([address & 0xFF, address >> 8, polarity]))
    with event_stream.Encoder(path, "generic", 0, 0) as encoder:
        encoder.write(chunk)


def read_evt(path, encoding):
    for time, x, y, polarity in Wizard(encoding=encoding).read(path):
        yield time, int(y) << 11 | int(x), polarity


def write_evt(path, events, encoding):
    fields = [("t", "<i8"), ("x", "<i2"), ("y", "<i2"), ("p", "u1")]
    rows = [(t, address & 0x7FF, address >> 11, polarity) for t, address, polarity in events]
    Wizard(encoding=encoding).save(path, numpy.array(rows, dtype=fields))


def main():
    action, kind, path = sys.argv[1:]
    if action == "read":
        for event in read_es(path) if kind == "es" else read_evt(path, kind):
            print(*event)
    else:
        events = [tuple(map(int, line.split())) for line in sys.stdin]
        if kind == "es":
            write_es(path, events)
        else:
            write_evt(path, events, kind)


if __name__ == "__main__":
    main()
