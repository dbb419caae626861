//! `cargo verify mutants`: plants changes in the crates' code, each of which the tests must notice.
//!
//! cargo-mutants lists the changes. A copy of the crates contains all of them at once, each behind a switch that is
//! read from the environment, so that its tests are compiled once. Each test runs alone and records which changes it
//! reaches. Then each change is switched on for the tests that reach it, the quickest first. `host-tests/mutants.toml`
//! lists those that no test notices; the check fails at any other.

mod changes;
mod copy;
mod held;
mod judge;
mod schemata;
mod tests;
mod text;

use anyhow::{Result, bail, ensure};
use copy::{Copy, Program};
use held::Held;
use judge::Verdict;
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, env};

/// Modules after which the tests' programs are named, with the beginnings of their sources' paths.
const ROOMS: [(&str, &[&str]); 4] = [
    ("wire", &["src/wire/", "src/event/", "src/out/", "src/serial.rs"]),
    ("cameras", &["cameras/src/"]),
    ("chips", &["chips/src/"]),
    ("codes", &["src/scheme/", "src/num/", "src/error/"]),
];

/// Crates that are changed, with the paths of their sources.
const CRATES: [(&str, &str); 3] =
    [("spikewire", "src"), ("spikewire-cameras", "cameras/src"), ("spikewire-chips", "chips/src")];

/// The reason that a change cannot be switched on.
#[derive(Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Out {
    /// The compiler rejects the change.
    DoesNotCompile,
    /// The compiler rejects its switch, or the change is in a constant.
    NoSwitch,
}

/// Runs the check. Environment variables select changes: `MUTANTS_SINCE=v0.1.0` those in lines that differ from that
/// commit, `MUTANTS_IN=src/wire` those with this in their names, `MUTANTS_AGAIN=1` those in the list that no test
/// notices yet, and `MUTANTS_AGAIN=all` the indistinguishable ones too. `MUTANTS_TESTS='chips wire'` leaves out the
/// tests of codes, which take longest to compile. A run that was stopped continues where it was.
pub fn mutants() -> Result<()> {
    let changes = changes::all()?;
    let names = changes::lasting_names(&changes);
    let recent =
        env::var("MUTANTS_SINCE").map(|commit| changes::since(&commit)).ok().transpose()?;
    let part = env::var("MUTANTS_IN").ok();
    let again = env::var("MUTANTS_AGAIN").ok();
    let held = Held::read()?;
    let is_listed = |name: &String| held.is_equal(name) || held.is_known(name);
    let is_asked = |number: &usize| {
        let name = &names[*number];
        recent.as_ref().is_none_or(|recent| recent.contains(&changes[*number].name))
            && again
                .as_ref()
                .is_none_or(|again| held.is_known(name) || again == "all" && held.is_equal(name))
    };
    let is_chosen =
        |number: &usize| part.as_ref().is_none_or(|part| changes[*number].name.contains(part));
    // Few changes compile soon; all parts of a run have the same ones, so that they compile once.
    let asked: Vec<usize> = (0..changes.len()).filter(is_asked).collect();
    let chosen: Vec<usize> = asked.iter().copied().filter(is_chosen).collect();
    ensure!(!chosen.is_empty() || recent.is_some(), "there is no such change");

    let mut copy = Copy::new(asked)?;
    let programs = copy.programs(&changes)?;
    let tests = tests::record(&programs)?;
    let tried: Vec<usize> =
        chosen.iter().copied().filter(|number| !copy.out.contains_key(number)).collect();
    println!("{} changes, {} tests", tried.len(), tests.len());
    let is_own = |change: usize, program: &Program| room(&changes[change].file) == program.name;
    let verdicts = judge::judge(&tried, &programs, &tests, is_own)?;

    for (name, _) in ROOMS {
        let is_here = |number: &&usize| room(&changes[**number].file) == name;
        let here: Vec<usize> = chosen.iter().filter(is_here).copied().collect();
        println!("{name}: {}", counts(&here, &names, &verdicts, &copy.out, &held));
    }
    let mut wrong = Vec::new();
    for (number, verdict) in &verdicts {
        let name = &names[*number];
        let is_listed = is_listed(name);
        match verdict {
            Verdict::Missed | Verdict::Quiet if !is_listed => {
                wrong.push(format!("not noticed: {name}"))
            }
            Verdict::NotReached if !is_listed => wrong.push(format!("not reached: {name}")),
            Verdict::Noticed | Verdict::Endless if is_listed => {
                wrong.push(format!("listed, but noticed: {name}"));
            }
            _ => {}
        }
    }
    let gone = held.names().filter(|name| !names.contains(name));
    wrong.extend(gone.map(|name| format!("listed, but gone: {name}")));
    if wrong.is_empty() { Ok(()) } else { bail!("{}", wrong.join("\n")) }
}

fn room(file: &str) -> &'static str {
    let is_here =
        |(_, sources): &&(_, &[&str])| sources.iter().any(|source| file.starts_with(source));
    ROOMS.iter().find(is_here).map_or("", |(name, _)| name)
}

/// Counts the verdicts on a module's changes.
fn counts(
    here: &[usize],
    names: &[String],
    verdicts: &BTreeMap<usize, Verdict>,
    out: &BTreeMap<usize, Out>,
    held: &Held,
) -> String {
    let judged = |of: &[Verdict]| {
        let is = |number: &&usize| verdicts.get(number).is_some_and(|verdict| of.contains(verdict));
        here.iter().filter(is).copied().collect::<Vec<_>>()
    };
    let left_out = |why| here.iter().filter(|number| out.get(number) == Some(&why)).count();
    let missed = judged(&[Verdict::Missed, Verdict::Quiet, Verdict::NotReached]);
    let equal = missed.iter().filter(|number| held.is_equal(&names[**number])).count();
    format!(
        "{} tried: {} noticed, {} without end, {equal} equal, {} not noticed; \
         {} do not compile, {} without a switch",
        here.len() - left_out(Out::DoesNotCompile) - left_out(Out::NoSwitch),
        judged(&[Verdict::Noticed]).len(),
        judged(&[Verdict::Endless]).len(),
        missed.len() - equal,
        left_out(Out::DoesNotCompile),
        left_out(Out::NoSwitch),
    )
}
