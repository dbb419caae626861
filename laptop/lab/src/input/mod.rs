//! Reads recordings in chunks: columns of a CSV table, or fields of a flight log.

mod clock;
mod csv;
mod cut;
mod flysight;
mod header;
pub mod inertial;
mod kinds;
pub mod messages;
mod names;
mod rollover;
#[cfg(not(target_family = "wasm"))]
mod rows;
mod spaces;
mod text;
mod time;
mod times;

pub(crate) use clock::is_other_rate;
pub use clock::{Clock, Kind, Step, UnevenRate};
pub use csv::{ColumnSummary, Summary, summary};
pub use kinds::{LogKind, TableKind};
pub use names::{items, near};
pub use rollover::Rollover;
pub use text::{shown, text};

use crate::{Error, Result};
use catalogue::run::{Given, Words};
use flight_logs::files::File;
use std::io;
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::str::FromStr;
pub use time::TimeUnit;

/// The name that stands for all columns except columns of times and counts.
const ALL: &str = "all";

/// Maximum number of samples in a chunk.
pub const CHUNK: usize = 8192;

/// The file of a recording, and options for reading the file.
#[derive(Clone, Debug)]
pub struct InputOptions {
    /// A table, a log, or `-` for a table on standard input. Files may be compressed. The formats of tables are CSV,
    /// JSON lines, Parquet, and `NumPy`'s `.npy` and `.npz`. The formats of logs are PX4's `ULog`, `ArduPilot`'s `.bin`
    /// and `.log`, telemetry `.tlog`, bags of ROS 1 and 2, MCAP, and Betaflight's blackbox.
    pub input: PathBuf,
    /// The channels to read.
    pub channel: ChannelOptions,
}

impl Deref for InputOptions {
    type Target = ChannelOptions;

    fn deref(&self) -> &ChannelOptions {
        &self.channel
    }
}

/// The chosen channels of a recording, and options for reading them.
#[derive(Clone, Debug, serde::Serialize)]
pub struct ChannelOptions {
    /// Columns of a CSV table, by name or by number from 1.
    pub column: Vec<String>,
    /// Columns of a table by name, such as `gyro_x`. The name `all` stands for all columns except times and counts. If
    /// the input is a log, each name is a field in the form `TOPIC.FIELD`.
    pub columns: Vec<String>,
    /// Name of the table's column or the log's field that holds the time, such as `header.stamp`. If `None`, the time
    /// column of a table is recognised by its name, as in exports of Betaflight, `ArduPilot`, PX4, ROS and pandas. If
    /// `None`, each message of a log has the sensor's own stamp if it has one that goes forward (`header.stamp`,
    /// `timestamp_sample`, `time_usec`, `time_boot_ms`), and the time at which it was recorded otherwise. The name
    /// `recorded` stands for the latter.
    pub time: Option<String>,
    /// Unit of the time column. By default, the unit is taken from the column's name, such as `time (us)` or
    /// `stamp_ns`, or from the column's values.
    pub time_unit: Option<TimeUnit>,
    /// Delimiter of columns: `,` `;` `|` `tab` `space`. By default, the delimiter is found in the header.
    pub delimiter: Option<Delimiter>,
    /// Number of the line with the names of a table's columns, counted from 1. The lines above it are left out. By
    /// default, the header is found where it is sure.
    pub header: Option<u64>,
    /// Topic of a log. The suffix `:1` stands for the second instance of a sensor. In a file of a `FlySight` 2, the
    /// topic is the kind of its records, such as `IMU`.
    pub topic: Option<String>,
    /// Fields of the topic, such as `gyro_rad[0]` or `angular_velocity.x`.
    pub field: Vec<String>,
    /// Further fields of the topic, read after those in [`field`](Self::field).
    pub fields: Vec<String>,
    /// Samples a second. They stand in place of the rate that the times show, and are needed where there are no times
    /// or where the times contradict themselves (see [`Clock::uneven`]). Of many recordings, each has this rate; a note
    /// says where the times show another one.
    pub rate: Option<f64>,
    /// Limit on the step between the times of consecutive samples, as a multiple of the usual step. A longer step
    /// counts as a gap.
    pub gap: f64,
    /// Whether incomplete rows are skipped and counted. A row is incomplete if one of its values is missing (empty,
    /// `NA`) or not finite. If `false`, an incomplete row is an error.
    pub skip_non_finite: bool,
    /// Whether damaged files are accepted. A truncated or damaged log is then read without its damaged parts, and a
    /// truncated table is read up to its last complete line. Otherwise, damage is an error.
    pub accept_cut: bool,
    /// The channels to read if none is named.
    #[serde(skip)]
    pub unnamed: Unnamed,
}

