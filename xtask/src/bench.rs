//! `cargo bench-target`: what every codec costs, counted exactly on the emulated boards.

mod baseline;
mod code;
mod table;

use crate::{
    boards::{BOARDS, Board},
    firmware, paths, qemu, setup, shell,
};
use anyhow::{Context, Result, bail};
use code::Code;
use serde::{Deserialize, Serialize};
use std::{
    path::{Path, PathBuf},
    thread,
};

const USAGE: &str = "\
cargo bench-target [CORE]... [--json | --markdown | --write FILE | --baseline]

  CORE          M0, M3, M4F, M7 or M33; all, if none is named
  --json        every figure, as an array of objects
  --markdown    the README's table
  --write FILE  puts that table into FILE, between its markers
  --baseline    makes these counts the ones that `cargo verify` compares with";

/// The programs of the firmware.
const SAMPLES: [&str; 4] = ["f32", "q16_16", "q8_8", "i16"];

/// What one form of one direction of a codec costs; instructions are those of a sample.
#[derive(Serialize)]
pub struct Row {
    codec: String,
    direction: String,
    sample: String,
    core: &'static str,
    form: String,
    signal: String,
    instructions_mean: f64,
    instructions_max: u32,
    /// Of the plain transcription; null where there is none.
    plain_mean: Option<f64>,
    code_bytes: u32,
    state_bytes: u32,
    flash_bytes: u32,
    stack_bytes: u32,
}

/// A line that the firmware prints.
#[derive(Deserialize)]
struct Printed {
    signal: String,
    codec: String,
    direction: String,
    sample: String,
    form: String,
    samples: u32,
    total: u32,
    max: u32,
    plain_samples: u32,
    plain: u32,
    code: u32,
    state: u32,
    flash: u32,
    stack: u32,
}

/// The figures, and the compiler that they are of.
struct Measured {
    rows: Vec<Row>,
    rustc: String,
}

pub fn bench(args: &[String]) -> Result<()> {
    let options: Vec<&str> = args.iter().map(String::as_str).collect();
    let cores: Vec<&str> =
        options.iter().copied().take_while(|arg| !arg.starts_with('-')).collect();
    match options[cores.len()..] {
        [] => {
            setup::setup()?;
            print!("{}", table::text(&measure(&cores)?.rows));
        }
        ["--json"] => println!("{}", serde_json::to_string_pretty(&measure(&cores)?.rows)?),
        ["--markdown"] => print!("{}", table::markdown(&measure(&table::CORES)?.rows)),
        ["--write", file] => table::write(&measure(&table::CORES)?.rows, Path::new(file))?,
        ["--baseline"] => baseline::write(&measure(&baseline::CORES)?)?,
        _ => bail!("{USAGE}"),
    }
    Ok(())
}

/// Fails if a codec takes more instructions than it did.
pub fn verify() -> Result<()> {
    baseline::compare(&measure(&baseline::CORES)?)
}

/// Runs on the named cores, or all. One is built while others run.
fn measure(cores: &[&str]) -> Result<Measured> {
    let boards = boards(cores)?;
    thread::scope(|scope| {
        let mut runs = Vec::new();
        for board in boards {
            eprintln!("Building and running on {} ({}).", board.core, board.machine);
            for image in build(board)? {
                runs.push(scope.spawn(move || {
                    let printed = qemu::run_counting(board, &image)?;
                    read(board, &image, &printed).with_context(|| format!("on {}", board.core))
                }));
            }
        }
        let mut measured = Measured { rows: Vec::new(), rustc: String::new() };
        for run in runs {
            let one = run.join().unwrap_or_else(|_| bail!("its thread panicked"))?;
            measured.rows.extend(one.rows);
            measured.rustc = one.rustc;
        }
        Ok(measured)
    })
}

fn boards(cores: &[&str]) -> Result<Vec<&'static Board>> {
    if cores.is_empty() {
        return Ok(BOARDS.iter().collect());
    }
    let named = |core: &&str| {
        let board = BOARDS.iter().find(|board| board.core.eq_ignore_ascii_case(core));
        board.with_context(|| format!("no core `{core}`\n\n{USAGE}"))
    };
    cores.iter().map(named).collect()
}

/// Builds a program for each sample type.
fn build(board: &Board) -> Result<[PathBuf; 4]> {
    let directory = paths::thumb_target().join("bench").join(board.machine);
    let (mut cargo, built) = firmware::building("bench-target", board, &directory)?;
    // Names that tell Rust's functions from the runtime's; and no debug information, which takes time.
    cargo
        .env("RUSTFLAGS", format!("-C target-cpu={} -C symbol-mangling-version=v0", board.cpu))
        .env("CARGO_PROFILE_RELEASE_DEBUG", "0")
        .env("TICKS_PER_GIGAINSTRUCTION", board.ticks_per_gigainstruction().to_string());
    shell::output(&mut cargo).with_context(|| format!("for {}", board.machine))?;
    Ok(SAMPLES.map(|sample| built.with_file_name(sample)))
}

fn read(board: &Board, image: &Path, printed: &str) -> Result<Measured> {
    let code = Code::read(image)?;
    let row = |line: &str| {
        let printed: Printed = serde_json::from_str(line).with_context(|| line.to_owned())?;
        // To a thousandth, or some would have 16 digits.
        let mean = |total: u32, samples: u32| {
            (f64::from(total) / f64::from(samples) * 1000.0).round() / 1000.0
        };
        Ok(Row {
            core: board.core,
            instructions_mean: mean(printed.total, printed.samples),
            instructions_max: printed.max,
            plain_mean: (printed.plain > 0).then(|| mean(printed.plain, printed.plain_samples)),
            code_bytes: code.bytes(printed.code),
            state_bytes: printed.state,
            flash_bytes: printed.flash,
            stack_bytes: printed.stack,
            codec: printed.codec,
            direction: printed.direction,
            sample: printed.sample,
            form: printed.form,
            signal: printed.signal,
        })
    };
    let rows = printed.lines().map(row).collect::<Result<Vec<_>>>()?;
    Ok(Measured { rows, rustc: code::compiler(image)? })
}
