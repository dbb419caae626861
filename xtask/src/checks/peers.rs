//! Checks against other people's programs: they read what is written here, and their output is read here.

use crate::common::{cargo, command, paths, run};
use crate::programs::{
    host::{self, tests},
    python::{self, environment_with},
};
use anyhow::Result;
use std::fs;

/// Installs the Python packages in an environment of their own, and runs the tests that need them.
pub fn peers() -> Result<()> {
    let python = environment_with("peers", "cameras/peers/requirements.txt")?;
    fs::create_dir_all(paths::target().join("tmp"))?; // cargo makes it where it compiles the tests
    run(tests("--test cameras peers -- --ignored")?.env("PEERS_PYTHON", &python))?;
    run(tests("--test network -- --ignored")?.env("PEERS_PYTHON", &python))
}

/// Checks logs of every kind with other people's programs, as writers and as readers.
pub fn logs() -> Result<()> {
    let python = environment_with("logs", "laptop/cli/python/logs_requirements.txt")?;
    let program = host::laptop()?;
    let place = paths::target().join("logs-check");
    let recording = paths::root().join("data/hexarotor.csv");
    let check = paths::root().join("laptop/cli/python/logs_check.py");
    run(command(&python).arg(check).args([&program, &recording, &place]))?;
    let check = paths::root().join("laptop/cli/python/tables_check.py");
    let tables = paths::target().join("tables-check");
    run(command(&python).arg(check).args([program, recording, tables]))?;
    run(&mut cargo("build --package flight-logs --example numbers"))?;
    let numbers = paths::target().join("debug/examples/numbers");
    let check = paths::root().join("laptop/cli/python/ardupilot_check.py");
    run(command(&python).arg(check).args([numbers, place]))
}

/// Compares `spikewire tune` with other people's optimisers.
pub fn tuner() -> Result<()> {
    let python = environment_with("tuner", "laptop/cli/python/tune_requirements.txt")?;
    python::package(&python, "release")?;
    let results = paths::target().join("tuner/peers.json");
    let recording = paths::root().join("data/hexarotor.csv").display().to_string();
    let check = paths::root().join("laptop/cli/python/tune_peers.py");
    let channels = ":gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z";
    // Beyond 300 settings, TPE would take most of the time.
    let signals = ["1", &(recording + channels), "--tpe", "300"];
    run(command(&python).arg(check).arg(results).args(signals))
}
