//! `spikewire samples`: writes channels of a recording as a table.

use crate::inputs::InputOptions;
use crate::words::tell;
use anyhow::Result;
use clap::Args;
use lab::flight::{self, Flight};
use lab::input::{Chunk, Unnamed};
use lab::output::{Output, is_table};
use std::io::Write;
use std::path::PathBuf;

/// Write channels of a recording as a CSV table: the time in seconds from the first sample, then a column for each
/// channel.
///
/// With --flight, the channels are those of the file, turn rates in rad/s and accelerations in m/s².
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire samples --channels gyro_x,gyro_y flight.csv
  spikewire samples --flight flight.toml flight.csv -o sensor.csv")]
pub(crate) struct Samples {
    /// Flight file (`flight.toml`), as written by `advise -o`, which names the channels and their units
    #[arg(long, value_name = "FILE", conflicts_with_all = ["column", "columns", "field", "fields"])]
    flight: Option<PathBuf>,
    #[command(flatten)]
    input: InputOptions,
    /// CSV file to write; default: standard output
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// Returns an error if the recording or the flight file is invalid, or if the output cannot be written.
pub(crate) fn run(options: &Samples) -> Result<()> {
    if let Some(output) = &options.output {
        is_table(output, "")?;
    }
    let asked = options.input.to_lab()?;
    let flight = options.flight.as_deref().map(Flight::read).transpose()?;
    let input = match &flight {
        Some(flight) => flight::input(flight, &asked)?,
        None => asked.or(Unnamed::All),
    };
    let mut source = input.open()?;
    let (names, sizes): (Vec<&str>, Vec<f64>) = match &flight {
        Some(flight) => {
            let names = flight.channels.iter().map(|channel| channel.name.as_str()).collect();
            (names, flight::unit_sizes(flight)?)
        }
        None => (source.names(), Vec::new()),
    };
    let names: Vec<String> = names.into_iter().map(field).collect();

    let mut output = Output::open(options.output.as_deref(), &input.input)?;
    let mut chunk = Chunk::default();
    source.next(&mut chunk)?;
    let first = chunk.times.first().copied();
    writeln!(output, "{}{}", if first.is_some() { "time," } else { "" }, names.join(","))?;
    while !chunk.is_empty() {
        for row in 0..chunk.len() {
            let mut line = Vec::new();
            if let (Some(time), Some(first)) = (chunk.times.get(row), first) {
                line.push(format!("{:.6}", (time - first) as f64 / 1e6));
            }
            for (channel, column) in chunk.columns.iter().enumerate() {
                let size = sizes.get(channel).copied().unwrap_or(1.0);
                line.push((column[row] * size).to_string());
            }
            writeln!(output, "{}", line.join(","))?;
        }
        source.next(&mut chunk)?;
    }
    tell(source.notes());
    Ok(output.finish()?)
}

/// A field of a CSV table.
fn field(name: &str) -> String {
    let is_plain = !name.contains([',', '"', '\n', '\r']);
    if is_plain { name.to_owned() } else { format!("\"{}\"", name.replace('"', "\"\"")) }
}
