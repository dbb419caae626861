//! `cargo verify fifo`: tests the driver of a sensor at 8 kHz with a FIFO, and counts what it costs an STM32F405's
//! core.

use crate::common::{cargo, paths, run};
use crate::programs::{boards::Board, host, image, qemu};
use anyhow::{Context, Result, ensure};

const PROGRAM: &str = "fifo-8khz";
/// Number of instructions a second that the examples' README promises: one for every 40 cycles of an STM32F405 at 168
/// MHz. Most instructions take more than one cycle; docs/costs.md has the cycles.
const PROMISED: u64 = 168_000_000 / 40;

pub fn fifo() -> Result<()> {
    let mut tests = cargo("test --quiet --manifest-path examples/Cargo.toml --package icm42688p");
    run(tests.env("CARGO_TARGET_DIR", paths::target()))?;
    count("M4F")
}

/// Runs the program, which checks that all samples are encoded and all frames decode to the same values, and counts
/// instructions.
pub fn count(core: &str) -> Result<()> {
    let board = Board::with(core)?;
    let printed = qemu::run_counting(board, &image::build(PROGRAM, board)?)?;
    println!("{core}:\n{printed}");
    let on_host = host::on_host(PROGRAM)?;
    ensure!(printed.lines().last() == on_host.lines().last(), "the host has other values");
    let count = instructions(&printed).context("no count")?;
    println!(
        "{:.2} % of 168 MHz, if each took one cycle; docs/costs.md has cycles",
        count as f64 / 168e6 * 100.0
    );
    ensure!(count > 0 && count <= PROMISED, "{count} instructions a second of {PROMISED}");
    Ok(())
}

fn instructions(printed: &str) -> Option<u64> {
    printed.lines().find_map(|line| line.strip_suffix(" instructions a second"))?.parse().ok()
}
