//! `cargo verify storm`: interrupts that push more events than main takes, on every emulated board and the host.

use crate::programs::{boards::BOARDS, host, image, qemu};
use anyhow::{Context, Result, ensure};

const PROGRAM: &str = "storm";

/// The program checks itself, and its exit status tells. The clock goes by instructions, so that the storm is the same
/// every time.
pub fn storm() -> Result<()> {
    for board in &BOARDS {
        let image = image::build(PROGRAM, board)?;
        let printed = qemu::run_repeatably(board, &image).with_context(|| board.core)?;
        ensure!(printed.lines().count() == 4, "{}: not every queue was tried", board.core);
        println!("{}:\n{printed}", board.core);
    }
    println!("host:\n{}", host::on_host(PROGRAM)?);
    println!("Every event is accounted for, whole and in order.");
    Ok(())
}
