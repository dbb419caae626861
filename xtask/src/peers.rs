//! Other people's programs, to read what we write and write what we read.

use crate::{
    host::tests,
    paths,
    shell::{command, run},
};
use anyhow::Result;

/// Installs the Python packages in an environment of their own and runs the tests against them.
pub fn peers() -> Result<()> {
    let environment = paths::target().join("peers");
    let python = environment.join("bin/python");
    if !python.is_file() {
        run(command("python3").args(["-m", "venv"]).arg(&environment))?;
    }
    let install =
        ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--requirement"];
    run(command(&python).args(install).arg("host-tests/peers/requirements.txt"))?;
    run(tests("--test all formats_peers -- --ignored")?.env("PEERS_PYTHON", &python))?;
    run(tests("--test network -- --ignored")?.env("PEERS_PYTHON", &python))
}
