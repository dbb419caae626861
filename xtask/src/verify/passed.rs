//! Records with what each step of `cargo verify` last passed, so that `--changed` can leave it out, and how long it took:
//! of all steps below `target`, of long ones also in `.ci/passed.toml`, which is committed.
//!
//! A step reads the packages of the programs that it builds and what these depend on, this program's modules behind it, and
//! each other file that was opened while it ran. All manifests and lock files count, as cargo reads them for others.

use super::{modules::Modules, opened, packages::Packages};
use crate::common::{
    command, output,
    paths::{root, target},
    shell::{self, Ran},
};
use anyhow::{Context, Result, ensure};
use serde::{Deserialize, Serialize};
use std::{
    collections::{BTreeMap, BTreeSet},
    env, fs,
    hash::{DefaultHasher, Hash, Hasher},
    path::{Path, PathBuf},
};

/// Variables that make a step do less, or something else. A run with one of them is not recorded.
const NARROW: [&str; 9] = [
    "BOARD",
    "CASES_TIMES",
    "FUZZ_SECONDS",
    "FUZZ_TARGET",
    "HAL",
    "MUTANTS_IN",
    "MUTANTS_SECONDS",
    "RUSTFLAGS",
    "SWEEPS_SEED",
];

/// Files that any step may read: cargo does, and the compiler.
const EVERYWHERE: [&str; 4] =
    ["Cargo.toml", "Cargo.lock", "rust-toolchain.toml", ".cargo/config.toml"];

/// Most files of a directory that a record names one by one.
const FEW: usize = 3;

/// The last run of a step.
#[derive(Clone, Default, Serialize, Deserialize)]
#[serde(default)]
struct Pass {
    /// Hash of all that it read, if it passed.
    hash: Option<String>,
    /// Processor time.
    seconds: u32,
    /// Packages that it built.
    builds: BTreeSet<String>,
    /// Other files that were opened, or directories with a slash at their ends.
    opens: BTreeSet<String>,
}

type Passes = BTreeMap<String, Pass>;

/// The files that git knows or would add, each with its mode and the hash of its content.
type Files = BTreeMap<String, String>;

/// The present state of the repository, and the records.
pub struct Passed {
    /// `None` if git does not tell.
    files: Option<Files>,
    packages: Packages,
    modules: Modules,
    passes: Passes,
    committed: Passes,
    /// Whether each step does all that it can.
    is_whole: bool,
}

impl Passed {
    /// Reads the present state. If that fails it is an error only if `is_needed`.
    pub fn read(is_needed: bool) -> Result<Self> {
        let is_whole = NARROW.iter().all(|name| env::var_os(name).is_none());
        ensure!(is_whole || !is_needed, "--changed knows nothing of {}", NARROW.join(", "));
        let files = files(&root(), &place());
        let files = if is_needed {
            Some(files.context("--changed asks git what has changed")?)
        } else {
            files.ok()
        };
        let packages = Packages::read(&names(files.iter().flatten()))?;
        let (passes, committed) = (parsed(&here())?, parsed(&committed())?);
        Ok(Self { files, packages, modules: Modules::read(), passes, committed, is_whole })
    }

    /// Returns whether the step has passed with the present state of all that it reads; `None` if git does not tell.
    pub fn is_fresh(&self, name: &str, code: &str) -> Option<bool> {
        let files = self.files.as_ref()?;
        let passes = [self.passes.get(name), self.committed.get(name)];
        let is_same =
            |pass: &Pass| pass.hash.is_some() && pass.hash == Some(self.hash(files, code, pass));
        Some(passes.into_iter().flatten().any(is_same))
    }

    /// Runs a step and records it if it passes, unless what it reads changed meanwhile. If the record cannot be written,
    /// the step is only repeated.
    pub fn run<T>(
        &mut self,
        name: &str,
        code: &str,
        is_long: bool,
        function: impl FnOnce() -> (Result<T>, f64),
    ) -> (Result<T>, f64) {
        let Some(before) = self.files.clone() else { return function() };
        let mut pass = self.passes.get(name).cloned().unwrap_or_default();
        pass.hash = None; // a failure leaves none
        put(&here(), &mut self.passes, name, &pass);
        shell::ran();
        let ((result, seconds), opened) = opened::opened(&root(), &names(&before), function);
        if result.is_ok() && self.is_whole {
            // What was read by an earlier run may lie in a cache now; both are below `target`.
            let ran = shell::ran();
            pass.builds.extend(ran.iter().flat_map(|ran| self.packages.built_by(ran)));
            pass.opens.extend(self.others(&before, code, &pass, &ran, opened));
            pass.seconds = seconds as u32;
            let hash = self.hash(&before, code, &pass);
            if let Ok(now) = files(&root(), &place()) {
                pass.hash = Some(hash.clone()).filter(|_| hash == self.hash(&now, code, &pass));
                self.files = Some(now);
            }
            if is_long && pass.hash.is_some() {
                put(&committed(), &mut self.committed, name, &pass);
            }
            put(&here(), &mut self.passes, name, &pass);
        }
        (result, seconds)
    }

