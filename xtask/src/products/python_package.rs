//! The Python package: every day built from what the tests are built of, in the long checks installed as a user
//! installs it.

use crate::common::{cargo, command, output, paths, run};
use crate::products::c_library;
use crate::programs::host;
use crate::programs::python::{
    environment_with, install, package, package_of_tests, pip, with_path,
};
use anyhow::{Result, ensure};
use std::{
    fs,
    path::{Path, PathBuf},
};

/// The package's version, as in `bindings/python/Cargo.toml`.
const VERSION: &str = "0.1.0";

const REQUIREMENTS: &str = "bindings/python/requirements.txt";

/// Runs the package's tests, doctests, README and example.
pub fn python() -> Result<()> {
    let python = environment_with("python", REQUIREMENTS)?;
    let built = package_of_tests(&python)?;

    let flight = paths::target().join("flight-log.txt");
    fs::write(&flight, host::flight_log()?)?;
    let pytest = "-m pytest --quiet -rP --no-header --doctest-modules --doctest-ignore-import-errors bindings/python/tests --pyargs spikewire";
    let mut tests = command(&python);
    tests.args(pytest.split_whitespace()).env("FLIGHT_LOG", &flight);
    tests.env("PYTHONPATH", built.path());
    tests.env("SPIKEWIRE", host::laptop()?);
    run(tests.env("FLIGHTS", c_library::write_flights()?))?;
    let mut example = command(&python);
    example.arg("bindings/python/examples/flight.py").env("FLIGHT_LOG", &flight);
    run(example.env("PYTHONPATH", built.path()))?;
    source_package(&python).map(drop)
}

/// Encodes a thousand logs with the program and with Dask, and a few with Ray, each killed on the way.
pub fn fleet() -> Result<()> {
    let python = environment_with("python-fleet", REQUIREMENTS)?;
    install(&python, &["ray==2.60.0"])?;
    package(&python, "release")?;
    let tests = "-m pytest --quiet --no-header bindings/python/tests/test_dataset.py";
    run(command(&python).args(tests.split_whitespace()))?;
    let thousand =
        "test --release --package spikewire-cli --test dataset a_thousand -- --ignored --nocapture";
    run(cargo(thousand).env("FLEET_PYTHON", &python))
}

/// Writes the type stub of the schemes' classes.
pub fn write_stub() -> Result<()> {
    let python = environment_with("python", REQUIREMENTS)?;
    let built = package_of_tests(&python)?;
    let mut stub = command(&python);
    stub.arg("bindings/python/tests/stubs.py").env("PYTHONPATH", built.path());
    let stub = output(&mut stub)?;
    fs::write(paths::root().join("bindings/python/spikewire/_schemes.pyi"), stub)?;
    Ok(())
}

/// Builds the package from its source package, optimised, and compares its speed with plain Python and other libraries.
pub fn speed() -> Result<()> {
    let python = environment_with("python-speed", REQUIREMENTS)?;
    let packed = source_package(&python)?;
    let mut pip = pip(&python);
    // A build of its own, as a user has it.
    pip.args(["--no-build-isolation", "--no-deps", "--force-reinstall"]).arg(packed);
    run(&mut pip)?;
    run(command(&python).args(["bindings/python/examples/speed.py", "--check"]))
}

/// Trains networks of other libraries on the package's spikes, tests its layer of PyTorch, and writes the pages of its classes.
pub fn torch() -> Result<()> {
    let python = environment_with("python-torch", REQUIREMENTS)?;
    install(
        &python,
        &[
            "torch==2.15.0",
            "snntorch==1.0.0",
            "norse==1.1.0",
            "spikingjelly==2.0.0",
            "nir==1.0.8",
            "mypy==2.4.1",
            "pyright[nodejs]==1.1.414",
            "pdoc==16.0.0",
        ],
    )?;
    package(&python, "dev")?;
    let tests = "-m pytest --quiet --no-header --doctest-modules bindings/python/tests/test_torch.py bindings/python/tests/test_arrays.py bindings/python/tests/test_users.py bindings/python/tests/test_network.py bindings/python/tests/test_notebooks.py bindings/python/tests/test_readme.py --pyargs spikewire.torch";
    run(command(&python).args(tests.split_whitespace()).env("SPIKEWIRE", host::laptop()?))?;
    run(command(&python).arg("bindings/python/examples/fleet.py"))?;
    let typed = "-m mypy --strict bindings/python/tests/typed.py";
    run(command(&python).args(typed.split_whitespace()))?;
    for asked in ["bindings/python/tests/typed.py", "--ignoreexternal --verifytypes spikewire"] {
        let mut pyright = with_path(&python);
        pyright.args(["-m", "pyright"]).args(asked.split_whitespace());
        run(&mut pyright)?;
    }
    let pages = paths::target().join("python-pages");
    let mut pdoc = command(&python);
    pdoc.args(["-m", "pdoc", "--docformat", "google", "--no-show-source", "--output-directory"]);
    run(pdoc.arg(pages).args(["spikewire", "spikewire.torch"]))
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
