//! `cargo xtask firmware`: runs every example program on every emulated board, and compares its output with the host's;
//! `cargo verify firmware` on those of every day.

use crate::common::paths;
use crate::figures::bits;
use crate::programs::boards::{Board, RISC_V};
use crate::programs::host::{self, FLIGHT_LOG};
use crate::programs::{image, qemu, size};
use crate::setup::needs;
use anyhow::{Result, bail, ensure};
use std::{fs, path::PathBuf, thread};

/// Runs the named programs, or all, on all boards, and fails if one prints another line than the host.
pub fn firmware(names: &[String]) -> Result<()> {
    compare_on(names, Board::all(), "-")
}

/// Runs all programs on the boards of every day.
pub fn every_day() -> Result<()> {
    compare_on(&[], Board::every_day(), "=")
}

/// Runs the named programs, or all, on these boards. In docs/bits.csv, boards that do not run must have the mark `absent`.
fn compare_on(
    names: &[String],
    boards: impl Iterator<Item = &'static Board>,
    absent: &'static str,
) -> Result<()> {
    needs::ensure_met()?;
    let all = programs()?;
    let chosen = if names.is_empty() { &all } else { names };
    if let Some(other) = chosen.iter().find(|program| !all.contains(program)) {
        bail!("no program `{other}`; there are {all:?}");
    }
    let boards: Vec<_> = boards.collect();
    build(chosen, &boards)?;
    let (mut differing, mut flown) = (Vec::new(), Vec::new());
    for program in chosen {
        let (host, outcomes) = run(program, &boards)?;
        if !compare(program, &host, &outcomes)? {
            differing.push(program.as_str());
        }
        if FLIGHT_LOG.contains(&program.as_str()) {
            flown.extend(marked(&host, &outcomes, absent));
        }
    }
    if FLIGHT_LOG.iter().all(|program| chosen.iter().any(|chosen| chosen == program)) {
        bits::ensure_written(&bits::table(&flown))?;
    }
    if !differing.is_empty() {
        bail!("boards and host differ in {}", differing.join(", "));
    }
    Ok(())
}

/// Writes spike counts, and which bits agree, into docs/bits.csv.
pub fn write() -> Result<()> {
    needs::ensure_met()?;
    let boards: Vec<_> = Board::all().collect();
    build(&FLIGHT_LOG.map(str::to_owned), &boards)?;
    let mut flown = Vec::new();
    for program in FLIGHT_LOG {
        let (host, outcomes) = run(program, &boards)?;
        flown.extend(marked(&host, &outcomes, "-"));
    }
    bits::write(&bits::table(&flown))
}

/// Lists the programs: the directories of the firmware workspace with a `src/main.rs`. Those that are only linked, or
/// print too much for a table, name it otherwise; those for a single part are workspaces of their own.
fn programs() -> Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(paths::examples())? {
        let entry = entry?;
        let path = entry.path();
        if path.join("src/main.rs").is_file() && !path.join("Cargo.lock").is_file() {
            names.push(entry.file_name().to_string_lossy().into_owned());
        }
    }
    names.sort();
    Ok(names)
}

/// The outcome of a program on one board.
struct Outcome {
    board: &'static Board,
    image: PathBuf,
    printed: Result<String>,
}

impl Outcome {
    fn agrees(&self, host: &str) -> bool {
        self.printed.as_ref().is_ok_and(|printed| printed == host)
    }

    /// Returns the table's mark for one of the host's lines.
    fn mark(&self, line: &str) -> &'static str {
        match &self.printed {
            Ok(printed) if printed.lines().any(|printed| printed == line) => "=",
            Ok(_) => "DIFF",
            Err(_) => "FAIL",
        }
    }
}

/// Returns whether the program runs on the board: all do on a Cortex-M, the recorded flight on RISC-V, too.
fn runs_on(program: &str, board: &Board) -> bool {
    FLIGHT_LOG.contains(&program) || RISC_V.iter().all(|other| other.core != board.core)
}

