"""Runs an image with a Cortex-M4F or M7 from its reset vector, with a sensor on its bus.

    python board.py PART IMAGE SENSOR SECONDS DIRECTORY [TIME:FATE]...

Writes and prints what `pico.mjs` does, which says more; but no cycles.
"""

import importlib
import json
import os
import pathlib
import struct
import sys

from bench import Bench
from cortex_m import LOOP, Reset, symbol
from unicorn import UcError
from unicorn.arm_const import UC_ARM_REG_PC

part_name, image, sensor, seconds, directory, *fates = sys.argv[1:]
module = importlib.import_module(part_name)
part = module.Part()
core, elf, end = part.core, pathlib.Path(image).read_bytes(), float(seconds) * 1e9
directory, rtt, log = pathlib.Path(directory), symbol(elf, b"_SEGGER_RTT"), bytearray()
core.load(elf, module.VECTORS, getattr(module, "ENTRY", module.VECTORS))
core.reset()
bench = Bench(core, sensor)
if recording := os.environ.get("RECORDING"):
    bench.js(f"sensor.fly({json.dumps(pathlib.Path(recording).read_text())})")


def drain():
    """Takes what the firmware logged, as a debug probe would."""
    if rtt is None:
        return  # an image without RTT has no log
    core.after(1e6, drain)
    if core.uc.mem_read(rtt, 4) != b"SEGG":
        return
    buffer, size, write, read = struct.unpack("<4I", core.uc.mem_read(rtt + 28, 16))
    while read != write:
        log.extend(core.uc.mem_read(buffer + read, 1))
        read = (read + 1) % size
    core.uc.mem_write(rtt + 40, struct.pack("<I", read))


def start(reason):
    """A part after a reset: RAM is what it was."""
    core.reset()
    bench.start()
    part.reset(bench, reason)
    bench.seen["starts"].append({"at": core.now / 1e6, "reason": int(reason == "watchdog")})
    drain()
    for fate in fates:
        time, _, name = fate.partition(":")
        if float(time) * 1e6 > core.now or not bench.seen["starts"][1:] and float(time) == 0:
            core.at(float(time) * 1e6, lambda name=name: strike(name))


def strike(name):
    if name == "reset":
        raise Reset("pin")
    if name == "hang":
        return hang()
    bench.strike(name)


def hang():
    """Ends everything in the task that runs: interrupts go on."""
    if core.active:
        core.after(1e3, hang)
    else:
        core.pc, core.asleep = LOOP | 1, False


start("power")
fault = None
while core.now < end and not fault:
    try:
        core.run(end)
    except Reset as reset:
        start(reset.args[0])
    except (LookupError, UcError) as error:
        fault = f"{error} at {core.uc.reg_read(UC_ARM_REG_PC):#x}"  # such as a panic's end
        fault += "" if core.touched is None else f": nothing is at {core.touched:#x}"
drain()
seen = bench.seen | {"instructions": core.instructions, "cycles": 0, "clkSys": core.hz, "fault": fault}
seen["pausesOnHalt"] = part.pauses_on_halt()
seen["configured"] = bool(bench.js("sensor.isConfigured"))
(directory / "uart").write_bytes(bench.uart)
(directory / "times").write_text("\n".join(f"{time:.0f}" for time in bench.times))
(directory / "log").write_bytes(log)
(directory / "samples").write_text(bench.js("sensor.samples.join('\\n')"))
executed = (f"{at},{count},{taken}" for at, (count, taken) in core.executed().items())
(directory / "executed").write_text("\n".join(executed))
print(json.dumps(seen))