    /// Returns the seconds of processor time that a step took when it last passed.
    pub fn took(&self, name: &str) -> Option<u32> {
        let pass = self.passes.get(name).or_else(|| self.committed.get(name));
        pass.map(|pass| pass.seconds).filter(|seconds| *seconds > 0)
    }

    /// Returns the files that were opened and belong to none of the packages built, nor to this program; a directory
    /// stands for more than a few.
    fn others(
        &self,
        files: &Files,
        code: &str,
        pass: &Pass,
        ran: &[Ran],
        opened: Option<BTreeSet<String>>,
    ) -> BTreeSet<String> {
        let top = root().display().to_string();
        // What is cloned is read, though nothing opens it here.
        let is_cloned = ran.iter().any(|ran| ran.words[0] == "git" && ran.words.contains(&top));
        let Some(opened) = opened.filter(|_| !is_cloned) else { return ["/".to_owned()].into() };
        let known = self.entries(code, &Pass { opens: BTreeSet::new(), ..pass.clone() });
        let manifests = manifests(files);
        let is_other =
            |file: &&String| !file.starts_with("xtask/") && !is_read(file, &known, &manifests);
        let mut by_directory: BTreeMap<&str, Vec<&String>> = BTreeMap::new();
        for file in opened.iter().filter(is_other) {
            let directory = file.rfind('/').map_or("", |end| &file[..=end]);
            by_directory.entry(directory).or_default().push(file);
        }
        let mut found = BTreeSet::new();
        for (directory, files) in by_directory {
            if files.len() > FEW && !directory.is_empty() {
                found.insert(directory.to_owned());
            } else {
                found.extend(files.into_iter().cloned());
            }
        }
        found
    }

    /// Returns what a step reads: files, and directories with a slash at their ends.
    fn entries(&self, code: &str, pass: &Pass) -> BTreeSet<String> {
        let modules = self.modules.behind(code);
        let mut built = pass.builds.clone();
        let linked = self.packages.dependencies("xtask").into_iter();
        built.extend(linked.filter(|name| self.modules.name(&modules, name)).map(str::to_owned));
        let mut entries = self.packages.directories(&built);
        entries.extend(modules);
        entries.extend(pass.opens.iter().cloned());
        entries
    }

    fn hash(&self, files: &Files, code: &str, pass: &Pass) -> String {
        let (entries, manifests) = (self.entries(code, pass), manifests(files));
        // Its algorithm may change with the compiler only, and then `rust-toolchain.toml` has changed, too.
        let mut hasher = DefaultHasher::new();
        for (name, content) in files.iter().filter(|(name, _)| is_read(name, &entries, &manifests))
        {
            (name, content).hash(&mut hasher);
        }
        format!("{:016x}", hasher.finish())
    }
}

/// Returns the directories with a manifest, with a slash at their ends.
fn manifests(files: &Files) -> BTreeSet<String> {
    files.keys().filter_map(|file| Some(file.strip_suffix("Cargo.toml")?.to_owned())).collect()
}

/// Returns whether a file is among the entries, or in a directory among them, unless a package of its own lies between.
fn is_read(file: &str, entries: &BTreeSet<String>, manifests: &BTreeSet<String>) -> bool {
    if file == COMMITTED {
        return false;
    }
    let name = Path::new(file).file_name();
    if EVERYWHERE.iter().any(|one| *one == file || name == Some(one.as_ref())) {
        return true;
    }
    let parents = || file.match_indices('/').map(|(end, _)| &file[..=end]);
    let package = parents().rfind(|parent| manifests.contains(*parent)).unwrap_or_default();
    entries.contains(file)
        || entries.contains("/")
        || parents().any(|parent| parent.len() >= package.len() && entries.contains(parent))
}

fn place() -> PathBuf {
    target().join("passed")
}

fn here() -> PathBuf {
    place().join("passed.toml")
}

/// The committed record, from the repository's top.
const COMMITTED: &str = ".ci/passed.toml";

fn committed() -> PathBuf {
    root().join(COMMITTED)
}

fn parsed(path: &Path) -> Result<Passes> {
    match fs::read_to_string(path) {
        Ok(text) => toml::from_str(&text).with_context(|| path.display().to_string()),
        Err(_) => Ok(Passes::new()),
    }
}

/// Adds a record, beside what another run has written meanwhile.
fn put(path: &Path, passes: &mut Passes, name: &str, pass: &Pass) {
    if let Ok(now) = parsed(path) {
        *passes = now;
    }
    passes.insert(name.to_owned(), pass.clone());
    if let Ok(text) = toml::to_string(passes) {
        let _ = fs::write(path, text);
    }
}

