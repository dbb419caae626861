//! `cargo xtask write`: generates all that is generated.

use crate::checks::{firmware, interface, network_flies, ros, simulated_drone, video};
use crate::common::usage;
use crate::figures::{bench, chips, demo, faults, flash, jumps, schemes};
use crate::products::{c_library, page, python_package};
use anyhow::{Context, Result};
use std::collections::HashSet;

/// A part of what is generated.
struct Part {
    name: &'static str,
    /// The committed files.
    files: &'static str,
    write: fn() -> Result<()>,
}

const fn part(name: &'static str, files: &'static str, write: fn() -> Result<()>) -> Part {
    Part { name, files, write }
}

/// The parts: those from the catalogue first, then those that are measured or drawn.
const PARTS: [Part; 21] = [
    part("interface", "interface.txt of each published crate", interface::write),
    part("c", "bindings/c/src/codecs.rs, bindings/c/src/sizes.rs", c_library::write),
    part("python", "bindings/python/spikewire/_schemes.pyi", python_package::write_stub),
    part("schemes", "docs/schemes.md: the table", schemes::write),
    part("jumps", "docs/jumps.svg", jumps::write),
    part("flight", "docs/flight.svg", demo::write),
    part(
        "loop",
        "docs/loop.md: its tables, docs/loop.svg and docs/crash.svg; well over an hour",
        simulated_drone::write,
    ),
    part(
        "advised",
        "docs/loop.md: the flights of the banks that `advise` takes",
        simulated_drone::write_advised,
    ),
    part(
        "verdicts",
        "docs/loop.md: its tables from laptop/loop/verdicts.json and minutes.json",
        simulated_drone::write_tables,
    ),
    part(
        "chip",
        "docs/flown-networks.md: the chip's flights, and docs/chip.svg",
        simulated_drone::write_chip,
    ),
    part("chips", "docs/chips.md: how well networks agree on the chips", chips::write),
    part("network-flies", "docs/flown-networks.md: the network's flights", network_flies::write),
    part("frames", "docs/frames.png", video::write),
    part("page", "docs/page.png", page::write),
    part("ros", "docs/ros.svg", ros::write),
    part("bits", "docs/bits.csv", firmware::write),
    part(
        "c-sizes",
        "bindings/c/sizes.csv, bindings/c/README.md: the sizes",
        c_library::write_sizes,
    ),
    part("costs", "docs/costs*.csv, docs/costs.md, README.md: the costs", bench::write),
    part("faults", "docs/faults.csv, SAFETY.md: the faults", faults::write),
    part("flash", "docs/costs.md: the table of flash", flash::write),
    part("stack", "docs/costs-stack.csv, docs/costs.md: the stacks", bench::write_stack),
];

/// Writes the named parts, or all.
pub fn write(names: &[String]) -> Result<()> {
    let known: HashSet<_> = PARTS.iter().map(|part| part.name).collect();
    if let Some(other) = names.iter().find(|name| !known.contains(name.as_str())) {
        let lines = PARTS.map(|Part { name, files, .. }| format!("  {name:8} {files}"));
        return Err(usage(format!(
            "nothing generated is called `{other}`\n\ncargo xtask write [PART]...\n\n{}",
            lines.join("\n")
        )));
    }
    let chosen = |part: &&Part| names.is_empty() || names.iter().any(|name| name == part.name);
    for Part { name, files, write } in PARTS.iter().filter(chosen) {
        println!("=== {name}: {files}");
        write().with_context(|| format!("cargo xtask write {name}"))?;
    }
    Ok(())
}
