//! Builds firmware.

use crate::common::{paths, shell};
use crate::programs::boards::Board;
use crate::setup::toolchain;
use anyhow::{Context, Result};
use std::{ffi::OsStr, fs, path::PathBuf, process::Command};

/// Builds the program for the board; returns the path of the image.
pub fn build(program: &str, board: &Board) -> Result<PathBuf> {
    Ok(build_each(&[program], board)?.join(program))
}

/// Builds programs that have a package each, in one call of cargo, which then compiles once what they share; returns
/// the directory with the images.
pub fn build_each(programs: &[&str], board: &Board) -> Result<PathBuf> {
    let packages: String = programs.iter().map(|program| format!("--package {program} ")).collect();
    kept(&mut building("build", &packages, board)?, &programs.join(", "), programs, board)
}

/// Builds the program for the board with these environment variables; returns the path of the image.
pub fn build_with(
    program: &str,
    board: &Board,
    variables: &[(&str, impl AsRef<OsStr>)],
) -> Result<PathBuf> {
    let mut cargo = building("build", &format!("--package {program}"), board)?;
    Ok(kept(
        cargo.envs(variables.iter().map(|(name, value)| (name, value))),
        program,
        &[program],
        board,
    )?
    .join(program))
}

/// Builds the package's programs for the board; returns the directory with the images.
pub fn build_all(package: &str, programs: &[&str], board: &Board) -> Result<PathBuf> {
    let mut cargo = building("build", &format!("--package {package}"), board)?;
    cargo.args(programs.iter().flat_map(|program| ["--bin", program]));
    kept(&mut cargo, package, programs, board)
}

/// Returns the directory with the images of a board: each has its own, as two share a target.
pub fn directory(board: &Board) -> PathBuf {
    paths::thumb_target().join("images").join(board.core)
}

fn kept(cargo: &mut Command, package: &str, programs: &[&str], board: &Board) -> Result<PathBuf> {
    let built = paths::thumb_target().join(board.target).join("release");
    shell::run(cargo).with_context(|| format!("{package} for {}", board.machine))?;

    let images = directory(board);
    fs::create_dir_all(&images)?;
    for program in programs {
        fs::copy(built.join(program), images.join(program)).context(program.to_string())?;
    }
    Ok(images)
}

/// Lints all programs as built for the board. Linting is separate from building: clippy's compiler leaves out
/// optimisations, so its code is not what a user gets.
pub fn lint_all(board: &Board) -> Result<()> {
    shell::run(shell::lint(&mut building("check", "--workspace", board)?))
        .with_context(|| format!("lints of the firmware for {}", board.machine))
}

/// Links the program for the board with a panic for every integer overflow, in a directory of its own.
pub fn link_checked(program: &str, board: &Board) -> Result<()> {
    let mut cargo = building("build", &format!("--package {program}"), board)?;
    cargo
        .env("CARGO_PROFILE_RELEASE_OVERFLOW_CHECKS", "true")
        .env("CARGO_TARGET_DIR", paths::thumb_target().join("checked"));
    shell::run(&mut cargo).with_context(|| format!("{program} for {}, checked", board.machine))
}

/// Prepares a build. All boards and checks share one directory and one profile, so that each crate is compiled once for
/// a core. Boards differ in the compiler's flags, by which cargo tells them apart.
fn building(command: &str, packages: &str, board: &Board) -> Result<Command> {
    let build = format!("{command} --release {packages} --manifest-path examples/Cargo.toml");
    let mut cargo = toolchain::cargo_for(board.target, &build)?;
    cargo
        .env("BOARD", board.machine)
        .env("TICKS_PER_GIGAINSTRUCTION", board.ticks_per_gigainstruction().to_string())
        // Names that tell Rust's functions from the runtime's, for `figures/bench/code.rs`.
        .env("RUSTFLAGS", format!("-C target-cpu={} -C symbol-mangling-version=v0", board.cpu));
    Ok(cargo)
}
