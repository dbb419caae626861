//! Options that choose the recording and its channels, and options for converting events between formats.

use anyhow::{Context, Result, bail};
use clap::builder::{MapValueParser, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use flight_logs::{Kind, Packing};
use lab::dataset::{self, ChannelsOf, Found, Split};
use lab::flight::Flight;
use lab::input::{self, Delimiter, TimeUnit, Unnamed, above_zero};
use std::fs;
use std::io::{self, BufRead, Cursor, Read};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use tempfile::NamedTempFile;

/// Options for converting events from one format to another.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct StreamOptions {
    /// Subtract the first event's tick from all ticks, because some formats count from 0
    #[arg(long)]
    pub from_zero: bool,
    /// Drop and count events that the output format cannot express, instead of stopping
    #[arg(long)]
    pub drop: bool,
}

/// The recording, and the options for reading it.
#[derive(Args, Clone, Debug)]
pub(crate) struct InputOptions {
    /// Table (CSV, JSON lines, Parquet, `NumPy`'s `.npy` and `.npz`) or log (PX4's `ULog`, `ArduPilot`'s `.bin` and
    /// `.log`, telemetry `.tlog`, bag of ROS 1 or 2, MCAP, Betaflight's blackbox), also compressed; `-` is standard
    /// input
    pub input: PathBuf,
    #[command(flatten)]
    channel: ChannelOptions,
}

/// Options that choose channels of a recording and say how to read them.
#[derive(Args, Clone, Debug)]
pub(crate) struct ChannelOptions {
    /// Channels to read: columns of a table by name or by number from 1, fields of a log as `TOPIC.FIELD`, or as `FIELD`
    /// if one topic has it. Patterns are taken: `gyro_*`, `gyro_rad[*]`, `gyro_rad[0..3]`; `all` is all columns of a
    /// table. Default, where several channels are taken: the gyroscope and the accelerometer that flew. `--channel` and
    /// `--columns` are other names of the option
    #[arg(
        long = "channels",
        alias = "columns",
        alias = "channel",
        value_delimiter = ',',
        value_name = "NAMES",
        help_heading = "Input"
    )]
    columns: Vec<String>,
    /// One channel, whose name may have a comma, as --channels takes it
    #[arg(long, value_name = "NAME", hide_short_help = true, help_heading = "Input")]
    column: Vec<String>,
    /// Column of a table, or field of a log such as `header.stamp`, that holds the time. Default in a table: the column
    /// whose name means time in tables of Betaflight, `ArduPilot`, PX4, ROS or pandas; in a log: the sensor's own stamp
    /// such as `header.stamp`, `timestamp_sample` or `time_boot_ms`, and without one the time at which a message was
    /// recorded, which is called `recorded`
    #[arg(long, value_name = "COLUMN", help_heading = "Input")]
    time: Option<String>,
    /// Unit of the time column; default: the unit in its name, such as `time (us)` or `stamp_ns`, or else a guess from
    /// its values
    #[arg(long, value_name = "UNIT", value_parser = units(), help_heading = "Input")]
    time_unit: Option<TimeUnit>,
    /// Separator of columns: `,` `;` `|` `tab` `space`; default: the one that the header uses
    #[arg(long, help_heading = "Input")]
    delimiter: Option<Delimiter>,
    /// Line of a table that holds the names of the columns, counted from 1; default: found where it is sure
    #[arg(long, value_name = "LINE", value_parser = clap::value_parser!(u64).range(1..), help_heading = "Input")]
    header: Option<u64>,
    /// Topic of a log, for --channels without it; `:1` after it selects the second instance of a sensor
    #[arg(long, hide_short_help = true, help_heading = "Input")]
    topic: Option<String>,
    /// Field of the topic, such as `gyro_rad[0]`: `--topic T --field F` is an older way to write `--channels T.F`
    #[arg(long, hide_short_help = true, help_heading = "Input")]
    field: Vec<String>,
    /// Several fields of the topic: `gyro_rad[0],gyro_rad[1]`
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "NAMES",
        hide_short_help = true,
        help_heading = "Input"
    )]
    fields: Vec<String>,
    /// Sample rate in Hz, for a recording without times, or with times that do not tell it, such as those of arrival
    #[arg(long, value_parser = above_zero, help_heading = "Input")]
    rate: Option<f64>,
    /// Report time steps longer than this multiple of the usual step
    #[arg(long, default_value_t = 1.5, value_parser = above_zero, help_heading = "Input")]
    gap: f64,
    /// Skip and count rows in which a value is missing (empty, `NA`) or not finite, instead of stopping; no spikes are
    /// emitted for skipped rows
    #[arg(long, help_heading = "Input")]
    skip_non_finite: bool,
    /// Read the undamaged part of a log that is cut short or damaged, and a table up to its last whole line
    #[arg(long, help_heading = "Input")]
    accept_cut: bool,
}

