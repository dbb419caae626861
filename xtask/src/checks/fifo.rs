//! `cargo verify fifo`: a sensor at 8 kHz through its FIFO: its driver's tests, and what it costs an STM32F405's core.

use crate::common::{cargo, paths, run};
use crate::programs::{boards::Board, host, image, qemu};
use anyhow::{Context, Result, ensure};

const PROGRAM: &str = "fifo-8khz";
/// What the examples' README promises, in instructions a second: one for every 40 cycles of an STM32F405 at 168 MHz.
/// Most instructions take more than one cycle: docs/costs.md has the cycles.
const PROMISED: u64 = 168_000_000 / 40;

pub fn fifo() -> Result<()> {
    let mut tests = cargo("test --quiet --manifest-path examples/Cargo.toml --package icm42688p");
    run(tests.env("CARGO_TARGET_DIR", paths::target()))?;
    count("M4F")
}

/// The program checks itself, and its exit status tells: all samples encoded, all frames decoded to the same values.
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
