//! `spikewire signal`: writes the test signal of the benchmark in Dupeyroux et al. (2022) as a table.

use crate::options::whole;
use anyhow::Result;
use clap::Args;
use lab::bench::signal::{RATE, Waveform};
use lab::output::{Output, is_table};
use std::io::Write;
use std::path::PathBuf;

/// Write the test signal of the paper's benchmark, Dupeyroux et al. (2022), as a CSV table `time_us,signal`, 100
/// samples a second.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire signal --seconds 15 -o signal.csv
  spikewire signal --seconds 15 | spikewire encode --scheme sf --threshold 0.5 -")]
pub(crate) struct Signal {
    /// Duration in seconds, 0 to 1000000
    #[arg(long, default_value_t = 1, value_parser = seconds)]
    seconds: usize,
    /// Seed of the noise in the signal
    #[arg(long, default_value_t = 1, value_parser = whole::<u64>)]
    seed: u64,
    /// CSV file to write; default: standard output
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// Parses a duration in whole seconds, 0 to 1 000 000; a longer signal would not fit into memory.
fn seconds(text: &str) -> Result<usize, String> {
    const MOST: usize = 1_000_000;
    let seconds = whole(text).ok().filter(|seconds| *seconds <= MOST);
    seconds.ok_or_else(|| format!("must be a whole number, 0 to {MOST}"))
}

/// Runs the command.
///
/// # Errors
/// Returns an error if the output cannot be written.
pub(crate) fn run(options: &Signal) -> Result<()> {
    if let Some(output) = &options.output {
        is_table(output, "")?;
    }
    let mut output = Output::to(options.output.as_deref())?;
    writeln!(output, "time_us,signal")?;
    for (step, value) in (1..).zip(Waveform::new(options.seconds).with_noise(options.seed, 0)) {
        writeln!(output, "{},{value}", step * 1_000_000 / RATE)?;
    }
    Ok(output.finish()?)
}
