//! Records the state with which each step of `cargo verify` last passed, so that `--changed` can skip it, and how long
//! each took last, for `--list`.

use crate::common::{command, output, paths};
use anyhow::{Context, Result, ensure};
use std::{
    env, fs,
    path::{Path, PathBuf},
};

/// Variables that make a step do less, or something else. A run with one of them is not recorded.
const NARROW: [&str; 10] = [
    "BOARD",
    "CASES_TIMES",
    "FUZZ_SECONDS",
    "FUZZ_TARGET",
    "MUTANTS_AGAIN",
    "MUTANTS_IN",
    "MUTANTS_SINCE",
    "MUTANTS_TESTS",
    "RUSTFLAGS",
    "SWEEPS_SEED",
];

/// Directories at the repository's top whose subdirectories count as modules.
const GROUPS: [&str; 2] = ["bindings", "laptop"];

/// A state of the repository: a line for each module and file at the top, with git's hash of its content, committed or
/// not; then each manifest and lock file, which cargo reads for others too; then the compiler. `None` if git does not
/// tell.
pub struct Passed(Option<String>);

impl Passed {
    /// Reads the present state. If that fails it is an error only if `is_needed`.
    pub fn now(is_needed: bool) -> Result<Self> {
        let is_whole = NARROW.iter().all(|name| env::var_os(name).is_none());
        ensure!(is_whole || !is_needed, "--changed knows nothing of {}", NARROW.join(", "));
        let told = told(&paths::root(), &place()).context("--changed asks git what has changed");
        Ok(Self(if is_needed { Some(told?) } else { told.ok().filter(|_| is_whole) }))
    }

    /// Returns whether the step has passed with the present state of all that it reads: all modules except those
    /// `apart`.
    pub fn holds(&self, name: &str, apart: &[&[&str]]) -> bool {
        let kept = fs::read_to_string(place().join(name)).ok();
        kept.is_some() && kept == self.0.as_deref().map(|told| read(told, apart))
    }

    /// Deletes the record of a step when it begins, so that a failure leaves none.
    pub fn remove(name: &str) {
        let _ = fs::remove_file(place().join(name));
    }

    /// Records that the step has passed, unless the repository changed meanwhile. If that cannot be written, the step
    /// is only repeated.
    pub fn add(&self, name: &str, apart: &[&[&str]]) {
        if let Some(told) = &self.0
            && Self::now(false).is_ok_and(|now| now.0.as_ref() == Some(told))
        {
            let _ = fs::write(place().join(name), read(told, apart));
        }
    }

    /// Records the processor time of a step that has passed. If that cannot be written, the list only lacks it.
    pub fn took(&self, name: &str, seconds: f64) {
        if self.0.is_some() {
            let _ = fs::write(times(name), format!("{seconds:.0}"));
        }
    }
}

/// Returns the seconds of processor time that a step took when it last ran here.
pub fn last_took(name: &str) -> Option<u32> {
    fs::read_to_string(times(name)).ok()?.parse().ok()
}

fn times(name: &str) -> PathBuf {
    place().join(format!("{name}.seconds"))
}

fn place() -> PathBuf {
    paths::target().join("passed")
}

/// Asks git with a separate index, so that the user's is unchanged.
fn told(root: &Path, place: &Path) -> Result<String> {
    fs::create_dir_all(place)?;
    let git = |args: &str| {
        let mut git = command("git");
        let git = git.current_dir(root).args(args.split(' '));
        output(git.env("GIT_INDEX_FILE", place.join("index")))
    };
    git("add --all")?;
    let tree = git("write-tree")?;
    let top = git(&format!("ls-tree {}", tree.trim()))?;
    // The rooms of a group are told apart, and the group itself is none.
    let below = git(&format!(
        "ls-tree {} {}",
        tree.trim(),
        GROUPS.map(|group| format!("{group}/")).join(" ")
    ))?;
    let is_room = |line: &&str| !GROUPS.iter().any(|group| line.ends_with(&format!("\t{group}")));
    let rooms: String =
        top.lines().filter(is_room).chain(below.lines()).flat_map(|line| [line, "\n"]).collect();
    let manifests = git("ls-files --stage -- *Cargo.toml *Cargo.lock")?;
    Ok([rooms, manifests, output(command("rustc").arg("-vV"))?].concat())
}

/// Returns the lines without those of modules that a step does not read. Unknown modules stay.
fn read(told: &str, apart: &[&[&str]]) -> String {
    let is_read = |line: &&str| {
        let name = line.split_once('\t').map(|(_, name)| name);
        name.is_none_or(|name| !apart.iter().any(|group| group.contains(&name)))
    };
    told.lines().filter(is_read).flat_map(|line| [line, "\n"]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_counts_where_it_is_read() {
        let told = |room: &str, manifest: &str| {
            format!(
                "040000 tree {room}\tros\n040000 tree 2\tnew\n100644 {manifest} 0\tros/Cargo.toml\n"
            )
        };
        let before = told("1", "3");
        let holds = |now: &str, apart: &[&[&str]]| read(now, apart) == read(&before, apart);
        assert!(holds(&before, &[]) && holds(&told("4", "3"), &[&["ros"]]));
        assert!(!holds(&told("4", "3"), &[]) && !holds(&told("4", "3"), &[&["docs"]]));
        assert!(!holds(&told("1", "5"), &[&["ros"]]));
        assert!(!holds(&before.replace('2', "6"), &[&["ros"]]));
    }

    /// A change counts before it is committed, and a file before it is added to git.
    #[test]
    fn git_tells_what_is_there() {
        let (root, place) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        output(command("git").current_dir(root.path()).args(["init", "--quiet"])).unwrap();
        let write = |path: &str, text: &str| {
            let path = root.path().join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
            told(root.path(), place.path()).unwrap()
        };
        let one = write("a/Cargo.toml", "one");
        let [two, three] = [write("a/Cargo.toml", "two"), write("b", "new")];
        assert_eq!(one.lines().filter(|line| !two.contains(line)).count(), 2, "{one}{two}");
        assert!(three.contains("\tb\n") && three.lines().count() == two.lines().count() + 1);
        assert_eq!(three, told(root.path(), place.path()).unwrap());
    }
}
