"""What a board is wired to: a sensor on SPI or I2C, its data-ready line, a serial line, a crystal, and fates that strike them.

The sensor is that of `sensors.mjs`, which the Pico's emulator has, too.
"""

import pathlib

import quickjs

GLUE = """
let sensor, bytes = [];
function feed(line, now) {
  const answers = [];
  for (const byte of line.split(",")) answers.push(sensor.transfer(Number(byte), now) ?? -1);
  return answers.join(",");
}
"""
CLASSES = {"bmi323": "Bmi323", "icm42688p": "Icm42688p", "bmi088": "Bmi088"}


class Bench:
    """The bench gives the part `pin` (a level of the data-ready line) and takes its transfers and bytes."""

    def __init__(self, core, sensor):
        self.core = core
        script = (pathlib.Path(__file__).parent / "sensors.mjs").read_text().replace("export class", "class")
        self.script = quickjs.Context()
        self.script.eval(script + GLUE + f"sensor = new {CLASSES[sensor]}();")
        self.feed, self.advance = self.script.get("feed"), self.script.eval("(now) => sensor.advance(now)")
        self.noise = 1
        self.mend()
        self.uart, self.times = bytearray(), []
        self.seen = {"starts": [], "shortestPause": 1e12, "shortestGuard": 1e12, "spiHz": 0, "baud": 0, "pulledUp": False}
        self.start()

    def start(self):
        """After a reset of the part: nothing is selected."""
        self.selected, self.since, self.level, self.fifo_ends = False, None, False, 0.0
        self.core.at(self.core.now, self.tick)

    def ticks_begin(self):
        """The clock of the events' ticks starts at zero."""
        self.seen["starts"][-1]["ticks"] = self.core.now / 1e3

    def js(self, code):
        return self.script.eval(code)

    def mend(self):
        self.miso, self.ready, self.clock, self.slow, self.crystal = "whole", True, True, False, True

    def strike(self, name):
        """What happens, by its name: those of `pico.mjs`."""
        kind, _, what = name.partition("-")
        match name:
            case "miso-cut" | "miso-noise" | "miso-low" | "miso-high":
                self.miso = what
            case "ready-cut":
                self.ready = False
            case "clock-cut":
                self.clock = False
            case "uart-slow":
                self.slow = True
            case "crystal-dead":
                self.crystal = False
            case "another":
                self.js("sensor.identity = 0x68")
            case "mend":
                self.mend()
                self.js("sensor.identity = 0x47")
            case "supply-gone":
                self.js("sensor.powerOff()")
            case "supply-back":
                self.js(f"sensor.powerOn({self.core.now})")
            case "freeze":
                self.js("sensor.isFrozen = true")
            case "freeze-accelerometer":
                self.js("sensor.isHalfFrozen = true")
            case "thaw":
                self.js("sensor.isFrozen = sensor.isHalfFrozen = false")
            case _:
                raise ValueError(f"no such fate: {name}")

    def tick(self):
        """The sensor's time, and its line."""
        now = self.core.now
        high = bool(self.advance(now))
        level = high and self.ready
        if level != self.level:
            self.level = level
            self.pin(level)
        self.core.at(min(self.js("sensor.next"), now + 10_001 if high else 1e18), self.tick)

    def select(self, low):
        """The chip-select line."""
        if low == self.selected:
            return
        self.selected, now = low, self.core.now
        if low:
            if self.since is not None:
                self.seen["shortestPause"] = min(self.seen["shortestPause"], now - self.since)
        elif self.since is not None:
            self.seen["shortestGuard"] = min(self.seen["shortestGuard"], now - self.since)
        self.since = now
        if self.clock:
            self.js(f"sensor.{'' if low else 'de'}select({now})")

    def transfer(self, sent, hz, pull, done):
        """Clocks bytes through the sensor, and hands over what MISO had when they are through."""
        now = self.core.now
        self.seen["spiHz"] = max(self.seen["spiHz"], round(hz))
        self.seen["pulledUp"] = pull == "up"
        if self.selected:
            self.seen["shortestGuard"] = min(self.seen["shortestGuard"], now - self.since)
        hears = self.selected and self.clock
        answers = map(int, self.feed(",".join(map(str, sent)), now).split(",")) if hears else [-1] * len(sent)
        read = bytes(self.read(answer, pull) for answer in answers)

        def end():
            self.since = self.core.now
            done(read)

        return self.core.after(len(sent) * 8e9 / hz, end)

    def read(self, driven, pull):
        noise = self.random() >> 31 and 0xFF
        floating = {"up": 0xFF, "down": 0x00}.get(pull, noise)
        whole = driven if driven >= 0 else floating
        return {"whole": whole, "cut": floating, "noise": noise, "low": 0x00, "high": 0xFF}[self.miso]

    # A sensor on I2C: MISO is SDA, that the bus pulls up, and the clock SCL.

    def holds_low(self):
        """Whether SDA is stuck low."""
        return self.miso == "low"

    def hears(self):
        return self.clock and self.miso in ("whole", "noise")

    def acknowledges(self, byte):
        """The first byte of a transfer: address, and whether it reads."""
        driven = self.hears() and self.js(f"sensor.begin({byte})")
        return bool(self.random() >> 31) if self.miso == "noise" else bool(driven)

    def put(self, byte):
        driven = self.hears() and self.js(f"sensor.put({byte})")
        return bool(self.random() >> 31) if self.miso == "noise" else bool(driven)

    def take(self):
        driven = self.js("sensor.get()") if self.hears() else -1
        return self.read(driven, "up")

    def send(self, byte, baud):
        """A byte on the serial line; returns how long it takes."""
        self.seen["baud"] = round(baud)
        took = 10e9 / (9600 if self.slow else baud)
        self.uart.append(byte)
        self.times.append((self.core.now + took) / 1e3)
        return took

    def random(self):
        self.noise = (self.noise * 1664525 + 1013904223) & 0xFFFFFFFF
        return self.noise
