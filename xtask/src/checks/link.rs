//! `cargo verify link`: a flight over a serial line, from a board's interrupt to values on the host, and to the
//! commands of a second board and of a companion computer.

use crate::common::{cargo, paths, run, shell};
use crate::programs::{boards::Board, host, image, published, qemu};
use anyhow::{Result, bail, ensure};
use std::{
    fs::{self, File},
    path::{Path, PathBuf},
};

/// Arguments that decode the board's channels, with their thresholds.
const LISTEN: &str = "listen --scheme sf --thresholds 0.1,0.1,0.1,0.5,0.5,0.5";

/// The program on the companion computer.
const COMPANION: &str = "far-end-linux";

/// Lets the board send frames from its UART, and `spikewire listen` decode them: the values must equal, bit for bit,
/// those that the board decoded itself.
pub fn link() -> Result<()> {
    let board = Board::with("M4F")?; // its UART is the one that the program knows
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
    let decoded = digest(&heard, false)?;
    println!("host:\n{decoded}");
    let of_board = sent.lines().next().unwrap_or_default();
    ensure!(of_board == decoded, "board and host decoded different values");
    println!("Every bit agrees.");
    far_ends(board, &captured, &digest(&heard, true)?)
}

/// Lets a second microcontroller and a companion computer receive the same bytes: both must decode these values, and
/// send back the same commands.
fn far_ends(board: &Board, heard: &Path, values: &str) -> Result<()> {
    run(cargo("test --quiet --manifest-path examples/Cargo.toml --package far-end")
        .env("CARGO_TARGET_DIR", paths::target()))?;

    let image = image::build("far-end-mcu", board)?;
    let of_board = paths::target().join("far-end-mcu.bytes");
    let printed = qemu::run_hearing(board, &image, &after_noise(heard)?, &of_board)?;
    print!("a second board:\n{printed}");
    ensure!(
        printed.lines().next() == Some(values),
        "the second board decoded other values: {values}"
    );

    let of_companion = paths::target().join("far-end-linux.bytes");
    run(cargo("fmt --check").current_dir(paths::examples().join(COMPANION)))?;
    let (elsewhere, patch) = published::copied(COMPANION, &["far-end"])?;
    let mut test = cargo("test --quiet --test pty --config");
    shell::lint(&mut test)
        .args([&patch, "--", "--ignored"])
        .current_dir(elsewhere.path().join(COMPANION))
        .env("CARGO_TARGET_DIR", paths::target())
        .env("LINK_BYTES", heard)
        .env("LINK_COMMANDS", &of_companion);
    run(&mut test)?;
    let [of_board, of_companion] = [fs::read(of_board)?, fs::read(of_companion)?];
    ensure!(!of_board.is_empty() && of_board == of_companion, "the far ends send other commands");
    println!("{} commands of board and companion, byte by byte the same.", of_board.len() / 8);
    Ok(())
}

/// Puts some noise before the bytes, which the link's reader must skip: a USART that is not on yet receives nothing.
fn after_noise(heard: &Path) -> Result<PathBuf> {
    let mut bytes = vec![0; 16 * 1024];
    bytes.extend(fs::read(heard)?);
    let path = paths::target().join("link-uart.noise");
    fs::write(&path, bytes)?;
    Ok(path)
}

/// Digests all values in a table of `spikewire listen` as the board does with its own: their number, and FNV-1a over
/// channel, time and bits of each. Keyframes repeat known values, and count only if asked for.
fn digest(table: &str, with_keyframes: bool) -> Result<String> {
    let (mut values, mut hash) = (0, 0xcbf2_9ce4_8422_2325_u64);
    for line in table.lines().skip(1).filter(|line| *line != "# restart") {
        let [tick, channel, value, known] = line.split(',').collect::<Vec<_>>()[..] else {
            bail!("`{line}` is no value: was something lost?");
        };
        match known {
            "exact" => {}
            "keyframe" if with_keyframes => {}
            "keyframe" => continue,
            _ => bail!("`{line}` is not exact"),
        }
        values += 1;
        let words = [channel.parse()?, tick.parse()?, value.parse::<f32>()?.to_bits()];
        for byte in words.into_iter().flat_map(u32::to_le_bytes) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
    let what = if with_keyframes { "values and keyframes" } else { "values" };
    Ok(format!("{values} {what} hash={hash:016x}"))
}
