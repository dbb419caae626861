//! Measures the table of faults in SAFETY.md: hours of flight with one fault after the other.

use crate::common::{cargo, output};
use crate::figures::markdown;
use anyhow::{Result, ensure};

const PAGE: &str = "SAFETY.md";
const MARKER: &str = "faults";

/// Flies, and writes the table into SAFETY.md.
pub fn write() -> Result<()> {
    markdown::write(PAGE, MARKER, &table()?)
}

/// Flies, and fails if a promise is broken or SAFETY.md has other figures.
pub fn verify() -> Result<()> {
    markdown::ensure_written(PAGE, MARKER, &table()?, "cargo xtask write faults")
}

fn table() -> Result<String> {
    let mut flights = cargo("test --release --package host-tests --test faults");
    let printed = output(flights.args(["--", "--ignored", "--nocapture"]))?;
    let rows: Vec<&str> = printed.lines().filter(|line| line.starts_with('|')).collect();
    ensure!(rows.len() > 20, "the flights print no table:\n{printed}");
    Ok(format!("\n{}\n\n", rows.join("\n")))
}
