//! `cargo verify storm`: interrupts push more events than the main loop takes, on emulated boards and the host.

use crate::programs::boards::{BOARDS, Board};
use crate::programs::{host, image, qemu};
use anyhow::{Context, Result, ensure};

const PROGRAM: &str = "storm";

/// Runs the program, which checks itself. The clock counts instructions, so that the storm is the same in each run.
pub fn storm() -> Result<()> {
    on(Board::every_day())
}

pub fn on_all() -> Result<()> {
    on(BOARDS.iter())
}

fn on(boards: impl Iterator<Item = &'static Board>) -> Result<()> {
    for board in boards {
        let image = image::build(PROGRAM, board)?;
        let printed = qemu::run_repeatably(board, &image).with_context(|| board.core)?;
        ensure!(printed.lines().count() == 4, "{}: not every queue was tried", board.core);
        println!("{}:\n{printed}", board.core);
    }
    println!("host:\n{}", host::on_host(PROGRAM)?);
    println!("Every event is accounted for, whole and in order.");
    Ok(())
}
