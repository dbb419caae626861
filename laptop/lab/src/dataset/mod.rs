//! Encodes many logs to Parquet files, in parallel and in constant memory. A run that was ended early can be continued.
//!
//! Each log gets two files, one of spikes and one of samples, and a row of the manifest. A file appears under its name
//! once it is complete, and the row is written after both files. A killed run thus leaves only complete rows, and the
//! next run encodes the logs that have no row.

mod kinds;
mod manifest;
mod parts;
mod paths;
mod restore;

pub use kinds::DatasetKind;
pub use manifest::{Row, Split, rows};
pub use restore::restore;

use crate::coding::Coding;
use crate::encode::{Encoded, encode_from};
use crate::flight::{self, Flight, Sampled};
use crate::input::{ChannelOptions, InputOptions, LogKind, Source, TableKind};
use crate::output::{Output, OutputKind};
use crate::watch::Progress;
use crate::{Error, ErrorKind, Result};
use catalogue::run::Given;
use flight_logs::Kind;
use manifest::{CHANGED, File, Manifest, Settings};
use parts::Parts;
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;

/// A data set to make, or to complete.
#[derive(Clone, Debug)]
pub struct Request {
    /// The logs to encode: files, directories and patterns such as `logs/*.ulg`.
    pub logs: Vec<PathBuf>,
    /// The scheme with which all logs are encoded.
    pub code: Code,
    /// Options for reading the logs. An option that does not apply to a kind of log is ignored for logs of that kind.
    pub channel: ChannelOptions,
    /// Channels to read from logs of certain kinds. A kind may have several entries, which are tried in order for each
    /// log. The first entry whose channels are all in the log is used.
    pub channels_of: Vec<ChannelsOf>,
    /// Directory of the data set.
    pub output: PathBuf,
    /// Share of the flights that are for testing, 0 to 1.
    pub test: f64,
    /// The way in which logs are grouped into flights for the split.
    pub flights: Flights,
    /// Number of logs that are encoded at once.
    pub jobs: usize,
}

/// The scheme with which all logs are encoded.
#[derive(Clone, Debug)]
pub enum Code {
    /// One scheme for all channels.
    Coding(Box<Coding>),
    /// The scheme and the channels of a drone's sender, as a `flight.toml` describes them. Logs are encoded as the
    /// sender would encode them.
    Flight(Box<Flight>),
}

/// The way in which logs are grouped into flights. All logs of a flight are on the same side of the split into training
/// and test data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flights {
    /// Each log is a flight of its own. Copies of one log are one flight.
    Logs,
    /// All logs in a directory are one flight. Its side goes by the directory's path, so that logs may be added.
    Directories,
}

/// The channels to read from logs of one kind, written `ulog=sensor_combined.gyro_rad[0],sensor_combined.gyro_rad[1]`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChannelsOf {
    /// Name of the kind of log, one of [`NAMES`].
    pub kind: &'static str,
    /// Names of the channels: columns of a table, or `TOPIC.FIELD` of a log.
    pub names: Vec<String>,
}

/// Names of the kinds of logs.
pub const NAMES: [&str; 8] =
    ["table", "ulog", "ardupilot", "mavlink", "bag", "ros2", "mcap", "blackbox"];

/// Returns the name of a kind of log. `None` stands for a table.
pub fn name(kind: Option<Kind>) -> &'static str {
    match kind {
        None => "table",
        Some(Kind::Ulog) => "ulog",
        Some(Kind::ArduPilot | Kind::ArduPilotText) => "ardupilot",
        Some(Kind::Mavlink) => "mavlink",
        Some(Kind::Bag) => "bag",
        Some(Kind::Sqlite | Kind::Directory) => "ros2",
        Some(Kind::Mcap) => "mcap",
        Some(Kind::Blackbox) => "blackbox",
    }
}

