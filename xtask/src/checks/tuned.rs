//! `cargo verify tuned`: compiles a constant that was tuned on a flight log, and compares its spikes with those that
//! the tuner scored.

use crate::common::{paths, shell};
use crate::figures::signal::Signal;
use crate::programs::{boards::BOARDS, host, image, qemu};
use anyhow::{Context, Result, ensure};
use serde_json::Value;
use std::fs;

/// A rate code with a filter in fixed point, which uses everything that a constant can hold.
const SCHEME: &str = "--scheme t-hsa --sample q16.16 --min-efficiency 60 --filter free";
/// A budget of settings rather than of time, so that each run finds the same ones.
const BUDGET: &str = "--evaluations 400 --seconds 600";
/// A core with a floating-point unit, and one without.
const CORES: [&str; 2] = ["M4F", "M0"];

/// Tunes on the recorded yaw rate, compiles the resulting constant into the example, and compares its spikes on
/// emulated boards with those of the encoder that was scored.
pub fn tuned() -> Result<()> {
    let (log, constant, parameters) = (
        paths::target().join("yaw.csv"),
        paths::target().join("yaw.rs"),
        paths::target().join("yaw.toml"),
    );
    // As the firmware has them: a `f64` says exactly what a `f32` is.
    let Signal { times, rates } = Signal::read();
    let rows =
        times.iter().zip(&rates).map(|(time, rate)| format!("{time},{}\n", f64::from(*rate)));
    fs::write(&log, ["time,gyro_z\n".to_owned()].into_iter().chain(rows).collect::<String>())?;

    let common = format!("tune {} --channel gyro_z {SCHEME} {BUDGET}", log.display());
    let told = shell::output(&mut host::spikewire(&format!("{common} --json"))?)?;
    let told: Value = serde_json::from_str(&told).context("the figures of `spikewire tune`")?;
    let scored = told["summary"]["channels"]["gyro_z"][0]["whole"]["spikes"]
        .as_u64()
        .context("no count of spikes")?;
    for (kind, path) in [("rust", &constant), ("toml", &parameters)] {
        let emit = format!("{common} --emit {kind} -o {}", path.display());
        shell::output(&mut host::spikewire(&emit)?)?;
    }
    println!("{}", fs::read_to_string(&constant)?);

    let encode =
        format!("encode --params {} --column gyro_z {}", parameters.display(), log.display());
    let encoded = shell::output(&mut host::spikewire(&encode)?)?;
    let lines = encoded.lines().filter(|line| !line.starts_with('#')).skip(1);
    let spikes: Vec<String> = lines
        .map(|line| match line.split(',').collect::<Vec<_>>()[..] {
            [index, _, sign, ..] => format!("{index},{sign}"),
            _ => line.to_owned(),
        })
        .collect();
    ensure!(spikes.len() as u64 == scored, "{scored} spikes were scored, {} encoded", spikes.len());

    for board in BOARDS.iter().filter(|board| CORES.contains(&board.core)) {
        let image = image::build_with("tuned", board, &[("TUNED", &constant)])?;
        let flown = qemu::run(board, &image)?;
        let flown: Vec<&str> = flown.lines().collect();
        ensure!(flown == spikes, "{}: other spikes than the tuner scored", board.core);
        println!("{}: {} spikes, each where the tuner scored it", board.core, flown.len());
    }
    Ok(())
}
