// Runs an image for a Pico from its reset vector, with a sensor on SPI0.
//
//   node pico.mjs IMAGE SENSOR SECONDS DIRECTORY [TIME:FATE]...
//
// Writes to DIRECTORY what left the UART (`uart`), when each byte had left (`times`, µs), the sensor's samples (`samples`),
// the log of the debug probe (`log`) and what was executed (`executed`), and prints what was seen as JSON. A fate strikes at its time, in ms: see FATES.
// The file that RECORDING in the environment names, if there is one, is what the sensor measures: see `fly` in sensors.mjs.
//
// rp2040js has the RP2040's core, clocks, DMA, timers, GPIO and SPI. Here are added: the PL011's transmit FIFO, the time of a
// byte on SPI, the ring oscillator's random bit, the end of a DMA transfer that is given up, the reset by the watchdog, and
// wires that break.

import { readFileSync, writeFileSync } from "node:fs";
import { LogLevel, ConsoleLogger, RP2040 } from "rp2040js";
import { segments, symbol } from "./elf.mjs";
import { Bmi323, Icm42688p } from "./sensors.mjs";

const [imagePath, sensorName, seconds, directory, ...fates] = process.argv.slice(2);
const PINS = { miso: 16, select: 17, dataReady: 20 };
const END = Number(seconds) * 1e9;
const SENSORS = { bmi323: Bmi323, icm42688p: Icm42688p };

const image = segments(imagePath);
const rtt = symbol(imagePath, "_SEGGER_RTT");
const sensor = new SENSORS[sensorName](PINS);
if (process.env.RECORDING) sensor.fly(readFileSync(process.env.RECORDING, "utf8"));
const seen = { starts: [], instructions: 0, cycles: 0, shortestPause: 1e12, shortestGuard: 1e12 };
const [uart, times, log] = [[], [], []];
const executed = new Map();
let slow = 0;
const wires = { miso: "whole", dataReady: "whole", clock: "whole", uart: "whole", crystal: "whole" };
/// Thrown out of whatever runs when the watchdog's time is over.
const BITTEN = new Error("the watchdog");
let [mcu, noise, isHung] = [undefined, 1, false];
let fault;
/// Registers that nothing models, and that change nothing here: the core's voltage, its brown-out; of the UART the levels of its
/// FIFOs, and that it may ask for DMA, which it never does here.
const HARMLESS = ["VREG_AND_CHIP_RESET_BASE 0x0", "VREG_AND_CHIP_RESET_BASE 0x4", "UART0 0x34", "UART0 0x48"];
/// Whether all else that nothing models ends the run: rp2040js only warns of it.
const IS_STRICT = process.env.STRICT === "1";

/// What a line picks up.
function noisy() {
  return random() >>> 31 ? 0xff : 0x00;
}

/// What a byte on MISO reads if nobody drives it: as the pad's pull has it, or noise.
function floating() {
  const pad = mcu.gpio[PINS.miso];
  if (pad.pullupEnabled) return 0xff;
  if (pad.pulldownEnabled) return 0x00;
  return noisy();
}

/// Changes what a register reads.
function reads(peripheral, register, value) {
  const read = peripheral.readUint32.bind(peripheral);
  peripheral.readUint32 = (offset) => (offset === register ? value(() => read(offset)) : read(offset));
}

function random() {
  return (noise = (Math.imul(noise, 1664525) + 1013904223) >>> 0);
}

/// Notes the first access to what nothing models.
class Strict extends ConsoleLogger {
  warn(component, message) {
    const [, place] = /(?:[Uu]nimplemented.*?|invalid memory address: |undefined address: )((?:0x)?[0-9a-f]+)(?:$|:)/.exec(message) ?? [];
    if (!IS_STRICT || place === undefined || HARMLESS.includes(`${component} ${place}`)) return;
    fault ??= `nothing models ${component}: ${message}, at ${mcu.core.PC.toString(16)}`;
  }
}

