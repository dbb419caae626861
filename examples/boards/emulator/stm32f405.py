"""An STM32F405's peripherals, as far as the firmware uses them (RM0090), on a SpeedyBee F405 V4. One without its clock faults."""

from collections import defaultdict

from cortex_m import Core, Reset
from unicorn.arm_const import UC_CPU_ARM_CORTEX_M4

MEMORIES = ((0x08000000, 0x100000), (0x10000000, 0x10000), (0x20000000, 0x20000))
VECTORS = 0x08000000
CRYSTAL = 8_000_000
START_NS = 2e6  # of the crystal
LOW_HZ = 32_000  # of the watchdog

# RM0090, table 43: what a stream of DMA2 moves on which channel.
REQUESTS = {(0, 3): "SPI_RX", (3, 3): "SPI_TX", (6, 5): "TX"}

# Bits of a stream's control: what it must have, of all that is modelled. MINC; and not CIRC, wider words, two buffers.
PLAIN, FANCY = 1 << 10, 1 << 8 | 15 << 11 | 1 << 18

# Where each lies, and the bit of RCC that clocks it.
PLACES = {
    "TIM2": (0x40000000, 0x40, 0),
    "TIM3": (0x40000400, 0x40, 1),
    "TIM4": (0x40000800, 0x40, 2),
    "TIM5": (0x40000C00, 0x40, 3),
    "IWDG": (0x40003000, None, 0),
    "PWR": (0x40007000, 0x40, 28),
    "USART6": (0x40011400, 0x44, 5),
    "SPI1": (0x40013000, 0x44, 12),
    "SYSCFG": (0x40013800, 0x44, 14),
    "EXTI": (0x40013C00, None, 0),
    **{f"GPIO{name}": (0x40020000 + 0x400 * at, 0x30, at) for at, name in enumerate("ABCDEFGHI")},
    "RCC": (0x40023800, None, 0),
    "FLASH": (0x40023C00, None, 0),
    "DMA1": (0x40026000, 0x30, 21),
    "DMA2": (0x40026400, 0x30, 22),
    "RNG": (0x50060800, 0x34, 6),
    "DBGMCU": (0xE0042000, None, 0),
}


class Registers:
    """Keeps what is written."""

    def __init__(self, part):
        self.part, self.core, self.words = part, part.core, defaultdict(int)

    def read(self, offset):
        return self.words[offset]

    def write(self, offset, value):
        before, self.words[offset] = self.words[offset], value
        self.written(offset, before, value)

    def written(self, offset, before, value):
        pass