/// Options that name many logs.
#[derive(Args, Clone, Debug)]
pub(crate) struct LogList {
    /// Logs and tables of all kinds, directories, and patterns such as 'logs/**/*.ulg'. In a directory, logs are
    /// recognised by their content, and tables by their file extensions, such as .csv and .parquet
    #[arg(value_name = "LOG", required_unless_present = "list")]
    logs: Vec<PathBuf>,
    /// File that lists further logs, directories and patterns, one on each line; `-` is standard input
    #[arg(long, value_name = "FILE")]
    list: Option<PathBuf>,
}

/// Options that choose many logs, or the logs of a data set.
#[derive(Args, Clone, Debug)]
pub(crate) struct LogOptions {
    #[command(flatten)]
    list: LogList,
    /// Flights to take from a data set of `dataset`, which is given by its directory or its `manifest.jsonl`; default:
    /// train
    #[arg(long, value_enum, value_name = "SIDE", help_heading = "Input")]
    split: Option<Side>,
}

/// The value of `--split`: a side of a data set's split.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Side {
    /// The flights for training
    Train,
    /// The flights for testing
    Test,
    /// All flights
    All,
}

/// Options that choose the channels of many logs.
#[derive(Args, Clone, Debug)]
pub(crate) struct ManyChannels {
    /// Channels to read from logs of one kind, in place of those that other options name. KIND is table, ulog,
    /// ardupilot, mavlink, bag, ros2, mcap or blackbox. If the option is given several times for a kind, each log is
    /// read with the first NAMES that are all in the log
    #[arg(long, value_name = "KIND=NAMES", help_heading = "Input")]
    pub channels_of: Vec<ChannelsOf>,
    #[command(flatten)]
    pub channel: ChannelOptions,
}

impl LogList {
    /// Returns the logs, directories and patterns as they are given.
    ///
    /// # Errors
    /// Returns an error if the file of `--list` cannot be read, or if standard input is both the list and a log.
    pub(crate) fn given(&self) -> Result<Vec<PathBuf>> {
        let Some(list) = &self.list else { return Ok(self.logs.clone()) };
        let is_stdin = list == Path::new("-");
        if is_stdin && self.logs.contains(list) {
            bail!("standard input cannot be both the list and a log");
        }
        let mut bytes = Vec::new();
        let read = if is_stdin {
            io::stdin().read_to_end(&mut bytes)
        } else {
            fs::File::open(list).and_then(|mut file| file.read_to_end(&mut bytes))
        };
        read.with_context(|| list.display().to_string())?;
        let lines =
            bytes.split(|byte| *byte == b'\n').map(|line| line.strip_suffix(b"\r").unwrap_or(line));
        let listed = lines.filter(|line| !line.trim_ascii().is_empty()).map(path_of);
        Ok(self.logs.iter().cloned().chain(listed).collect())
    }
}

/// Returns the path that these bytes name. On Unix a name may have bytes that are not UTF-8.
#[cfg(unix)]
fn path_of(bytes: &[u8]) -> PathBuf {
    PathBuf::from(<std::ffi::OsStr as std::os::unix::ffi::OsStrExt>::from_bytes(bytes))
}

#[cfg(not(unix))]
fn path_of(bytes: &[u8]) -> PathBuf {
    PathBuf::from(String::from_utf8_lossy(bytes).into_owned())
}

impl LogOptions {
    /// Finds the logs. A file that is missing is found too, and refused when it is read.
    ///
    /// # Errors
    /// Returns an error if there are no logs, if a list or a manifest cannot be read, or if `--split` is given without a
    /// data set.
    pub(crate) fn find(&self) -> Result<Found> {
        let split = match self.split.unwrap_or(Side::Train) {
            Side::Train => Some(Split::Train),
            Side::Test => Some(Split::Test),
            Side::All => None,
        };
        let found = dataset::expand(&self.list.given()?, split)?;
        if self.split.is_some() && !found.has_set {
            bail!("--split chooses flights of a data set, and none of the logs is one");
        }
        Ok(found)
    }
}

