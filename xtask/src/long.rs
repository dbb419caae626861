//! The checks of `cargo verify --long`, which take too long for every change.

use crate::{
    bench, paths,
    shell::{cargo, run},
};
use anyhow::{Context, Result, ensure};
use std::fs;

/// The recordings, and what they are extracted into for the comparison.
const RECORDINGS: [&str; 2] = ["hexarotor.csv", "vtol_at_rest.csv"];

/// Extracts the flights from the logs in two published crates, and compares them with the files in `data`.
pub fn recordings() -> Result<()> {
    let extracted = paths::target().join("recordings");
    fs::create_dir_all(&extracted)?;
    let program = "run --package host-tests --features extract --bin extract_flight --";
    run(cargo(program).arg(&extracted))?;
    for name in RECORDINGS {
        let read = |path: std::path::PathBuf| {
            fs::read_to_string(&path).with_context(|| path.display().to_string())
        };
        let (kept, new) =
            (read(paths::root().join("data").join(name))?, read(extracted.join(name))?);
        ensure!(kept == new, "data/{name} is not what the log holds");
    }
    println!("{} are what the logs hold.", RECORDINGS.join(" and "));
    Ok(())
}

/// Exhaustive sweeps. Those against other people's programs have a check of their own.
pub fn sweeps() -> Result<()> {
    let tests = "test --release --package spikewire --package host-tests --all-features --tests";
    run(&mut cargo(&format!("{tests} -- --ignored --skip peers")))
}

/// Lints and tests the laptop program with all features.
pub fn capture() -> Result<()> {
    let package = "--package spikewire-cli --all-features";
    run(&mut cargo(&format!("clippy {package} --all-targets -- -D warnings")))?;
    run(&mut cargo(&format!("test {package} --test capture")))
}

/// The counts of the cores that `cargo verify` leaves out are shown; there is no baseline of them.
pub fn cores() -> Result<()> {
    bench::bench(&[])
}
