//! `cargo bench-target`: counts what every codec costs, and what an event costs on its way, exactly, on the emulated
//! boards.

mod baseline;
mod code;
pub mod cycles;
mod events;
mod figures;
pub mod listing;
mod loops;
mod measured;
mod slower;
mod stack;
mod table;

use crate::common::usage;
use crate::programs::boards::{BOARDS, Board};
use crate::programs::image;
use crate::setup::needs;
use anyhow::{Context, Result, bail, ensure};
use code::Code;
use events::Event;
use figures::{CORES, Row, cycles_max, cycles_mean, mean};
use measured::Measured;
use serde::{Deserialize, Serialize};
use stack::Stack;
use std::{path::Path, thread};

const USAGE: &str = "\
cargo bench-target [events | sets] [CORE]... [--json | --markdown | --baseline]
cargo bench-target loops [CORE]...

  events        not the codecs: only what an event costs in queue, links, formats and chips' words, and what sets of samples do
  sets          only what sets of six samples cost, in a bank and from there to frames
  loops         checks the cycles of small loops against those that were worked out by hand
  CORE          M0, M3, M4F, M7 or M33; all, if none is named
  --json        every figure, as an array of objects; those of an event have the kind `event`
  --markdown    the tables of docs/costs.md
  --baseline    makes these counts the ones that `cargo verify` compares with, and puts the tables into the docs";

/// Programs that count codecs, two for each sample type, and those that count events and sets of samples.
const CODECS: [&str; 8] =
    ["f32_1", "f32_2", "q16_16_1", "q16_16_2", "q8_8_1", "q8_8_2", "i16_1", "i16_2"];
const EVENTS: &str = "events";
const SETS: &str = "sets";
const LOOPS: &str = "loops";

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
    total_cycles: [u32; 2],
    max: u32,
    max_cycles: [u32; 2],
    plain_samples: u32,
    plain: u32,
    in_c: u32,
    in_c_cycles: [u32; 2],
    code: u32,
    state: u32,
    flash: u32,
    stack: u32,
}

pub fn bench(args: &[String]) -> Result<()> {
    let options: Vec<&str> = args.iter().map(String::as_str).collect();
    let named = options.iter().take_while(|arg| !arg.starts_with('-')).count();
    let (named, output) = options.split_at(named);
    if let [LOOPS, cores @ ..] = named {
        needs::ensure_met()?;
        return boards(cores)?.into_iter().try_for_each(loops::verify);
    }
    let (programs, cores): (&[&str], _) = match named {
        [EVENTS, cores @ ..] => (&[EVENTS, SETS], cores),
        [SETS, cores @ ..] => (&[SETS], cores),
        cores => (&[], cores),
    };
    needs::ensure_met()?;
    match *output {
        [] => {
            let Measured { rows, events, .. } = measure(programs, cores)?;
            print!("{}{}", table::text(&rows), events::text(&events));
        }
        ["--json"] => println!("{}", json(&measure(programs, cores)?)?),
        ["--markdown"] => print!("{}", table::markdown(&measure(programs, &CORES)?)?),
        ["--baseline"] => {
            let measured = measure(&[], &baseline::CORES)?;
            baseline::write(&measured)?;
            table::write(&measured)?;
        }
        _ => return Err(usage(USAGE.into())),
    }
    Ok(())
}

/// Writes the tables into docs/costs.md and the files beside it, and the short ones into README.md.
pub fn write() -> Result<()> {
    needs::ensure_met()?;
    table::write(&measure(&[], &CORES)?)
}

/// Writes the table of stacks into docs/costs.md, and all of them beside it.
pub fn write_stack() -> Result<()> {
    needs::ensure_met()?;
    table::write_stack(&measure(&CODECS, &CORES)?)
}

/// Maximum stack of a codec, in bytes.
const MOST_STACK: u32 = 1024;

/// Fails if a codec's stack has no bound, has one above `MOST_STACK`, or was seen deeper than its bound.
pub fn verify_stack() -> Result<()> {
    let measured = measure(&CODECS, &CORES)?;
    let mut deepest = 0;
    for row in &measured.rows {
        let (Row { core, codec, sample, direction, form, .. }, seen) = (row, row.stack_bytes);
        let of = format!("{core} {codec} {sample} {direction} {form}");
        let bound = row.stack_bound_bytes.with_context(|| format!("{of}: no bound"))?;
        ensure!(seen <= bound, "{of}: {seen} bytes of stack were seen, where the bound is {bound}");
        ensure!(bound <= MOST_STACK, "{of}: {bound} bytes of stack");
        deepest = deepest.max(bound);
    }
    println!("{} stacks; the deepest may take {deepest} bytes.", measured.rows.len());
    Ok(())
}

/// Fails if small loops take other cycles than calculated, if anything takes more instructions on a core than it did,
/// if 16-bit counts or plain C are exceeded by more than allowed, or if six channels take more than promised.
pub fn verify(core: &str) -> Result<()> {
    loops::verify(Board::with(core)?)?;
    let measured = measure(&[], &[core])?;
    if core == events::PROMISED {
        events::ensure_six_channels_fit(&measured.events)?;
    }
    baseline::compare(core, &measured)
}

/// An element of the array in which codecs and events are printed.
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
    let programs: Vec<&str> = CODECS.into_iter().chain([EVENTS, SETS]).filter(wanted).collect();
    thread::scope(|scope| {
        let mut runs = Vec::new();
        for board in boards {
            let images = image::build_all("bench-target", &programs, board)?;
            for &program in &programs {
                let image = images.join(program);
                runs.push(scope.spawn(move || {
                    let printed = cycles::run_counting(board, &image)?;
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
            measured.compilers = one.compilers;
        }
        measured.group();
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

fn read(board: &Board, program: &str, image: &Path, printed: &str) -> Result<Measured> {
    let compilers = code::compilers(image)?;
    if [EVENTS, SETS].contains(&program) {
        let events = printed.lines().map(|line| Event::read(board, line));
        return Ok(Measured {
            events: events.collect::<Result<_>>()?,
            compilers,
            rows: Vec::new(),
        });
    }
    let (code, stack) = (Code::read(image)?, Stack::read(image)?);
    let row = |line: &str| {
        let printed: Printed = serde_json::from_str(line).with_context(|| line.to_owned())?;
        let seen = printed.stack.saturating_sub(stack.between(printed.code));
        let bound = stack.depth(printed.code).ok().filter(|bound| !bound.is_blind);
        Ok(Row {
            core: board.core,
            instructions_mean: mean(printed.total, printed.samples),
            instructions_max: printed.max,
            cycles_mean: cycles_mean(printed.total_cycles, printed.samples),
            cycles_max: cycles_max(printed.max_cycles),
            plain_mean: (printed.plain > 0).then(|| mean(printed.plain, printed.plain_samples)),
            in_c_mean: (printed.in_c > 0).then(|| mean(printed.in_c, printed.plain_samples)),
            in_c_cycles_mean: cycles_mean(printed.in_c_cycles, printed.plain_samples),
            code_bytes: code.bytes(printed.code),
            state_bytes: printed.state,
            flash_bytes: printed.flash,
            stack_bytes: seen,
            stack_bound_bytes: bound.map(|bound| bound.bytes),
            codec: printed.codec,
            direction: printed.direction,
            sample: printed.sample,
            form: printed.form,
            signal: printed.signal,
        })
    };
    let rows = printed.lines().map(row).collect::<Result<Vec<_>>>()?;
    Ok(Measured { rows, compilers, events: Vec::new() })
}
