//! `cargo verify loop`: flies a whole control loop, with the models of tinyODIN and ReckOn in the firmware, and
//! compares board and host.

use crate::common::paths;
use crate::programs::{boards::Board, host, image, qemu};
use anyhow::{Context, Result, ensure};
use std::{fmt::Write, fs, path::PathBuf, process::Command};

const PROGRAM: &str = "rate-loop";

/// Arguments that bring the first network of the firmware from the file of its training; its code is that in
/// `trained.rs`.
const ROLL: &str = "network laptop/cli/tests/peers/roll.nir --scheme position --neurons 20 --min -2 --max 2 \
                       --reset zero --compare spike --no-held-out --column gyro_x data/hexarotor.csv";

/// Arguments that bring the second network, on ReckOn; its code is that in `recurrent.rs`. The two tables follow them.
const TURNS: &str = "network laptop/cli/tests/peers/turns.nir --chip reckon --scheme position --neurons 25 --min=-1.2 \
                     --max 1.2 --dt 0.005 --reset zero --column gyro_x";

/// Number of samples in a stretch of the flight; every third stretch is held out from the training of the second
/// network.
const STRETCH: usize = 250;

/// Compares the board's output with the host's, bit for bit, and the spikes of the trained networks with what
/// `spikewire network` predicts. The board has an STM32F405: tinyODIN's memories alone take 36 KiB.
pub fn rate_loop() -> Result<()> {
    let on_host = host::on_host(PROGRAM)?;
    ensure!(on_host.contains(" hash="), "{PROGRAM} tells no hash on the host");
    println!("host:\n{on_host}");
    let board = Board::with("M4F")?;
    let printed = qemu::run_repeatably(board, &image::build(PROGRAM, board)?)?;
    println!("{}:\n{printed}", board.core);
    for line in on_host.lines() {
        ensure!(printed.lines().any(|printed| printed == line), "not so on the board: {line}");
    }

    foretold(&mut host::spikewire(ROLL)?, "roll", &on_host)?;
    let [trained, held_out] = [false, true].map(table);
    foretold(
        host::spikewire(TURNS)?.arg(trained?).arg("--held-out").arg(held_out?),
        "turns",
        &on_host,
    )?;
    println!("Every bit agrees.");
    Ok(())
}

/// Runs `spikewire network`, which must make the firmware's constant and predict how often its neurons fire.
fn foretold(network: &mut Command, name: &str, on_host: &str) -> Result<()> {
    let said = network.output()?;
    let report = String::from_utf8_lossy(&said.stderr).into_owned();
    print!("{report}");
    ensure!(said.status.success(), "`spikewire network` refuses its own test's network");
    let constant = fs::read(paths::examples().join(format!("{PROGRAM}/src/{name}.rs")))?;
    ensure!(
        said.stdout == constant,
        "`spikewire network` makes another constant than src/{name}.rs"
    );
    let counted = on_host.lines().find_map(|line| of_firmware(line, name));
    let [foretold, counted] = [of_report(&report)?, counted.context("no spikes told")?];
    ensure!(foretold == counted, "{name}: {foretold} spikes foretold, {counted} counted");
    Ok(())
}

/// Writes a table of the stretches that the second network was trained on, or that were held out, as `turns.py` does.
fn table(is_held_out: bool) -> Result<PathBuf> {
    let flight = fs::read_to_string(paths::root().join("data/hexarotor.csv"))?;
    let rows: Vec<&str> = flight.lines().skip(1).collect();
    let chosen = rows.chunks(STRETCH).enumerate();
    let chosen = chosen.filter(|(at, _)| (at % 3 == 2) == is_held_out).flat_map(|(_, rows)| rows);
    let mut table = "time_s,gyro_x\n".to_owned();
    for (at, row) in chosen.enumerate() {
        let rate = row.split(',').nth(1).context("a row without a rate")?;
        writeln!(table, "{},{rate}", at as f64 / 200.0)?;
    }
    let name = if is_held_out { "held_out.csv" } else { "trained.csv" };
    let place = paths::target().join(PROGRAM);
    fs::create_dir_all(&place)?;
    let path = place.join(name);
    fs::write(&path, table)?;
    Ok(path)
}

/// Parses the number of spikes of the last layer on the chip: `name: neurons, clipped; spikes, on the chip, distance`.
fn of_report(report: &str) -> Result<u32> {
    let layers = report.lines().filter(|line| line.starts_with("node `"));
    let figures = layers.filter_map(|line| line.split_once("; "));
    let mut counts = figures.filter_map(|(_, figures)| figures.split(", ").nth(1)?.parse().ok());
    counts.next_back().context("no layer in the report")
}

/// Parses the number in `NAME: N spikes ...`.
fn of_firmware(line: &str, name: &str) -> Option<u32> {
    let (spikes, _) = line.strip_prefix(name)?.strip_prefix(": ")?.split_once(" spikes")?;
    spikes.parse().ok()
}
