//! Runs other programs: prints each command first, and makes its failure an error.

use crate::common::{paths, progress};
use anyhow::{Context, Result, bail};
use std::{
    path::Path,
    process::{Command, Output},
};

/// Prepares a program to be started at the repository's top.
pub fn command(program: impl AsRef<std::ffi::OsStr>) -> Command {
    let mut command = Command::new(program);
    command.current_dir(paths::root());
    command
}

/// Prepares cargo of the toolchain that runs `cargo xtask`; arguments are separated by blanks.
pub fn cargo(args: &str) -> Command {
    let mut command = command("cargo");
    // What is kept for the next change is a third of the disk, and no check changes anything.
    command.args(args.split_whitespace()).env("CARGO_INCREMENTAL", "0");
    // One profile for all workspaces, so that they share what they can.
    command.env("CARGO_PROFILE_DEV_DEBUG", "false");
    command
}

/// Replaces the compiler by clippy for the workspace's own crates, which then lints and builds at once. A warning is an
/// error.
pub fn lint(cargo: &mut Command) -> &mut Command {
    // The form in which cargo hands arguments to clippy.
    const WARNINGS: &str = "-D__CLIPPY_HACKERY__warnings__CLIPPY_HACKERY__";
    cargo.env("RUSTC_WORKSPACE_WRAPPER", "clippy-driver").env("CLIPPY_ARGS", WARNINGS)
}

/// Prints the command, runs it with its output shown, and fails if it fails.
pub fn run(command: &mut Command) -> Result<()> {
    eprintln!("$ {}", shown(command));
    let _running = progress::running(short(command));
    let status =
        command.status().with_context(|| format!("`{}` does not start", shown(command)))?;
    if !status.success() {
        bail!("`{}` failed: {status}", shown(command));
    }
    Ok(())
}

/// Runs the command quietly and returns its standard output; if it fails, the error includes its messages.
pub fn output(command: &mut Command) -> Result<String> {
    let _running = progress::running(short(command));
    let Output { status, stdout, stderr } =
        command.output().with_context(|| format!("`{}` does not start", shown(command)))?;
    if !status.success() {
        let said = String::from_utf8_lossy(&stderr);
        bail!("`{}` failed: {status}\n{said}", shown(command));
    }
    Ok(String::from_utf8_lossy(&stdout).into_owned())
}

/// Returns whether the command succeeds; shows nothing.
pub fn succeeds(command: &mut Command) -> bool {
    command.output().is_ok_and(|output| output.status.success())
}

/// Returns whether there is a program of this name on the path.
pub fn has(program: &str) -> bool {
    std::env::var_os("PATH")
        .is_some_and(|path| std::env::split_paths(&path).any(|dir| dir.join(program).is_file()))
}

/// Returns the beginning of the command without its environment, for a line of progress.
fn short(command: &Command) -> String {
    let words = words(command);
    match words.char_indices().nth(72) {
        Some((end, _)) => format!("{}…", &words[..end]),
        None => words,
    }
}

/// Formats the command as it would be typed at the repository's top.
fn shown(command: &Command) -> String {
    let set = command
        .get_envs()
        .filter_map(|(name, value)| Some((name, value?)))
        .map(|(name, value)| format!("{}='{}' ", name.display(), value.display()));
    set.chain([words(command)]).collect()
}

fn words(command: &Command) -> String {
    let root = format!("{}/", paths::root().display());
    let words = [command.get_program()].into_iter().chain(command.get_args());
    let words = words.map(|word| Path::new(word).display().to_string().replace(&root, ""));
    words.collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_shows_no_environment() {
        let mut command = command("cargo");
        command.arg("build").env("FLAGS", "-C a -C b");
        assert_eq!(short(&command), "cargo build");
        assert_eq!(shown(&command), "FLAGS='-C a -C b' cargo build");
        assert_eq!(short(command.arg("µ".repeat(80))).chars().count(), 73);
    }
}
