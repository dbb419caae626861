//! `cargo verify link`: a flight over a serial line, from a board's interrupt to values on the host.

use crate::{boards::BOARDS, host, image, paths, qemu, shell};
use anyhow::{Context, Result, bail, ensure};
use std::{fs, fs::File};

/// With the thresholds of the board's channels.
const LISTEN: &str = "listen --scheme sf --thresholds 0.1,0.1,0.1,0.5,0.5,0.5";

/// The board sends frames out of its UART, `spikewire listen` decodes them: the values must be those that the board
/// decoded itself, bit for bit.
pub fn link() -> Result<()> {
    let board = BOARDS.iter().find(|board| board.machine == "netduinoplus2");
    let board = board.context("no board with the UART that the program knows")?;
    let image = image::build("link-uart", board)?;
    let captured = paths::target().join("link-uart.bytes");
    let sent = qemu::run_capturing(board, &image, &captured)?;
    print!("board:\n{sent}");
    let bytes = fs::metadata(&captured)?.len();
    ensure!(
        sent.contains(&format!("\n{bytes} bytes, 0 events lost")),
        "the board lost events or bytes"
    );

    let heard = shell::output(host::spikewire(LISTEN)?.arg(&captured))?;
    let piped = shell::output(host::spikewire(LISTEN)?.stdin(File::open(&captured)?))?;
    ensure!(heard == piped, "a file and standard input give different values");
    let decoded = digest(&heard)?;
    println!("host:\n{decoded}");
    let of_board = sent.lines().next().unwrap_or_default();
    ensure!(of_board == decoded, "board and host decoded different values");
    println!("Every bit agrees.");
    Ok(())
}

/// All values of a table that `spikewire listen` wrote, as the board prints its own: their number, and FNV-1a over
/// channel, time and bits of each.
fn digest(table: &str) -> Result<String> {
    let (mut values, mut hash) = (0, 0xcbf2_9ce4_8422_2325_u64);
    for line in table.lines().skip(1).filter(|line| *line != "# restart") {
        let [tick, channel, value, known] = line.split(',').collect::<Vec<_>>()[..] else {
            bail!("`{line}` is no value: was something lost?");
        };
        match known {
            "exact" => {}
            "keyframe" => continue, // repeats what is known
            _ => bail!("`{line}` is not exact"),
        }
        values += 1;
        let words = [channel.parse()?, tick.parse()?, value.parse::<f32>()?.to_bits()];
        for byte in words.into_iter().flat_map(u32::to_le_bytes) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
    Ok(format!("{values} values hash={hash:016x}"))
}
