//! `spikewire info`: what a flight log holds.

use crate::input::{Clock, Log, above_zero, is_flight_log};
use anyhow::{Result, bail};
use clap::Args;
use std::io::{Write, stdout};
use std::path::PathBuf;

/// List a flight log's topics with their fields, rates and gaps, and the logger's dropouts.
#[derive(Args, Debug)]
#[command(after_help = "\
Example:
  spikewire info flight.ulg")]
pub(crate) struct Info {
    /// PX4 flight log (`ULog`), also compressed by gzip
    log: PathBuf,
    /// Report steps in time above this many usual steps
    #[arg(long, default_value_t = 1.5, value_parser = above_zero)]
    gap: f64,
    /// Take the whole messages of a log that is cut short or damaged
    #[arg(long)]
    accept_cut: bool,
}

/// Runs the command.
///
/// # Errors
/// The log cannot be read.
pub(crate) fn run(options: &Info) -> Result<()> {
    if !is_flight_log(&options.log)? {
        bail!("{}: not a flight log; ULog files start with `ULog`", options.log.display());
    }
    let log = Log::read(&options.log, options.accept_cut)?;
    let topics = log.topics()?;
    let mut output = stdout().lock();
    write!(output, "{}", log.findings)?;
    for (name, topic) in topics {
        let (count, times) = (topic.times.len(), &topic.times);
        let mut clock = Clock::new(times, None, options.gap);
        clock.observe(times);
        let seconds = times
            .last()
            .zip(times.first())
            .map_or(0.0, |(last, first)| last.saturating_sub(*first) as f64 * 1e-6);
        match clock.rate() {
            Some(rate) => writeln!(
                output,
                "{name}: {count} samples, {seconds:.3} s, {rate:.2} Hz\n  {clock}"
            )?,
            None => writeln!(output, "{name}: {count} samples")?,
        }
        writeln!(output, "  {}", fields(&topic.fields))?;
        if !topic.texts.is_empty() {
            writeln!(output, "  text: {}", topic.texts.join(", "))?;
        }
    }
    Ok(())
}

/// The fields with arrays joined: `gyro_rad[0..3]`.
fn fields(names: &[String]) -> String {
    let runs = names.chunk_by(|a, b| a.contains('[') && array(a) == array(b));
    let joined = runs.map(|run| match run {
        [one] => one.clone(),
        [first, ..] => format!("{}[0..{}]", array(first), run.len()),
        [] => String::new(),
    });
    joined.collect::<Vec<_>>().join(", ")
}

fn array(name: &str) -> &str {
    name.rsplit_once('[').map_or(name, |(array, _)| array)
}
