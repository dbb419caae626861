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
    if names == ["--list"] {
        for step in STEPS {
            println!("{:10} {}", step.name, step.what);
        }
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
