//! `spikewire dataset`: encodes many logs to Parquet files, with a manifest.

use crate::inputs::{LogList, ManyChannels};
use crate::options::{Coding, answer, whole};
use crate::report::Report;
use anyhow::{Result, bail};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use lab::dataset::{self, Code, Flights, Outcome, Request};
use lab::flight::{Flight, visible};
use lab::watch::Progress;
use std::fmt::Write;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::thread;

/// Encode many logs of any kinds to Parquet files of spikes and samples, with a manifest of the logs.
///
/// The directory DIR holds two Parquet files for each log, and the file `manifest.jsonl`. `events/NAME.parquet` holds
/// the log's spikes in the columns `index`, `channel` and `polarity`, with `neuron` if a channel has several neurons,
/// and `time_us` if the log has times. `values/NAME.parquet` holds the samples that were encoded. `manifest.jsonl`
/// holds a row for each log. A row has the hash of the log, the number of samples read, the number of samples left out,
/// and whether the log is for training or testing, which its hash decides. If a log cannot be read, its row gives the
/// reason.
///
/// The same command, given again, continues a run that was interrupted or killed. A log that has changed is encoded
/// again. `decode --spikes` turns a Parquet file of spikes into the file that `encode` writes.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire dataset --flight flight.toml logs -o spikes
  spikewire dataset --scheme sf --threshold 0.1 --channels 'gyro_*' 'flights/**/*.csv' -o spikes
  spikewire dataset --flight flight.toml --channels-of 'ulog=sensor_combined.gyro_rad[0]' --channels-of ardupilot=IMU.GyrX logs -o spikes")]
pub(crate) struct Dataset {
    #[command(flatten)]
    coding: Coding,
    /// Flight file (`flight.toml`) that `advise -o` wrote. It sets the channels to encode, and the encoders, which are
    /// those of the sender on the drone
    #[arg(long, value_name = "FILE", conflicts_with_all = ["scheme", "sample", "params", "column", "columns", "topic", "field", "fields"])]
    flight: Option<PathBuf>,
    #[command(flatten)]
    logs: LogList,
    #[command(flatten)]
    channels: ManyChannels,
    /// Directory to write; a directory that an earlier run left incomplete is completed
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Share of the flights to use for testing, 0 to 1, about: each flight goes by its own hash, so that other logs never
    /// change its side
    #[arg(long, value_name = "SHARE", default_value_t = 0.2)]
    test: f64,
    /// Count all logs of a directory as one flight, which is wholly for training or wholly for testing; default: each
    /// log is a flight of its own
    #[arg(long)]
    by_directory: bool,
    /// Number of logs to encode at the same time; default: one for each core
    #[arg(long, value_parser = whole::<usize>)]
    jobs: Option<usize>,
    /// Print the rows of the manifest, and the numbers of logs, samples and spikes, as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
///
/// # Errors
/// Returns an error if an option is invalid, if no log can be encoded, or if a file cannot be written.
pub(crate) fn run(options: &Dataset) -> Result<()> {
    let bar = ProgressBar::no_length().with_style(ProgressStyle::with_template(
        "{bar:40} {pos} of {len} logs, {eta} left; {msg}",
    )?);
    let (outcome, rows) = dataset::run(&options.request()?, &mut |progress: &Progress| {
        bar.set_length(progress.total as u64);
        bar.set_position(progress.done as u64);
        bar.set_message(visible(&progress.words));
    })?;
    bar.finish_and_clear();
    let Outcome { logs, done_before, gone, refused, passed_over, samples, events, train, test } =
        outcome;
    if options.json {
        Report { command: "dataset", logs: &rows, summary: outcome }.print()?;
    } else {
        let encoded = logs - refused;
        let mut text = format!(
            "{encoded} logs with {samples} samples and {events} spikes, {train} to train and {test} to test\n"
        );
        for (count, what) in [
            (done_before, "logs were done before"),
            (refused, "logs are refused; the manifest has the reasons"),
            (gone, "logs are gone, and have no row any more; their files stay"),
            (passed_over, "files are neither logs nor tables"),
        ] {
            if count > 0 {
                writeln!(text, "{count} {what}")?;
            }
        }
        let is_empty = |share: f64, count: usize| share > 0.0 && count == 0 && encoded > 0;
        if is_empty(options.test, test) || is_empty(1.0 - options.test, train) {
            text += "one side has no flight: each goes by its own hash, so that a few may all be on one; --test gives another share\n";
        }
        answer(text)?;
    }
    if refused == logs {
        let why = rows.iter().find_map(|row| row.refused.as_deref()).unwrap_or("no logs");
        bail!("no log can be encoded: {why}");
    }
    Ok(())
}

impl Dataset {
    fn request(&self) -> Result<Request> {
        let code = match &self.flight {
            Some(_) if !self.coding.chosen()?.2.is_empty() => bail!("--flight says all parameters"),
            Some(flight) => Code::Flight(Box::new(Flight::read(flight)?)),
            None => {
                let (scheme, sample, asked) = self.coding.one()?;
                Code::Coding(Box::new(lab::coding::Coding { scheme, sample, asked }))
            }
        };
        let cores = thread::available_parallelism().map_or(1, NonZeroUsize::get);
        Ok(Request {
            logs: self.logs.given()?,
            code,
            channel: self.channels.channel.of(Path::new("")).channel,
            channels_of: self.channels.channels_of.clone(),
            output: self.output.clone(),
            test: self.test,
            flights: if self.by_directory { Flights::Directories } else { Flights::Logs },
            jobs: self.jobs.unwrap_or(cores),
        })
    }
}
