//! `spikewire info`: what a log holds.

use anyhow::{Result, bail};
use clap::Args;
use flight_logs::Kind;
use lab::input::above_zero;
use lab::input::messages::{Overview, overview};
use std::io::{Write, stdout};
use std::path::PathBuf;

/// The kinds of logs that are read.
const KINDS: &str =
    "there are PX4's ULog, bags of ROS 1 and 2, MCAP files and Betaflight's blackbox";

/// List a log's topics with their fields, rates and gaps, and what its logger missed.
#[derive(Args, Debug)]
#[command(after_help = "\
Example:
  spikewire info flight.ulg")]
pub(crate) struct Info {
    /// PX4's `ULog`, a bag of ROS 1 or 2, an MCAP file or Betaflight's blackbox, also compressed by gzip
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
    let Info { log, gap, accept_cut } = options;
    let Some(kind) = Kind::of(log)? else {
        bail!("{}: not a log that is known; {KINDS}", log.display())
    };
    let (topics, notes) = overview(log, kind, *accept_cut, *gap)?;
    let mut output = stdout().lock();
    for note in notes {
        writeln!(output, "{note}")?;
    }
    for topic in &topics {
        write(topic, &mut output)?;
    }
    Ok(())
}

fn write(topic: &Overview, output: &mut impl Write) -> Result<()> {
    let Overview { name, kind, count, clock, rollover, .. } = topic;
    let of = if kind.is_empty() { String::new() } else { format!(" of {kind}") };
    match clock.rate() {
        Some(rate) => {
            let seconds = clock.seconds();
            writeln!(
                output,
                "{name}: {count} samples{of}, {seconds:.3} s, {rate:.2} Hz\n  {clock}"
            )?;
        }
        None => writeln!(output, "{name}: {count} samples{of}")?,
    }
    if let Some(note) = rollover.note() {
        writeln!(output, "  {note}")?;
    }
    if topic.missing > 0 {
        writeln!(
            output,
            "  {} messages are missing, by the numbers of those there",
            topic.missing
        )?;
    }
    match &topic.unread {
        Some(why) => writeln!(output, "  not read: {why}")?,
        None => writeln!(output, "  {}", topic.fields.join(", "))?,
    }
    if !topic.texts.is_empty() {
        writeln!(output, "  text: {}", topic.texts.join(", "))?;
    }
    Ok(())
}
