// Reads ELF files.

import { readFileSync } from "node:fs";

/// The loadable segments of an ELF file, each with its physical address.
export function segments(path) {
  const elf = readFileSync(path);
  const table = elf.readUInt32LE(28);
  const [size, count] = [elf.readUInt16LE(42), elf.readUInt16LE(44)];
  return Array.from({ length: count }, (_, at) => table + at * size)
    .filter((header) => elf.readUInt32LE(header) === 1 && elf.readUInt32LE(header + 16) > 0)
    .map((header) => {
      const [offset, length] = [elf.readUInt32LE(header + 4), elf.readUInt32LE(header + 16)];
      return { address: elf.readUInt32LE(header + 12), bytes: elf.subarray(offset, offset + length) };
    });
}

/// The address of a symbol, or undefined.
export function symbol(path, name) {
  const elf = readFileSync(path);
  const [table, size, count] = [elf.readUInt32LE(32), elf.readUInt16LE(46), elf.readUInt16LE(48)];
  const section = (at) => table + at * size;
  for (let at = 0; at < count; at++) {
    if (elf.readUInt32LE(section(at) + 4) !== 2) continue;
    const [offset, length] = [elf.readUInt32LE(section(at) + 16), elf.readUInt32LE(section(at) + 20)];
    const names = elf.readUInt32LE(section(elf.readUInt32LE(section(at) + 24)) + 16);
    for (let entry = offset; entry < offset + length; entry += 16) {
      const from = names + elf.readUInt32LE(entry);
      if (elf.toString("latin1", from, elf.indexOf(0, from)) === name) return elf.readUInt32LE(entry + 4);
    }
  }
}
