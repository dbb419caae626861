"""A Cortex-M4F around Unicorn: time, interrupts, sleep and the peripherals' bus.

Unicorn executes the instructions. Here are the NVIC, exceptions' entry and return, WFE and SEV, and time: one cycle an
instruction, without the flash's wait states. What nothing models faults.
"""

import heapq
import struct

from unicorn import UC_ARCH_ARM, UC_HOOK_BLOCK, UC_HOOK_CODE, UC_HOOK_MEM_INVALID, UC_MODE_MCLASS, UC_MODE_THUMB, Uc
from unicorn import arm_const as arm

LOOP = 0x60000000  # a page of ours, with `b .`
RETURN = LOOP + 4  # where exceptions return to, in place of the architecture's 0xFFFFFFF9
FRAME = (arm.UC_ARM_REG_R0, arm.UC_ARM_REG_R1, arm.UC_ARM_REG_R2, arm.UC_ARM_REG_R3, arm.UC_ARM_REG_R12, arm.UC_ARM_REG_LR)
SYSTEM = 0xE000E000
# The bits that begin what is not modelled: SysTick's, and those that pend an NMI, a PendSV or a SysTick.
MISSING = {0x010: ("SysTick", 1), 0xD04: ("a system exception", 1 << 31 | 1 << 28 | 1 << 26)}
WFE, WFI, SEV = 0xBF20, 0xBF30, 0xBF40
POLLS, CLOSE = 16, 20  # so many reads of one register, each so few instructions after the last, are a loop


class Reset(Exception):
    """Ends what runs; its argument is the reason."""


def segments(elf):
    """The loadable segments of an ELF file: physical address, bytes."""
    table, (size, count) = struct.unpack_from("<I", elf, 28)[0], struct.unpack_from("<HH", elf, 42)
    for at in range(table, table + size * count, size):
        kind, offset, _, address, length = struct.unpack_from("<5I", elf, at)
        if kind == 1 and length > 0:
            yield address, elf[offset : offset + length]


def symbol(elf, name):
    """The address of a symbol, or None."""
    table, (size, count) = struct.unpack_from("<I", elf, 32)[0], struct.unpack_from("<HH", elf, 46)
    for at in (table + size * one for one in range(count)):
        if struct.unpack_from("<I", elf, at + 4)[0] != 2:
            continue
        offset, length, link = struct.unpack_from("<3I", elf, at + 16)
        names = struct.unpack_from("<I", elf, table + link * size + 16)[0]
        for entry in range(offset, offset + length, 16):
            start, value = struct.unpack_from("<II", elf, entry)
            if elf[names + start : elf.index(0, names + start)] == name:
                return value
    return None


