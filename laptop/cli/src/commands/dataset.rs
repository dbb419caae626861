//! `spikewire dataset`: encodes many logs to Parquet files, with a manifest.

use crate::inputs::ChannelOptions;
use crate::options::{Coding, answer, whole};
use anyhow::{Context, Result, bail};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use lab::dataset::{self, ChannelsOf, Code, Flights, Outcome, Request};
use lab::flight::Flight;
use lab::watch::Progress;
use std::fmt::Write;
use std::fs;
use std::io::{self, Read};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::thread;

/// Encode many logs of any kinds to Parquet files of spikes and samples, with a manifest of what became of each log.
///
/// In the directory DIR, `events/NAME.parquet` has a log's spikes (`index`, `channel`, `polarity`, `neuron` if a channel
/// has several, `time_us` if the log has times), `values/NAME.parquet` the samples that were encoded, and `manifest.jsonl` a
/// row for each log: its hash, what was read and what was not, and on which side of the split it is. A log that cannot be
/// read gets a row with the reason. A run that was ended, even killed, is continued by the same command; a log that has
/// changed is encoded again. `decode --spikes` turns a file of spikes into the one that `encode` writes.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire dataset --flight flight.toml logs -o spikes
  spikewire dataset --scheme sf --threshold 0.1 --columns gyro_x,gyro_y,gyro_z 'flights/**/*.csv' -o spikes
  spikewire dataset --flight flight.toml --channels-of 'ulog=sensor_combined.gyro_rad[0]' --channels-of ardupilot=IMU.GyrX logs -o spikes")]
pub(crate) struct Dataset {
    #[command(flatten)]
    coding: Coding,
    /// Flight's file (TOML) that `advise -o` wrote: encodes its channels as the flight's sender does
    #[arg(long, value_name = "FILE", conflicts_with_all = ["scheme", "sample", "params", "column", "columns", "topic", "field", "fields"])]
    flight: Option<PathBuf>,
    /// Files, directories and patterns such as 'logs/**/*.ulg'. In a directory, logs are found by their content, and
    /// tables by their endings, such as .csv and .parquet
    logs: Vec<PathBuf>,
    /// File with more of them, one on each line; `-` is standard input
    #[arg(long, value_name = "FILE")]
    list: Option<PathBuf>,
    /// Channels to read from logs of one kind, in place of the flight's or of --columns. KIND is table, ulog, ardupilot,
    /// mavlink, bag, ros2, mcap or blackbox. If given several times for a kind, the first that a log has is taken
    #[arg(long, value_name = "KIND=NAMES", help_heading = "Input")]
    channels_of: Vec<ChannelsOf>,
    #[command(flatten)]
    channel: ChannelOptions,
    /// Directory to write, or to complete
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Share of the flights that is for testing, 0 to 1
    #[arg(long, value_name = "SHARE", default_value_t = 0.2)]
    test: f64,
    /// Put all logs of a directory on the same side of the split; otherwise each log is a flight of its own
    #[arg(long)]
    by_directory: bool,
    /// Number of logs to encode at once; default: one for each core
    #[arg(long, value_parser = whole::<usize>)]
    jobs: Option<usize>,
    /// Print the counts as JSON
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
    let outcome = dataset::run(&options.request()?, &mut |progress: &Progress| {
        bar.set_length(progress.total as u64);
        bar.set_position(progress.done as u64);
        bar.set_message(progress.words.clone());
    })?;
    bar.finish_and_clear();
    let Outcome { logs, done_before, refused, passed_over, samples, events, train, test } = outcome;
    if options.json {
        answer(serde_json::to_string_pretty(&outcome)? + "\n")?;
    } else {
        let encoded = logs - refused;
        let mut text = format!(
            "{encoded} logs with {samples} samples and {events} spikes, {train} to train and {test} to test\n"
        );
        for (count, what) in [
            (done_before, "logs were done before"),
            (refused, "logs are refused; the manifest has the reasons"),
            (passed_over, "files are neither logs nor tables"),
        ] {
            if count > 0 {
                writeln!(text, "{count} {what}")?;
            }
        }
        answer(text)?;
    }
    if refused == logs {
        let rows = dataset::rows(&options.output)?;
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
            logs: self.logs.iter().cloned().chain(self.listed()?).collect(),
            code,
            channel: self.channel.of(Path::new("")).channel,
            channels_of: self.channels_of.clone(),
            output: self.output.clone(),
            test: self.test,
            flights: if self.by_directory { Flights::Directories } else { Flights::Logs },
            jobs: self.jobs.unwrap_or(cores),
        })
    }

    /// Reads the list of logs.
    fn listed(&self) -> Result<Vec<PathBuf>> {
        let Some(list) = &self.list else { return Ok(Vec::new()) };
        let text = if list == Path::new("-") {
            let mut text = String::new();
            io::stdin().read_to_string(&mut text).map(|_| text)
        } else {
            fs::read_to_string(list)
        };
        let text = text.with_context(|| list.display().to_string())?;
        Ok(text.lines().filter(|line| !line.trim().is_empty()).map(PathBuf::from).collect())
    }
}