class Rcc(Registers):
    REASONS = {"power": 0b0110 << 25, "pin": 1 << 26, "software": 1 << 28 | 1 << 26, "watchdog": 1 << 29 | 1 << 26}

    def __init__(self, part):
        super().__init__(part)
        self.words |= {0x00: 0x81, 0x04: 0x24003010, 0x30: 0x100000, 0x74: self.REASONS[part.reason]}
        self.since = None

    def read(self, offset):
        value = self.words[offset]
        if offset == 0x00:
            crystal = self.since is not None and self.core.now - self.since > START_NS and self.part.bench.crystal
            pll = value >> 24 & 1 and (crystal or not self.words[0x04] >> 22 & 1)
            return value & ~0x02020002 | value << 1 & 2 | crystal << 17 | pll << 25
        if offset == 0x08:
            return value & ~0xC | value << 2 & 0xC
        return value & ~2 | value << 1 & 2 if offset == 0x74 else value

    def written(self, offset, before, value):
        if offset == 0x00 and (before ^ value) >> 16 & 1:
            self.since = self.core.now if value >> 16 & 1 else None
        if offset == 0x74 and value >> 24 & 1:
            self.words[0x74] &= 0x00FFFFFF
        if offset in (0x00, 0x04, 0x08):
            self.core.hz = self.hz()
            self.core.deadline = 0.0

    def hz(self):
        source = self.words[0x08] & 3
        return (16_000_000, CRYSTAL, self.pll(self.words[0x04] >> 16 & 3) // 1)[source]

    def pll(self, p):
        word = self.words[0x04]
        entry = CRYSTAL if word >> 22 & 1 else 16_000_000
        return entry // (word & 63) * (word >> 6 & 511) // (2 * p + 2)

    def bus(self, first_bit):
        """A peripheral bus' clock, and its divider."""
        code = self.words[0x08] >> first_bit & 7
        divider = 1 if code < 4 else 2 << (code - 4)
        return self.hz() // divider, divider

    def timer_hz(self):
        clock, divider = self.bus(10)
        return clock * (1 if divider == 1 else 2)

    def spi_hz(self):
        return self.bus(13)[0]

    def port_hz(self):
        return self.bus(13)[0]


class Timer(Registers):
    """TIM5: an update, and four compares. It is the clock of the events' ticks."""

    began, LINE, HAS_TICKS = None, 50, True

    def hz(self):
        return self.part.rcc.timer_hz() / (self.words[0x28] + 1)

    def count(self):
        return 0 if self.began is None else int((self.core.now - self.began) * self.hz() / 1e9 + 1e-3)

    def period(self):
        return self.words[0x2C] + 1

    def read(self, offset):
        return self.count() % self.period() if offset == 0x24 else self.words[offset]

    def written(self, offset, before, value):
        if offset == 0x10:
            self.words[offset] = before & value
        elif offset == 0x14:
            self.words[0x10] |= 0 if self.words[0x00] >> 2 & 1 else 1
            self.began = self.began and self.core.now
        elif offset == 0x00 and value & 1 and self.began is None:
            self.began = self.core.now
            if self.HAS_TICKS:
                self.part.bench.ticks_begin()
            for channel in range(5):
                self.compare(channel)
        elif 0x34 <= offset <= 0x40:
            self.compare((offset - 0x30) // 4)
        self.update()

    def compare(self, channel):
        """Channel 0 is the update."""
        if self.began is None:
            return
        value = self.words[0x30 + 4 * channel] if channel else 0
        count = self.count()
        ahead = (value - count) % self.period() or self.period()

        def reached():
            if channel and self.words[0x30 + 4 * channel] != value:
                return
            self.words[0x10] |= 1 << channel
            self.update()
            self.compare(channel)

        self.core.at(self.began + (count + ahead) * 1e9 / self.hz(), reached)

    def update(self):
        self.core.line(self.LINE, self.words[0x10] & self.words[0x0C] & 0x1F != 0)


class Tim2(Timer):
    LINE, HAS_TICKS = 28, False


class Tim3(Timer):
    LINE, HAS_TICKS = 29, False


class Tim4(Timer):
    LINE, HAS_TICKS = 30, False


class Watchdog(Registers):
    bite = None

    def written(self, offset, before, value):
        if offset != 0:
            return
        if value == 0xCCCC or value == 0xAAAA and self.bite:
            if self.bite:
                self.bite[2] = None
            ns = (4 << self.words[4]) * (self.words[8] + 1) / LOW_HZ * 1e9
            self.bite = self.core.after(ns, self.over)

    def over(self):
        raise Reset("watchdog")


class Random(Registers):
    def read(self, offset):
        if offset == 4:
            return self.words[0] >> 2 & 1
        return self.part.bench.random() if offset == 8 else self.words[offset]


class Gpio(Registers):
    def __init__(self, part, name):
        super().__init__(part)
        self.name, self.level = name, 0

    def read(self, offset):
        return self.level if offset == 0x10 else self.words[offset]

    def written(self, offset, before, value):
        if offset == 0x18:
            self.words[0x14] = (self.words[0x14] | value & 0xFFFF) & ~(value >> 16)
        port, pin = self.part.SELECT
        if self.name == port and self.words[0] >> 2 * pin & 3 == 1:
            self.part.bench.select(not self.words[0x14] >> pin & 1)

    def does(self, pin, function):
        """Whether a pin has this alternate function."""
        chosen = self.words[0x20 + pin // 8 * 4] >> pin % 8 * 4 & 15
        return self.words[0] >> 2 * pin & 3 == 2 and chosen == function


class Exti(Registers):
    MASK, RISES, FALLS, PENDING = 0x00, 0x08, 0x0C, 0x14

    def written(self, offset, before, value):
        if offset == self.PENDING:
            self.words[offset] = before & ~value
        self.update()

    def edge(self, port, pin, rises):
        chosen = self.part.named["SYSCFG"].words[0x08 + pin // 4 * 4] >> pin % 4 * 4 & 15
        if "ABCDEFGHI"[chosen] == port and self.words[self.RISES if rises else self.FALLS] >> pin & 1:
            self.words[self.PENDING] |= 1 << pin
            self.update()

    def update(self):
        active = self.words[self.PENDING] & self.words[self.MASK]
        for line in range(5):
            self.core.line(6 + line, active >> line & 1 == 1)
        self.core.line(23, active >> 5 & 0x1F != 0)
        self.core.line(40, active >> 10 & 0x3F != 0)


class NoDma(Registers):
    """A controller none of whose requests is modelled."""

    def written(self, offset, before, value):
        if offset >= 0x10 and (offset - 0x10) % 0x18 == 0 and value & 1:
            self.part.missing("a stream of this DMA controller")


class Dma(Registers):
    """A controller's streams: bytes, between memory and one register."""

    LINES = (56, 57, 58, 59, 60, 68, 69, 70)

    def stream(self, request):
        """The stream that is on for this request, or None."""
        for stream in range(8):
            control = self.words[0x10 + 0x18 * stream]
            if control & 1 and self.request(stream, control) == request:
                return stream
        return None

    def request(self, stream, control):
        return REQUESTS.get((stream, control >> 25 & 7))

    def memory(self, stream):
        return self.words[0x1C + 0x18 * stream], self.words[0x14 + 0x18 * stream]

    def bytes(self, stream):
        """What it reads; None, and an error, if it does not reach that memory."""
        address, length = self.memory(stream)
        if self.part.reaches(address, length):
            return bytes(self.core.uc.mem_read(address, length))
        self.fail(stream)
        return None

    def fail(self, stream):
        self.words[0x10 + 0x18 * stream] &= ~1
        self.flag(stream, 0b1000)

    def done(self, stream, left=0):
        self.words[0x14 + 0x18 * stream] = left
        self.words[0x10 + 0x18 * stream] &= ~1
        self.flag(stream, 0b100000)

    def flag(self, stream, bits):
        self.words[stream // 4 * 4] |= bits << (0, 6, 16, 22)[stream % 4]
        self.update()

    def written(self, offset, before, value):
        if offset in (0x08, 0x0C):
            self.words[offset - 8] &= ~value
        stream, register = divmod(offset - 0x10, 0x18)
        if offset >= 0x10 and register == 0:
            if value & 1 and not before & 1:
                if self.request(stream, value) is None or value & (PLAIN | FANCY) != PLAIN:
                    self.part.missing(f"what stream {stream} does with control {value:#x}")
                self.part.moved()
            elif before & 1 and not value & 1:
                self.part.stopped(stream)
                self.flag(stream, 0b100000)
        self.update()

    def update(self):
        for stream, line in enumerate(self.LINES):
            flags = self.words[stream // 4 * 4] >> (0, 6, 16, 22)[stream % 4]
            control = self.words[0x10 + 0x18 * stream]
            asked = (control >> 4 & 1) << 5 | (control >> 3 & 1) << 4 | (control >> 2 & 1) << 3
            self.core.line(line, flags & asked != 0)


class Spi(Registers):
    """By DMA, both ways or sending; on an STM32F405 also byte by byte."""

    running, DATA = None, 0x0C
    waiting, moves, received, is_overrun = None, False, None, False

    def read(self, offset):
        if offset == 8:
            is_busy = self.running is not None or self.moves
            flags = (self.received is not None) | (self.waiting is None) << 1 | self.is_overrun << 6
            return flags | is_busy << 7
        if offset == self.DATA:
            value, self.received, self.is_overrun = self.received or 0, None, False
            return value
        return self.words[offset]

    def written(self, offset, before, value):
        if offset == self.DATA:
            self.byte(value & 0xFF)
        self.part.moved()

    def byte(self, value):
        if self.DATA != 0x0C or not self.words[0] >> 6 & 1 or self.words[4] & 3:
            self.part.missing("a byte that goes to SPI while it is off, or has DMA")
        elif self.waiting is not None:
            self.part.missing("a byte for SPI that replaces the one before")
        else:
            self.waiting = value
            self.clocks()

    def clocks(self):
        """Moves the byte that waits."""
        if self.moves or self.waiting is None:
            return
        part, sent = self.part, bytes([self.waiting])
        part.wired(part.SCK, part.MOSI, part.MISO)
        self.waiting, self.moves = None, True

        def done(read):
            self.moves = False
            if self.received is None:
                self.received = read[0]
            else:
                self.is_overrun = True
            self.clocks()

        part.bench.transfer(sent, part.rcc.spi_hz() / self.divider(), self.pull(), done)

    def pull(self):
        port, pin, _ = self.part.MISO
        return {1: "up", 2: "down"}.get(self.part.named["GPIO" + port].words[0x0C] >> 2 * pin & 3, "none")

    def is_on(self):
        return self.words[0] >> 6 & 1 and self.words[4] & 2

    def receives(self):
        return self.words[4] & 1

    def divider(self):
        return 2 << (self.words[0] >> 3 & 7)

    def go(self):
        part, dma = self.part, self.part.dma
        into, out = dma.stream("SPI_RX"), dma.stream("SPI_TX")
        receives = self.receives()
        if self.running or not self.is_on() or receives and into is None or out is None:
            return
        pull = self.pull()
        part.wired(part.SCK, part.MOSI, *([part.MISO] if receives else []))
        sent = dma.bytes(out)
        if receives:
            place, length = dma.memory(into)
            if sent is None or not part.reaches(place, length):
                return dma.fail(into)
        if sent is None:
            return

        def done(read):
            self.running = None
            dma.done(out)
            if receives:
                self.core.uc.mem_write(place, read)
                dma.done(into)

        self.streams = (into, out)
        self.running = part.bench.transfer(sent, part.rcc.spi_hz() / self.divider(), pull, done)

    def stop(self, stream):
        if self.running and stream in self.streams:
            self.running[2], self.running = None, None


class Usart(Registers):
    """Its sending half: a byte in its register while the one before leaves. On an STM32F405 also without DMA."""

    stream, free, DATA = None, 0.0, 0x04
    waiting, moves = None, False

    def read(self, offset):
        if offset == 0:
            return (self.waiting is None) << 7 | (self.waiting is None and not self.moves) << 6
        return self.words[offset]

    def written(self, offset, before, value):
        if offset == self.DATA:
            self.byte(value & 0xFF)
        self.part.moved()

    def byte(self, value):
        if self.DATA != 0x04 or self.words[0x0C] & 0x2008 != 0x2008 or self.words[0x14] >> 7 & 1:
            self.part.missing("a byte that goes to the serial port while it is off, or has DMA")
        elif self.waiting is not None:
            self.part.missing("a byte for the serial port that replaces the one before")
        else:
            self.waiting = value
            self.leaves()

    def leaves(self):
        """Sends the byte that waits."""
        if self.moves or self.waiting is None:
            return
        self.part.wired(self.part.TX)
        took = self.part.bench.send(self.waiting, self.part.rcc.port_hz() / self.divider())
        self.waiting, self.moves = None, True

        def left():
            self.moves = False
            self.leaves()

        self.core.after(took, left)

    def is_on(self):
        return self.words[0x0C] & 0x2008 == 0x2008 and self.words[0x14] >> 7 & 1

    def divider(self):
        return self.words[8]

    def go(self):
        dma = self.part.dma
        stream = dma.stream("TX")
        if self.stream is not None or not self.is_on() or stream is None:
            return
        self.part.wired(self.part.TX)
        self.bytes, self.sent = dma.bytes(stream), 0
        if self.bytes is not None:
            self.stream = stream
            self.core.at(max(self.free, self.core.now), self.next)

    def next(self):
        if self.stream is None:
            return
        took = self.part.bench.send(self.bytes[self.sent], self.part.rcc.port_hz() / self.divider())
        self.sent, self.free = self.sent + 1, self.core.now + took
        if self.sent < len(self.bytes):
            self.core.at(self.free, self.next)
            return
        stream, self.stream = self.stream, None
        self.part.dma.done(stream)

    def stop(self, stream):
        if stream == self.stream:
            self.stream = None


class Part:
    MEMORIES, MODEL, PLACES = MEMORIES, UC_CPU_ARM_CORTEX_M4, PLACES
    KINDS = {"TIM2": Tim2, "TIM3": Tim3, "TIM4": Tim4, "TIM5": Timer, "IWDG": Watchdog, "USART6": Usart, "SPI1": Spi, "EXTI": Exti, "RCC": Rcc, "DMA1": NoDma, "DMA2": Dma, "RNG": Random, "GPIO": Gpio}
    SPI, PORT, DMA, HAS_BITS = "SPI1", "USART6", "DMA2", True
    # The wires: port, pin, alternate function.
    SCK, MISO, MOSI, TX = ("A", 5, 5), ("A", 6, 5), ("A", 7, 5), ("C", 6, 8)
    SELECT, READY = ("A", 4), ("C", 4)
    REACHED = ((0x20000000, 0x20020000), (0x08000000, 0x08100000))

    def __init__(self):
        self.core = Core(self.MEMORIES, self.MODEL)
        for base in sorted({place & ~0xFFF for place, _, _ in self.PLACES.values()}):
            self.core.bus(base, 0x1000, Window(self, base))
        if self.HAS_BITS:
            self.core.bus(0x42000000, 0x02000000, Bits(self))

    def reset(self, bench, reason):
        self.bench, self.reason, self.named = bench, reason, {}
        for name in self.PLACES:
            is_port = name.startswith("GPIO")
            self.named[name] = self.KINDS["GPIO"](self, name[4:]) if is_port else self.KINDS.get(name, Registers)(self)
        self.rcc, self.dma = self.named["RCC"], self.named[self.DMA]
        self.core.hz = self.rcc.hz()
        self.places = {place: (name, register, bit) for name, (place, register, bit) in self.PLACES.items()}
        bench.pin = self.pin

    def pauses_on_halt(self):
        """Whether the watchdog stands still while a debugger halts the core: DBG_IWDG_STOP."""
        return bool(self.named["DBGMCU"].words[8] >> 12 & 1)

    def pin(self, level):
        port, pin = self.READY
        self.named["GPIO" + port].level = level << pin
        self.named["EXTI"].edge(port, pin, level)

    def find(self, address):
        name, register, bit = self.places.get(address & ~0x3FF, ("", None, 0))
        if not name or register and not self.rcc.words[register] >> bit & 1:
            self.core.raise_later(LookupError(f"nothing at {address:#x}, or without a clock: {name}"))
            return Registers(self)
        return self.named[name]

    def wired(self, *pins):
        for port, pin, function in pins:
            if not self.named["GPIO" + port].does(pin, function):
                self.core.raise_later(LookupError(f"P{port}{pin} is not the peripheral's"))

    def missing(self, what):
        """Ends the run: the firmware asks for what a board has and this does not."""
        self.core.raise_later(LookupError(f"nothing models {what}"))

    def moved(self):
        """A stream or a peripheral was turned on."""
        self.named[self.SPI].go()
        self.named[self.PORT].go()

    def stopped(self, stream):
        self.named[self.SPI].stop(stream)
        self.named[self.PORT].stop(stream)

    def reaches(self, address, length):
        """Whether DMA reaches this memory."""
        return any(start <= address <= end - length for start, end in self.REACHED)


class Window:
    """Peripherals of 1 KiB within a page."""

    def __init__(self, part, base):
        self.part, self.base = part, base

    def read(self, offset):
        return self.part.find(self.base + offset).read(offset & 0x3FF)

    def write(self, offset, value):
        self.part.find(self.base + offset).write(offset & 0x3FF, value)


class Bits:
    """A Cortex-M4's bit band: a word for each bit of the peripherals, of which a write reads and writes the register."""

    def __init__(self, part):
        self.part = part

    def place(self, offset):
        address = 0x40000000 + offset // 32 & ~3
        return self.part.find(address), address & 0x3FF, offset // 4 & 31

    def read(self, offset):
        one, register, bit = self.place(offset)
        return one.read(register) >> bit & 1

    def write(self, offset, value):
        one, register, bit = self.place(offset)
        one.write(register, one.read(register) & ~(1 << bit) | (value & 1) << bit)
