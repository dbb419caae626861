//! `cargo verify soak`: simulates hours of flight over a bad line, on emulated boards and the host.

use crate::common::{cargo, output, paths};
use crate::programs::{boards::Board, image, qemu};
use anyhow::{Context, Result, bail, ensure};
use std::thread;

const PROGRAM: &str = "soak";
/// Number of spells of each fault, and the variable that sets it: eleven hours of flight.
const SPELLS: (&str, &str) = ("SOAK_SPELLS", "2400");
/// A core with a floating-point unit, and one without.
const CORES: [&str; 2] = ["M4F", "M0"];

/// Runs the program, which checks itself. Random numbers are from a fixed seed, so each core and the host must count
/// the same.
pub fn soak() -> Result<()> {
    let mut host = cargo("run --release --quiet --manifest-path examples/Cargo.toml --package");
    host.arg(PROGRAM).env(SPELLS.0, SPELLS.1).env("CARGO_TARGET_DIR", paths::target());
    let host = output(&mut host)?;
    println!("{host}");
    let boards = CORES.map(Board::with).into_iter().collect::<Result<Vec<_>>>()?;
    let images = boards.iter().map(|board| image::build_with(PROGRAM, board, &[SPELLS]));
    let images = images.collect::<Result<Vec<_>>>()?;
    thread::scope(|scope| {
        let runs: Vec<_> = boards
            .iter()
            .zip(&images)
            .map(|(board, image)| (board, scope.spawn(|| qemu::run_long(board, image))))
            .collect();
        for (board, run) in runs {
            let printed =
                run.join().unwrap_or_else(|_| bail!("its thread panicked")).context(board.core)?;
            ensure!(printed == host, "{} counts otherwise:\n{printed}", board.core);
            println!("{}: the same to the last count", board.core);
        }
        Ok(())
    })
}
