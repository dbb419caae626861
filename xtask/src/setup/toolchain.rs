//! Chooses the cargo that builds for a microcontroller.

use crate::common::{paths, shell};
use crate::setup::distribution;
use anyhow::{Result, ensure};
use std::{fs, path::PathBuf, process::Command};

/// The microcontrollers' targets for which the crate is built.
pub const TARGETS: [&str; 6] = [
    "thumbv6m-none-eabi",
    "thumbv7m-none-eabi",
    "thumbv7em-none-eabihf",
    "thumbv8m.main-none-eabihf",
    "riscv32imc-unknown-none-elf",
    "riscv32imafc-unknown-none-elf",
];

/// Prepares cargo for a microcontroller's target: `cargo …` if the current toolchain has its core library, or else `cargo +thumb
/// …`, the distribution's compiler as `cargo xtask setup` prepares it. It builds into a separate directory, since the
/// compiler may differ.
pub fn cargo_for(target: &str, args: &str) -> Result<Command> {
    let by_default = has_core(target)?;
    ensure!(
        by_default || distribution::has_core(target)?,
        "nothing here builds for {target}; `cargo xtask setup` mends that"
    );
    Ok(cargo(by_default, &[target], args))
}

/// Prepares cargo for several targets: one call for all targets of a compiler, which then share what runs on the host.
pub fn cargo_for_each(targets: &[&str], args: &str) -> Result<Vec<Command>> {
    let (mut by_default, mut by_distribution) = (Vec::new(), Vec::new());
    for &target in targets {
        if has_core(target)? { &mut by_default } else { &mut by_distribution }.push(target);
    }
    let both = [(true, by_default), (false, by_distribution)];
    let some = both.iter().filter(|(_, targets)| !targets.is_empty());
    Ok(some.map(|(by_default, targets)| cargo(*by_default, targets, args)).collect())
}

fn cargo(by_default: bool, targets: &[&str], args: &str) -> Command {
    let mut cargo = shell::command("cargo");
    if !by_default && shell::has("rustup") {
        cargo.arg("+thumb");
    }
    cargo.args(args.split_whitespace());
    for target in targets {
        cargo.args(["--target", target]);
    }
    cargo.env("CARGO_TARGET_DIR", paths::thumb_target());
    // What a debugger needs is a fifth of the building time, and most of the disk.
    cargo.env("CARGO_PROFILE_RELEASE_DEBUG", "false");
    cargo.env("CARGO_INCREMENTAL", "0");
    cargo
}

/// Returns whether the current toolchain can build for the target.
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
