//! `spikewire signal`: a signal of the paper's benchmark, to try things on.

use anyhow::{Result, bail};
use clap::Args;
use lab::bench::signal::{RATE, Waveform};
use lab::output::Output;
use std::io::Write;
use std::path::PathBuf;

/// Write a signal of the paper's benchmark as a CSV table `time_us,signal`, 100 samples a second.
#[derive(Args, Debug)]
#[command(after_help = "\
Example:
  spikewire signal --seconds 15 | spikewire encode --scheme sf --threshold 0.5 -")]
pub(crate) struct Signal {
    /// Its duration in seconds
    #[arg(long, default_value_t = 1)]
    seconds: usize,
    /// Seed of its noise
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// CSV file; standard output unless given
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// The output cannot be written.
pub(crate) fn run(options: &Signal) -> Result<()> {
    // All of it is held in memory.
    const MOST: usize = 1_000_000;
    if options.seconds > MOST {
        bail!("--seconds {} must be {MOST} at most", options.seconds);
    }
    let mut output = Output::to(options.output.as_deref())?;
    writeln!(output, "time_us,signal")?;
    for (step, value) in (1..).zip(Waveform::new(options.seconds).with_noise(options.seed, 0)) {
        writeln!(output, "{},{value}", step * 1_000_000 / RATE)?;
    }
    output.finish()
}