impl FromStr for ChannelsOf {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let unknown = || DatasetKind::KindOfLog { name: text.to_owned() };
        let (kind, names) = text.split_once('=').ok_or_else(unknown)?;
        let kind = NAMES.into_iter().find(|own| *own == kind).ok_or_else(unknown)?;
        Ok(Self { kind, names: names.split(',').map(|name| name.trim().to_owned()).collect() })
    }
}

/// The result of a run: the numbers of logs, samples and spikes in the data set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Outcome {
    /// Number of logs in the data set: those that were requested, and those of earlier runs.
    pub logs: usize,
    /// Number of these logs that an earlier run had already encoded or refused.
    pub done_before: usize,
    /// Number of logs of earlier runs that are no longer there. They have no row any more.
    pub gone: usize,
    /// Number of logs that cannot be read or encoded. The manifest has the reasons.
    pub refused: usize,
    /// Number of files in the requested directories that are neither logs nor tables.
    pub passed_over: usize,
    /// Number of samples of each channel, over all logs.
    pub samples: u64,
    /// Number of spikes of all channels, over all logs.
    pub events: u64,
    /// Number of logs for training.
    pub train: usize,
    /// Number of logs for testing.
    pub test: usize,
}

/// Makes a data set, or completes one that an earlier run began with the same settings. Also returns the manifest's rows.
///
/// # Errors
/// Returns an error if there are no logs, if the directory holds a data set with other settings, or if a file cannot be
/// written. A log that cannot be read or encoded is not an error: the log's row in the manifest gives the reason.
pub fn run(request: &Request, tell: &mut dyn FnMut(&Progress)) -> Result<(Outcome, Vec<Row>)> {
    let mut run = Run::open(request)?;
    let (next, left) = (AtomicUsize::new(0), run.left());
    let mut progress =
        Progress { total: run.logs.len(), done: run.done_before(), ..Progress::default() };
    let (sender, rows) = mpsc::channel();
    thread::scope(|scope| -> Result<()> {
        // Dropped before the workers are waited for, even after an error: their next row finds nobody.
        let rows = rows;
        for _ in 0..request.jobs.clamp(1, left.len().max(1)) {
            let (sender, next, left) = (sender.clone(), &next, &left[..]);
            scope.spawn(move || {
                while let Some(log) = left.get(next.fetch_add(1, Ordering::Relaxed)) {
                    if sender.send(request.encode(log)).is_err() {
                        return;
                    }
                }
            });
        }
        drop(sender);
        let mut refused = 0;
        tell(&progress);
        for row in &rows {
            let row = row?;
            refused += usize::from(row.refused.is_some());
            progress.done += 1;
            progress.words = format!("{refused} refused, last {}", row.log);
            run.add(row)?;
            tell(&progress);
        }
        Ok(())
    })?;
    run.finish()
}

/// A data set that is being completed. Its directory is locked, which keeps other runs out.
///
/// [`run`] does all the work in one process. Several processes can also share the work. One process holds the `Run`.
/// Every process calls [`Request::encode`] for some of the logs in [`left`](Self::left), and gets a row for each. The
/// process with the `Run` passes all rows to [`add`](Self::add), and calls [`finish`](Self::finish) at the end.
pub struct Run {
    request: Request,
    manifest: Manifest,
    logs: Vec<PathBuf>,
    left: Vec<PathBuf>,
    passed_over: usize,
}

impl Run {
    /// Finds the logs and opens the manifest.
    ///
    /// # Errors
    /// Returns an error if the request is invalid, if there are no logs, or if the directory cannot be written, is in
    /// use, or holds a data set with other settings.
    pub fn open(request: &Request) -> Result<Self> {
        request.check()?;
        let (logs, passed_over) = paths::find(&request.logs, &request.output)?;
        let manifest = Manifest::open(&request.output, &request.settings())?;
        let is_left = |log: &&PathBuf| File::of(log).map_or(true, |file| !manifest.has(log, &file));
        let left = logs.iter().filter(is_left).cloned().collect();
        Ok(Self { request: request.clone(), manifest, logs, left, passed_over })
    }