/// A part after a reset: RAM, and the watchdog's reason, are what was there before.
function start(reason) {
  const before = mcu;
  mcu = new RP2040();
  mcu.logger = new Strict(LogLevel.Error, false);
  if (before) {
    mcu.clock.nanosCounter = before.clock.nanos;
    mcu.sram.set(before.sram);
  }
  for (const { address, bytes } of image) mcu.flash.set(bytes, address - 0x10000000);
  const watchdog = mcu.peripherals[0x40058];
  watchdog.reason = reason;
  watchdog.onWatchdogTrigger = () => {
    throw BITTEN;
  };
  // The boot ROM runs the first 256 bytes, which set the flash up and go on here.
  mcu.core.VTOR = 0x10000100;
  mcu.core.reset();
  // What a bus takes more than the core's own cycle, or the single-cycle port less.
  const bus = mcu.core.cyclesIO.bind(mcu.core);
  mcu.core.cyclesIO = (address, write) => {
    const cycles = bus(address, write);
    slow += cycles - 1;
    return cycles;
  };
  seen.starts.push({ at: mcu.clock.nanos / 1e6, reason });
  wireSpi();
  wireUart();
  const STABLE = 1 << 31;
  reads(mcu.peripherals[0x40024], 0x04, (status) => (wires.crystal === "whole" ? status() : status() & ~STABLE));
  reads(mcu.peripherals[0x40060], 0x1c, () => random() >>> 31);
  mcu.peripherals[0x40060].writeUint32 = () => {};
  reads(mcu.dma, 0x444, () => 0);
  isHung = false;
}

function wireSpi() {
  const spi = mcu.spi[0];
  let [selected, last, risen] = [false, 0, -Infinity];
  mcu.gpio[PINS.select].addListener((state) => {
    const [now, low] = [mcu.clock.nanos, state === 0];
    if (low === selected) return;
    selected = low;
    if (low) {
      seen.shortestPause = Math.min(seen.shortestPause, now - risen);
      last = -now; // negative: no byte so far
      if (wires.clock === "whole") sensor.select(now);
    } else {
      if (last > 0) seen.shortestGuard = Math.min(seen.shortestGuard, now - last);
      risen = now;
      if (wires.clock === "whole") sensor.deselect(now);
    }
  });
  spi.onTransmit = (byte) => {
    const now = mcu.clock.nanos;
    if (last <= 0) seen.shortestGuard = Math.min(seen.shortestGuard, now + last);
    const hears = selected && wires.clock === "whole";
    const driven = hears ? sensor.transfer(byte, now) : undefined;
    const read = { whole: driven ?? floating(), cut: floating(), noise: noisy(), low: 0x00, high: 0xff }[wires.miso];
    seen.spiHz = spi.clockFrequency;
    const done = mcu.clock.createAlarm(() => {
      last = mcu.clock.nanos;
      spi.completeTransmit(read);
    });
    done.schedule((8 * 1e9) / spi.clockFrequency);
  };
}

/// The PL011 with its transmit FIFO of 32 bytes, an interrupt when it falls to a half, and the time of a byte.
function wireUart() {
  const port = mcu.uart[0];
  const [write, read] = [port.writeUint32.bind(port), port.readUint32.bind(port)];
  const fifo = [];
  let isBusy = false;
  const interrupt = () => mcu.setInterrupt(port.irq, !!(port.interruptStatus & port.interruptMask));
  const next = () => {
    if (isBusy || fifo.length === 0) return;
    isBusy = true;
    const alarm = mcu.clock.createAlarm(() => {
      isBusy = false;
      uart.push(fifo.shift());
      times.push(mcu.clock.nanos / 1e3);
      if (fifo.length === 16) port.interruptStatus |= 1 << 5;
      interrupt();
      next();
    });
    seen.baud = port.baudRate;
    alarm.schedule((10 * 1e9) / (wires.uart === "slow" ? 9600 : port.baudRate));
  };
  port.checkInterrupts = interrupt;
  port.writeUint32 = (offset, value) => {
    if (offset !== 0) return write(offset, value);
    if (fifo.length < 32) fifo.push(value & 0xff);
    next();
  };
  port.readUint32 = (offset) => {
    if (offset === 0x48) return 0; // no DMA
    if (offset !== 0x18) return read(offset);
    const status = (fifo.length === 32 ? 1 << 5 : 0) | (fifo.length === 0 ? 1 << 7 : 0);
    return (1 << 4) | status | (isBusy ? 1 << 3 : 0);
  };
}

/// What strikes, by its name. `miso-cut` leaves the line to the pad's pull.
const FATES = {
  "miso-cut": () => (wires.miso = "cut"),
  "miso-noise": () => (wires.miso = "noise"), // whatever the pull
  "miso-low": () => (wires.miso = "low"),
  "miso-high": () => (wires.miso = "high"),
  "ready-cut": () => (wires.dataReady = "cut"),
  "clock-cut": () => (wires.clock = "cut"),
  another: () => (sensor.identity = 0x68), // than the one that was there
  mend: () => {
    Object.assign(wires, { miso: "whole", dataReady: "whole", clock: "whole", uart: "whole", crystal: "whole" });
    sensor.identity = 0x47;
  },
  "supply-gone": () => sensor.powerOff(),
  "supply-back": () => sensor.powerOn(mcu.clock.nanos),
  freeze: () => (sensor.isFrozen = true),
  "freeze-accelerometer": () => (sensor.isHalfFrozen = true),
  thaw: () => (sensor.isFrozen = sensor.isHalfFrozen = false),
  "uart-slow": () => (wires.uart = "slow"),
  "crystal-dead": () => (wires.crystal = "dead"),
  hang: () => (isHung = true),
  reset: () => start(0),
};

