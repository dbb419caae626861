//! `cargo verify link`: a flight over a serial line, from a board's interrupt to values on the host.

use crate::{boards::BOARDS, firmware, paths, qemu, shell};
use anyhow::{Context, Result, ensure};
use std::{fs, fs::File};

const PROGRAM: &str = "link-uart";

/// The board sends frames out of its UART, the host decodes them: the values must be those that the board decoded
/// itself, bit for bit.
pub fn link() -> Result<()> {
    let board = BOARDS.iter().find(|board| board.machine == "netduinoplus2");
    let board = board.context("no board with the UART that the program knows")?;
    let image = firmware::build(PROGRAM, board)?;
    let captured = paths::target().join("link-uart.bytes");
    let sent = qemu::run_capturing(board, &image, &captured)?;

    let mut receiver = shell::cargo("run --quiet --release --manifest-path examples/Cargo.toml");
    receiver.args(["--package", PROGRAM]).stdin(File::open(&captured)?);
    let received = shell::output(&mut receiver)?;
    println!("board:\n{sent}host:\n{received}");

    let bytes = fs::metadata(&captured)?.len();
    ensure!(
        sent.contains(&format!("\n{bytes} bytes, 0 events lost")),
        "the board lost events or bytes"
    );
    ensure!(received.contains(" 0 lost, 0 bytes skipped"), "the host missed frames");
    let [Some(there), Some(here)] = [&sent, &received].map(|said| said.lines().next()) else {
        unreachable!("both said something")
    };
    ensure!(there == here, "board and host decoded different values");
    println!("Every bit agrees: {here}");
    Ok(())
}
