//! `cargo verify`: every check, in order, each with its time. A failure does not hide the next one.

use crate::{checks, link, logging, parts, storm};
use anyhow::{Result, bail};
use std::time::Instant;

/// A check that `cargo verify <name>` runs alone.
struct Step {
    name: &'static str,
    what: &'static str,
    run: fn() -> Result<()>,
}

/// To add a check: write a function in `checks.rs`, and a line here.
const STEPS: &[Step] = &[
    step("setup", "compiler targets, QEMU, binutils", checks::setup),
    step("fmt", "rustfmt", checks::fmt),
    step("clippy", "clippy, host and firmware", checks::clippy),
    step("test", "host tests and doctests", checks::test),
    step("peers", "event formats against other programs", checks::peers),
    step("readme", "the README's code runs", checks::readme),
    step("doc", "documentation without warnings", checks::doc),
    step("features", "every feature alone, on the host", checks::features),
    step("targets", "the crate for every Cortex-M", checks::targets),
    step("no-panic", "every codec links without a panic handler", checks::no_panic),
    step("parts", "the examples for real parts", parts::parts),
    step("demo", "the demo's table and picture", checks::demo),
    step("firmware", "emulated boards against the host", checks::firmware),
    step("storm", "more events than main takes, on emulated boards and host", storm::storm),
    step("logging", "defmt out of emulated boards, decoded on the host", logging::logging),
    step("link", "a flight over a serial line, board against host", link::link),
    step("laptop", "the laptop program on a flight, and the paper's tables", checks::laptop),
    step("bench", "instruction counts against the baseline", checks::bench),
];

const fn step(name: &'static str, what: &'static str, run: fn() -> Result<()>) -> Step {
    Step { name, what, run }
}

/// Runs the named steps, or all, in the list's order.
pub fn verify(names: &[String]) -> Result<()> {
    let steps = || {
        let lines = STEPS.iter().map(|step| format!("{:10} {}\n", step.name, step.what));
        lines.collect::<String>()
    };
    if names == ["--list"] {
        print!("{}", steps());
        return Ok(());
    }
    if names.iter().any(|name| matches!(name.as_str(), "-h" | "--help" | "help")) {
        print!("{}", help(&steps()));
        return Ok(());
    }
    if let Some(name) =
        names.iter().find(|name| STEPS.iter().all(|step| step.name != name.as_str()))
    {
        bail!("no step `{name}`; `cargo verify --list` names them");
    }

    let mut results = Vec::new();
    for step in STEPS {
        if !names.is_empty() && !names.iter().any(|name| name == step.name) {
            continue;
        }
        println!("\n=== {}: {}", step.name, step.what);
        let start = Instant::now();
        let result = (step.run)();
        if let Err(error) = &result {
            println!("FAILED: {error:#}");
        }
        results.push((step, result.is_ok(), start.elapsed().as_secs_f64()));
        if step.name == "setup" && result.is_err() {
            break; // nothing below can work
        }
    }
    summary(&results)
}

fn help(steps: &str) -> String {
    format!(
        "\
cargo verify [STEP]...

Runs every check, or the named ones in the order below, each with its time, and a summary at the end.
A failure does not hide the next one; the exit status is 1 if one failed.

  cargo verify                 all of them
  cargo verify clippy test     two of them
  cargo verify --list          their names

{steps}"
    )
}

fn summary(results: &[(&Step, bool, f64)]) -> Result<()> {
    println!("\n=== summary");
    for (step, good, seconds) in results {
        let verdict = if *good { "ok" } else { "FAILED" };
        println!("{verdict:6} {seconds:6.1} s  {:10} {}", step.name, step.what);
    }
    let failed: Vec<&str> =
        results.iter().filter(|(_, good, _)| !good).map(|(step, ..)| step.name).collect();
    if failed.is_empty() { Ok(()) } else { bail!("failed: {}", failed.join(", ")) }
}

#[cfg(test)]
mod tests {
    use super::{STEPS, verify};

    #[test]
    fn help_is_no_step_and_names_them_all() {
        assert!(verify(&["--help".to_owned()]).is_ok());
        assert!(verify(&["what".to_owned()]).is_err());
        let text = super::help("clippy");
        assert!(text.contains("cargo verify [STEP]...") && text.ends_with("clippy"));
        assert!(STEPS.iter().all(|step| !step.what.is_empty()));
    }
}
