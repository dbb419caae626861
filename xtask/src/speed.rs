//! What an image writes to an STM32F405's GPIO registers, seen by an emulator that has none.

use crate::shell::command;
use anyhow::{Context, Result, ensure};
use std::{
    io::{BufRead, BufReader},
    path::Path,
    process::Stdio,
};

/// SCK and MOSI of SPI1 and SPI2.
const PINS: [(&str, u32); 4] = [("GPIOA", 5), ("GPIOA", 7), ("GPIOB", 13), ("GPIOB", 15)];
const OSPEEDR: u32 = 8;
const VERY_HIGH: u32 = 0b11;

/// The emulator says more than this while an image waits for a clock that it does not have either.
const MOST_LINES: usize = 2_000;

/// Runs the image until it waits for its clock: by then its pins are set.
pub fn spi_pins_are_fast(image: &Path) -> Result<()> {
    let mut emulator = command("qemu-system-arm");
    emulator.args(["-M", "netduinoplus2", "-nographic", "-monitor", "none", "-serial", "none"]);
    emulator.args(["-d", "unimp", "-kernel"]).arg(image);
    let mut child = emulator.stdin(Stdio::null()).stderr(Stdio::piped()).spawn()?;
    let said = BufReader::new(child.stderr.take().context("no log")?).lines();
    let said: Vec<String> = said.take(MOST_LINES).collect::<Result<_, _>>()?;
    child.kill()?;
    child.wait()?;
    for (port, pin) in PINS {
        let written: Vec<u32> = said.iter().filter_map(|line| speeds(line, port)).collect();
        let is_fast = written.iter().any(|word| word >> (2 * pin) & 3 == VERY_HIGH);
        ensure!(is_fast, "{port} pin {pin} is slow: of its port {written:x?} are written");
    }
    println!("SCK and MOSI of both buses are at very high speed.");
    Ok(())
}

/// What a line of the log writes to the port's speed register. A register that is not there reads as 0: each write has the
/// pins that it changes alone.
fn speeds(line: &str, port: &str) -> Option<u32> {
    let write = line.strip_prefix(port)?.strip_prefix(": unimplemented device write (")?;
    let (_, access) = write.trim_end_matches(')').split_once("offset 0x")?;
    let (offset, value) = access.split_once(", value 0x")?;
    let hex = |digits| u32::from_str_radix(digits, 16).ok();
    (hex(offset)? == OSPEEDR).then(|| hex(value))?
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn writes_to_the_speed_register_are_read() {
        let line = |access: &str| format!("GPIOB: unimplemented device {access}");
        let write = line("write (size 4, offset 0x008, value 0xc0000000)");
        assert_eq!(speeds(&write, "GPIOB"), Some(0xC000_0000));
        assert_eq!(speeds(&write, "GPIOA"), None);
        assert_eq!(speeds(&line("write (size 4, offset 0x018, value 0x1)"), "GPIOB"), None);
        assert_eq!(speeds(&line("read  (size 4, offset 0x008)"), "GPIOB"), None);
    }
}
