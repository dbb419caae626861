//! Runs other programs: prints each command first, and makes its failure an error.

use crate::common::{paths, progress};
use anyhow::{Context, Result, bail};
use std::{
    ffi::OsStr,
    fs, mem,
    path::{Path, PathBuf},
    process::{Command, ExitStatus, Output},
    sync::{Mutex, PoisonError},
};

/// The commands that were run since they were last asked for.
static RAN: Mutex<Vec<Ran>> = Mutex::new(Vec::new());

/// A command that was run.
pub struct Ran {
    pub directory: PathBuf,
    /// Program and arguments.
    pub words: Vec<String>,
    /// The manifest's text, if it lies outside the repository or in what is generated, and may be gone later.
    pub manifest: Option<String>,
}

impl Ran {
    fn new(command: &Command) -> Self {
        let directory = command.get_current_dir().map_or_else(paths::root, PathBuf::from);
        let words = [command.get_program()].into_iter().chain(command.get_args());
        let words = words.map(|word| word.to_string_lossy().into_owned()).collect();
        let mut ran = Self { directory, words, manifest: None };
        if ran.is_cargo() {
            let path =
                ran.directory.join(ran.behind(&["--manifest-path"]).next().unwrap_or("Cargo.toml"));
            if !path.starts_with(paths::root()) || path.starts_with(paths::target()) {
                ran.manifest = fs::read_to_string(path).ok();
            }
        }
        ran
    }

    pub fn is_cargo(&self) -> bool {
        self.words
            .first()
            .is_some_and(|program| Path::new(program).file_name() == Some(OsStr::new("cargo")))
    }

    /// Returns the words behind these options.
    pub fn behind(&self, options: &[&str]) -> impl Iterator<Item = &str> {
        let pairs = self.words.windows(2).filter(|pair| options.contains(&pair[0].as_str()));
        pairs.map(|pair| pair[1].as_str())
    }
}

/// Returns the commands that were run since the last call.
pub fn ran() -> Vec<Ran> {
    mem::take(&mut *RAN.lock().unwrap_or_else(PoisonError::into_inner))
}

fn record(command: &Command) {
    RAN.lock().unwrap_or_else(PoisonError::into_inner).push(Ran::new(command));
}

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
    let status = status(command)?;
    if !status.success() {
        bail!("`{}` failed: {status}", shown(command));
    }
    Ok(())
}

/// Prints the command, runs it with its output shown, and returns how it ended.
pub fn status(command: &mut Command) -> Result<ExitStatus> {
    eprintln!("$ {}", shown(command));
    record(command);
    let _running = progress::running(short(command));
    command.status().with_context(|| format!("`{}` does not start", shown(command)))
}

/// Runs the command quietly and returns its standard output; if it fails, the error includes its messages.
pub fn output(command: &mut Command) -> Result<String> {
    record(command);
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