/// Builds the programs for the boards.
fn build(programs: &[String], boards: &[&Board]) -> Result<()> {
    for board in boards {
        let names = programs.iter().map(String::as_str);
        let own: Vec<&str> = names.filter(|program| runs_on(program, board)).collect();
        if !own.is_empty() {
            image::build_each(&own, board)?;
        }
    }
    Ok(())
}

/// Runs a program on the host and on the boards for which it was built; returns the host's output, and each outcome.
fn run(program: &str, boards: &[&'static Board]) -> Result<(String, Vec<Outcome>)> {
    let host = host::on_host(program)?;
    ensure!(!host.is_empty(), "{program} prints nothing on the host");
    let own = boards.iter().copied().filter(|board| runs_on(program, board));
    let images: Vec<_> = own.map(|board| (board, image::directory(board).join(program))).collect();

    let outcomes = thread::scope(|scope| {
        let runs: Vec<_> =
            images.iter().map(|(board, image)| scope.spawn(|| qemu::run(board, image))).collect();
        images
            .iter()
            .zip(runs)
            .map(|((board, image), run)| Outcome {
                board,
                image: image.clone(),
                printed: run.join().unwrap_or_else(|_| bail!("its thread panicked")),
            })
            .collect()
    });
    Ok((host, outcomes))
}

/// Prints the outcomes of a program; returns true if every board agrees with the host.
fn compare(program: &str, host: &str, outcomes: &[Outcome]) -> Result<bool> {
    print_table(program, host, outcomes);
    for outcome in outcomes {
        print_difference(host, outcome);
    }
    for Outcome { board, image, .. } in outcomes {
        println!("{:4} {}", board.core, size::of(image, board)?);
    }
    let agree = outcomes.iter().all(|outcome| outcome.agrees(host));
    if agree {
        let (lines, boards) = (host.lines().count(), outcomes.len());
        println!("Every bit agrees: {lines} lines, host and {boards} boards.");
    }
    Ok(agree)
}

/// Returns the host's lines, each with its mark for every board: `absent` for one that did not run.
fn marked(host: &str, outcomes: &[Outcome], absent: &'static str) -> Vec<(String, String)> {
    let of = |board: &Board| outcomes.iter().find(|outcome| outcome.board.core == board.core);
    let mark = |board, line| of(board).map_or(absent, |outcome| outcome.mark(line));
    let marks = |line| Board::all().map(|board| mark(board, line)).collect::<Vec<_>>();
    host.lines().map(|line| (line.to_owned(), marks(line).join(" "))).collect()
}

/// Prints a row for each of the host's lines, with a column for each board.
fn print_table(program: &str, host: &str, outcomes: &[Outcome]) {
    let width = host.lines().map(|line| label(line).len()).max().unwrap_or(0);
    let width = width.max(program.len());
    print!("\n{program:width$}");
    for outcome in outcomes {
        print!(" {:>5}", outcome.board.core);
    }
    println!();
    for line in host.lines() {
        print!("{:width$}", label(line));
        for outcome in outcomes {
            print!(" {:>5}", outcome.mark(line));
        }
        println!();
    }
    println!();
}

/// Returns the line without its two columns of hexadecimal, which serve only for the comparison.
fn label(line: &str) -> &str {
    line.split_once(" rmse=").map_or(line, |(label, _)| label)
}

/// Prints the lines in which board and host differ, one below the other.
fn print_difference(host: &str, outcome: &Outcome) {
    let core = outcome.board.core;
    match &outcome.printed {
        Err(error) => println!("{core} failed: {error:#}"),
        Ok(_) if outcome.agrees(host) => {}
        Ok(printed) => {
            let only_in = |one: &str, other: &str, name: &str| {
                for line in one.lines() {
                    if !other.lines().any(|same| same == line) {
                        println!("only {name:4} {line}");
                    }
                }
            };
            println!("{core} and the host differ:");
            only_in(host, printed, "host");
            only_in(printed, host, core);
        }
    }
}
