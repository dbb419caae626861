//! The changes to try, as cargo-mutants lists them.

use super::CRATES;
use crate::common::{
    paths,
    shell::{cargo, command, output, run},
};
use anyhow::Result;
use serde::Deserialize;
use std::{
    collections::{HashMap, HashSet},
    ffi::OsStr,
    fs,
};

/// One change of a crate's source.
#[derive(Deserialize)]
pub struct Change {
    /// The source file, from the repository's top.
    pub file: String,
    /// File, line and column, and what is replaced by what.
    pub name: String,
    pub replacement: String,
    genre: String,
    span: Span,
}

#[derive(Deserialize)]
struct Span {
    start: Place,
}

#[derive(Deserialize)]
struct Place {
    line: usize,
    column: usize,
}

/// Where a change is found in the syntax tree: genre, line and column, the latter two from 1.
pub type Site = (String, usize, usize);

impl Change {
    pub fn site(&self) -> Site {
        (self.genre.clone(), self.span.start.line, self.span.start.column)
    }
}

/// Lists all changes of the crates.
pub fn all() -> Result<Vec<Change>> {
    listed(&[])
}

/// Returns the names of the changes in lines that differ from a commit's.
pub fn since(commit: &str) -> Result<HashSet<String>> {
    let lines = paths::target().join("mutants/lines.diff");
    fs::create_dir_all(paths::target().join("mutants"))?;
    fs::write(
        &lines,
        output(command("git").args(["diff", commit, "--"]).args(CRATES.map(|(_, source)| source)))?,
    )?;
    let changes = listed(&["--in-diff".as_ref(), lines.as_os_str()])?;
    Ok(changes.into_iter().map(|change| change.name).collect())
}

/// Runs cargo-mutants, and installs it first if it is missing.
fn listed(of: &[&OsStr]) -> Result<Vec<Change>> {
    let tools = paths::target().join("tools");
    let program = tools.join("bin/cargo-mutants");
    if !program.is_file() {
        let mut install = cargo("install cargo-mutants --locked --root");
        run(install.arg(&tools).arg("--target-dir").arg(tools.join("build")))?;
    }
    let packages = CRATES.iter().flat_map(|(name, _)| ["--package", name]);
    let mut list = command(program);
    list.args(["mutants", "--list", "--json"]).args(packages).args(of);
    Ok(serde_json::from_str(&output(&mut list)?)?)
}

/// Returns names that stay the same if lines are added above: without line and column, and numbered if several are
/// equal.
pub fn lasting_names(changes: &[Change]) -> Vec<String> {
    let mut seen = HashMap::new();
    let lasting = changes.iter().map(|change| {
        let what = change.name.splitn(4, ':').nth(3).unwrap_or_default();
        let name = format!("{}:{what}", change.file);
        let times = seen.entry(name.clone()).and_modify(|times| *times += 1).or_insert(1);
        if *times == 1 { name } else { format!("{name} ({times})") }
    });
    lasting.collect()
}
