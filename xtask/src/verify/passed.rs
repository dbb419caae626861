//! Which steps of `cargo verify` have passed at a commit, so that a machine that stops does not lose them.

use crate::common::{command, output, paths};
use anyhow::{Result, ensure};
use std::{
    fs::{self, OpenOptions},
    io::Write,
    path::PathBuf,
};

/// A file of names below `target`, if the commit says all that is in the tree.
pub struct Passed(Option<PathBuf>);

impl Passed {
    /// Of the commit that is checked out. Changes that no commit holds are an error if the file `is_needed`.
    pub fn at_head(is_needed: bool) -> Result<Self> {
        let git = |args: &str| output(command("git").args(args.split(' ')));
        let clean = git("status --porcelain").is_ok_and(|changes| changes.is_empty());
        ensure!(
            clean || !is_needed,
            "--rest is for a commit: this tree has changes, or is no repository"
        );
        let commit = clean.then(|| git("rev-parse HEAD")).transpose()?;
        Ok(Self(commit.map(|commit| paths::target().join("passed").join(commit.trim()))))
    }

    pub fn holds(&self, name: &str) -> bool {
        let names = self.0.as_ref().and_then(|file| fs::read_to_string(file).ok());
        names.is_some_and(|names| names.lines().any(|passed| passed == name))
    }

    /// A file that cannot be written costs a repetition, and no more.
    pub fn add(&self, name: &str) {
        let Some(file) = &self.0 else { return };
        let _ = fs::create_dir_all(paths::target().join("passed"));
        let file = OpenOptions::new().create(true).append(true).open(file);
        let _ = file.and_then(|mut file| writeln!(file, "{name}"));
    }
}
