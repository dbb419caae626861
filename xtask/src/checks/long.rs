//! The steps of `cargo verify --long`, which take too long for every change.

use crate::checks::{everyday::check_for, fifo, logging};
use crate::common::{cargo, paths, run};
use crate::figures::bench;
use crate::setup::toolchain::{TARGETS, cargo_for};
use anyhow::{Context, Result, ensure};
use std::{
    fs,
    time::{SystemTime, UNIX_EPOCH},
};

/// The recordings, and the files into which they are extracted for the comparison.
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

/// Runs every test, optimised, with many more cases, drawn from a fresh seed unless `SWEEPS_SEED` is set. Tests against
/// other people's programs, and flights with faults, are steps of their own.
pub fn sweeps() -> Result<()> {
    let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH)?;
    let seed = std::env::var("SWEEPS_SEED").unwrap_or_else(|_| since_1970.as_micros().to_string());
    println!("SWEEPS_SEED={seed} draws these cases again.");
    let tests = "test --release --package spikewire --package spikewire-cameras --package spikewire-chips --package host-tests --package lab --package spikewire-cli --tests";
    let mut all = cargo(&format!(
        "{tests} --no-fail-fast -- --include-ignored --skip peers:: --skip hours_of_flight"
    ));
    run(all.env("CASES_TIMES", "20").env("PROPTEST_RNG_SEED", &seed))?;
    let mut catalogue = cargo("test --release --package catalogue --lib");
    run(catalogue.env("PROPTEST_CASES", "5120").env("PROPTEST_RNG_SEED", &seed))
}

/// Tests the codes with the loops for a core without vectors, as on a Cortex-M, and networks with the code of a
/// Cortex-M0; the host does not run these by default.
pub fn scalar() -> Result<()> {
    for tests in ["--package host-tests --test codes", "--package spikewire-network --tests"] {
        let mut cargo = cargo(&format!("test {tests}"));
        cargo.env("RUSTFLAGS", "--cfg without_vectors");
        run(cargo.env("CARGO_TARGET_DIR", paths::target().join("scalar")))?;
    }
    Ok(())
}

/// Explores the memory orderings of the lock-free queue.
pub fn loom() -> Result<()> {
    run(&mut cargo("test --package host-tests --features loom --test loom -- --test-threads 1"))
}

/// Compares the speed of slices with another crate's, which compiles with an older Rust than it asks for.
pub fn beside() -> Result<()> {
    let program =
        "run --release --quiet --ignore-rust-version --manifest-path laptop/beside/Cargo.toml";
    run(cargo(program).arg("--target-dir").arg(paths::target().join("beside")))
}

/// Runs the lints that `clippy` and the builds of firmware leave out.
pub fn lints() -> Result<()> {
    let warnings = ["--", "-D", "warnings"];
    run(cargo("clippy --workspace --all-targets --all-features").args(warnings))?;
    let library = "clippy --manifest-path bindings/c/Cargo.toml --features header --all-targets";
    run(cargo(library).args(warnings))?;
    let firmware = "clippy --workspace --manifest-path examples/Cargo.toml";
    run(cargo(firmware).args(warnings))?;
    check_for(&TARGETS)?;
    // One core stands for all: the firmware's source has no conditions on the core.
    run(cargo_for("thumbv7em-none-eabihf", firmware)?.args(warnings))
}

/// Tests the part of the laptop program that needs the feature `capture`.
pub fn capture() -> Result<()> {
    run(&mut cargo("test --package spikewire-cli --all-features --test capture"))
}

/// Counts on the cores that `cargo verify` leaves out; the counts are printed, as there is no baseline for them.
pub fn cores() -> Result<()> {
    bench::bench(&[])?;
    logging::on("M0")?;
    fifo::count("M7")
}
