//! `cargo bench-target`: what every codec costs, and an event on its way, counted exactly on the emulated boards.

mod baseline;
mod code;
mod events;
mod table;

use crate::{
    boards::{BOARDS, Board},
    firmware, paths, qemu, setup, shell,
};
use anyhow::{Context, Result, bail};
use code::Code;
use events::Event;
use serde::{Deserialize, Serialize};
use std::{
    path::{Path, PathBuf},
    thread,
};

const USAGE: &str = "\
cargo bench-target [events] [CORE]... [--json | --markdown | --write FILE | --baseline]

  events        not the codecs: only what an event costs in queue, links, formats and chips' words
  CORE          M0, M3, M4F, M7 or M33; all, if none is named
  --json        every figure, as an array of objects; those of an event have the kind `event`
  --markdown    the README's tables
  --write FILE  puts those tables into FILE, between their markers
  --baseline    makes these counts the ones that `cargo verify` compares with";

/// The programs that count codecs, and the one that counts events.
const SAMPLES: [&str; 4] = ["f32", "q16_16", "q8_8", "i16"];
const EVENTS: &str = "events";

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
#[derive(Default)]
struct Measured {
    rows: Vec<Row>,
    events: Vec<Event>,
    rustc: String,
}

pub fn bench(args: &[String]) -> Result<()> {
    let options: Vec<&str> = args.iter().map(String::as_str).collect();
    let named = options.iter().take_while(|arg| !arg.starts_with('-')).count();
    let (named, output) = options.split_at(named);
    let (programs, cores): (&[&str], _) = match named {
        [EVENTS, cores @ ..] => (&[EVENTS], cores),
        cores => (&[], cores),
    };
    let tables = || measure(programs, &table::CORES);
    match *output {
        [] => {
            setup::setup()?;
            let Measured { rows, events, .. } = measure(programs, cores)?;
            print!("{}{}", table::text(&rows), events::text(&events));
        }
        ["--json"] => println!("{}", json(&measure(programs, cores)?)?),
        ["--markdown"] => print!("{}", table::markdown(&tables()?)?),
        ["--write", file] => table::write(&tables()?, Path::new(file))?,
        ["--baseline"] => baseline::write(&measure(&[], &baseline::CORES)?)?,
        _ => bail!("{USAGE}"),
    }
    Ok(())
}

/// Fails if anything takes more instructions than it did, or six channels more than is promised.
pub fn verify() -> Result<()> {
    let measured = measure(&[], &baseline::CORES)?;
    events::ensure_six_channels_fit(&measured.events)?;
    baseline::compare(&measured)
}

/// An element of the array: both kinds in one, each with its own members.
#[derive(Serialize)]
#[serde(untagged)]
enum Element<'a> {
    Codec(&'a Row),
    Event(&'a Event),
}

fn json(Measured { rows, events, .. }: &Measured) -> Result<String> {
    let (rows, events) = (rows.iter().map(Element::Codec), events.iter().map(Element::Event));
    Ok(serde_json::to_string_pretty(&rows.chain(events).collect::<Vec<_>>())?)
}

/// Runs the named programs, or all, on the named cores, or all. One is built while others run.
fn measure(programs: &[&str], cores: &[&str]) -> Result<Measured> {
    let boards = boards(cores)?;
    let wanted = |program: &&str| programs.is_empty() || programs.contains(program);
    let programs: Vec<&str> = SAMPLES.into_iter().chain([EVENTS]).filter(wanted).collect();
    thread::scope(|scope| {
        let mut runs = Vec::new();
        for board in boards {
            eprintln!("Building and running on {} ({}).", board.core, board.machine);
            let built = build(board)?;
            for &program in &programs {
                let image = built.with_file_name(program);
                runs.push(scope.spawn(move || {
                    let printed = qemu::run_counting(board, &image)?;
                    read(board, program, &image, &printed)
                        .with_context(|| format!("on {}", board.core))
                }));
            }
        }
        let mut measured = Measured::default();
        for run in runs {
            let one = run.join().unwrap_or_else(|_| bail!("its thread panicked"))?;
            measured.rows.extend(one.rows);
            measured.events.extend(one.events);
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

/// Builds the programs, which lie beside what is returned.
fn build(board: &Board) -> Result<PathBuf> {
    let directory = paths::thumb_target().join("bench").join(board.machine);
    let (mut cargo, built) = firmware::building("bench-target", board, &directory)?;
    // Names that tell Rust's functions from the runtime's; and no debug information, which takes time.
    cargo
        .env("RUSTFLAGS", format!("-C target-cpu={} -C symbol-mangling-version=v0", board.cpu))
        .env("CARGO_PROFILE_RELEASE_DEBUG", "0")
        .env("TICKS_PER_GIGAINSTRUCTION", board.ticks_per_gigainstruction().to_string());
    shell::output(&mut cargo).with_context(|| format!("for {}", board.machine))?;
    Ok(built)
}

fn read(board: &Board, program: &str, image: &Path, printed: &str) -> Result<Measured> {
    let rustc = code::compiler(image)?;
    if program == EVENTS {
        let events = printed.lines().map(|line| Event::read(board, line));
        return Ok(Measured { events: events.collect::<Result<_>>()?, rustc, rows: Vec::new() });
    }
    let code = Code::read(image)?;
    let row = |line: &str| {
        let printed: Printed = serde_json::from_str(line).with_context(|| line.to_owned())?;
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
    Ok(Measured { rows, rustc, events: Vec::new() })
}

/// To a thousandth, or some would have 16 digits.
fn mean(total: u32, count: u32) -> f64 {
    (f64::from(total) / f64::from(count) * 1000.0).round() / 1000.0
}
