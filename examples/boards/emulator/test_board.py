"""Small images for the emulated STM32F405: what is modelled works, and what is not ends the run.

    python test_board.py
"""

import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

FLASH, HANDLER = 0x08000000, 0x08000200
RCC, GPIOA, GPIOC, SPI1, DMA1, DMA2 = 0x40023800, 0x40020000, 0x40020800, 0x40013000, 0x40026000, 0x40026400
USART6, TIM2 = 0x40011400, 0x40000000
LIKE_SPI = (
    (RCC + 0x30, 1 << 0 | 1 << 21 | 1 << 22),  # GPIOA, DMA1, DMA2
    (RCC + 0x44, 1 << 5 | 1 << 12),  # USART6, SPI1
    (GPIOA + 0x00, 0xA900),  # PA4 is an output, PA5 to PA7 are SPI1's
    (GPIOA + 0x20, 0x55500000),
)
# PC6 is USART6's, which sends at 1 Mbaud.
LIKE_PORT = (
    (RCC + 0x30, 1 << 2),
    (RCC + 0x44, 1 << 5),
    (GPIOC + 0x00, 2 << 12),
    (GPIOC + 0x20, 8 << 24),
    (USART6 + 0x08, 16),
    (USART6 + 0x0C, 0x2008),
)
SENDS = 3 << 25 | 1 << 10 | 1 << 6 | 1 << 4 | 1  # of a stream: channel 3, MINC, from memory, TCIE, EN


def enables(irq):
    return 0xE000E100 + irq // 32 * 4, 1 << irq % 32


def stream(control):
    """Four bytes of flash through stream 3 of DMA2."""
    return (DMA2 + 0x5C, 4), (DMA2 + 0x64, FLASH), (DMA2 + 0x58, control)


def image(writes, handled):
    """An ELF file without symbols: writes these words to these addresses, then sleeps; one interrupt has a handler."""
    code = bytearray(0x400)
    struct.pack_into("<II", code, 0, 0x20001000, FLASH + 0x300 | 1)
    struct.pack_into("<I", code, 4 * (16 + handled), HANDLER | 1)
    struct.pack_into("<H", code, 0x200, 0x4770)  # bx lr
    # ldr r0, =table; 1: ldm r0!, {r1, r2}; cbz r1, 2f; str r2, [r1]; b 1b; 2: wfi; b 2b
    struct.pack_into("<8H", code, 0x300, 0x4803, 0xC806, 0xB109, 0x600A, 0xE7FB, 0xBF30, 0xE7FD, 0)
    struct.pack_into("<I", code, 0x310, FLASH + 0x400)
    code += b"".join(struct.pack("<II", *one) for one in writes) + bytes(8)
    header = struct.pack("<16s2H5I6H", b"\x7fELF\1\1\1", 2, 40, 1, FLASH + 0x301, 52, 0, 0, 52, 32, 1, 0, 0, 0)
    return header + struct.pack("<8I", 1, 84, FLASH, FLASH, len(code), len(code), 5, 4) + code


def run(writes, handled=0):
    """What the board says, and how often the handler ran."""
    with tempfile.TemporaryDirectory() as directory:
        place = pathlib.Path(directory)
        (place / "image").write_bytes(image(writes, handled))
        board = pathlib.Path(__file__).with_name("board.py")
        words = [sys.executable, board, "stm32f405", place / "image", "icm42688p", "0.01", place]
        done = subprocess.run(words, capture_output=True, text=True, check=True)
        executed = dict(line.split(",")[:2] for line in (place / "executed").read_text().splitlines())
        assert (place / "log").read_bytes() == b""
        return json.loads(done.stdout), int(executed.get(str(HANDLER), 0))


