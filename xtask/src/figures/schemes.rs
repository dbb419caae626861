//! Measures each scheme on a flight and on the paper's signal, with the laptop program.

use crate::common::{output, paths};
use crate::figures::markdown;
use crate::programs::host::spikewire;
use anyhow::{Context, Result};
use serde::Deserialize;

const PAGE: &str = "docs/schemes.md";
const MARKER: &str = "schemes";

/// The report of `spikewire score --json`.
#[derive(Deserialize)]
struct Report {
    logs: [Log; 1],
}

/// The entry of a log.
#[derive(Deserialize)]
struct Log {
    schemes: Vec<Figures>,
}

/// The figures of a scheme.
#[derive(Deserialize)]
struct Figures {
    scheme: String,
    efficiency: f64,
    rmse: f64,
    spikes_per_second: Option<f64>,
}

/// Writes the figures into docs/schemes.md.
pub fn write() -> Result<()> {
    markdown::write(PAGE, MARKER, &table()?)
}

/// Fails if docs/schemes.md has other figures.
pub fn ensure_written() -> Result<()> {
    markdown::ensure_written(PAGE, MARKER, &table()?, "cargo xtask write schemes")
}

fn table() -> Result<String> {
    let signal = paths::target().join("paper-signal.csv");
    output(&mut spikewire(&format!("signal --seconds 15 -o {}", signal.display()))?)?;
    let flight = scored("--column gyro_x data/hexarotor.csv")?;
    let paper = scored(&format!("--column signal {}", signal.display()))?;
    let mut table = "\n| scheme | flight: spikes a second | RMSE, rad/s | paper's signal: spikes a second | efficiency, % | RMSE |\n\
                     |---|---:|---:|---:|---:|---:|\n"
        .to_owned();
    for (flight, paper) in flight.iter().zip(&paper) {
        let rate = |figures: &Figures| {
            figures.spikes_per_second.map_or(String::new(), |rate| format!("{rate:.1}"))
        };
        table += &format!(
            "| `{}` | {} | {:.3} | {} | {:.1} | {:.3} |\n",
            flight.scheme,
            rate(flight),
            flight.rmse,
            rate(paper),
            paper.efficiency,
            paper.rmse
        );
    }
    Ok(table + "\n")
}

fn scored(what: &str) -> Result<Vec<Figures>> {
    let json = output(&mut spikewire(&format!("score --json {what}"))?)?;
    let report: Report = serde_json::from_str(&json).context("the figures of `spikewire score`")?;
    let [log] = report.logs;
    Ok(log.schemes)
}
