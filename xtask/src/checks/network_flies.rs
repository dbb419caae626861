//! `cargo verify net-flies`: flies a simulated drone with the committed network, which replaces a cascade of
//! controllers.

use super::network::everywhere;
use super::simulated_drone::{environment, program};
use crate::common::{output, paths, run};
use crate::figures::markdown;
use crate::programs::{boards::Board, host};
use anyhow::Result;
use std::fs;

const PAGE: &str = "docs/flown-networks.md";
const MARKER: &str = "network";
const EXPORT: &str = "network laptop/loop/network.nir --on controller --reset subtract --fires above --decay euler \
                      --current new --dt 0.002";

/// Checks that the table of the network in docs/flown-networks.md comes again from the committed graph.
pub fn verify() -> Result<()> {
    markdown::ensure_written(PAGE, MARKER, &flown()?, "cargo xtask write network-flies")
}

/// Flies all manoeuvres, and writes the table into docs/flown-networks.md.
pub fn write() -> Result<()> {
    markdown::write(PAGE, MARKER, &flown()?)
}

/// Returns the table, which includes the cost of a flip on two emulated boards, whose potentials have the host's bits.
fn flown() -> Result<String> {
    let place = paths::target().join("network-flies");
    fs::create_dir_all(&place)?;
    let (spikes, module) = (place.join("flip.txt"), place.join("network.rs"));
    let table = output(program(&environment()?, "network_flies.py").arg(&spikes))?;
    run(host::spikewire(EXPORT)?.arg(&spikes).arg("-o").arg(&module))?;
    let told = everywhere(&module, &spikes, Board::every_day())?;
    let costs: Vec<String> = told
        .lines()
        .filter_map(|line| line.split_once(": the same, "))
        .map(|(board, costs)| format!("{board}, {costs}"))
        .collect();
    let text = format!("\n{table}\nThe spikes of a flip, mean and most: {}.\n\n", costs.join("; "));
    println!("{text}");
    Ok(text)
}