/// The channels that are read if the options name none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Unnamed {
    /// The only channel. Where there are several, one must be named.
    #[default]
    One,
    /// The axes of the gyroscope and the accelerometer that flew, as their names tell them. If no name does, the only
    /// channel.
    Inertial,
    /// The axes of the gyroscope and the accelerometer that flew. If no name tells them, all columns of a table.
    InertialOrAll,
    /// All columns of a table; in a log, the axes of the gyroscope and the accelerometer that flew.
    All,
}

impl Default for ChannelOptions {
    fn default() -> Self {
        Self {
            column: Vec::new(),
            columns: Vec::new(),
            time: None,
            time_unit: None,
            delimiter: None,
            header: None,
            topic: None,
            field: Vec::new(),
            fields: Vec::new(),
            rate: None,
            gap: 1.5,
            skip_non_finite: false,
            accept_cut: false,
            unnamed: Unnamed::One,
        }
    }
}

impl ChannelOptions {
    /// Returns the options with other channels: columns of a table, or fields of a log in the form `TOPIC.FIELD`.
    #[must_use]
    pub fn with_names(self, names: Vec<String>) -> Self {
        let (column, field, fields) = (Vec::new(), Vec::new(), Vec::new());
        Self { columns: names, column, topic: None, field, fields, ..self }
    }
}

/// The delimiter of a table's columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Delimiter(pub u8);

impl FromStr for Delimiter {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match (text, text.as_bytes()) {
            ("tab" | "\\t", _) => Ok(Self(b'\t')),
            ("space", _) => Ok(Self(b' ')),
            (_, &[byte]) if byte.is_ascii() && !byte.is_ascii_alphanumeric() => Ok(Self(byte)),
            _ => Err(TableKind::Delimiter.into()),
        }
    }
}

/// Consecutive samples of all channels, with their times if the recording has any.
#[derive(Debug, Default)]
pub struct Chunk {
    /// The samples of each channel. All channels have the same number of samples. A sample that is missing or not
    /// finite in the recording is NaN or infinite.
    pub columns: Vec<Vec<f64>>,
    /// The samples' times in µs, one for each row. Empty if the recording has no times.
    pub times: Vec<i64>,
}

impl Chunk {
    /// Returns the number of samples in each channel.
    pub fn len(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }

    /// Returns whether the chunk has no samples.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Removes all samples and times, and sets the number of channels.
    fn clear(&mut self, channels: usize) {
        self.columns.resize(channels, Vec::new());
        self.columns.iter_mut().for_each(Vec::clear);
        self.times.clear();
    }

    /// Moves the samples and times of `other` to the end of this chunk.
    pub fn append(&mut self, other: &mut Self) {
        self.columns.resize(self.columns.len().max(other.columns.len()), Vec::new());
        for (column, more) in self.columns.iter_mut().zip(&mut other.columns) {
            column.append(more);
        }
        self.times.append(&mut other.times);
    }

    /// Returns for each row whether all its values are finite.
    pub fn finite_rows(&self) -> Vec<bool> {
        let mut rows = vec![true; self.len()];
        for column in &self.columns {
            for (row, value) in rows.iter_mut().zip(column) {
                *row &= value.is_finite();
            }
        }
        rows
    }

    /// Returns each channel's values in the rows for which `rows` is true.
    pub fn kept(&self, rows: &[bool]) -> Vec<Vec<f64>> {
        let kept = |column: &Vec<f64>| {
            column.iter().zip(rows).filter(|(_, kept)| **kept).map(|(value, _)| *value).collect()
        };
        self.columns.iter().map(kept).collect()
    }
}

/// A recording that is being read.
pub trait Source {
    /// Replaces the chunk's content with the next samples. After the last sample, the chunk is empty.
    ///
    /// # Errors
    /// Returns an error, with the place in the file, if a sample cannot be read.
    fn next(&mut self, chunk: &mut Chunk) -> Result<()>;

    /// Reads all remaining samples.
    ///
    /// # Errors
    /// See [`next`](Self::next).
    fn rest(&mut self) -> Result<Chunk> {
        let (mut all, mut chunk) = (Chunk::default(), Chunk::default());
        loop {
            self.next(&mut chunk)?;
            if chunk.is_empty() {
                return Ok(all);
            }
            all.append(&mut chunk);
        }
    }

    /// Returns the channels' names, which are the names of columns or fields. A name may contain commas.
    fn names(&self) -> Vec<&str>;

    /// Returns the unit of each channel, if the recording gives it.
    fn units(&self) -> Vec<Option<String>> {
        vec![None; self.names().len()]
    }

