//! Runs each test alone, and records its duration and the changes that it reaches.

use super::copy::Program;
use crate::common::{cpu, paths, shell::output};
use anyhow::{Context, Result};
use std::{
    fs,
    hash::{DefaultHasher, Hash, Hasher},
    path::PathBuf,
    process::{Command, Stdio},
    thread,
    time::{Duration, Instant},
};

/// Longest processor time of a test, in seconds. A slower test is left out, as a change that none notices is tried with
/// all tests.
const LONGEST: u64 = 20;

/// Maximum memory of a test in kilobytes: a change may allocate without end.
const MEMORY: u64 = 6 << 20;

pub struct Test<'a> {
    pub program: &'a Program,
    pub name: String,
    /// Processor time, in seconds.
    pub seconds: f64,
    /// The changes that it reaches.
    pub reached: Vec<usize>,
}

/// The outcome of tests in one process.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    Passed,
    Failed,
    /// Stopped after many times the usual duration.
    Endless,
}

/// Records every test that passes in the unchanged copy in time. The record of a program is kept until the program
/// changes.
pub fn record(programs: &[Program]) -> Result<Vec<Test<'_>>> {
    let mut tests = Vec::new();
    for program in programs {
        let kept = kept("tests", program)?;
        if !kept.is_file() {
            let mut lines = String::new();
            for name in names(program)? {
                lines += &recorded(program, &name)?;
            }
            fs::write(&kept, lines)?;
        }
        for line in fs::read_to_string(&kept)?.lines() {
            let mut words = line.split(' ');
            let name = words.next().context("no name")?.to_owned();
            let seconds = words.next().context("no time")?.parse()?;
            let reached = words.map(str::parse).collect::<Result<_, _>>()?;
            tests.push(Test { program, name, seconds, reached });
        }
    }
    Ok(tests)
}

/// Returns the path of a file about the present state of a program.
pub fn kept(what: &str, program: &Program) -> Result<PathBuf> {
    let mut hasher = DefaultHasher::new();
    fs::read(&program.path)?.hash(&mut hasher);
    let directory = paths::target().join("mutants/known");
    fs::create_dir_all(&directory)?;
    Ok(directory.join(format!("{}-{what}-{:016x}", program.name, hasher.finish())))
}

/// Lists all tests except those that `cargo test` leaves out.
fn names(program: &Program) -> Result<Vec<String>> {
    let list = |of: &[&str]| -> Result<Vec<String>> {
        let told = output(command(program, LONGEST).args(["--list", "--format=terse"]).args(of))?;
        Ok(told.lines().filter_map(|line| Some(line.strip_suffix(": test")?.to_owned())).collect())
    };
    let ignored = list(&["--ignored"])?;
    Ok(list(&[])?.into_iter().filter(|name| !ignored.contains(name)).collect())
}

/// Returns a line with name, seconds and changes; empty if the test is left out.
fn recorded(program: &Program, name: &str) -> Result<String> {
    let reached = paths::target().join("mutants/reached");
    fs::write(&reached, "")?;
    let before = cpu::seconds();
    let mut command = command(program, LONGEST);
    command.env("MUTANTS_REACHED", &reached).args(["--exact", name]);
    let end = ended(&mut command, LONGEST * 10)?;
    let seconds = cpu::seconds() - before;
    if end != End::Passed {
        println!("left out: {} {name}, {end:?}", program.name);
        return Ok(String::new());
    }
    let changes = fs::read_to_string(&reached)?.replace('\n', " ");
    Ok(format!("{name} {seconds:.3} {}\n", changes.trim_end()).replace(" \n", "\n"))
}

/// Runs tests of one program with a change switched on.
pub fn with_change(change: usize, tests: &[&Test<'_>]) -> Result<End> {
    let Some(first) = tests.first() else { return Ok(End::Passed) };
    let usual: f64 = tests.iter().map(|test| test.seconds).sum();
    let limit = (3.0 + 10.0 * usual) as u64;
    let mut command = command(first.program, limit);
    command.env("MUTANTS_CHANGE", change.to_string()).arg("--exact");
    ended(command.args(tests.iter().map(|test| &test.name)), 30 + limit * 10)
}

/// Prepares the program as cargo starts it, with limits.
fn command(program: &Program, seconds: u64) -> Command {
    let mut command = Command::new("sh");
    let bounded = format!("ulimit -t {seconds}; ulimit -v {MEMORY}; exec \"$0\" \"$@\"");
    command
        .current_dir(&program.package)
        .env("CARGO_MANIFEST_DIR", &program.package)
        .env("PROPTEST_RNG_SEED", "2022")
        // A failure is enough, and need be neither simple nor kept.
        .env("PROPTEST_MAX_SHRINK_ITERS", "0")
        .env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "1")
        .env("RUST_BACKTRACE", "0")
        .args(["-c", &bounded])
        .arg(&program.path)
        .arg("--test-threads=1");
    command
}

/// Waits for the end, for at most this many seconds.
fn ended(command: &mut Command, seconds: u64) -> Result<End> {
    let mut child =
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn()?;
    let start = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        if start.elapsed() > Duration::from_secs(seconds) {
            child.kill()?;
            child.wait()?;
            return Ok(End::Endless);
        }
        thread::sleep(
            (start.elapsed() / 20).clamp(Duration::from_millis(1), Duration::from_millis(50)),
        );
    };
    Ok(if status.success() {
        End::Passed
    } else if status.to_string().contains("SIGXCPU") || status.to_string().contains("SIGKILL") {
        End::Endless
    } else {
        End::Failed
    })
}
