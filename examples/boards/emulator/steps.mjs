// Runs an image on an emulated RP2040 that prints over semihosting, and counts the cycles of its function `network_step`.
//
//   node steps.mjs IMAGE
//
// The image's vector table begins the flash: there is no boot code. Every cycle is one of the core's manual; flash has no wait
// states, as where a program is copied to RAM.

import { ConsoleLogger, LogLevel, RP2040 } from "rp2040js";
import { segments, symbol } from "./elf.mjs";

const [path] = process.argv.slice(2);
const FLASH = 0x10000000;
const mcu = new RP2040();
mcu.logger = new ConsoleLogger(LogLevel.Error, false);
for (const { address, bytes } of segments(path)) mcu.flash.set(bytes, address - FLASH);
mcu.core.VTOR = FLASH;
mcu.core.reset();

// Semihosting: SYS_OPEN 1, SYS_WRITE 5, SYS_EXIT 0x18.
let [said, status] = ["", undefined];
mcu.onBreak = () => {
  const [operation, argument] = mcu.core.registers;
  const word = (at) => mcu.readUint32(argument + 4 * at);
  if (operation === 5) {
    const [from, length] = [word(1), word(2)];
    for (let at = 0; at < length; at++) said += String.fromCharCode(mcu.readUint8(from + at));
    mcu.core.registers[0] = 0;
  } else if (operation === 0x18) {
    status = argument === 0x20026 ? 0 : 1;
  } else {
    mcu.core.registers[0] = 1;
  }
};

const step = symbol(path, "network_step") & ~1;
let [begun, back, steps, sum, most] = [0, undefined, 0, 0, 0];
while (status === undefined) {
  const at = mcu.core.PC & ~1;
  if (at === step && back === undefined) [begun, back] = [mcu.core.cycles, mcu.core.LR & ~1];
  else if (at === back) {
    const cycles = mcu.core.cycles - begun;
    [back, steps, sum, most] = [undefined, steps + 1, sum + cycles, Math.max(most, cycles)];
  }
  mcu.core.executeInstruction();
}
process.stdout.write(said);
if (steps > 0) console.log(`# cycles a step: ${Math.round(sum / steps)} (${most})`);
process.exitCode = status;
