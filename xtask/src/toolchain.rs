//! Which cargo builds for a Cortex-M.

use crate::{distribution, paths, shell};
use anyhow::{Result, ensure};
use std::{fs, path::PathBuf, process::Command};

/// The Cortex-M cores that the crate is built for.
pub const TARGETS: [&str; 4] = [
    "thumbv6m-none-eabi",
    "thumbv7m-none-eabi",
    "thumbv7em-none-eabihf",
    "thumbv8m.main-none-eabihf",
];

/// Cargo for a Cortex-M target: `cargo …` where the toolchain in use has its core library, and
/// `cargo +thumb …`, the distribution's compiler as `cargo xtask setup` prepares it, where it has not.
/// It builds into a directory of its own, since that may be another compiler.
pub fn cargo_for(target: &str, args: &str) -> Result<Command> {
    let mut cargo = shell::command("cargo");
    if !has_core(target)? {
        ensure!(
            distribution::has_core(target)?,
            "nothing here builds for {target}; `cargo xtask setup` mends that"
        );
        if shell::has("rustup") {
            cargo.arg("+thumb");
        }
    }
    cargo.args(args.split_whitespace());
    cargo.args(["--target", target]);
    cargo.env("CARGO_TARGET_DIR", paths::thumb_target());
    Ok(cargo)
}

/// Whether the toolchain in use can build for the target.
pub fn has_core(target: &str) -> Result<bool> {
    let mut rustc = shell::command("rustc");
    rustc.args(["--print", "target-libdir", "--target", target]);
    let libraries = PathBuf::from(shell::output(&mut rustc)?.trim());
    let found = fs::read_dir(libraries).is_ok_and(|mut files| {
        files.any(|file| {
            file.is_ok_and(|file| file.file_name().to_string_lossy().starts_with("libcore-"))
        })
    });
    Ok(found)
}