fn names<'a>(files: impl IntoIterator<Item = (&'a String, &'a String)>) -> BTreeSet<String> {
    files.into_iter().map(|(name, _)| name.clone()).collect()
}

/// Asks git with a separate index, so that the user's is unchanged. A file counts before it is committed or added.
fn files(top: &Path, place: &Path) -> Result<Files> {
    fs::create_dir_all(place)?;
    let mut listed = String::new();
    for args in ["add --all", "-c core.quotePath=false ls-files --stage"] {
        let mut git = command("git");
        git.current_dir(top).args(args.split(' ')).env("GIT_INDEX_FILE", place.join("index"));
        listed = output(&mut git)?;
    }
    let pairs = listed.lines().filter_map(|line| line.split_once('\t'));
    Ok(pairs.map(|(content, name)| (name.to_owned(), content.to_owned())).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(names: &[&str]) -> BTreeSet<String> {
        names.iter().map(|name| (*name).to_owned()).collect()
    }

    #[test]
    fn a_directory_ends_where_another_package_begins() {
        let entries = set(&["chips/", "src/", "docs/loop.md", "laptop/loop/"]);
        let manifests = set(&["", "chips/", "chips/silicon/", "laptop/cli/"]);
        for (file, expected) in [
            ("chips/src/odin.rs", true),
            ("chips/silicon/src/odin.rs", false),
            ("chips/silicon/Cargo.toml", true),
            ("src/num/mod.rs", true),
            ("docs/loop.md", true),
            ("docs/fly.md", false),
            ("laptop/loop/steps.py", true),
            ("laptop/cli/src/main.rs", false),
            (COMMITTED, false),
        ] {
            assert_eq!(is_read(file, &entries, &manifests), expected, "{file}");
            assert!(file == COMMITTED || is_read(file, &set(&["/"]), &manifests), "{file}");
        }
    }

    /// The check of the C library runs the laptop program, and so reads what writes C.
    #[test]
    fn what_is_built_is_read_with_all_on_which_it_depends() {
        let place = tempfile::tempdir().unwrap();
        let packages = Packages::read(&names(&files(&root(), place.path()).unwrap())).unwrap();
        let built = |directory: &str, words: &str| {
            let words = words.split(' ').map(str::to_owned).collect();
            packages.built_by(&Ran { directory: root().join(directory), words, manifest: None })
        };
        let program = built("", "cargo test --workspace --no-run --test pipes");
        assert_eq!(program, set(&["spikewire-cli"]));
        let read = packages.directories(&program);
        for directory in ["laptop/cli/", "laptop/lab/", "laptop/catalogue/", "src/", "flight-logs/"]
        {
            assert!(read.contains(directory), "{directory}: {read:?}");
        }
        assert!(!read.contains("xtask/") && !read.contains("bindings/c/"), "{read:?}");
        assert_eq!(built("bindings/c", "cargo rustc --lib"), set(&["spikewire-c"]));
        assert_eq!(
            built("", "python -m pip install ./bindings/python"),
            set(&["spikewire-python"])
        );
        assert_eq!(built("", "cargo test"), set(&["host-tests", "spikewire"]));
        assert!(
            built("", "cargo build --manifest-path examples/Cargo.toml --package demo")
                .contains("demo")
        );
        let manifest =
            "[dependencies]\nx = { package = \"spikewire\", path = \"x\" }\nanyhow = \"1\"\n";
        let ran = Ran {
            directory: "/".into(),
            words: vec!["cargo".into()],
            manifest: Some(manifest.into()),
        };
        assert_eq!(packages.built_by(&ran), set(&["spikewire"]));
    }

    #[test]
    fn a_step_reads_the_modules_that_it_names() {
        let modules = Modules::read().behind("c_library :: verify");
        for file in ["products/c_library/flights.rs", "programs/host.rs", "common/shell.rs"] {
            assert!(modules.contains(&format!("xtask/src/{file}")), "{file}: {modules:?}");
        }
        assert!(!modules.contains("xtask/src/checks/ros.rs"), "{modules:?}");
    }

    /// A change counts before it is committed, and a file before it is added to git.
    #[test]
    fn git_tells_what_is_there() {
        let (top, place) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        output(command("git").current_dir(top.path()).args(["init", "--quiet"])).unwrap();
        let write = |path: &str, text: &str| {
            fs::write(top.path().join(path), text).unwrap();
            files(top.path(), place.path()).unwrap()
        };
        let [one, two, three] = [write("a", "one"), write("a", "two"), write("µ", "new")];
        assert!(one["a"] != two["a"] && one.len() == 1);
        assert!(three["a"] == two["a"] && three.contains_key("µ") && three.len() == 2);
    }
}
