//! `cargo verify mutants`: cargo-mutants plants changes, one after the other, in the code that flies or writes what flies; with
//! each a test must fail or run without end. `host-tests/mutants.toml` lists those that no test notices, with the reasons;
//! the check fails at any other.

use crate::common::{
    paths,
    shell::{self, cargo, command, output, run},
};
use anyhow::{Context, Result, bail, ensure};
use serde::Deserialize;
use std::{
    collections::{BTreeSet, HashMap},
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

/// A package that is changed.
struct Room {
    package: &'static str,
    /// Sources that are changed, from the repository's top: directories, or files.
    sources: &'static [&'static str],
    /// Packages whose tests must notice, beside its own, with the directories of these tests.
    tests: &'static [(&'static str, &'static str)],
}

const HOST_TESTS: (&str, &str) = ("host-tests", "host-tests");
const PROGRAM: (&str, &str) = ("spikewire-cli", "laptop/cli");

/// The packages that fly, and those that write what flies; the quickest first.
const ROOMS: [Room; 8] = [
    Room { package: "spikewire-network", sources: &["network/src"], tests: &[] },
    Room { package: "spikewire-flight", sources: &["laptop/flight/src"], tests: &[] },
    Room { package: "flight-logs", sources: &["flight-logs/src"], tests: &[PROGRAM] },
    Room { package: "spikewire-cameras", sources: &["cameras/src"], tests: &[HOST_TESTS] },
    Room { package: "spikewire-chips", sources: &["chips/src"], tests: &[HOST_TESTS] },
    Room { package: "catalogue", sources: &["laptop/catalogue/src"], tests: &[HOST_TESTS] },
    Room {
        package: "lab",
        sources: &["laptop/lab/src/emit.rs", "laptop/lab/src/network/controller/emit.rs"],
        tests: &[PROGRAM],
    },
    Room {
        package: "spikewire",
        sources: &["src"],
        tests: &[HOST_TESTS, ("catalogue", "laptop/catalogue")],
    },
];

/// Maximum memory of a program in kilobytes: a change may allocate without end.
const MEMORY: u64 = 10 << 20;

/// A change, as cargo-mutants lists it.
#[derive(Deserialize)]
struct Change {
    file: String,
    /// File, line and column, and what is replaced by what.
    name: String,
}

/// The committed list of changes that no test notices.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Listed {
    /// Changes that no test can distinguish from the code.
    equal: Vec<Equal>,
    /// Changes that a test should notice, but none does yet.
    not_noticed_yet: BTreeSet<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Equal {
    /// The reason, for readers only.
    #[serde(rename = "reason")]
    _reason: String,
    changes: BTreeSet<String>,
}

/// Runs the check. `MUTANTS_IN='spikewire-network flight-logs'` selects packages, and `MUTANTS_SECONDS=600` stops each
/// after this time. A run continues where the last one stopped, unless the sources or the tests have changed.
pub fn mutants() -> Result<()> {
    let program = installed()?;
    let file = paths::root().join("host-tests/mutants.toml");
    let listed: Listed =
        toml::from_str(&fs::read_to_string(&file)?).context("host-tests/mutants.toml")?;
    let listed: BTreeSet<String> = listed
        .equal
        .into_iter()
        .flat_map(|equal| equal.changes)
        .chain(listed.not_noticed_yet)
        .collect();
    let wanted = env::var("MUTANTS_IN").ok();
    let is_wanted = |room: &&Room| {
        wanted
            .as_ref()
            .is_none_or(|wanted| wanted.split_whitespace().any(|name| name == room.package))
    };
    let chosen: Vec<&Room> = ROOMS.iter().filter(is_wanted).collect();
    ensure!(!chosen.is_empty(), "there are {}", ROOMS.map(|room| room.package).join(", "));
    let (tree, commit) = tree()?;
    let (mut wrong, mut lines) = (Vec::new(), Vec::new());
    for room in chosen {
        lines.push(room.judge(&program, &tree, &commit, &listed, &mut wrong)?);
        println!("{}", lines[lines.len() - 1]);
    }
    println!("\n{}", lines.join("\n"));
    if wrong.is_empty() { Ok(()) } else { bail!("{}", wrong.join("\n")) }
}

/// Installs cargo-mutants if it is missing; returns its path.
fn installed() -> Result<PathBuf> {
    let tools = paths::target().join("tools");
    let program = tools.join("bin/cargo-mutants");
    if !program.is_file() {
        let mut install = cargo("install cargo-mutants --locked --root");
        run(install.arg(&tools).arg("--target-dir").arg(tools.join("build")))?;
    }
    Ok(program)
}

/// Brings a copy of the repository below `target`, in which the changes are made, to the present state, committed or not;
/// returns its directory and the state's name in git.
fn tree() -> Result<(PathBuf, String)> {
    let place = paths::target().join("mutants");
    let tree = place.join("tree");
    fs::create_dir_all(&tree)?;
    let git = |index: &str, args: &str| {
        let mut git = command("git");
        git.args(args.split(' ')).env("GIT_INDEX_FILE", place.join(index));
        git
    };
    run(&mut git("index", "add --all"))?;
    let commit = output(&mut git("index", "write-tree"))?.trim().to_owned();
    let directory = output(&mut git("index", "rev-parse --absolute-git-dir"))?;
    // Files that stay as they are keep their times, so that cargo compiles anew only what has changed.
    let mut read = git("tree-index", "read-tree --reset -u");
    read.arg(&commit)
        .current_dir(&tree)
        .env("GIT_DIR", directory.trim())
        .env("GIT_WORK_TREE", &tree);
    run(&mut read)?;
    Ok((tree, commit))
}

