//! Python environments below the target directory, and the installation of this repository's package.

use super::host;
use crate::common::{command, lint, paths, run};
use anyhow::Result;
use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};
use tempfile::TempDir;

/// Returns the Python of an environment, which is created if it is missing.
pub fn environment(name: &str) -> Result<PathBuf> {
    let place = paths::target().join(name);
    let python = place.join("bin/python");
    if !python.is_file() {
        run(command("python3").args(["-m", "venv"]).arg(&place))?;
    }
    Ok(python)
}

/// Returns the Python of an environment with the packages that a file names.
pub fn environment_with(name: &str, requirements: &str) -> Result<PathBuf> {
    let python = environment(name)?;
    install(&python, &["--requirement", requirements])?;
    Ok(python)
}

/// Prepares `pip install` in the environment.
pub fn pip(python: &Path) -> Command {
    // The builder is a program of the environment.
    let mut pip = with_path(python);
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
    pip
}

/// Prepares a Python that finds the programs of its environment first.
pub fn with_path(python: &Path) -> Command {
    let mut own_first = command(python);
    let own = python.parent().map(PathBuf::from).into_iter();
    let others = env::var_os("PATH").unwrap_or_default();
    let all: Vec<PathBuf> = own.chain(env::split_paths(&others)).collect();
    if let Ok(path) = env::join_paths(all) {
        own_first.env("PATH", path);
    }
    own_first
}

/// Installs packages from PyPI.
pub fn install(python: &Path, what: &[&str]) -> Result<()> {
    run(pip(python).args(what))
}

/// Compiles the package in a profile of cargo, and installs it. In the profile `dev` it is linted like the other crates;
/// clippy would compile it without some optimisations, which takes 15 % of the speed.
pub fn package(python: &Path, profile: &str) -> Result<()> {
    let mut pip = pip(python);
    pip.args(["--no-build-isolation", "--no-deps", "--force-reinstall", "./bindings/python"]);
    pip.env("MATURIN_PEP517_ARGS", format!("--profile {profile}")).env("CARGO_INCREMENTAL", "0");
    run(if profile == "dev" { lint(&mut pip) } else { &mut pip })
}

/// Puts the package together without a wheel, which would compile its hundreds of dependencies once more; returns a
/// directory for `PYTHONPATH`, which goes with its handle.
pub fn package_of_tests(python: &Path) -> Result<TempDir> {
    let place = tempfile::tempdir()?;
    run(command("cp").args(["-r", "bindings/python/spikewire"]).arg(place.path()))?;
    fs::copy(host::python_module(python)?, place.path().join("spikewire/_native.abi3.so"))?;
    Ok(place)
}
