"""An STM32H743's peripherals where they differ from an STM32F405's (RM0433), on a Matek H743. No caches, no MPU."""

import stm32f405 as f4
from unicorn.arm_const import UC_CPU_ARM_CORTEX_M7

VECTORS = 0x08000000
LINES = (11, 12, 13, 14, 15, 16, 17, 47)  # of DMA1's streams
REQUESTS = {37: "SPI_RX", 38: "SPI_TX", 42: "TX"}  # of DMAMUX1: RM0433, table 121


class Rcc(f4.Rcc):
    REASONS = {"power": 3 << 22, "pin": 1 << 22, "software": 1 << 24 | 1 << 22, "watchdog": 1 << 26 | 1 << 22}

    def __init__(self, part):
        f4.Registers.__init__(self, part)
        self.words |= {0x00: 0x01, 0x28: 0x02020200, 0x30: 0x01010280, 0xD0: self.REASONS[part.reason]}
        self.since = None

    def read(self, offset):
        value = self.words[offset]
        if offset == 0x00:
            crystal = self.since is not None and self.core.now - self.since > f4.START_NS and self.part.bench.crystal
            pll = value >> 24 & 1 and (crystal or self.words[0x28] & 3 != 2)
            others = (value & 0x01) << 2 | (value & 0x80) << 1 | (value & 0x1000) << 1
            return value & ~0x2A022104 | others | 0xC000 | crystal << 17 | bool(pll) << 25
        if offset == 0x10:
            return value & ~0x38 | value << 3 & 0x38
        return value & ~2 | value << 1 & 2 if offset == 0x74 else value

    def written(self, offset, before, value):
        if offset == 0x00 and (before ^ value) >> 16 & 1:
            self.since = self.core.now if value >> 16 & 1 else None
        if offset == 0x28 and self.words[0] >> 24 & 1:
            self.words[0x28] = before & 0x3F3 | value & ~0x3F3  # source and first divider hold while the first PLL is on
        if offset == 0xD0 and value >> 16 & 1:
            self.words[0xD0] = 0
        if offset in (0x00, 0x10, 0x18, 0x28, 0x30):
            self.core.hz = self.hz()
            self.core.deadline = 0.0

    def hz(self):
        source = self.words[0x10] & 7
        system = {0: 64_000_000, 1: 4_000_000, 2: f4.CRYSTAL}.get(source) or self.pll(9)
        return system // divided(self.words[0x18] >> 8 & 15, 8)

    def pll(self, first_bit):
        """An output of the first PLL: P from bit 9 on, Q from bit 16."""
        source = (64_000_000, 4_000_000, f4.CRYSTAL, 0)[self.words[0x28] & 3]
        dividers = self.words[0x30]
        vco = source // (self.words[0x28] >> 4 & 63 or 1) * ((dividers & 511) + 1)
        return vco // ((dividers >> first_bit & 127) + 1)

    def bus(self, first_bit):
        divider = divided(self.words[0x1C] >> first_bit & 7, 4)
        return self.hz() // divided(self.words[0x18] & 15, 8) // divider, divider

    def timer_hz(self):
        clock, divider = self.bus(4)
        return clock * (1 if divider == 1 else 2)

    def spi_hz(self):
        return self.pll(16)

    def port_hz(self):
        return self.bus(8)[0]


def divided(code, first):
    """A bus divider: 1 below the first code, then 2, 4, 8, 16, 64, 128, 256, 512."""
    return 1 if code < first else (2, 4, 8, 16, 64, 128, 256, 512)[code - first]


class Power(f4.Registers):
    """Its voltage is there at once."""

    def read(self, offset):
        return self.words[offset] | (1 << 13 if offset in (0x04, 0x18) else 0)


class Exti(f4.Exti):
    MASK, RISES, FALLS, PENDING = 0x80, 0x00, 0x04, 0x88


class Dma(f4.Dma):
    """DMA1 behind DMAMUX1."""

    LINES = LINES

    def request(self, stream, control):
        return REQUESTS.get(self.part.named["DMAMUX1"].words[4 * stream] & 127)


class Spi(f4.Spi):
    DATA = 0x20

    def read(self, offset):
        return self.words[offset] if offset != 0x14 else 2 if self.running else 0x1002

    def written(self, offset, before, value):
        if offset == 0x00 and value & 0x201 == 0x201:
            self.words[0] &= ~0x200
            self.asked = True
        super().written(offset, before, value)

    asked = False

    def is_on(self):
        return self.asked and self.words[0] & 1 and self.words[8] >> 15 & 1

    def receives(self):
        return self.words[8] >> 14 & 1

    def divider(self):
        return 2 << (self.words[8] >> 28 & 7)

    def go(self):
        super().go()
        if self.running:
            self.asked = False


class Usart(f4.Usart):
    DATA = 0x28

    def read(self, offset):
        return 0x6000C0 if offset == 0x1C else self.words[offset]

    def is_on(self):
        return self.words[0x00] & 9 == 9 and self.words[0x08] >> 7 & 1

    def divider(self):
        return self.words[0x0C]


class Part(f4.Part):
    MEMORIES = (
        (0x08000000, 0x200000),
        (0x20000000, 0x20000),  # DTCM
        (0x24000000, 0x80000),  # AXI SRAM
        (0x30000000, 0x20000),  # SRAM1
    )
    MODEL = UC_CPU_ARM_CORTEX_M7
    KINDS = {"TIM5": f4.Timer, "IWDG": f4.Watchdog, "USART1": Usart, "SPI1": Spi, "EXTI": Exti, "RCC": Rcc, "DMA1": Dma, "DMA2": f4.NoDma, "RNG": f4.Random, "PWR": Power, "GPIO": f4.Gpio}
    SPI, PORT, DMA, HAS_BITS = "SPI1", "USART1", "DMA1", False
    SCK, MISO, MOSI, TX = ("A", 5, 5), ("A", 6, 5), ("D", 7, 5), ("A", 9, 7)
    SELECT, READY = ("C", 15), ("B", 2)
    # Not the DTCM.
    REACHED = ((0x24000000, 0x24080000), (0x30000000, 0x30020000), (0x08000000, 0x08200000))
    PLACES = {
        "TIM5": (0x40000C00, 0xE8, 3),
        "CRS": (0x40008400, 0xEC, 1),
        "USART1": (0x40011000, 0xF0, 4),
        "SPI1": (0x40013000, 0xF0, 12),
        "DMA1": (0x40020000, 0xD8, 0),
        "DMA2": (0x40020400, 0xD8, 1),
        "DMAMUX1": (0x40020800, None, 0),
        "RNG": (0x48021800, 0xDC, 6),
        "FLASH": (0x52002000, None, 0),
        "EXTI": (0x58000000, None, 0),
        "SYSCFG": (0x58000400, 0xF4, 1),
        "IWDG": (0x58004800, None, 0),
        **{f"GPIO{name}": (0x58020000 + 0x400 * at, 0xE0, at) for at, name in enumerate("ABCDEFGHIJK")},
        "RCC": (0x58024400, None, 0),
        "PWR": (0x58024800, None, 0),
        "DBGMCU": (0x5C001000, None, 0),
    }

    def pauses_on_halt(self):
        """DBG_IWDG1 of APB4FZ1."""
        return bool(self.named["DBGMCU"].words[0x54] >> 18 & 1)
