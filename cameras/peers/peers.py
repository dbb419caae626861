"""Reads and writes event files with other people's programs.

    peers.py read  es|evt2|evt3 FILE   prints a line for each event: time, address, polarity
    peers.py write es|evt2 FILE        writes the events of such lines on standard input
"""

import sys

import event_stream
import evt3
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


def read_evt2(path):
    for time, x, y, polarity in Wizard(encoding="evt2").read(path):
        yield time, int(y) << 11 | int(x), polarity


# expelliarmus adds 4096 us wherever the low bits of EVT3's time wrap, also if the upper bits have been sent.
def read_evt3(path):
    events = evt3.decode_file(path)
    for time, x, y, polarity in zip(events.timestamp, events.x, events.y, events.polarity):
        yield time, int(y) << 11 | int(x), int(polarity)


def write_evt2(path, events):
    fields = [("t", "<i8"), ("x", "<i2"), ("y", "<i2"), ("p", "u1")]
    rows = [(t, address & 0x7FF, address >> 11, polarity) for t, address, polarity in events]
    Wizard(encoding="evt2").save(path, numpy.array(rows, dtype=fields))


def main():
    action, kind, path = sys.argv[1:]
    if action == "read":
        readers = {"es": read_es, "evt2": read_evt2, "evt3": read_evt3}
        for event in readers[kind](path):
            print(*event)
    else:
        events = [tuple(map(int, line.split())) for line in sys.stdin]
        (write_es if kind == "es" else write_evt2)(path, events)


if __name__ == "__main__":
    main()
