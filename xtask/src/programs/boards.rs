//! The emulated boards: one for each Cortex-M core that the crate supports, and a RISC-V machine with two cores.

use crate::common::paths;
use anyhow::{Context, Result};
use std::{fs, path::PathBuf};

/// A board that QEMU emulates. Its memory map is `examples/board/memory/<machine>.x`.
pub struct Board {
    /// Column heading in the tables.
    pub core: &'static str,
    /// Name in QEMU.
    pub machine: &'static str,
    /// Target in Rust.
    pub target: &'static str,
    /// Name of its core for the compiler, which tunes code for it and uses all of its instructions.
    pub cpu: &'static str,
    /// Clock in Hz that counts instructions.
    pub clock: u64,
    /// Duration of an instruction when counting: 2^icount ns, which is at least 2 ticks of that clock.
    pub icount: u32,
}

pub const BOARDS: [Board; 5] = [
    Board {
        core: "M0",
        machine: "microbit",
        target: "thumbv6m-none-eabi",
        cpu: "cortex-m0",
        clock: 16_000_000,
        icount: 8,
    },
    Board {
        core: "M3",
        machine: "lm3s6965evb",
        target: "thumbv7m-none-eabi",
        cpu: "cortex-m3",
        clock: 12_500_000,
        icount: 8,
    },
    Board {
        core: "M4F",
        machine: "netduinoplus2", // an STM32F405: the top-level memory.x
        target: "thumbv7em-none-eabihf",
        cpu: "cortex-m4",
        clock: 168_000_000,
        icount: 4,
    },
    Board {
        core: "M7",
        machine: "mps2-an500",
        target: "thumbv7em-none-eabihf",
        cpu: "cortex-m7",
        clock: 25_000_000,
        icount: 7,
    },
    Board {
        core: "M33",
        machine: "mps2-an505",
        target: "thumbv8m.main-none-eabihf",
        cpu: "cortex-m33",
        clock: 20_000_000,
        icount: 7,
    },
];

/// QEMU's RISC-V machine: with the core of an ESP32-C3, which has no floating point and no atomic instructions, and
/// with a core that has both. It runs the recorded flight only, as the other programs use a Cortex-M's peripherals.
pub const RISC_V: [Board; 2] = [
    Board {
        core: "RV32",
        machine: "virt",
        target: "riscv32imc-unknown-none-elf",
        cpu: "generic-rv32",
        clock: 10_000_000,
        icount: 8,
    },
    Board {
        core: "RV32F",
        machine: "virt",
        target: "riscv32imafc-unknown-none-elf",
        cpu: "generic-rv32",
        clock: 10_000_000,
        icount: 8,
    },
];

impl Board {
    /// Returns the boards on which firmware is compared with the host every day: a core without floating point and
    /// without a multiplication of 64 bits, and one with both. `cargo verify all-cores` takes all.
    pub fn every_day() -> impl Iterator<Item = &'static Self> + Clone {
        BOARDS.iter().filter(|board| ["M0", "M4F"].contains(&board.core))
    }

    /// Returns the boards of all cores.
    pub fn all() -> impl Iterator<Item = &'static Self> {
        BOARDS.iter().chain(&RISC_V)
    }

    /// Returns QEMU's program and the options that choose the board.
    pub fn emulator(&self) -> (&'static str, &'static [&'static str]) {
        match self.core {
            "RV32" => ("qemu-system-riscv32", &["-cpu", "rv32,a=off,f=off,d=off", "-bios", "none"]),
            "RV32F" => ("qemu-system-riscv32", &["-cpu", "rv32,d=off", "-bios", "none"]),
            _ => ("qemu-system-arm", &[]),
        }
    }

    /// Returns the start of the names of the GNU tools for the core.
    pub fn tools(&self) -> &'static str {
        if self.target.starts_with("riscv") { "riscv64-unknown-elf-" } else { "arm-none-eabi-" }
    }

    /// Returns the board with this core.
    pub fn with(core: &str) -> Result<&'static Self> {
        let board = Self::all().find(|board| board.core.eq_ignore_ascii_case(core));
        board.with_context(|| format!("no core `{core}`"))
    }

    /// Returns the number of clock ticks for 10^9 instructions.
    pub fn ticks_per_gigainstruction(&self) -> u64 {
        self.clock << self.icount
    }

    /// Returns the path of the linker's memory map.
    pub fn memory_map(&self) -> PathBuf {
        match self.machine {
            "netduinoplus2" => paths::root().join("memory.x"),
            other => paths::examples().join(format!("board/memory/{other}.x")),
        }
    }

    /// Returns the bytes of flash and of RAM, from the map with which the firmware is linked.
    pub fn memory(&self) -> Result<(u32, u32)> {
        let path = self.memory_map();
        Ok((length(&path, "FLASH")?, length(&path, "RAM")?))
    }
}

/// Reads `LENGTH` of a region in a linker's memory map, written in K.
fn length(path: &PathBuf, region: &str) -> Result<u32> {
    let map = fs::read_to_string(path).with_context(|| path.display().to_string())?;
    map.lines()
        .filter(|line| line.trim_start().starts_with(region))
        .find_map(|line| {
            let (_, length) = line.split_once("LENGTH = ")?;
            let kibibytes: u32 = length.trim().strip_suffix('K')?.parse().ok()?;
            Some(kibibytes * 1024)
        })
        .with_context(|| format!("no `{region} : … LENGTH = <n>K` in {}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_board_has_a_map_and_a_known_target() {
        for board in Board::all() {
            let (flash, ram) = board.memory().unwrap();
            assert!(flash >= 128 * 1024 && ram >= 16 * 1024, "{}", board.machine);
            assert!(crate::setup::toolchain::TARGETS.contains(&board.target));
        }
    }

    #[test]
    fn rounding_ticks_gives_exact_counts() {
        for board in &BOARDS {
            assert!(board.ticks_per_gigainstruction() >= 2_000_000_000, "{}", board.machine);
        }
    }

    #[test]
    fn the_default_map_is_the_stm32f405() {
        let board = BOARDS.iter().find(|board| board.core == "M4F").unwrap();
        assert_eq!(board.memory().unwrap(), (1024 * 1024, 128 * 1024));
    }
}
