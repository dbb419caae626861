"""An nRF52840's peripherals, as far as the firmware uses them: Nordic's product specification, v1.8."""

from collections import defaultdict

from cortex_m import Core, Reset
from unicorn.arm_const import UC_CPU_ARM_CORTEX_M4

MEMORIES = ((0x00000000, 0x100000), (0x20000000, 0x40000))
VECTORS = 0
SCK, MISO, MOSI, SELECT, READY, TX = (1, 15), (1, 14), (1, 13), (1, 12), (1, 11), (0, 6)
SLOW_NS = 1e9 / 32_768


class Peripheral:
    """Tasks below 0x100, events below 0x200, and the interrupt that both enable."""

    def __init__(self, part, base, irq):
        self.part, self.core, self.irq = part, part.core, irq
        self.registers, self.enabled = defaultdict(int), 0
        part.at[base] = self

    def read(self, offset):
        if offset in (0x304, 0x308):
            return self.enabled
        return self.registers[offset]

    def write(self, offset, value):
        if offset < 0x100:
            if value & 1:
                self.task(offset)
        elif offset == 0x304:
            self.enabled |= value
        elif offset == 0x308:
            self.enabled &= ~value
        else:
            self.registers[offset] = value
            self.written(offset, value)
        if offset >= 0x100:
            self.update()

    def task(self, offset):
        pass

    def written(self, offset, value):
        pass

    def fire(self, offset):
        self.registers[offset] = 1
        self.update()

    def wired(self, pins):
        """Whether the pins are chosen, by their registers; anything else ends the run."""
        for offset, (port, pin) in pins.items():
            if self.registers[offset] != port << 5 | pin:
                self.core.raise_later(LookupError(f"P{port}.{pin} is not the peripheral's"))

    def update(self):
        fired = any(self.registers[0x100 + 4 * one] for one in range(32) if self.enabled >> one & 1)
        self.core.line(self.irq, fired)