/// Ends everything in the task that runs: interrupts go on.
function hang() {
  const loop = 0x20041f00;
  mcu.sramView.setUint16(loop - 0x20000000, 0xe7fe, true); // b .
  mcu.core.PC = loop;
}

/// Takes what the firmware logged, as a debug probe would.
function drain() {
  if (rtt === undefined) return;
  const word = (address) => mcu.readUint32(address);
  if (word(rtt) !== 0x47474553) return; // "SEGG"
  const channel = rtt + 24;
  const [buffer, size, write] = [word(channel + 4), word(channel + 8), word(channel + 12)];
  for (let read = word(channel + 16); read !== write; ) {
    log.push(mcu.readUint8(buffer + read));
    read = (read + 1) % size;
    mcu.writeUint32(channel + 16, read);
  }
}

start(0);
const struck = fates.map((fate) => fate.split(":")).map(([at, name]) => ({ at: at * 1e6, name }));
let nextDrain = 0;
/// An instruction, or the time until something happens.
function step() {
  const { clock, core } = mcu;
  const now = clock.nanos;
  if (struck.length > 0 && struck[0].at <= now) FATES[struck.shift().name]();
  if (isHung && core.PC >= 0x10000000 && core.PC < 0x20000000 && core.IPSR === 0) hang();
  // The sensor's time, and its line.
  const edge = sensor.advance(now);
  const pin = mcu.gpio[PINS.dataReady];
  const level = edge && wires.dataReady === "whole";
  if (pin.rawInputValue !== level) pin.setInputValue(level);
  if (now >= nextDrain) {
    drain();
    nextDrain = now + 1e6;
  }
  if (core.waiting) {
    const until = Math.min(sensor.next, struck[0]?.at ?? END, nextDrain, END);
    const alarm = clock.nextAlarm ? clock.nextAlarm.nanos : END;
    clock.tick(Math.max(Math.min(until, alarm) - now, 8));
  } else {
    // Here and not within, so that the address is that of what is executed.
    if (core.interruptsUpdated && core.checkForInterrupts()) core.waiting = false;
    // Of a handler's address rp2040js keeps the bit for Thumb, which an addition of PC would take along.
    const at = core.PC & ~1;
    core.PC = at;
    slow = 0;
    const cycles = core.executeInstruction();
    if (fates.length === 0) note(at, cycles); // what breaks is executed no differently
    seen.instructions += 1;
    seen.cycles += cycles;
    clock.tick((cycles * 1e9) / mcu.clkSys);
  }
}

/// Keeps how often each instruction was executed, how often it branched, and its cycles without the buses'.
function note(at, cycles) {
  let one = executed.get(at);
  if (one === undefined) executed.set(at, (one = { count: 0, taken: 0, cycles: 0 }));
  const isWide = mcu.readUint16(at) >> 11 > 0b11100;
  one.count += 1;
  one.taken += (mcu.core.PC & ~1) !== at + (isWide ? 4 : 2) ? 1 : 0;
  one.cycles += cycles - slow;
}

while (mcu.clock.nanos < END && !fault) {
  try {
    step();
  } catch (error) {
    if (error !== BITTEN) throw error;
    start(1);
  }
}
drain();
Object.assign(seen, { fault, clkSys: mcu.clkSys, clkPeri: mcu.clkPeri, reads: sensor.reads, configured: sensor.isConfigured });
seen.pulledUp = mcu.gpio[PINS.miso].pullupEnabled;
seen.pausesOnHalt = (mcu.peripherals[0x40058].readUint32(0x00) >> 24 & 7) === 7; // PAUSE_JTAG, PAUSE_DBG0, PAUSE_DBG1
writeFileSync(`${directory}/uart`, Buffer.from(uart));
writeFileSync(`${directory}/times`, times.map((at) => at.toFixed(0)).join("\n"));
writeFileSync(`${directory}/log`, Buffer.from(log));
writeFileSync(`${directory}/samples`, sensor.samples.join("\n"));
const line = ([at, { count, taken, cycles }]) => [at, count, taken, cycles].join(",");
writeFileSync(`${directory}/executed`, [...executed].map(line).join("\n"));
console.log(JSON.stringify(seen));