class Core:
    """The processor. Peripherals are objects with `read(offset)` and `write(offset, value)`, times are ns."""

    def __init__(self, memories, model):
        self.uc = Uc(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS)
        self.uc.ctl_set_cpu_model(model)
        for address, size in (*memories, (LOOP, 0x1000)):
            self.uc.mem_map(address, size)
        self.uc.mem_write(LOOP, b"\xfe\xe7")
        self.now, self.instructions, self.hz = 0.0, 0, 0
        self.events, self.order = [], 0
        self.blocks, self.fault = {}, None
        self.uc.hook_add(UC_HOOK_BLOCK, self.block)
        self.touched = None  # what nothing is at
        self.uc.hook_add(UC_HOOK_MEM_INVALID, self.invalid)
        self.bus(SYSTEM, 0x1000, self)

    def load(self, elf, vectors, entry):
        for address, code in segments(elf):
            self.uc.mem_write(address, bytes(code))
            for at in range(0, len(code) - 1, 2):
                one = struct.unpack_from("<H", code, at)[0]
                if one in (WFE, WFI, SEV):
                    self.uc.hook_add(UC_HOOK_CODE, self.hint, one, address + at, address + at)
        self.table, self.entry = vectors, entry

    def invalid(self, _uc, _access, address, _size, _value, _data):
        self.touched = address
        return False

    def bus(self, base, size, one):
        """Puts a peripheral at its address."""

        def read(_uc, offset, _size, _data):
            place = base + offset
            again = place == self.polled and self.instructions - self.polled_at < CLOSE
            self.polls = self.polls + 1 if again else 0
            self.polled, self.polled_at = place, self.instructions
            return one.read(offset) & 0xFFFFFFFF

        def write(_uc, offset, _size, value, _data):
            self.polls = 0
            one.write(offset, value)

        self.uc.mmio_map(base, size, read, None, write, None)

    def reset(self):
        self.enabled, self.pending, self.lines, self.priorities = set(), set(), set(), {}
        self.active, self.system = [], {}
        self.events.clear()
        self.event, self.polls, self.polled, self.polled_at = False, 0, None, 0
        self.deadline, self.asleep, self.before = 0.0, False, None
        self.vectors = self.table
        stack, self.pc = struct.unpack("<II", self.uc.mem_read(self.entry, 8))
        self.uc.reg_write(arm.UC_ARM_REG_SP, stack)
        self.uc.reg_write(arm.UC_ARM_REG_PRIMASK, 0)
        self.uc.reg_write(arm.UC_ARM_REG_BASEPRI, 0)

    # Time

    def at(self, time, act):
        """Does this at a time. What it returns is called off by setting its last item to None."""
        self.order += 1
        event = [time, self.order, act]
        heapq.heappush(self.events, event)
        self.deadline = min(self.deadline, time)
        return event

    def after(self, ns, act):
        return self.at(self.now + ns, act)

    def block(self, _uc, address, size, _data):
        """Before every basic block."""
        if self.now >= self.deadline or address == RETURN:
            return self.stop(address)
        if self.polls > POLLS or address == LOOP:
            # A loop around a register, or around nothing: until something happens, a round of it is like the other.
            self.now = max(self.now, min(self.deadline, self.now + 10_000))
        block = self.blocks.get((address, size)) or self.decoded(address, size)
        if self.before and address != self.before[2]:
            self.before[3] += 1
        self.before = block
        block[1] += 1
        self.instructions += len(block[0])
        self.now += len(block[0]) * self.cycle

    def decoded(self, address, size):
        """A block's instructions, how often it was executed, what follows in memory, and how often something else did."""
        code, at, instructions = self.uc.mem_read(address, size), 0, []
        while at < size:
            instructions.append(address + at)
            one = struct.unpack_from("<H", code, at)[0]
            at += 4 if one >> 11 > 0b11100 else 2
            if one in (WFE, WFI):
                break
        block = self.blocks[(address, size)] = [instructions, 0, address + at, 0]
        return block

    def executed(self):
        """Of each instruction: its address, how often it was executed, and how often it branched."""
        counts = {}
        for instructions, times, _, branched in self.blocks.values():
            for one in instructions:
                count, taken = counts.get(one, (0, 0))
                counts[one] = count + times, taken + (branched if one == instructions[-1] else 0)
        return counts

    def stop(self, address):
        self.pc = address | 1
        self.stopped, self.before = True, None
        self.uc.emu_stop()

    def hint(self, _uc, address, _size, one):
        if one == SEV:
            self.event = True
            return
        self.asleep = not self.event or one == WFI
        self.event = self.event and one == WFI
        self.stop(address + 2)  # Unicorn knows neither

    def run(self, end):
        """Runs until this time."""
        while self.now < end:
            while self.events and self.events[0][0] <= self.now:
                act = heapq.heappop(self.events)[2]
                if act:
                    act()
            until = min(self.events[0][0] if self.events else end, end)
            if self.take():
                self.asleep = False
            if self.asleep:
                self.now = max(self.now, until)
                continue
            # One that is masked or not more urgent is looked at before each block.
            self.deadline = self.now if self.pending & self.enabled else until
            self.cycle = 1e9 / self.hz
            self.stopped = False
            self.step()
            if self.pc == RETURN | 1:
                self.leave()

    def step(self):
        # At least a block, even if the time is over.
        if self.deadline <= self.now:
            self.deadline = self.now + self.cycle / 2
        self.uc.emu_start(self.pc | 1, 0xFFFFFFFE)
        if self.fault:
            fault, self.fault = self.fault, None
            raise fault
        if not self.stopped:
            self.pc = self.uc.reg_read(arm.UC_ARM_REG_PC) | 1

    # Interrupts

    def line(self, number, level):
        """A peripheral's interrupt line."""
        if level and number not in self.lines:
            self.lines.add(number)
            self.pending.add(number)
            self.deadline = 0.0
        elif not level:
            self.lines.discard(number)

    def take(self):
        """Enters the most urgent interrupt, if one may come now."""
        ready = self.pending & self.enabled
        if not ready:
            return False
        best = min(ready, key=lambda one: (self.priorities.get(one, 0), one))
        running = min((self.priorities.get(one, 0) for one, _ in self.active), default=256)
        # BASEPRI masks what is not more urgent; 0 masks nothing.
        running = min(running, self.uc.reg_read(arm.UC_ARM_REG_BASEPRI) or 256)
        masked = self.uc.reg_read(arm.UC_ARM_REG_PRIMASK) & 1
        if masked or self.priorities.get(best, 0) >= running:
            self.asleep = False  # WFI ends all the same
            return False
        self.pending.discard(best)
        uses_fpu = self.uc.reg_read(arm.UC_ARM_REG_CONTROL) & 4
        floats = [self.uc.reg_read(arm.UC_ARM_REG_S0 + one) for one in range(32)] if uses_fpu else []
        stack = self.uc.reg_read(arm.UC_ARM_REG_SP)
        state = self.uc.reg_read(arm.UC_ARM_REG_XPSR)
        # A frame with floating point is longer by 18 words; the registers themselves are kept here.
        place = stack - 32 - (72 if uses_fpu else 0)
        padding = place & 4
        place -= padding
        frame = [self.uc.reg_read(one) for one in FRAME]
        self.uc.mem_write(place, struct.pack("<8I", *frame, self.pc & ~1, state & ~(1 << 9) | padding << 7 | 1 << 24))
        self.uc.reg_write(arm.UC_ARM_REG_SP, place)
        self.uc.reg_write(arm.UC_ARM_REG_LR, RETURN | 1)
        self.active.append((best, (stack, floats)))
        self.pc = struct.unpack("<I", self.uc.mem_read(self.vectors + 4 * (16 + best), 4))[0]
        self.now += 12 * 1e9 / self.hz
        return True

    def leave(self):
        number, (stack, floats) = self.active.pop()
        words = struct.unpack("<8I", self.uc.mem_read(self.uc.reg_read(arm.UC_ARM_REG_SP), 32))
        for register, value in zip(FRAME, words):
            self.uc.reg_write(register, value)
        for one, value in enumerate(floats):
            self.uc.reg_write(arm.UC_ARM_REG_S0 + one, value)
        self.uc.reg_write(arm.UC_ARM_REG_SP, stack)
        self.uc.reg_write(arm.UC_ARM_REG_XPSR, words[7] & 0xF8000000 | 1 << 24)
        self.pc = words[6] | 1
        self.now += 12 * 1e9 / self.hz
        self.event = True
        if number in self.lines:
            self.pending.add(number)

    # The system's registers

    def read(self, offset):
        if offset >= 0x400 and offset < 0x4F0:
            return sum(self.priorities.get(offset - 0x400 + one, 0) << 8 * one for one in range(4))
        bank = {1: self.enabled, 2: self.pending}.get(offset >> 8)
        if bank is not None:
            first = (offset & 0x7F) * 8
            return sum(1 << one for one in range(32) if first + one in bank)
        return self.system.get(offset, {0xD00: 0x410FC241, 0xD08: self.vectors}.get(offset, 0))

    def write(self, offset, value):
        if offset >= 0x400 and offset < 0x4F0:
            self.priorities[offset - 0x400] = value & 0xFF  # byte by byte, as cortex-m does
            return
        bank = {1: self.enabled, 2: self.pending}.get(offset >> 8)
        if bank is not None:
            named = {(offset & 0x7F) * 8 + one for one in range(32) if value >> one & 1}
            (bank.difference_update if offset & 0x80 else bank.update)(named)
            self.pending |= self.lines & named
            self.deadline = 0.0
        elif offset == 0xF00:
            self.pending.add(value & 0x1FF)  # STIR
            self.deadline = 0.0
        elif offset in MISSING and value & MISSING[offset][1]:
            self.raise_later(LookupError(f"nothing models {MISSING[offset][0]}"))
        elif offset == 0xD0C and value >> 16 == 0x05FA and value & 4:
            self.raise_later(Reset("software"))
        elif offset == 0xD08:
            self.vectors = value
        else:
            self.system[offset] = value

    def raise_later(self, fault):
        """Out of a callback nothing can be raised."""
        self.fault = fault
        self.uc.emu_stop()
