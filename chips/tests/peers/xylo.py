"""Runs SynSense's own software on the registers of a Xylo Audio 3, and writes xylo.txt.

    xylo.py ROCKPOOL > xylo.txt

ROCKPOOL is `rockpool` 3.1.0, unpacked (`pip download --no-deps --no-binary :all: rockpool==3.1.0`). Its functions for the
chip read the registers from a table, in place of the library `samna`. Needs `numpy` and `xylosim` 0.1.3, which simulates
the chip's neurons: each of 16 takes the counts of one input, and fires once for each spike.

A line: 16 counts; what xylosim makes of them; the seven registers of `REGISTERS`; the counts that rockpool reads from the
bank in use; 1 if that step is done; the outputs that fired.
"""

import importlib
import random
import sys
from types import ModuleType
from unittest.mock import MagicMock

from xylosim.v2 import XyloLayer, XyloSynapse

REGISTERS = (0x149, 0x14A, 0x14B, 0x14C, 0x152, 0x153, 0x171)


def functions(rockpool):
    sys.modules["samna"] = sys.modules["samna.xyloAudio3"] = MagicMock()
    sys.modules["samna.xyloAudio3.configuration"] = MagicMock()
    # The package itself imports much that these functions do not need.
    package = sys.modules["audio3"] = ModuleType("audio3")
    package.__path__ = [f"{rockpool}/rockpool/devices/xylo/syns65302"]
    return importlib.import_module("audio3.xa3_devkit_utils")


def fired(counts):
    def synapses(weighted):
        return [[XyloSynapse(at, 0, 64)] if weighted else [] for at in range(16)]

    # The layer does not own its synapses, so they must live as long as it does. A current loses at least 1 in a step.
    inner, none, slow = [synapses(True), synapses(False)], [0] * 16, [15] * 16
    layer = XyloLayer(
        synapses_in=inner[0], synapses_rec=inner[1], synapses_out=inner[1], aliases=[[]] * 16,
        threshold=[63] * 16, threshold_out=[1], has_bias=False, bias=none, bias_out=[0], weight_shift_inp=0,
        weight_shift_rec=0, weight_shift_out=0, dash_mem=slow, dash_mem_out=[15], dash_syns=[[15, 15]] * 16,
        dash_syns_out=[[15]], name="counts")
    layer.evolve([counts])
    return layer.rec_recurrent_spikes[0]


def main():
    vendor, noise = functions(sys.argv[1]), random.Random(1)
    for _ in range(50):
        counts = [noise.choice((0, 1, 7, 14, 15, 16, 255, noise.randrange(16))) for _ in range(16)]
        values = [noise.getrandbits(32) for _ in REGISTERS]
        held = dict(zip(REGISTERS, values))
        vendor.read_register = lambda read, write, address: [held[address]]
        buffers = MagicMock(), MagicMock()
        outputs = [at for at, fires in enumerate(vendor.read_output_events(*buffers)) if fires]
        done = [int(bool(vendor.is_xylo_ready(*buffers)))]
        columns = counts, fired(counts), values, vendor.read_input_spikes(*buffers), done, outputs
        print(";".join(" ".join(str(one) for one in column) for column in columns))


if __name__ == "__main__":
    main()
