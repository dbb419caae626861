"""The board in the loop: QEMU's STM32F405 flies, sample by sample, and must have the laptop's bits.

`board.py IMAGE` starts the emulator and flies a short manoeuvre, with frames lost, on what the board commands. The board
encodes the registers, hears the frames and runs the cascade; so does the laptop beside it. Both take turns: neither has a
clock that the other could miss.
"""

from __future__ import annotations

import struct
import subprocess
import sys

import numpy as np

import flight
from codes import Coded, schemes
from control import Control
from manoeuvres import Manoeuvre, flip, steps

#: The board's first word: a port that is not yet on hears nothing.
READY = b"!"
#: The last word to the board.
END = b"\xff"


class Board:
    """The emulated board at the other end of a pair of pipes."""

    def __init__(self, image: str):
        machine = ["-M", "netduinoplus2", "-nographic", "-monitor", "none", "-serial", "stdio", "-icount", "shift=4"]
        target = ["-semihosting-config", "enable=on,target=native", "-kernel", image]
        self._process = subprocess.Popen(
            ["qemu-system-arm", *machine, *target], stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )

        if self._take(1) != READY:
            raise SystemExit("the board is not ready")

    def _take(self, count: int) -> bytes:
        data = self._process.stdout.read(count)
        if len(data) != count:
            raise SystemExit(f"the board ended: {data!r}")
        return data

    def step(self, counts, wanted, thrust: float, turn: float, lost: int):
        """A sample: the frames that the board makes of it, what it hears, and the speeds it commands."""
        self._process.stdin.write(struct.pack("<B6h6f", lost, *counts, *wanted, thrust, turn))
        self._process.stdin.flush()
        frames = []
        while length := struct.unpack("<H", self._take(2))[0]:
            frames.append(self._take(length))
        values = np.frombuffer(self._take(40), dtype="<f4")
        return frames, values[:6], values[6:]

    def end(self) -> str:
        """Ends the board, and returns what it says of itself."""
        said, _ = self._process.communicate(END, timeout=60)
        if self._process.returncode:
            raise SystemExit(f"the board failed: {said!r}")
        return said.decode().strip()


class Beside(Coded):
    """The laptop's chain, whose frames and losses are kept for the board."""

    def carry(self, sample, is_lost):
        """What the cascade hears; no keyframe's frame is spared."""
        self.lost, self.frames = 0, []

        def noted():
            is_gone = bool(is_lost())
            self.lost |= is_gone << len(self.frames)
            return is_gone

        return super().carry(sample, noted)

    def send(self, sample):
        """The frames of a sample, kept once their fate is known."""
        for frame in super().send(sample):
            yield frame
            self.frames.append(frame.content)


class Both(Control):
    """The laptop's cascade beside the board's, which flies."""

    def __init__(self, rate, board, path, registers):
        super().__init__(rate)
        self.board, self.path, self.registers, self.samples = board, path, registers, 0

    def step(self, sample, wanted, thrust, feed=(0.0, 0.0, 0.0)):
        """The board's speeds; an error where a bit differs."""
        own = np.array(super().step(sample, wanted, thrust, feed), dtype="<f4")
        frames, heard, speeds = self.board.step(self.registers(), wanted, thrust, feed[0], self.path.lost)
        for what, ours, theirs in [
            ("frames", b"".join(self.path.frames), b"".join(frames)),
            ("values", np.array(sample, "<f4").tobytes(), heard.tobytes()),
            ("speeds", own.tobytes(), speeds.tobytes()),
        ]:
            if ours != theirs:
                raise SystemExit(f"sample {self.samples}: other {what}: {ours.hex(' ')}, the board {theirs.hex(' ')}")
        self.samples += 1
        return [float(speed) for speed in speeds]


def main(image: str) -> None:
    board, path, last = Board(image), Beside(schemes("sod")), []
    read = flight.Sensor.read

    def registers(sensor, felt):
        last[:] = [read(sensor, felt)]
        return last[0]

    flight.Sensor.read = registers
    both = Both(flight.RATE, board, path, lambda: last[0])
    manoeuvre = Manoeuvre("steps and a flip", 2.5, lambda time: steps(20)(time + 0.2) if time < 0.9 else flip(time - 0.9))
    flown = flight.fly(manoeuvre, path, seed=1, loss=0.02, control=both)
    said = board.end()
    if flown.lost or path.receiver.lost == 0:
        raise SystemExit(f"not the flight that was meant: {flown.errors.max():.0f}°, {path.receiver.lost} frames lost")
    print(
        f"{both.samples} samples, {path.receiver.lost} frames lost, mean error {flown.errors.mean():.2f}°: frames, values and "
        f"speeds of the board are the laptop's, bit for bit. It says: {said}"
    )


if __name__ == "__main__":
    main(sys.argv[1])
