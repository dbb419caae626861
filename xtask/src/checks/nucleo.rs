//! `cargo verify nucleo`: compiles and links the whole program in docs/firmware.md, with the HAL that it names.

use crate::common::{paths, run};
use crate::programs::published;
use crate::setup::toolchain;
use anyhow::{Context, Result};
use std::fs;

const PAGE: &str = "docs/firmware.md";
const HEADING: &str = "## A firmware of your own";
/// Its blocks of code, by their languages.
const FILES: [(&str, &str); 4] = [
    ("toml", "Cargo.toml"),
    ("rust", "src/main.rs"),
    ("text", "memory.x"),
    ("ini", ".cargo/config.toml"),
];

pub fn nucleo() -> Result<()> {
    let page = fs::read_to_string(paths::root().join(PAGE))?;
    let (_, section) = page.split_once(HEADING).context(HEADING)?;
    let project = tempfile::tempdir()?;
    for (language, file) in FILES {
        let (_, rest) = section.split_once(&format!("```{language}\n")).context(language)?;
        let (code, _) = rest.split_once("```").context(language)?;
        let path = project.path().join(file);
        fs::create_dir_all(path.parent().context(file)?)?;
        fs::write(path, code)?;
    }
    let mut cargo = toolchain::cargo_for("thumbv7em-none-eabihf", "build --release")?;
    run(cargo.args(["--config", &published::patch()?]).current_dir(project.path()))
}
