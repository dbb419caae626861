//! `cargo verify network-flies`: a simulated drone on the committed network, which does what a cascade does.

use super::simulated_drone::{environment, program};
use crate::common::output;
use crate::figures::markdown;
use anyhow::Result;

const PAGE: &str = "docs/loop.md";
const MARKER: &str = "network";

/// What the page says of the network comes again from the committed graph.
pub fn verify() -> Result<()> {
    markdown::ensure_written(PAGE, MARKER, &flown()?, "cargo xtask write network-flies")
}

/// Flies all manoeuvres, and puts the table into the page.
pub fn write() -> Result<()> {
    markdown::write(PAGE, MARKER, &flown()?)
}

fn flown() -> Result<String> {
    let table = output(&mut program(&environment()?, "network_flies.py"))?;
    println!("{table}");
    Ok(format!("\n{table}\n"))
}
