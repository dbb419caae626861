//! `cargo xtask loop`: flies a drone in RotorPy on spikes, in a Python environment of its own.

use crate::common::{command, output, paths, run, usage};
use crate::figures::{drawing, markdown};
use crate::programs::{boards::Board, host, image, python};
use anyhow::{Result, ensure};
use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

const PAGE: &str = "docs/loop.md";
/// A table, and the page that has it.
#[derive(Clone, Copy)]
struct Table {
    page: &'static str,
    marker: &'static str,
}

const fn on_page(marker: &'static str) -> Table {
    Table { page: PAGE, marker }
}

/// The tables of `minutes.py`: what is sent beside its rivals, flights of a minute, and bad lines.
const MINUTES: [Table; 3] = [on_page("rivals"), on_page("minutes"), on_page("lines")];
/// The tables of `table.py`: each code's flights when it is tuned by flying, when it is tuned on its error behind other
/// filters, and in a third world.
const TABLES: [Table; 3] =
    [on_page("loop"), on_page("filters"), Table { page: WORLDS, marker: "third" }];
/// The page of the simulated worlds.
const WORLDS: &str = "docs/simulation.md";
/// The page of the networks that fly, and its table of a chip's flights.
const NETWORKS: &str = "docs/flown-networks.md";
const CHIP: &str = "chip";
const PICTURE: &str = "docs/loop.svg";
const CRASH: &str = "docs/crash.svg";
const CHIP_PICTURE: &str = "docs/chip.svg";
/// The banks that `advise` takes.
const ADVISED: &str = "laptop/loop/advised.json";

/// The row of two tables that a check flies again.
const AGAIN: &str = "sod";
/// The way that a check flies again, in one condition.
const WAY: &str = "sod/numbered";

/// Flies a flip on the spikes of a code, and draws it.
pub fn fly(args: &[String]) -> Result<()> {
    if args.len() > 1 {
        return Err(usage("cargo xtask loop [CODE]".into()));
    }
    let python = environment()?;
    let picture = paths::target().join("loop.svg");
    run(program(&python, "picture.py").arg(&picture).args(args))?;
    println!("{} shows it, in a browser.", picture.display());
    Ok(())
}

/// Flies all codes, and writes tables and pictures into docs/loop.md.
pub fn write() -> Result<()> {
    let python = environment()?;
    drawing::keep(&draw(&python, "picture.py")?, PICTURE)?;
    drawing::keep(&draw(&python, "crash.py")?, CRASH)?;
    fs::write(paths::root().join(ADVISED), advised(&python)?)?;
    put(MINUTES, &output(program(&python, "minutes.py").arg("--anew"))?)?;
    put(TABLES, &output(&mut program(&python, "table.py"))?)
}

/// Flies the banks that `advise` takes anew, and writes the tables into docs/loop.md.
pub fn write_advised() -> Result<()> {
    let python = environment()?;
    let banks = advised(&python)?;
    fs::write(paths::root().join(ADVISED), &banks)?;
    let names = banks.lines().filter_map(|line| line.split('"').nth(1));
    put(TABLES, &output(program(&python, "table.py").args(names))?)
}

/// Writes the tables of the flights stored in `laptop/loop/verdicts.json` and `minutes.json` into docs/loop.md, without
/// flying.
pub fn write_tables() -> Result<()> {
    let python = environment()?;
    put(MINUTES, &output(program(&python, "minutes.py").arg("--print"))?)?;
    put(TABLES, &output(program(&python, "table.py").arg("--print"))?)
}

/// Asks `spikewire advise` for banks.
fn advised(python: &Path) -> Result<String> {
    output(program(python, "advised.py").arg(host::laptop()?))
}

fn put(places: [Table; 3], printed: &str) -> Result<()> {
    for (place, table) in tables(places, printed) {
        markdown::write(place.page, place.marker, &table)?;
    }
    Ok(())
}