class Clock(Peripheral):
    """CLOCK and POWER. The crystals take 0.36 ms and 0.25 s."""

    def __init__(self, part, base, irq):
        super().__init__(part, base, irq)
        self.registers[0x400] = {"watchdog": 2, "software": 4}.get(part.reason, 0)

    def task(self, offset):
        ns = {0: 0.36e6, 8: 250e6}.get(offset)
        if ns and self.part.bench.crystal:
            self.core.after(ns, lambda: self.fire(0x100 + offset // 2))

    def written(self, offset, value):
        if offset == 0x400:
            self.registers[offset] = 0


class Watchdog(Peripheral):
    bite = None

    def task(self, offset):
        self.registers[0x400] = 1
        self.reload()

    def written(self, offset, value):
        if offset == 0x600 and value == 0x6E524635 and self.registers[0x400]:
            self.reload()

    def reload(self):
        if self.bite:
            self.bite[2] = None
        self.bite = self.core.after((self.registers[0x504] + 1) * SLOW_NS, self.over)

    def over(self):
        raise Reset("watchdog")


class Counter(Peripheral):
    """RTC1: 24 bits at 32 768 Hz, while it runs."""

    began = None

    def count(self):
        return 0 if self.began is None else int((self.core.now - self.began) / SLOW_NS + 1e-3)

    def task(self, offset):
        if offset in (0, 8):
            self.began = self.core.now
            for one in range(4):
                self.compare(one)

    def read(self, offset):
        return self.count() & 0xFFFFFF if offset == 0x504 else super().read(offset)

    def written(self, offset, value):
        if 0x540 <= offset < 0x550:
            self.compare((offset - 0x540) // 4)

    def compare(self, one):
        if self.began is None:
            return
        count, value = self.count(), self.registers[0x540 + 4 * one]
        # A compare with the count that is, or the next one, may come a round later.
        ahead = (value - count) & 0xFFFFFF or 1 << 24
        if ahead == 1:
            ahead += 1 << 24

        def reached():
            if self.registers[0x540 + 4 * one] == value:
                self.fire(0x140 + 4 * one)

        self.core.at(self.began + (count + ahead) * SLOW_NS, reached)


class Timer(Peripheral):
    """A timer at 1 MHz. STOP holds it, and SHUTDOWN clears it, too."""

    began, held = None, 0

    def count(self):
        hz = 16e6 / (1 << (self.registers[0x510] & 15))
        return self.held + (0 if self.began is None else int((self.core.now - self.began) * hz / 1e9 + 1e-3))

    def task(self, offset):
        if offset == 0:
            self.began = self.core.now if self.began is None else self.began
            self.part.bench.ticks_begin()
        elif offset in (4, 0x10):
            self.held, self.began = self.count() if offset == 4 else 0, None
        elif offset == 0xC:
            self.held, self.began = 0, None if self.began is None else self.core.now
        elif offset >= 0x40:
            bits = {0: 16, 1: 8, 2: 24, 3: 32}[self.registers[0x508] & 3]
            self.registers[0x540 + offset - 0x40] = self.count() & ((1 << bits) - 1)


class Random(Peripheral):
    def task(self, offset):
        if offset == 0:
            self.core.after(30e3, self.ready)
            self.registers[0x7FC] = 1
        else:
            self.registers[0x7FC] = 0

    def ready(self):
        if self.registers[0x7FC]:
            self.registers[0x508] = self.part.bench.random() >> 24
            self.fire(0x100)
            self.core.after(120e3, self.ready)


class Spi(Peripheral):
    """SPIM2, with EasyDMA, which reaches RAM alone."""

    def task(self, offset):
        if offset != 0x10:
            return
        self.wired({0x508: SCK, 0x50C: MOSI, 0x510: MISO})
        get = self.registers.__getitem__
        count = max(get(0x538), get(0x548))
        sent = self.part.ram(get(0x544), get(0x548)).ljust(count, bytes([get(0x5C0) & 0xFF]))
        into, room = get(0x534), get(0x538)
        hz = {0x80000000: 8e6, 0x40000000: 4e6, 0x20000000: 2e6, 0x10000000: 1e6}[get(0x524)]

        def done(read):
            self.core.uc.mem_write(into, read[:room])
            self.registers[0x53C], self.registers[0x54C] = room, len(sent)
            for event in (0x110, 0x120, 0x118):
                self.fire(event)

        pull = {0: "none", 1: "down", 3: "up"}[self.part.ports.pins[MISO] >> 2 & 3]
        self.fire(0x14C)
        self.part.bench.transfer(sent, hz, pull, done)


class Uart(Peripheral):
    """UARTE0, its sending half, with EasyDMA."""

    following = None

    def task(self, offset):
        if offset == 8:
            self.wired({0x50C: TX})
            self.bytes = list(self.part.ram(self.registers[0x544], self.registers[0x548]))
            self.sent = 0
            self.fire(0x150)
            self.next()
        elif offset == 0xC:
            if self.following:
                self.following[2] = None
                self.end()
            self.fire(0x158)

    def next(self):
        if self.sent == len(self.bytes):
            return self.end()
        # A whole number of its 16 MHz' clocks, as the table's actual rates have it.
        clocks = int(2**32 / self.registers[0x524])
        took = self.part.bench.send(self.bytes[self.sent], 16e6 / clocks)
        self.sent += 1
        self.following = self.core.after(took, self.next)

    def end(self):
        self.following, self.registers[0x54C] = None, self.sent
        self.fire(0x120)


class Ports:
    """P0 and P1, and GPIOTE's event of both: LATCH, and the edge of its sum."""

    def __init__(self, part):
        self.part, self.pins, self.latch, self.out, self.high = part, defaultdict(lambda: 2), [0, 0], [0, 0], set()

    @staticmethod
    def place(offset):
        """The second port begins 0x300 above the first, whose first registers are at 0x500."""
        return (1, offset - 0x300) if offset >= 0x800 else (0, offset)

    def read(self, offset):
        port, offset = self.place(offset)
        if offset >= 0x700:
            return self.pins[port, (offset - 0x700) // 4]
        if offset == 0x510:
            return sum(1 << pin for at, pin in self.high if at == port)
        return {0x504: self.out[port], 0x508: self.out[port], 0x50C: self.out[port], 0x520: self.latch[port]}.get(offset, 0)

    def write(self, offset, value):
        port, offset = self.place(offset)
        if offset >= 0x700:
            self.pins[port, (offset - 0x700) // 4] = value
        elif offset == 0x520:
            self.latch[port] &= ~value
            self.sense(again=True)
            return
        else:
            before = self.out[port]
            self.out[port] = {0x504: value, 0x508: before | value, 0x50C: before & ~value}.get(offset, before)
        if SELECT[0] == port and self.pins[SELECT] & 1:
            self.part.bench.select(not self.out[port] >> SELECT[1] & 1)
        self.sense()

    def level(self, pin, level):
        (self.high.add if level else self.high.discard)(pin)
        self.sense()

    def sense(self, again=False):
        before = any(self.latch) and not again
        for (port, pin), how in self.pins.items():
            if how >> 16 & 3 == (2 if (port, pin) in self.high else 3):
                self.latch[port] |= 1 << pin
        if any(self.latch) and not before:
            self.part.edges.fire(0x17C)


class Flash:
    """FICR and UICR, which nobody programmed so far, and a flash that is ready."""

    def __init__(self):
        self.words = {}

    def read(self, offset):
        return self.words.get(offset, 0xFFFFFFFF)

    def write(self, offset, value):
        self.words[offset] = self.read(offset) & value


class Part:
    def __init__(self):
        self.core = Core(MEMORIES, UC_CPU_ARM_CORTEX_M4)
        self.at = {}
        self.core.bus(0x40000000, 0x2F000, self)
        self.core.bus(0x50000000, 0x1000, self.delayed("ports"))
        for base in (0x10000000, 0x10001000):
            self.core.bus(base, 0x1000, Flash())

    def delayed(self, name):
        part = self

        class Now:
            def read(self, offset):
                return getattr(part, name).read(offset)

            def write(self, offset, value):
                getattr(part, name).write(offset, value)

        return Now()

    def reset(self, bench, reason):
        self.bench, self.reason, self.at = bench, reason, {}
        self.core.hz = 64_000_000
        Clock(self, 0x00000, 0)
        Uart(self, 0x02000, 2)
        self.edges = Peripheral(self, 0x06000, 6)
        Timer(self, 0x09000, 9)
        Peripheral(self, 0x0C000, 12)  # TEMP, which the HAL trims
        Random(self, 0x0D000, 13)
        Watchdog(self, 0x10000, 16)
        Counter(self, 0x11000, 17)
        Spi(self, 0x23000, 35)
        self.at[0x1E000] = Flash()  # NVMC: ready
        self.ports = Ports(self)
        bench.pin = lambda level: self.ports.level(READY, level)

    def pauses_on_halt(self):
        """Whether the watchdog stands still while a debugger halts the core: HALT of its CONFIG."""
        return not self.at[0x10000].registers[0x50C] >> 3 & 1

    def read(self, offset):
        return self.at[offset & ~0xFFF].read(offset & 0xFFF) if offset & ~0xFFF in self.at else self.missing(offset)

    def write(self, offset, value):
        if offset & ~0xFFF in self.at:
            self.at[offset & ~0xFFF].write(offset & 0xFFF, value)
        else:
            self.missing(offset)

    def missing(self, offset):
        self.core.raise_later(LookupError(f"no peripheral at {0x40000000 + offset:#x}"))
        return 0

    def ram(self, address, length):
        if not 0x20000000 <= address <= 0x20040000 - length:
            self.core.raise_later(LookupError(f"EasyDMA does not reach {address:#x}"))
            return bytes(length)
        return bytes(self.core.uc.mem_read(address, length))
