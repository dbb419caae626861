//! Measures the table of faults in SAFETY.md: hours of flight with one fault after the other.

use crate::common::{cargo, output, paths};
use crate::figures::markdown;
use anyhow::{Result, ensure};
use std::fs;

const PAGE: &str = "SAFETY.md";
const MARKER: &str = "faults";
/// Every figure, of which the page shows a few.
const FIGURES: &str = "docs/faults.csv";
const COMMAND: &str = "cargo xtask write faults";

/// Flies, and writes the table into SAFETY.md, and every figure beside the other pages.
pub fn write() -> Result<()> {
    let rows = fly()?;
    fs::write(paths::root().join(FIGURES), csv(&rows))?;
    markdown::write(PAGE, MARKER, &table(&rows))
}

/// Flies, and fails if a promise is broken or the figures are others.
pub fn verify() -> Result<()> {
    let rows = fly()?;
    let written = fs::read_to_string(paths::root().join(FIGURES))?;
    ensure!(
        written == csv(&rows),
        "{FIGURES} has other figures; `{COMMAND}` writes these:\n{}",
        csv(&rows)
    );
    markdown::ensure_written(PAGE, MARKER, &table(&rows), COMMAND)
}

/// A row that the flights print.
struct Row {
    fault: String,
    injected: String,
    noticed: String,
    recovery: String,
    exact: String,
}

/// Flies, and reads the rows, the one of the heads first and the sum last.
fn fly() -> Result<Vec<Row>> {
    let mut flights = cargo("test --release --package host-tests --test faults");
    let printed = output(flights.args(["--", "--ignored", "--nocapture"]))?;
    let rows: Vec<Row> = read(&printed);
    ensure!(rows.len() > 20, "the flights print no table:\n{printed}");
    Ok(rows)
}

fn read(printed: &str) -> Vec<Row> {
    printed.lines().filter_map(row).collect()
}

/// Reads a row; none of a line that is no row of five cells, such as the rule below the heads.
fn row(line: &str) -> Option<Row> {
    let cells = line.strip_prefix('|')?.strip_suffix('|')?.split('|');
    let cells: Vec<String> = cells.map(|cell| cell.trim().to_owned()).collect();
    let [fault, injected, noticed, recovery, exact] = cells.try_into().ok()?;
    (!fault.starts_with("---")).then_some(Row { fault, injected, noticed, recovery, exact })
}

/// Formats the faults, each with the kinds of what was noticed, without their numbers.
fn table(rows: &[Row]) -> String {
    let mut lines = Vec::new();
    for Row { fault, noticed, recovery, .. } in rows {
        let kinds: Vec<&str> = noticed.split(", ").map(without_number).collect();
        lines.push(format!("| {fault} | {} | {recovery} |", kinds.join(", ")));
    }
    if let Some(Row { fault, exact, .. }) = rows.last() {
        lines.pop();
        lines.push(format!("| {fault} | | {exact} |"));
    }
    lines.insert(1, "|---|---|---|".into());
    format!("\n{}\n\n", lines.join("\n"))
}

fn without_number(counted: &str) -> &str {
    counted.trim_start_matches(|sign: char| sign.is_ascii_digit()).trim()
}

/// Formats every figure.
fn csv(rows: &[Row]) -> String {
    let mut text = String::new();
    for Row { fault, injected, noticed, recovery, exact } in rows {
        let cells = [fault, injected, noticed, recovery, exact].map(|cell| format!("\"{cell}\""));
        text += &(cells.join(",") + "\n");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_go_to_the_file_and_kinds_to_the_page() {
        let rows = read(
            "| fault | injected | noticed | exact again within | exact |\n|---|---|---|---|---|\n\
             | cut | 7 frames | 3 lost, 4 late | 0.05 s, 0.45 s | 9 |\n| 2 spells | | | | 9, 0 wrong |\n",
        );
        assert_eq!(
            table(&rows),
            "\n| fault | noticed | exact again within |\n|---|---|---|\n\
             | cut | lost, late | 0.05 s, 0.45 s |\n| 2 spells | | 9, 0 wrong |\n\n"
        );
        assert_eq!(
            csv(&rows[1..]),
            "\"cut\",\"7 frames\",\"3 lost, 4 late\",\"0.05 s, 0.45 s\",\"9\"\n\
             \"2 spells\",\"\",\"\",\"\",\"9, 0 wrong\"\n"
        );
    }
}
