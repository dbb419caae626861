//! Builds for the host. All checks build with the same options, so that each crate is compiled once.

use super::published::CRATES;
use crate::common::{cargo, command, lint, output, paths, run};
use anyhow::{Context, Result};
use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Prepares `cargo test` for the whole workspace, with every feature except two: the debug probe's driver, and `defmt`,
/// whose symbols keep a shared library such as the Python package from linking. Lints while compiling.
pub fn tests(args: &str) -> Result<Command> {
    workspace("test", args)
}

/// Builds an example of a crate of the workspace, as for the tests; returns its path.
pub fn example_of_tests(name: &str) -> Result<PathBuf> {
    run(workspace("build", "--quiet --example")?.arg(name))?;
    Ok(paths::target().join("debug/examples").join(name))
}

fn workspace(verb: &str, args: &str) -> Result<Command> {
    let mut features = vec!["host-tests/extract".to_owned()];
    for own in CRATES {
        let names = own.features()?.into_iter().filter(|name| name != "defmt");
        features.extend(names.map(|name| format!("{}/{name}", own.name)));
    }
    let mut cargo = cargo(verb);
    cargo.args(["--workspace", "--features"]);
    cargo.arg(features.join(",")).args(args.split_whitespace());
    lint(&mut cargo);
    Ok(cargo)
}

/// Prepares the laptop program, built as for its tests; arguments are separated by blanks.
pub fn spikewire(args: &str) -> Result<Command> {
    let mut spikewire = command(laptop()?);
    spikewire.args(args.split_whitespace());
    Ok(spikewire)
}

/// Builds the laptop program as for its tests; returns its path.
pub fn laptop() -> Result<PathBuf> {
    run(&mut tests("--quiet --no-run --test pipes")?)?; // a test that runs the program, so that cargo builds that too
    Ok(paths::target().join("debug/spikewire"))
}

/// Builds the native half of the Python package for this interpreter, out of what the tests are built of; returns its
/// path.
pub fn python_module(python: &Path) -> Result<PathBuf> {
    // With an example, whose features are those of the tests.
    let mut build = workspace("build", "--quiet --lib --example mistaken")?;
    // What maturin sets: the interpreter has the symbols.
    run(build.env("PYO3_BUILD_EXTENSION_MODULE", "1").env("PYO3_PYTHON", python))?;
    Ok(paths::target().join("debug").join(format!("{DLL_PREFIX}_native{DLL_SUFFIX}")))
}

/// Returns the host's target triple.
pub fn triple() -> Result<String> {
    let version = output(command("rustc").arg("-vV"))?;
    let host = version.lines().find_map(|line| line.strip_prefix("host: "));
    host.map(str::to_owned).context("rustc -vV")
}

/// Builds one of the examples; returns its path.
pub fn example(program: &str) -> Result<PathBuf> {
    let target = paths::target();
    let mut cargo = cargo("build --quiet --manifest-path examples/Cargo.toml --package");
    run(cargo.arg(program).env("CARGO_TARGET_DIR", &target))?;
    Ok(target.join("debug").join(program))
}

/// Returns the output of an example on the host.
pub fn on_host(program: &str) -> Result<String> {
    output(&mut command(example(program)?))
}

/// Programs that fly the recorded flight through every scheme, each in two sample types.
pub const FLIGHT_LOG: [&str; 2] = ["flight-log", "flight-log-fixed"];

/// Returns the output of these programs on the host.
pub fn flight_log() -> Result<String> {
    FLIGHT_LOG.into_iter().map(on_host).collect()
}
