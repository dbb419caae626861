//! `cargo verify nucleo`: compiles and links the whole program of docs/firmware.md, with the HAL that it names.

use crate::common::{paths, run};
use crate::programs::published;
use crate::setup::toolchain;
use anyhow::{Context, Result};
use std::fs;

/// The program, and the files that a reader copies.
const PROGRAM: &str = "templates/nucleo";
const FILES: [&str; 4] = ["Cargo.toml", "src/main.rs", "memory.x", ".cargo/config.toml"];

pub fn nucleo() -> Result<()> {
    let project = tempfile::tempdir()?;
    for file in FILES {
        let path = project.path().join(file);
        fs::create_dir_all(path.parent().context(file)?)?;
        fs::copy(paths::examples().join(PROGRAM).join(file), path).context(file)?;
    }
    let mut cargo = toolchain::cargo_for("thumbv7em-none-eabihf", "build --release")?;
    run(cargo.args(["--config", &published::patch()?]).current_dir(project.path()))
}
