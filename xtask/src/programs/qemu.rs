//! Runs a firmware image on an emulated board.

use crate::common::{progress, shell};
use crate::programs::boards::Board;
use anyhow::{Context, Result, bail, ensure};
use std::{
    fs::File,
    io::Read,
    path::Path,
    process::{Child, Command, ExitStatus, Stdio},
    thread,
    time::{Duration, Instant},
};

/// Longest time of a program. A fault before the console is up, for one, would never end.
const PATIENCE: Duration = Duration::from_mins(2);

/// Longest time of a program that counts: software floating point on a Cortex-M0 takes some 10^10 instructions.
const LONG_PATIENCE: Duration = Duration::from_mins(10);

/// Runs the image to its end; returns its output. Fails if the program fails, or does not end in time.
pub fn run(board: &Board, image: &Path) -> Result<String> {
    run_for(PATIENCE, board, emulator(board), image)
}

/// Runs an image as [`run`] does, for output that is not text.
pub fn run_bytes(board: &Board, image: &Path) -> Result<Vec<u8>> {
    run_to_end(PATIENCE, board, emulator(board), image)
}

/// Runs an image as [`run`] does, with a longer time.
pub fn run_long(board: &Board, image: &Path) -> Result<String> {
    run_for(LONG_PATIENCE, board, emulator(board), image)
}

/// Runs an image as [`run`] does, with a clock that counts instructions, so that every run is the same.
pub fn run_repeatably(board: &Board, image: &Path) -> Result<String> {
    run_for(PATIENCE, board, counting(board), image)
}

/// Runs an image that counts instructions, with a longer time.
pub fn run_counting(board: &Board, image: &Path) -> Result<String> {
    run_for(LONG_PATIENCE, board, counting(board), image)
}

/// Runs an image that counts instructions, with a plugin, in a directory.
pub fn run_counting_with(
    board: &Board,
    image: &Path,
    directory: &Path,
    plugin: &str,
) -> Result<String> {
    let mut emulator = counting(board);
    emulator.current_dir(directory).args(["-plugin", plugin]);
    run_for(LONG_PATIENCE, board, emulator, image)
}

/// Runs an image as [`run_counting`] does, and keeps the output of the board's first serial port in a file.
pub fn run_capturing(board: &Board, image: &Path, serial: &Path) -> Result<String> {
    let mut emulator = counting(board);
    // Or the monitor takes the console that the serial port leaves.
    emulator.args(["-monitor", "none"]);
    emulator.arg("-serial").arg(format!("file:{}", serial.display()));
    run_for(PATIENCE, board, emulator, image)
}

/// Runs an image in real time. The board's first serial port receives the file `heard`; the output of the second is
/// kept.
pub fn run_hearing(board: &Board, image: &Path, heard: &Path, said: &Path) -> Result<String> {
    let mut emulator = emulator(board);
    emulator.args(["-monitor", "none"]);
    emulator.args(["-serial", "stdio"]).stdin(File::open(heard)?);
    emulator.arg("-serial").arg(format!("file:{}", said.display()));
    run_for(PATIENCE, board, emulator, image)
}

fn emulator(board: &Board) -> Command {
    let (program, options) = board.emulator();
    let mut emulator = shell::command(program);
    emulator.args(["-M", board.machine, "-nographic"]).args(options).stdin(Stdio::null());
    emulator
}

fn counting(board: &Board) -> Command {
    let mut emulator = emulator(board);
    emulator.arg("-icount").arg(format!("shift={}", board.icount));
    emulator
}

fn run_for(patience: Duration, board: &Board, emulator: Command, image: &Path) -> Result<String> {
    Ok(text(&run_to_end(patience, board, emulator, image)?))
}

fn run_to_end(
    patience: Duration,
    board: &Board,
    mut emulator: Command,
    image: &Path,
) -> Result<Vec<u8>> {
    emulator
        .args(["-semihosting-config", "enable=on,target=native"])
        .arg("-kernel")
        .arg(image)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let program = image.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let _running = progress::running(format!("{program} on {}", board.core));
    let mut child =
        emulator.spawn().context("the emulator does not start; `cargo xtask setup` installs it")?;

    // Read both streams while it runs, or a full pipe stops it.
    let printed = read_all(child.stdout.take());
    let said = read_all(child.stderr.take());
    let status = wait(&mut child, patience)?;
    let printed = printed.join().unwrap_or_default();
    let said = said.join().unwrap_or_default();

    let shown = || text(&printed) + &text(&said);
    let Some(status) = status else {
        bail!("no end after {patience:?}; so far: {}", shown());
    };
    ensure!(status.success(), "{status}: {}", shown());
    Ok(printed)
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn read_all(stream: Option<impl Read + Send + 'static>) -> thread::JoinHandle<Vec<u8>> {
    thread::spawn(move || {
        let mut bytes = Vec::new();
        if let Some(mut stream) = stream {
            // What came before an error is still worth showing.
            let _ = stream.read_to_end(&mut bytes);
        }
        bytes
    })
}

/// Returns the exit status; `None` if the program ran out of time and was ended.
fn wait(child: &mut Child, patience: Duration) -> Result<Option<ExitStatus>> {
    let start = Instant::now();
    while start.elapsed() < patience {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status));
        }
        thread::sleep(Duration::from_millis(10));
    }
    child.kill()?;
    child.wait()?;
    Ok(None)
}
