//! Finds out which changes the tests notice.

use super::{
    copy::Program,
    tests::{self, End, Test},
};
use anyhow::Result;
use std::{
    collections::BTreeMap,
    fs::{self, OpenOptions},
    io::Write,
    path::{Path, PathBuf},
    ptr,
    sync::Mutex,
    time::{Duration, Instant},
};

/// Longest time of a quick test, in seconds; all changes are tried with the quick tests first.
const QUICK: f64 = 0.2;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// No test reaches the change.
    NotReached,
    /// All tests that reach the change pass.
    Missed,
    /// The quick tests that reach the change pass; the others are still to be tried.
    Quiet,
    /// A test did not end.
    Endless,
    /// A test failed.
    Noticed,
}

/// The tests of a program, and what is known about them.
struct Judge<'a> {
    program: &'a Program,
    /// For each change the tests that reach it, the quickest first.
    reaching: BTreeMap<usize, Vec<&'a Test<'a>>>,
    known: PathBuf,
    verdicts: BTreeMap<usize, Verdict>,
}

/// Tries these changes, first with the tests of their own module. The results are appended to a file for each program,
/// and are valid until the program changes.
pub fn judge(
    changes: &[usize],
    programs: &[Program],
    tests: &[Test<'_>],
    is_own: impl Fn(usize, &Program) -> bool,
) -> Result<BTreeMap<usize, Verdict>> {
    let judges = programs.iter().map(|program| Judge::new(program, tests));
    let mut judges = judges.collect::<Result<Vec<_>>>()?;
    let quick: fn(&Test<'_>) -> bool = |test| test.seconds <= QUICK;
    let others: fn(&Test<'_>) -> bool = |test| test.seconds > QUICK;
    for (before, which, after, is_home) in [
        (None, quick, Verdict::Quiet, true),
        (None, quick, Verdict::Quiet, false),
        (Some(Verdict::Quiet), others, Verdict::Missed, true),
        (Some(Verdict::Quiet), others, Verdict::Missed, false),
    ] {
        for index in 0..judges.len() {
            let all = verdicts(changes, &judges);
            let one = &mut judges[index];
            let is_open = |change: &usize| {
                all.get(change).is_none_or(|verdict| *verdict <= Verdict::Quiet)
                    && one.verdicts.get(change).copied() == before
                    && one.reaching.contains_key(change)
                    && (!is_home || is_own(*change, one.program))
            };
            let open: Vec<usize> = changes.iter().copied().filter(is_open).collect();
            one.in_pairs(&open, which, after)?;
        }
    }
    Ok(verdicts(changes, &judges))
}

/// Returns the strongest verdict on each change.
fn verdicts(changes: &[usize], judges: &[Judge<'_>]) -> BTreeMap<usize, Verdict> {
    let best = |change: &usize| judges.iter().filter_map(|one| one.verdicts.get(change)).max();
    let all = changes
        .iter()
        .map(|change| (*change, best(change).copied().unwrap_or(Verdict::NotReached)));
    all.collect()
}

impl<'a> Judge<'a> {
    fn new(program: &'a Program, tests: &'a [Test<'a>]) -> Result<Self> {
        let mut reaching: BTreeMap<usize, Vec<&Test<'_>>> = BTreeMap::new();
        for test in tests.iter().filter(|test| ptr::eq(test.program, program)) {
            for change in &test.reached {
                reaching.entry(*change).or_default().push(test);
            }
        }
        for tests in reaching.values_mut() {
            tests.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
        }
        let known = tests::kept("changes", program)?;
        let verdicts = read(&known);
        Ok(Self { program, reaching, known, verdicts })
    }

    /// Tries changes, two at a time, and appends the results to the file.
    fn in_pairs(
        &mut self,
        changes: &[usize],
        is_chosen: fn(&Test<'_>) -> bool,
        passed: Verdict,
    ) -> Result<()> {
        let file = Mutex::new(OpenOptions::new().create(true).append(true).open(&self.known)?);
        let next = Mutex::new((changes.iter(), Instant::now()));
        let work = || -> Result<()> {
            loop {
                let change = {
                    let mut next = next.lock().unwrap_or_else(|broken| broken.into_inner());
                    let Some(change) = next.0.next() else { return Ok(()) };
                    if next.1.elapsed() > Duration::from_secs(15) {
                        let left = next.0.len() + 1;
                        println!(
                            "{}: {left} of {} changes to go",
                            self.program.name,
                            changes.len()
                        );
                        next.1 = Instant::now();
                    }
                    *change
                };
                let tests = self.reaching[&change].iter().copied().filter(|test| is_chosen(test));
                let (verdict, by) = tried(change, tests.collect(), passed)?;
                let mut file = file.lock().unwrap_or_else(|broken| broken.into_inner());
                writeln!(file, "{change} {verdict:?} {by}")?;
            }
        };
        std::thread::scope(|scope| {
            let other = scope.spawn(work);
            work()?;
            other.join().unwrap_or(Ok(()))
        })?;
        self.verdicts = read(&self.known);
        Ok(())
    }
}

/// Runs tests in batches of growing size; returns which of them noticed the change.
fn tried(change: usize, tests: Vec<&Test<'_>>, passed: Verdict) -> Result<(Verdict, String)> {
    let (mut left, mut size) = (&tests[..], 1);
    while !left.is_empty() {
        let (batch, rest) = left.split_at(size.min(left.len()));
        let by = || batch.iter().map(|test| &*test.name).collect::<Vec<_>>().join(" ");
        match tests::with_change(change, batch)? {
            End::Passed => (left, size) = (rest, size * 2),
            End::Failed => return Ok((Verdict::Noticed, by())),
            End::Endless => return Ok((Verdict::Endless, by())),
        }
    }
    Ok((passed, String::new()))
}

/// Reads the results; the last line about a change counts.
fn read(known: &Path) -> BTreeMap<usize, Verdict> {
    let text = fs::read_to_string(known).unwrap_or_default();
    let lines = text.lines().filter_map(|line| {
        let mut words = line.split(' ');
        let change = words.next()?.parse().ok()?;
        let verdict = match words.next()? {
            "Noticed" => Verdict::Noticed,
            "Endless" => Verdict::Endless,
            "Quiet" => Verdict::Quiet,
            "Missed" => Verdict::Missed,
            _ => return None,
        };
        Some((change, verdict))
    });
    lines.collect()
}
