//! `cargo verify logging`: decodes on the host what emulated boards log by defmt.

use crate::common::{paths, shell};
use crate::programs::{boards::Board, host, image, qemu};
use anyhow::{Context, Result, ensure};
use std::fs::{self, File};

const PROGRAM: &str = "logging";

/// Checks the log of the usual core; `cargo verify cores` checks that of the smallest.
pub fn logging() -> Result<()> {
    on("M4F")
}

/// Compares the decoded log with the text file beside the program.
pub fn on(core: &str) -> Result<()> {
    let expected = paths::examples().join("logging/expected.txt");
    let expected = fs::read_to_string(&expected).with_context(|| expected.display().to_string())?;
    let board = Board::with(core)?;
    let image = image::build(PROGRAM, board)?;
    let said = paths::target().join(format!("logging-{}.defmt", board.machine));
    fs::write(&said, qemu::run_bytes(board, &image)?)?;

    let mut decoder = shell::command(host::example(PROGRAM)?);
    decoder.arg(&image).stdin(File::open(&said)?);
    let log = shell::output(&mut decoder)?;
    ensure!(log == expected, "{} logs\n{log}and should log\n{expected}", board.core);
    println!("{}: {} lines, as they should be", board.core, log.lines().count());
    print!("{expected}");
    Ok(())
}
