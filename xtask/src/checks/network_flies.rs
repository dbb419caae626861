//! `cargo verify net-flies`: a simulated drone on the committed network, which does what a cascade does.

use super::network::everywhere;
use super::simulated_drone::{environment, program};
use crate::common::{output, paths, run};
use crate::figures::markdown;
use crate::programs::host;
use anyhow::Result;
use std::fs;

const PAGE: &str = "docs/loop.md";
const MARKER: &str = "network";
const EXPORT: &str = "network laptop/loop/network.nir --on controller --reset subtract --fires above --decay euler \
                      --current new --dt 0.002";

/// What the page says of the network comes again from the committed graph.
pub fn verify() -> Result<()> {
    markdown::ensure_written(PAGE, MARKER, &flown()?, "cargo xtask write network-flies")
}

/// Flies all manoeuvres, and puts the table into the page.
pub fn write() -> Result<()> {
    markdown::write(PAGE, MARKER, &flown()?)
}

/// The table; and what a flip costs on two emulated boards, whose potentials have the host's bits.
fn flown() -> Result<String> {
    let place = paths::target().join("network-flies");
    fs::create_dir_all(&place)?;
    let (spikes, module) = (place.join("flip.txt"), place.join("network.rs"));
    let table = output(program(&environment()?, "network_flies.py").arg(&spikes))?;
    run(host::spikewire(EXPORT)?.arg(&spikes).arg("-o").arg(&module))?;
    let told = everywhere(&module, &spikes)?;
    let costs: Vec<String> = told
        .lines()
        .filter_map(|line| line.split_once(": the same, "))
        .map(|(board, costs)| format!("{board}, {costs}"))
        .collect();
    let text = format!("\n{table}\nThe spikes of a flip, mean and most: {}.\n\n", costs.join("; "));
    println!("{text}");
    Ok(text)
}