/// Splits the output into tables at empty lines, each with its place.
fn tables(places: [Table; 3], printed: &str) -> impl Iterator<Item = (Table, String)> {
    let each = printed.split("\n\n").map(|table| format!("\n{}\n\n", table.trim_end()));
    places.into_iter().zip(each)
}

/// Checks that control is stable, that links carry what codecs make, and that the same seeds give the page's picture
/// and one of its rows.
pub fn verify() -> Result<()> {
    let python = environment()?;
    run(&mut program(&python, "test_loop.py"))?;
    run(&mut program(&python, "steps.py"))?;
    drawing::ensure_kept(&draw(&python, "picture.py")?, PICTURE, "cargo xtask write loop")?;
    drawing::ensure_kept(&draw(&python, "crash.py")?, CRASH, "cargo xtask write loop")?;
    for (name, places) in [("minutes.py", MINUTES), ("table.py", TABLES)] {
        let printed = output(program(&python, name).arg("--print"))?;
        for (place, table) in tables(places, &printed) {
            markdown::ensure_written(
                place.page,
                place.marker,
                &table,
                "cargo xtask write verdicts",
            )?;
        }
    }
    run(program(&python, "minutes.py").args(["--check", WAY]))?;
    ensure!(
        advised(&python)? == fs::read_to_string(paths::root().join(ADVISED))?,
        "`advise` takes other banks than {ADVISED} has; `cargo xtask write advised` flies them"
    );
    for (option, name) in [("--filters", PAGE), ("--third", WORLDS)] {
        let page = fs::read_to_string(paths::root().join(name))?;
        let table = output(program(&python, "table.py").args([option, AGAIN]))?;
        let row = table.lines().last().unwrap_or_default();
        println!("{row}");
        ensure!(
            page.lines().any(|line| line == row),
            "{name} has another row; `cargo xtask write loop` flies all"
        );
    }
    Ok(())
}

/// Flies all manoeuvres with a network on the model of tinyODIN: the page's table and picture of it must come again
/// from the committed graph.
pub fn chip() -> Result<()> {
    let (python, command) = (environment()?, "cargo xtask write chip");
    drawing::ensure_kept(&draw(&python, "chip_picture.py")?, CHIP_PICTURE, command)?;
    markdown::ensure_written(NETWORKS, CHIP, &on_chip(&python)?, command)
}

/// Flies all manoeuvres with a network on the model of tinyODIN, writes the table into docs/flown-networks.md, and
/// draws the picture.
pub fn write_chip() -> Result<()> {
    let python = environment()?;
    drawing::keep(&draw(&python, "chip_picture.py")?, CHIP_PICTURE)?;
    markdown::write(NETWORKS, CHIP, &on_chip(&python)?)
}

fn on_chip(python: &Path) -> Result<String> {
    let flown = output(program(python, "chip.py").arg(host::laptop()?))?;
    println!("{flown}");
    Ok(format!("\n{flown}\n"))
}

/// Flies a short manoeuvre on an emulated board, in lockstep with the simulation: each bit must be the laptop's.
pub fn board() -> Result<()> {
    let python = environment()?;
    let image = image::build("in-the-loop", Board::with("M4F")?)?;
    run(program(&python, "board.py").arg(image))
}

fn draw(python: &Path, name: &str) -> Result<PathBuf> {
    let picture = paths::target().join(name).with_extension("svg");
    run(program(python, name).arg(&picture))?;
    Ok(picture)
}

/// Returns a program of `laptop/loop`, to be run with this Python.
pub(super) fn program(python: &Path, name: &str) -> Command {
    let mut program = command(python);
    program.arg(paths::root().join("laptop/loop").join(name));
    program
}

/// Returns an environment with `RotorPy` and with this repository's package, compiled like its tests.
pub(super) fn environment() -> Result<PathBuf> {
    println!(
        "Installs in target/loop, from PyPI: what laptop/loop/requirements.txt names, 1.2 GB."
    );
    let python = python::environment_with("loop", "laptop/loop/requirements.txt")?;
    python::package(&python, "dev")?;
    Ok(python)
}