    /// Returns the origin of the channels, as keys and values for the header of a file of spikes.
    fn origin(&self) -> &[(&'static str, String)];

    /// Returns notes for the user on how the recording is read. Each note is a line.
    fn notes(&self) -> &[Words];
}

impl InputOptions {
    /// Opens the recording at its start. Times continue to rise where the recorder's clock wraps around.
    ///
    /// # Errors
    /// Returns an error if the file, column, topic or field is missing, or if the file is empty.
    pub fn open(&self) -> Result<Box<dyn Source>> {
        Ok(Box::new(rollover::Unwrapped::new(self.open_as_is()?)))
    }

    fn open_as_is(&self) -> Result<Box<dyn Source>> {
        let of_tables =
            [("delimiter", self.delimiter.is_some()), ("header", self.header.is_some())];
        let kind = if self.is_stdin() { None } else { flight_logs::Kind::of(&self.input)? };
        if let Some(kind) = kind {
            self.refuse(&of_tables, "a log")?;
            return Ok(Box::new(messages::Channel::open(self, kind)?));
        }
        Ok(Box::new(self.open_table()?))
    }

    /// Opens the recording as a CSV table.
    fn open_table(&self) -> Result<csv::Table> {
        let of_logs = [("field", !self.field.is_empty()), ("fields", !self.fields.is_empty())];
        let name = self.name();
        if self.is_stdin() {
            self.refuse(&of_logs, "a CSV table")?;
            return csv::Table::open(io::stdin(), &name, self);
        }
        let file = File::open(&self.input).map_err(|error| Error::open(&name, error))?;
        self.refuse(&of_logs, "a CSV table")?;
        #[cfg(not(target_family = "wasm"))]
        if self.input.is_file()
            && let Some(rows) = rows::of_file(&self.input, &name)?
        {
            return csv::Table::of_rows(rows, &name, self);
        }
        csv::Table::open(file, &name, self)
    }

    /// Returns a copy of these options that reads `unnamed` if no channel is named.
    #[must_use]
    pub fn or(&self, unnamed: Unnamed) -> Self {
        let mut options = self.clone();
        options.channel.unnamed = unnamed;
        options
    }

    /// Returns whether the input is standard input.
    pub fn is_stdin(&self) -> bool {
        self.input == Path::new("-")
    }

    /// Returns whether the recording can be read only once: from standard input, or from a pipe.
    pub fn is_read_once(&self) -> bool {
        let is_pipe = || self.input.metadata().is_ok_and(|own| !own.is_file() && !own.is_dir());
        self.is_stdin() || is_pipe()
    }

    /// Returns the name of the input for messages to the user: its path, or `standard input`.
    pub fn name(&self) -> String {
        if self.is_stdin() { "standard input".to_owned() } else { self.input.display().to_string() }
    }

    /// Returns the table columns that the options choose.
    fn columns(&self) -> impl Iterator<Item = &str> {
        self.column.iter().chain(&self.columns).map(String::as_str)
    }

    /// Returns the message fields that the options choose.
    fn fields(&self) -> impl Iterator<Item = &str> {
        self.field.iter().chain(&self.fields).map(String::as_str)
    }

    /// Checks that at most one channel is chosen; `command` is the command's name in the error.
    ///
    /// # Errors
    /// Returns an error if several channels are chosen.
    pub fn single(&self, command: &str) -> Result<()> {
        match self.columns().count().max(self.fields().count()) {
            _ if self.columns().any(|name| name == ALL) => {
                Err(TableKind::OneColumn { command: command.to_owned() }.into())
            }
            0 | 1 => Ok(()),
            channels => {
                let command = command.to_owned();
                Err(TableKind::OneChannel { command, channels }.into())
            }
        }
    }

    /// Returns an error if a topic is chosen, which a table does not have.
    fn refuse_topic(&self) -> Result<()> {
        self.refuse(&[("topic", self.topic.is_some())], "a CSV table")
    }

    /// Checks that a source has one channel, as a pattern may stand for several; `command` is the command's name in the
    /// error.
    ///
    /// # Errors
    /// Returns an error if the source has several channels.
    pub(crate) fn check_single(source: &dyn Source, command: &str) -> Result<()> {
        match source.names().len() {
            0 | 1 => Ok(()),
            channels => {
                let command = command.to_owned();
                Err(TableKind::OneChannel { command, channels }.into())
            }
        }
    }

    fn refuse(&self, options: &[(&'static str, bool)], what: &'static str) -> Result<()> {
        match options.iter().find(|(_, is_given)| *is_given) {
            Some((name, _)) => {
                let error = TableKind::TakesNo { what }.of(Given::named(*name));
                Err(error.at(self.input.as_path()))
            }
            None => Ok(()),
        }
    }
}

/// Parses a number that must be above 0 and finite.
///
/// # Errors
/// Returns an error if the text is not a number, or if the number is not above 0 and finite.
pub fn above_zero(text: &str) -> Result<f64> {
    match text.parse() {
        Ok(number) if number > 0.0 && f64::is_finite(number) => Ok(number),
        _ => Err(TableKind::NotAboveZero.into()),
    }
}