    /// Returns the logs that had no row in the manifest when the data set was opened.
    pub fn left(&self) -> Vec<PathBuf> {
        self.left.clone()
    }

    fn done_before(&self) -> usize {
        self.logs.len() - self.left.len()
    }

    /// Appends the row of a log to the manifest. The row replaces an earlier one of the same log.
    ///
    /// # Errors
    /// Returns an error if the manifest cannot be written.
    pub fn add(&mut self, row: Row) -> Result<()> {
        self.manifest.add(row)
    }

    /// Splits the data set into training and test data, and sorts the rows of the manifest by the logs' paths. All logs
    /// of a flight (see [`Flights`]) are on the same side of the split. A log that is no longer there loses its row; its
    /// files stay. Returns the numbers and the rows.
    ///
    /// # Errors
    /// Returns an error if a file cannot be written.
    pub fn finish(self) -> Result<(Outcome, Vec<Row>)> {
        let Request { test, flights, .. } = self.request;
        let (rows, gone) = self.manifest.finish(&self.request.settings(), test, flights)?;
        let left: HashSet<&[u8]> =
            self.left.iter().map(|log| log.as_os_str().as_encoded_bytes()).collect();
        let mut outcome = Outcome {
            logs: rows.len(),
            done_before: rows.iter().filter(|row| !left.contains(&*row.key())).count(),
            gone,
            passed_over: self.passed_over,
            ..Outcome::default()
        };
        for row in &rows {
            outcome.refused += usize::from(row.refused.is_some());
            outcome.samples += row.samples;
            outcome.events += row.spikes.iter().sum::<u64>();
            outcome.train += usize::from(row.split == Some(Split::Train));
            outcome.test += usize::from(row.split == Some(Split::Test));
        }
        Ok((outcome, rows))
    }
}

/// The recordings that were found among files, directories, patterns and data sets.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Found {
    /// The paths of the recordings, without repetitions.
    pub logs: Vec<PathBuf>,
    /// Whether a single file was given, by its name.
    pub is_single: bool,
    /// Whether a data set was given.
    pub has_set: bool,
}

/// Finds the recordings among files, directories and patterns. The directory or the manifest of a data set is replaced
/// by the sample files of the flights on one side of its split, or of all flights if `split` is `None`. A file that is
/// given several times is taken once. Standard input and names of missing files are returned unchanged.
///
/// # Errors
/// Returns an error if nothing is given, if a directory cannot be read, if a directory or a pattern gives no recordings,
/// or if a data set is incomplete, has no flight on the chosen side, or has an invalid manifest.
pub fn expand(given: &[PathBuf], split: Option<Split>) -> Result<Found> {
    let mut found = Found { is_single: given.len() == 1, ..Found::default() };
    let mut known = HashSet::new();
    for path in given {
        let is_pattern = !path.exists() && path.display().to_string().contains(['*', '?', '[']);
        let paths = if is_pattern { paths::matches(path)? } else { vec![path.clone()] };
        let mut all = Vec::new();
        for own in paths {
            if let Some(directory) = set(&own) {
                found.has_set = true;
                all.extend(recordings(directory, split)?);
            } else if own.is_dir() && Kind::of(&own).is_err() {
                all.extend(paths::find(std::slice::from_ref(&own), Path::new(""))?.0);
            } else {
                all.push(own);
            }
        }
        if all.is_empty() {
            return Err(DatasetKind::NoneInside.at(path.as_path()));
        }
        found.is_single &= all == [path.clone()];
        all.retain(|own| known.insert(own.canonicalize().unwrap_or_else(|_| own.clone())));
        found.logs.append(&mut all);
    }
    if found.logs.is_empty() { Err(DatasetKind::NoLogs.into()) } else { Ok(found) }
}

/// Returns the directory of the data set that a path names, by the directory or by the manifest.
fn set(path: &Path) -> Option<&Path> {
    if path.file_name().is_some_and(|own| own == manifest::MANIFEST) {
        return path.parent();
    }
    Some(path).filter(|own| own.join(manifest::MANIFEST).is_file())
}

