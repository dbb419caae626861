"""A Crazyflie 2.1: an STM32F405 behind a bootloader, and its sensor on I2C (RM0090, chapter 27)."""

import stm32f405 as f4

VECTORS, ENTRY = 0x08000000, 0x08004000  # the bootloader's, and the image's, which it starts
REQUESTS = {(2, 3): "I2C_RX", (4, 3): "I2C_TX", (6, 4): "TX"}  # of DMA1: RM0090, table 42
MOTORS = (("A", 15), ("A", 1), ("B", 11), ("B", 9))
START, ADDRESSED, FINISHED = 1 << 0, 1 << 1, 1 << 2  # of SR1: SB, ADDR, BTF
LOST, REFUSED = 1 << 9, 1 << 10  # ARLO, AF


class Dma(f4.Dma):
    LINES = (11, 12, 13, 14, 15, 16, 17, 47)

    def request(self, stream, control):
        return REQUESTS.get((stream, control >> 25 & 7))


class Usart(f4.Usart):
    """USART2, on the slow bus. By the first frame the motors are held still."""

    def go(self):
        super().go()
        if self.stream is not None and not all(self.part.named["GPIO" + port].holds_low(pin) for port, pin in MOTORS):
            self.core.raise_later(LookupError("a motor's pin is not held low"))

    def divider(self):
        return self.words[8] * self.part.rcc.bus(13)[0] / self.part.rcc.bus(10)[0]


class I2c(f4.Registers):
    """I2C3 as a master, with DMA. SDA that is held low lets no transfer begin, and takes one from the master."""

    is_master = is_open = is_reading = False
    moving = None

    def bit(self):
        word = self.words[0x1C]
        divider = (25 if word >> 14 & 1 else 3) if word >> 15 else 2
        return 1e9 * divider * (word & 0xFFF) / self.part.rcc.bus(10)[0]

    def read(self, offset):
        if offset != 0x18:
            return self.words[offset]
        if self.words[0x14] & ADDRESSED:
            self.words[0x14] &= ~ADDRESSED
            self.is_open = True
            self.update()
            self.go()
        return self.is_master | self.is_master << 1 | (not self.is_reading) << 2

    def written(self, offset, before, value):
        if offset == 0x00 and value >> 15 & 1:
            self.words[0x14], self.is_master, self.is_open, self.moving = 0, False, False, None
        elif offset == 0x00:
            if value >> 8 & ~before >> 8 & 1:
                self.core.after(self.bit(), self.start)
            if value >> 9 & ~before >> 9 & 1:
                self.core.after(self.bit(), self.stop_condition)
        elif offset == 0x10 and self.words[0x14] & START:
            self.words[0x14] &= ~START
            self.core.after(9 * self.bit(), lambda: self.address(value))
        elif offset == 0x14:
            self.words[0x14] = before & (value | 0xFF)
        self.update()
        self.part.moved()

    def start(self):
        if not self.words[0] >> 8 & 1:
            return
        if self.part.bench.holds_low():
            self.core.after(10e3, self.start)
            return
        self.part.wired(self.part.SCL, self.part.SDA)
        self.words[0] &= ~(1 << 8)
        self.words[0x14] = self.words[0x14] & ~FINISHED | START
        self.is_master, self.is_open, self.moving = True, False, None
        self.part.bench.seen["spiHz"] = round(1e9 / self.bit())
        self.update()

    def stop_condition(self):
        if self.is_reading and self.is_open:
            self.core.after(self.bit(), self.stop_condition)  # after the byte that comes
            return
        self.words[0] &= ~(1 << 9)
        self.words[0x14] &= ~FINISHED
        self.is_master = self.is_open = False
        self.moving = None

    def address(self, byte):
        self.is_reading = bool(byte & 1)
        if self.part.bench.holds_low():
            return self.flag(LOST)
        self.flag(ADDRESSED if self.part.bench.acknowledges(byte) else REFUSED)

    def flag(self, bit):
        self.words[0x14] |= bit
        if bit == LOST:
            self.is_master = False
        if bit in (LOST, REFUSED):
            self.is_open, self.moving = False, None
        self.update()

    def update(self):
        flags, enabled = self.words[0x14], self.words[4]
        self.core.line(72, flags & 7 != 0 and enabled >> 9 & 1 == 1)
        self.core.line(73, flags & 0xDF00 != 0 and enabled >> 8 & 1 == 1)

    def go(self):
        dma = self.part.dma
        stream = dma.stream("I2C_RX" if self.is_reading else "I2C_TX")
        if not self.is_open or self.moving or not self.words[4] >> 11 & 1 or stream is None:
            return
        place, length = dma.memory(stream)
        sent = dma.bytes(stream)
        if sent is None:
            return
        move = self.moving = [stream]
        if not self.is_reading and length == 1:
            dma.done(stream)  # it has left the memory

        def byte(at):
            if self.moving is not move:
                return
            bench = self.part.bench
            if self.is_reading:
                self.core.uc.mem_write(place + at, bytes([bench.take()]))
            elif bench.holds_low():
                return self.flag(LOST)
            elif not bench.put(sent[at]):
                return self.flag(REFUSED)
            if at + 1 < length:
                self.core.after(9 * self.bit(), lambda: byte(at + 1))
                if not self.is_reading and at + 2 == length:
                    dma.done(stream)
                return
            self.moving, self.is_open = None, False
            if self.is_reading:
                dma.done(stream)
            else:
                self.flag(FINISHED)

        self.core.after(9 * self.bit(), lambda: byte(0))

    def stop(self, stream):
        if self.moving and self.moving[0] == stream and self.is_reading:
            self.moving = None


class Gpio(f4.Gpio):
    """The sensor's bus is pulled up on the board."""

    def holds_low(self, pin):
        return self.words[0] >> 2 * pin & 3 == 1 and not self.words[0x14] >> pin & 1

    def read(self, offset):
        value = super().read(offset)
        if offset != 0x10:
            return value
        for port, pin, _ in (self.part.SCL, self.part.SDA):
            is_driven = self.holds_low(pin)
            is_held = pin == self.part.SDA[1] and self.part.bench.holds_low()
            if port == self.name and not is_driven and not is_held:
                value |= 1 << pin
        return value


class Part(f4.Part):
    KINDS = f4.Part.KINDS | {"I2C3": I2c, "USART2": Usart, "DMA1": Dma, "DMA2": f4.NoDma, "GPIO": Gpio}
    SPI, PORT, DMA = "I2C3", "USART2", "DMA1"
    SCL, SDA, TX = ("A", 8, 4), ("C", 9, 4), ("A", 2, 7)
    SELECT, READY = ("", 0), ("C", 14)
    PLACES = f4.PLACES | {"USART2": (0x40004400, 0x40, 17), "I2C3": (0x40005C00, 0x40, 23)}

    def reset(self, bench, reason):
        super().reset(bench, reason)
        bench.seen["pulledUp"] = True
