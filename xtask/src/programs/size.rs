//! Measures how much of a board's memory an image takes.

use crate::common::shell;
use crate::programs::boards::Board;
use anyhow::{Context, Result};
use std::path::Path;

/// Formats "flash 12.3 of 256 KiB, RAM 1.0 of 16 KiB", for static memory; the stack comes in addition.
pub fn of(image: &Path, board: &Board) -> Result<String> {
    let [text, data, bss] = sections(image)?;
    let (flash, ram) = board.memory()?;
    let kib = |bytes: u32| f64::from(bytes) / 1024.0;
    Ok(format!(
        "flash {:.1} of {} KiB, static RAM {:.1} of {} KiB",
        kib(text + data), // initial values are stored in flash
        kib(flash),
        kib(data + bss),
        kib(ram),
    ))
}

/// Returns the bytes of code and constants.
pub fn flash(image: &Path) -> Result<u32> {
    let [text, data, _] = sections(image)?;
    Ok(text + data)
}

/// Returns the bytes of code, of initial values, and of zeroed memory. `riscv-rt` makes a section of the memory that is
/// left for the stack, which is not counted.
fn sections(image: &Path) -> Result<[u32; 3]> {
    let size = |format| shell::output(shell::command("arm-none-eabi-size").arg(format).arg(image));
    let [text, data, zeroed] =
        first_three(&size("-B")?).context("arm-none-eabi-size prints something else")?;
    Ok([text, data, zeroed - stack(&size("-A")?)])
}

/// Parses the size of the section `.stack`; 0 if there is none.
fn stack(table: &str) -> u32 {
    let row = table.lines().find_map(|line| line.strip_prefix(".stack "));
    row.and_then(|row| row.split_whitespace().next()?.parse().ok()).unwrap_or(0)
}

/// Parses the first three numbers in the second line.
fn first_three(table: &str) -> Option<[u32; 3]> {
    let mut numbers = table.lines().nth(1)?.split_whitespace();
    let mut next = || numbers.next()?.parse().ok();
    Some([next()?, next()?, next()?])
}