/// Returns the sample files of the flights on one side of a data set's split, or of all flights if `split` is `None`.
fn recordings(directory: &Path, split: Option<Split>) -> Result<Vec<PathBuf>> {
    let rows = rows(directory)?;
    if rows.iter().any(|row| row.values.is_some() && row.split.is_none()) {
        return Err(DatasetKind::NotComplete.at(directory));
    }
    let chosen = rows.into_iter().filter(|row| split.is_none_or(|own| row.split == Some(own)));
    let all: Vec<_> = chosen.filter_map(|row| row.values).map(|own| directory.join(own)).collect();
    if all.is_empty() {
        let side = match split {
            Some(Split::Train) => "training",
            Some(Split::Test) => "testing",
            None => "either",
        };
        return Err(DatasetKind::NoFlight { side }.at(directory));
    }
    Ok(all)
}

/// Calls `read` with the options for reading a log of a kind, one of many: without the options that do not apply to the
/// kind. Of `channels_of`, the entries of this kind are tried in order until the log contains all channels of an entry.
///
/// # Errors
/// Returns an error if the log lacks channels of each entry, or if `read` does.
pub fn read<T>(
    log: &Path,
    kind: Option<Kind>,
    channel: &ChannelOptions,
    channels_of: &[ChannelsOf],
    mut read: impl FnMut(&InputOptions) -> Result<T>,
) -> Result<T> {
    let mut channel = channel.clone();
    if kind.is_some() {
        (channel.delimiter, channel.header) = (None, None);
    }
    if kind == Some(Kind::Ulog) {
        (channel.time, channel.time_unit) = (None, None);
    }
    let of = |channel| InputOptions { input: log.to_owned(), channel };
    let mut choices = channels_of.iter().filter(|own| own.kind == name(kind)).peekable();
    while let Some(own) = choices.next() {
        match read(&of(channel.clone().with_names(own.names.clone()))) {
            Err(error) if choices.peek().is_some() && is_channel_missing(&error) => {}
            other => return other,
        }
    }
    read(&of(channel))
}

impl Request {
    /// Checks the settings of the request.
    ///
    /// # Errors
    /// Returns an error if a setting is invalid.
    fn check(&self) -> Result<()> {
        if self.logs.is_empty() {
            return Err(DatasetKind::NoLogs.into());
        }
        if !(0.0..=1.0).contains(&self.test) {
            return Err(DatasetKind::Share.of(Given::new("test", self.test)));
        }
        let Code::Flight(flight) = &self.code else { return Ok(()) };
        let channels = flight.channels.len();
        match self.channels_of.iter().find(|own| own.names.len() != channels) {
            Some(other) => {
                let given = Given::new("channels_of", other.kind);
                Err(DatasetKind::OtherCount { names: other.names.len(), channels }.of(given))
            }
            None => Ok(()),
        }
    }

    /// Returns the settings that determine the content of the files of spikes and samples.
    fn settings(&self) -> Settings {
        let (code, paper) = match &self.code {
            Code::Coding(coding) => (coding.to_toml(&[]), coding.asked.paper),
            Code::Flight(flight) => (flight.to_toml(&[]), false),
        };
        let channels_of: Vec<String> = self
            .channels_of
            .iter()
            .map(|own| format!("{}={}", own.kind, own.names.join(",")))
            .collect();
        Settings::new(serde_json::json!({
            "spikewire": env!("CARGO_PKG_VERSION"),
            "is_flight": matches!(self.code, Code::Flight(_)),
            "code": code,
            "paper": paper,
            "input": self.channel,
            "channels_of": channels_of,
        }))
    }

