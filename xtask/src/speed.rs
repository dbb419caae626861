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
const OSPEEDR: &str = "0x8";
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
        let fastest = said.iter().filter_map(|line| speeds(line, port)).next_back();
        let speeds = said.iter().filter_map(|line| speeds(line, port));
        let is_fast = speeds.into_iter().any(|word| word >> (2 * pin) & 3 == VERY_HIGH);
        ensure!(is_fast, "{port} pin {pin} is slow: {fastest:x?} in {} lines", said.len());
    }
    println!("SCK and MOSI of both buses are at very high speed.");
    Ok(())
}

/// What a line of the log writes to the port's speed register. A register that is not there reads as 0: each write has the
/// pins that it changes alone.
fn speeds(line: &str, port: &str) -> Option<u32> {
    let (device, access) = line.split_once(": unimplemented device write (")?;
    let (_, access) = access.split_once("offset ").filter(|_| device == port)?;
    let (offset, value) = access.split_once(", value ")?;
    let value = value.trim_end_matches(')').trim_start_matches("0x");
    (offset.trim_start_matches("0x").trim_start_matches('0') == OSPEEDR.trim_start_matches("0x"))
        .then(|| u32::from_str_radix(value, 16).ok())?
}