impl ManyChannels {
    /// Calls `read` with the options for reading one of the logs. An option that does not apply to the log's kind is
    /// ignored. If `is_single` is set and `--channels-of` is not given, such an option is an error instead.
    ///
    /// # Errors
    /// Returns an error if the log cannot be read.
    pub(crate) fn read<T>(
        &self,
        log: &Path,
        is_single: bool,
        mut read: impl FnMut(&input::InputOptions) -> lab::Result<T>,
    ) -> Result<T> {
        let file = as_file(log)?;
        let options = self.channel.of(&file);
        if is_single && self.channels_of.is_empty() {
            return Ok(read(&options)?);
        }
        let kind = if options.is_stdin() { None } else { Kind::of(&file)? };
        Ok(dataset::read(&file, kind, &options.channel, &self.channels_of, read)?)
    }
}

/// Returns a parser of a unit of time: `s`, `ms`, `us` or `ns`.
pub(crate) fn units() -> MapValueParser<PossibleValuesParser, fn(String) -> TimeUnit> {
    PossibleValuesParser::new(["s", "ms", "us", "ns"]).map(|name| match name.as_str() {
        "ms" => TimeUnit::Ms,
        "us" => TimeUnit::Us,
        "ns" => TimeUnit::Ns,
        // `PossibleValuesParser` accepts no other name.
        _ => TimeUnit::S,
    })
}

impl InputOptions {
    /// Converts the options to the type that the library `lab` takes. A log from standard input is copied to a file
    /// first.
    ///
    /// # Errors
    /// Returns an error if standard input cannot be read or copied.
    pub(crate) fn to_lab(&self) -> Result<input::InputOptions> {
        Ok(self.channel.of(&as_file(&self.input)?))
    }
}

impl ChannelOptions {
    /// Converts the options to the type that the library `lab` takes, for the recording at `input`.
    pub(crate) fn of(&self, input: &Path) -> input::InputOptions {
        let options = self.clone();
        let channel = input::ChannelOptions {
            column: options.column,
            columns: options.columns,
            time: options.time,
            time_unit: options.time_unit,
            delimiter: options.delimiter,
            header: options.header,
            topic: options.topic,
            field: options.field,
            fields: options.fields,
            rate: options.rate,
            gap: options.gap,
            skip_non_finite: options.skip_non_finite,
            accept_cut: options.accept_cut,
            unnamed: Unnamed::One,
        };
        input::InputOptions { input: input.to_owned(), channel }
    }
}

/// Reads a flight file, and prints on standard error the parameters that the sample type changes.
///
/// # Errors
/// Returns an error, with file and line, if the file is not a valid flight.
pub(crate) fn read_flight(path: &Path) -> Result<Flight> {
    let flight = Flight::read(path)?;
    for rounded in flight.rounded() {
        say!("{}: {rounded}", path.display());
    }
    Ok(flight)
}

/// Temporary copy of standard input; `None` if no copy was needed.
static COPIED: Mutex<Option<NamedTempFile>> = Mutex::new(None);

/// Returns the path from which a recording can be read. A log, a `NumPy` archive or a Parquet file on standard input is
/// copied to a temporary file, because readers need random access to it; the result is then the path of the copy.
/// Otherwise the result is `input` itself.
///
/// # Errors
/// Returns an error if standard input cannot be read or copied.
pub(crate) fn as_file(input: &Path) -> Result<PathBuf> {
    /// First bytes of the tables that are copied: `NumPy`'s `.npz` archives, and Parquet files.
    const TABLES: [&[u8]; 2] = [b"PK\x03\x04", b"PAR1"];
    if input != Path::new("-") {
        return Ok(input.to_owned());
    }
    let mut stdin = io::stdin().lock();
    // These bytes are read again.
    let start = stdin.fill_buf()?;
    let is_log = match Packing::of(start) {
        None => Kind::of_start(start).is_some(),
        Some(packing) => {
            let mut content = Vec::new();
            // The content goes on behind these bytes; of some packings they give none yet.
            let _ = packing.reader(Cursor::new(start.to_vec())).read_to_end(&mut content);
            content.is_empty() || Kind::of_start(&content).is_some()
        }
    };
    if !is_log && !TABLES.iter().any(|own| start.starts_with(own)) {
        return Ok(input.to_owned());
    }
    let mut file = tempfile::Builder::new().prefix("standard-input-").tempfile()?;
    io::copy(&mut stdin, &mut file)?;
    let path = file.path().to_owned();
    *COPIED.lock().unwrap_or_else(PoisonError::into_inner) = Some(file);
    Ok(path)
}

/// Deletes the copy of standard input.
pub(crate) fn delete_copy() {
    drop(COPIED.lock().unwrap_or_else(PoisonError::into_inner).take());
}