impl Room {
    /// Tries the changes of a package; adds to `wrong` those that are not judged as listed, and returns the counts.
    fn judge(
        &self,
        program: &Path,
        tree: &Path,
        commit: &str,
        listed: &BTreeSet<String>,
        wrong: &mut Vec<String>,
    ) -> Result<String> {
        let kept = self.kept(commit)?;
        let changes: Vec<Change> =
            serde_json::from_str(&output(self.command(program, tree).args(["--list", "--json"]))?)?;
        ensure!(!changes.is_empty(), "no changes in {}", self.package);
        let mut tried = self.command(program, tree);
        // In the copy itself, which is compiled in one directory from one run to the next.
        tried.args(["--in-place", "--iterate", "--colors=never", "--output"]).arg(&kept);
        for (name, _) in self.tests.iter().chain(&[(self.package, "")]) {
            tried.args(["--test-package", name]);
        }
        // Without the code of documentation, which takes a compiler's run for each piece.
        shell::status(tried.args(["--", "--tests"]))?;

        let told = |what: &str| -> BTreeSet<String> {
            let text = fs::read_to_string(kept.join("mutants.out").join(what)).unwrap_or_default();
            text.lines().map(str::to_owned).collect()
        };
        let noticed: BTreeSet<_> = ["caught.txt", "previously_caught.txt", "timeout.txt"]
            .iter()
            .flat_map(|what| told(what))
            .collect();
        let (missed, invalid) = (told("missed.txt"), told("unviable.txt"));
        let names = lasting_names(&changes);
        let mut untried = 0;
        for (change, name) in changes.iter().zip(&names) {
            if missed.contains(&change.name) && !listed.contains(name) {
                wrong.push(format!("not noticed: {name}, at {}", change.name));
            } else if noticed.contains(&change.name) && listed.contains(name) {
                wrong.push(format!("listed, but noticed: {name}"));
            }
            let is_tried =
                [&noticed, &missed, &invalid].iter().any(|all| all.contains(&change.name));
            untried += usize::from(!is_tried);
        }
        let is_here = |name: &&String| self.sources.iter().any(|source| name.starts_with(source));
        let gone = listed.iter().filter(is_here).filter(|name| !names.contains(name));
        wrong.extend(gone.map(|name| format!("listed, but gone: {name}")));
        // Those that do not compile are known to the first run alone: a further one leaves them out.
        let is_stopped = env::var_os("MUTANTS_SECONDS").is_some();
        if untried > 0 && !is_stopped && !kept.join("mutants.out.old").exists() {
            wrong.push(format!("{}: {untried} changes were not tried", self.package));
        }
        Ok(format!(
            "{}: {} changes, {} noticed, {} not noticed, {} do not compile, {untried} not tried in this run",
            self.package,
            changes.len(),
            noticed.len(),
            missed.len(),
            invalid.len(),
        ))
    }

    /// Returns the directory of the results, which are valid until the sources or the tests change.
    fn kept(&self, commit: &str) -> Result<PathBuf> {
        let mut read: Vec<&str> = self.sources.to_vec();
        read.extend(self.tests.iter().map(|(_, directory)| *directory));
        read.extend(self.sources.iter().filter_map(|source| source.strip_suffix("/src")));
        let mut git = command("git");
        git.arg("rev-parse").args(read.iter().map(|path| format!("{commit}:{path}")));
        let hashes: String = output(&mut git)?.lines().filter_map(|hash| hash.get(..6)).collect();
        let place = paths::target().join("mutants").join(format!("{}-{hashes}", self.package));
        fs::create_dir_all(&place)?;
        Ok(place)
    }

    /// Prepares cargo-mutants for this package, with the limits of time and memory.
    fn command(&self, program: &Path, tree: &Path) -> Command {
        let seconds = env::var("MUTANTS_SECONDS").unwrap_or_else(|_| "0".into()); // 0 is no limit
        let limited =
            format!("ulimit -v {MEMORY}; exec timeout --signal=INT {seconds} \"$0\" \"$@\"");
        let mut command = command("sh");
        command
            .current_dir(tree)
            .args(["-c", &limited])
            .arg(program)
            .args(["mutants", "--no-config"]);
        command.args(["--package", self.package]);
        for source in self.sources {
            let all = if source.ends_with(".rs") { "" } else { "/**" };
            command.args(["--file", &format!("{source}{all}")]);
        }
        // A failure is enough, and need be neither simple nor kept.
        command
            .env("PROPTEST_MAX_SHRINK_ITERS", "0")
            .env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "1");
        command.env("CARGO_PROFILE_DEV_DEBUG", "false").env("RUST_BACKTRACE", "0");
        command.env("CARGO_TARGET_DIR", paths::target().join("mutants/build"));
        command
    }
}

/// Returns names that stay the same if lines are added above: without line and column, and numbered if several are
/// equal.
fn lasting_names(changes: &[Change]) -> Vec<String> {
    let mut seen = HashMap::new();
    let mut names = Vec::new();
    for change in changes {
        let what = change.name.splitn(4, ':').nth(3).unwrap_or_default();
        let name = format!("{}:{what}", change.file);
        let times = seen.entry(name.clone()).and_modify(|times| *times += 1).or_insert(1);
        names.push(if *times == 1 { name } else { format!("{name} ({times})") });
    }
    names
}