class Board(unittest.TestCase):
    def test_an_image_without_rtt_runs(self):
        seen, _ = run([])
        self.assertIsNone(seen["fault"])
        self.assertGreater(seen["instructions"], 0)

    def test_software_triggers_an_interrupt(self):
        self.assertEqual(run([(0xE000EF00, 50), enables(50)], 50)[1], 1)
        self.assertEqual(run([enables(50), (0xE000EF00, 50)], 50)[1], 1)
        self.assertEqual(run([(0xE000EF00, 50)], 50)[1], 0)

    def test_a_byte_goes_out_of_spi_and_serial_port_without_dma(self):
        seen, _ = run([*LIKE_SPI, (SPI1, 1 << 6), (SPI1 + 0x0C, 0x55)])
        self.assertEqual(seen["spiHz"], 8_000_000)
        seen, _ = run([*LIKE_PORT, (USART6 + 0x04, 0x55)])
        self.assertEqual(seen["baud"], 1_000_000)

    def test_a_bit_has_a_word_of_its_own(self):
        bit = lambda register, bit: 0x42000000 + (register - 0x40000000) * 32 + bit * 4
        timer = [(bit(RCC + 0x40, 0), 1), (TIM2 + 0x2C, 999), (bit(TIM2 + 0x0C, 0), 1), (bit(TIM2, 0), 1)]
        self.assertGreater(run([*timer, enables(28)], 28)[1], 0)
        self.assertEqual(run([*timer, (bit(TIM2 + 0x0C, 0), 0), enables(28)], 28)[1], 0)

    def test_a_timer_interrupts(self):
        timer = [(RCC + 0x40, 1), (TIM2 + 0x2C, 999), (TIM2 + 0x0C, 1), (TIM2, 1)]
        self.assertGreater(run([*timer, enables(28)], 28)[1], 0)
        self.assertEqual(run(timer, 28)[1], 0)

    def test_dma_that_only_sends_clocks_its_bytes(self):
        for cr2, cr1 in [(2, 1 << 6 | 1 << 2), (2, 1 << 6 | 1 << 2 | 1 << 3)]:
            spi = ((SPI1 + 4, cr2), (SPI1, cr1))
            for writes in [(*stream(SENDS), *spi), (*spi, *stream(SENDS))]:
                seen, handled = run([*LIKE_SPI, enables(59), *writes], 59)
                # An interrupt whose flag nobody clears comes again and again.
                self.assertGreater(handled, 0)
                self.assertEqual(seen["spiHz"], 16_000_000 // (4 if cr1 & 8 else 2))

    def test_what_nothing_models_ends_the_run(self):
        for writes, words in [
            ([(0xE000E010, 7)], "nothing models SysTick"),
            ([(0xE000ED04, 1 << 28)], "nothing models a system exception"),
            ([*LIKE_SPI, (SPI1 + 0x0C, 0x55)], "nothing models a byte that goes to SPI while it is off, or has DMA"),
            ([*LIKE_SPI, (SPI1, 1 << 6), *3 * [(SPI1 + 0x0C, 0x55)]], "nothing models a byte for SPI that replaces the one before"),
            (
                [*LIKE_SPI, (USART6 + 0x04, 0x55)],
                "nothing models a byte that goes to the serial port while it is off, or has DMA",
            ),
            (
                [*LIKE_PORT, *3 * [(USART6 + 0x04, 0x55)]],
                "nothing models a byte for the serial port that replaces the one before",
            ),
            ([*LIKE_SPI, *stream(SENDS & ~(7 << 25))], "nothing models what stream 3 does with control 0x451"),
            ([*LIKE_SPI, *stream(SENDS | 1 << 8)], "nothing models what stream 3 does with control 0x6000551"),
            ([*LIKE_SPI, *stream(SENDS & ~(1 << 10))], "nothing models what stream 3 does with control 0x6000051"),
            ([*LIKE_SPI, (DMA1 + 0x10, 1)], "nothing models a stream of this DMA controller"),
            ([(SPI1, 1)], "nothing at 0x40013000, or without a clock: SPI1"),
            ([(0x40000000, 1)], "nothing at 0x40000000, or without a clock: TIM2"),
            ([(0x40003400, 1)], "nothing at 0x40003400, or without a clock: "),
        ]:
            with self.subTest(words):
                self.assertRegex(run(writes)[0]["fault"], f"^{words} at 0x[0-9a-f]+$")

    def test_an_address_where_nothing_is_ends_the_run_and_is_named(self):
        seen, _ = run([(0x40001000, 1)])
        self.assertRegex(seen["fault"], "nothing is at 0x40001000$")


if __name__ == "__main__":
    unittest.main()
