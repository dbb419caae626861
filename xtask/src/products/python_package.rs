//! The Python package, installed as a user installs it.

use crate::common::{cargo, command, output, paths, run};
use crate::products::c_library;
use crate::programs::host;
use crate::programs::python::{environment, install, package, pip};
use crate::setup;
use anyhow::{Result, ensure};
use std::{
    fs,
    path::{Path, PathBuf},
};

/// The package's version, as in `bindings/python/Cargo.toml`.
const VERSION: &str = "0.1.0";

/// Installs the package in an environment of its own, and runs its tests, doctests, README and example.
///
/// It is compiled with the same options as the other tests, so that they share dependencies.
pub fn python() -> Result<()> {
    let python = environment("python")?;
    install(&python, &["--requirement", "bindings/python/requirements.txt"])?;
    package(&python, "dev")?;

    let flight = paths::target().join("flight-log.txt");
    fs::write(&flight, host::flight_log()?)?;
    let pytest = "-m pytest --quiet -rP --no-header --doctest-modules bindings/python/tests --pyargs spikewire";
    let mut tests = command(&python);
    tests.args(pytest.split_whitespace()).env("FLIGHT_LOG", &flight);
    run(&mut cargo("build --package spikewire-cli"))?;
    tests.env("SPIKEWIRE", paths::target().join("debug/spikewire"));
    run(tests.env("FLIGHTS", c_library::write_flights()?))?;
    run(command(&python).arg("bindings/python/examples/flight.py").env("FLIGHT_LOG", &flight))?;
    source_package(&python).map(drop)
}

/// Encodes a thousand logs with the program and with Dask, each killed on the way, and trains a network on logs.
///
/// Debian's torch needs no GPU libraries, but works only with Debian's Python.
pub fn fleet() -> Result<()> {
    let python = environment("python-fleet")?;
    install(&python, &["--requirement", "bindings/python/requirements.txt"])?;
    package(&python, "release")?;
    let thousand =
        "test --release --package spikewire-cli --test dataset a_thousand -- --ignored --nocapture";
    run(cargo(thousand).env("FLEET_PYTHON", &python))?;

    setup::packages("torch, for the system's Python", &["python3-torch", "python3-venv"])?;
    let place = paths::target().join("python-torch");
    let torch = place.join("bin/python");
    if !torch.is_file() {
        run(command("/usr/bin/python3")
            .args(["-m", "venv", "--system-site-packages"])
            .arg(&place))?;
    }
    let pinned = ["bindings/python/examples/requirements.txt", "bindings/python/requirements.txt"];
    install(
        &torch,
        &["--no-deps", "--requirement", pinned[0], "--constraint", pinned[1], "maturin"],
    )?;
    package(&torch, "release")?;
    run(command(&torch).arg("bindings/python/examples/fleet.py"))
}

/// Writes the type stub of the schemes' classes.
pub fn write_stub() -> Result<()> {
    let python = environment("python")?;
    install(&python, &["--requirement", "bindings/python/requirements.txt"])?;
    package(&python, "dev")?;
    let stub = output(command(&python).arg("bindings/python/tests/stubs.py"))?;
    fs::write(paths::root().join("bindings/python/spikewire/_schemes.pyi"), stub)?;
    Ok(())
}

/// Builds the package from its source package, optimised, and compares its speed with plain Python and other libraries.
pub fn speed() -> Result<()> {
    let python = environment("python-speed")?;
    install(&python, &["--requirement", "bindings/python/requirements.txt"])?;
    let packed = source_package(&python)?;
    let mut pip = pip(&python);
    // A build of its own, as a user has it.
    pip.args(["--no-build-isolation", "--no-deps", "--force-reinstall"]).arg(packed);
    run(&mut pip)?;
    run(command(&python).args(["bindings/python/examples/speed.py", "--check"]))
}

/// Makes the source package, which must contain all that the package is built from.
fn source_package(python: &Path) -> Result<PathBuf> {
    let place = paths::target().join("python-source");
    let maturin = python.with_file_name("maturin");
    let manifest = "bindings/python/Cargo.toml";
    run(command(maturin).args(["sdist", "--manifest-path", manifest, "--out"]).arg(&place))?;
    let packed = place.join(format!("spikewire-{}.tar.gz", VERSION));
    let listed = output(command("tar").arg("--list").arg("--file").arg(&packed))?;
    for file in [
        "LICENSE-MIT",
        "LICENSE-APACHE",
        "README.md",
        "baseline.json",
        "py.typed",
        "catalogue/src/lib.rs",
    ] {
        ensure!(listed.contains(file), "the source package lacks {file}");
    }
    Ok(packed)
}