    /// Encodes a log to its files of spikes and samples, and returns its row of the manifest. Once the new files are
    /// complete, they replace the files of an earlier call for the same log.
    ///
    /// # Errors
    /// Returns an error if the file of spikes or of samples cannot be written.
    pub fn encode(&self, log: &Path) -> Result<Row> {
        let mut row = Row::new(log, &self.settings());
        let file = match File::of(log) {
            Ok(file) => file,
            Err(why) => {
                row.refuse("Open", why.to_string());
                return Ok(row);
            }
        };
        file.describe(&mut row);
        let mut encoded = row.clone();
        match self.encoded(log, &mut encoded) {
            Err(error) if matches!(*error.kind, ErrorKind::Output(_)) => return Err(error),
            Err(error) => encoded.refuse(error.kind.name(), error.to_string()),
            // The hash, the spikes and the samples are of the same bytes only if the log stayed as it was.
            Ok(()) if File::of(log).ok() != Some(file) => {
                row.refuse(
                    CHANGED,
                    "it changed while it was read; the next run reads it again".to_owned(),
                );
                return Ok(row);
            }
            Ok(()) => {}
        }
        Ok(encoded)
    }

    /// Encodes a log to its files of spikes and samples, and adds the results to the log's row.
    fn encoded(&self, log: &Path, row: &mut Row) -> Result<()> {
        let kind = Kind::of(log)?;
        name(kind).clone_into(&mut row.kind);
        row.hash(log)?;
        let mut channel = self.channel.clone();
        if let Code::Flight(flight) = &self.code {
            let names = flight.channels.iter().map(|own| own.source.clone());
            channel = channel.with_names(names.collect());
        }
        read(log, kind, &channel, &self.channels_of, |input| self.encoded_from(input, row))
    }

    fn encoded_from(&self, input: &InputOptions, row: &mut Row) -> Result<()> {
        let (events, values) = row.parts();
        let [events_path, values_path] = [&events, &values].map(|own| self.output.join(own));
        let to = |path: &Path| Output::to(Some(path)).map_err(unwritten);
        let parts = |start: &crate::encode::Start<'_>| -> Result<Box<dyn crate::spikes::Record>> {
            let outputs = [to(&events_path)?, to(&values_path)?];
            Ok(Box::new(Parts::new(outputs, start, &input.channel)?))
        };
        let encoded = match &self.code {
            Code::Coding(coding) => {
                let open = || input.open();
                encode_from(&open, input, (coding.scheme, coding.sample, &coding.asked), parts)?
            }
            Code::Flight(flight) => {
                let Coding { scheme, sample, asked } = Coding::of_flight(flight);
                let open = || -> Result<Box<dyn Source + '_>> {
                    Ok(Box::new(Sampled::new(flight, input.open()?)?))
                };
                let mut encoded = encode_from(&open, input, (scheme, sample, &asked), parts)?;
                encoded.notes.extend(flight::other_rate(flight, encoded.clock.rate()));
                encoded
            }
        };
        let Encoded { output, names, spikes, summary, clock, notes } = encoded;
        output.finish().map_err(unwritten)?;
        let length = |path: &Path| path.metadata().map(|data| data.len());
        row.events_bytes = length(&events_path)?;
        row.values_bytes = length(&values_path)?;
        (row.events, row.values) = (Some(events), Some(values));
        (row.channels, row.spikes) = (names, spikes);
        row.take(&clock);
        (row.samples, row.not_finite) = (summary.samples, summary.rejected);
        row.notes = notes.iter().map(ToString::to_string).collect();
        Ok(())
    }
}

/// Returns whether the error says that a log lacks the requested channels. In that case, other channels may be tried.
fn is_channel_missing(error: &Error) -> bool {
    matches!(
        &*error.kind,
        ErrorKind::Table(TableKind::NoColumn { .. })
            | ErrorKind::Log(
                LogKind::NoTopic { .. }
                    | LogKind::NoField { .. }
                    | LogKind::NoChannelOf { .. }
                    | LogKind::NoMessages { .. }
            )
    )
}

/// Converts an error in writing a file into an error that ends the run. Errors in reading a log do not end the run.
fn unwritten(error: Error) -> Error {
    match *error.kind {
        ErrorKind::Io(error) => OutputKind::Unwritten { error }.into(),
        _ => error,
    }
}
