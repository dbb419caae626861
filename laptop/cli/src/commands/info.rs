//! `spikewire info`: lists the content of a log or a table.

use crate::inputs::as_file;
use crate::words::option;
use anyhow::Result;
use catalogue::run::Worded;
use clap::Args;
use flight_logs::Kind;
use lab::input::messages::{Overview, overview};
use lab::input::{ChannelOptions, InputOptions, Summary, above_zero, summary};
use lab::output::Output;
use std::io::Write;
use std::path::{Path, PathBuf};

/// List a log's topics with their fields, rates and gaps, and the data that the logger lost; or a table's columns,
/// rows, rate and gaps.
#[derive(Args, Debug)]
#[command(after_help = "\
Example:
  spikewire info flight.ulg")]
pub(crate) struct Info {
    /// Log or table: PX4's `ULog`, `ArduPilot`'s `.bin` or `.log`, a telemetry log `.tlog`, a bag of ROS 1 or 2, an
    /// MCAP file, Betaflight's blackbox, or a table in CSV, JSON lines, Parquet or `NumPy`'s arrays, also compressed; `-` is
    /// standard input
    log: PathBuf,
    /// Report time steps longer than this multiple of the usual step
    #[arg(long, default_value_t = 1.5, value_parser = above_zero)]
    gap: f64,
    /// Read the undamaged part of a log that is cut short or damaged
    #[arg(long)]
    accept_cut: bool,
}

/// Runs the command.
///
/// # Errors
/// Returns an error if the log cannot be read.
pub(crate) fn run(options: &Info) -> Result<()> {
    let Info { log, gap, accept_cut } = options;
    let (gap, accept_cut) = (*gap, *accept_cut);
    let log = &as_file(log)?;
    let kind = if log == Path::new("-") { None } else { Kind::of(log)? };
    let mut output = Output::to(None)?;
    let Some(kind) = kind else {
        let channel = ChannelOptions { gap, accept_cut, ..ChannelOptions::default() };
        let input = InputOptions { input: log.clone(), channel };
        write_table(&input.name(), &summary(&input)?, &mut output)?;
        return Ok(output.finish()?);
    };
    let (topics, notes) = overview(log, kind, accept_cut, gap)?;
    for note in notes {
        writeln!(output, "{note}")?;
    }
    for topic in &topics {
        write(topic, &mut output)?;
    }
    Ok(output.finish()?)
}

fn write_table(name: &str, table: &Summary, output: &mut impl Write) -> Result<()> {
    let Summary { columns, rows, clock, rollover, notes } = table;
    for note in notes {
        writeln!(output, "{}", note.spelled(option))?;
    }
    write!(output, "{name}: {rows} rows")?;
    if let Some(rate) = clock.rate() {
        write!(output, ", {:.3} s, {rate:.2} Hz", clock.seconds())?;
    }
    writeln!(output, "\n  {clock}")?;
    if let Some(note) = rollover.note() {
        writeln!(output, "  {note}")?;
    }
    let numbers = columns.iter().filter(|column| column.text.is_none());
    let numbers: Vec<&str> = numbers.map(|column| column.name.as_str()).collect();
    writeln!(output, "  {}", numbers.join(", "))?;
    for column in columns {
        if let Some((line, text)) = &column.text {
            writeln!(output, "  {}: no signal, as line {line} has `{text}`", column.name)?;
        } else if column.missing > 0 {
            let rows = if column.missing == 1 { "row" } else { "rows" };
            writeln!(
                output,
                "  {}: missing or not finite in {} {rows}",
                column.name, column.missing
            )?;
        }
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
