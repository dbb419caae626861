//! Recordings: channels of a CSV table or of a log, a chunk at a time.

mod clock;
mod csv;
mod header;
mod kinds;
pub mod messages;
mod names;
mod rollover;
mod text;
mod time;
mod times;

pub use clock::{Clock, Kind, Step};
pub use csv::{ColumnSummary, Summary, summary};
pub use kinds::{LogKind, TableKind};
pub use names::near;
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

/// All columns that are neither times nor counts.
const ALL: &str = "all";

/// How many samples a chunk holds.
pub const CHUNK: usize = 8192;

/// A recording, and how to read it.
#[derive(Clone, Debug)]
pub struct InputOptions {
    /// CSV table with a header, or log: PX4's `ULog`, `ArduPilot`'s `.bin` and `.log`, telemetry `.tlog`, bag of ROS 1 or
    /// 2, MCAP, Betaflight's blackbox; also compressed; `-` is a CSV table on standard input
    pub input: PathBuf,
    /// The channel to read.
    pub channel: ChannelOptions,
}

impl Deref for InputOptions {
    type Target = ChannelOptions;

    fn deref(&self) -> &ChannelOptions {
        &self.channel
    }
}

/// The channel of a recording, and how to read it.
#[derive(Clone, Debug)]
pub struct ChannelOptions {
    /// Column of a CSV table, by name or by number from 1; `encode` takes several
    pub column: Vec<String>,
    /// Several columns at once: `gyro_x,gyro_y,gyro_z`, or `all`; of a log `TOPIC.FIELD`
    pub columns: Vec<String>,
    /// Column that holds the time; found by its name, as Betaflight, `ArduPilot`, PX4, ROS and pandas
    /// write it, unless given. In a ROS log a field such as `header.stamp`; when a message was recorded unless given
    pub time: Option<String>,
    /// Unit of that column; told by its name, such as `time (us)` or `stamp_ns`, or by its values,
    /// unless given
    pub time_unit: Option<TimeUnit>,
    /// Delimiter of columns: `,` `;` `|` `tab` `space`; found in the header unless given
    pub delimiter: Option<Delimiter>,
    /// Topic of a log; with `:1` after it for the second instance of a sensor
    pub topic: Option<String>,
    /// Field of that topic, such as `gyro_rad[0]` or `angular_velocity.x`; `encode` takes several
    pub field: Vec<String>,
    /// Several fields at once: `gyro_rad[0],gyro_rad[1]`
    pub fields: Vec<String>,
    /// Samples a second, where no time is recorded
    pub rate: Option<f64>,
    /// Report steps in time above this many usual steps
    pub gap: f64,
    /// Go on over rows with a value that is missing (empty, `NA`) or not finite: they emit nothing and
    /// are counted
    pub skip_non_finite: bool,
    /// Take the whole messages of a log that is cut short or damaged
    pub accept_cut: bool,
}

impl Default for ChannelOptions {
    fn default() -> Self {
        Self {
            column: Vec::new(),
            columns: Vec::new(),
            time: None,
            time_unit: None,
            delimiter: None,
            topic: None,
            field: Vec::new(),
            fields: Vec::new(),
            rate: None,
            gap: 1.5,
            skip_non_finite: false,
            accept_cut: false,
        }
    }
}

/// The delimiter of a table's columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

/// Samples in order, with their times where there are any.
#[derive(Debug, Default)]
pub struct Chunk {
    /// The samples by channel, perhaps not finite; all channels have the same number.
    pub columns: Vec<Vec<f64>>,
    /// Their times in µs: as many, or none at all.
    pub times: Vec<i64>,
}

impl Chunk {
    /// How many samples a channel has.
    pub fn len(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Removes all samples, and prepares this many channels.
    fn clear(&mut self, channels: usize) {
        self.columns.resize(channels, Vec::new());
        self.columns.iter_mut().for_each(Vec::clear);
        self.times.clear();
    }

    /// Adds the samples of another.
    pub fn append(&mut self, other: &mut Self) {
        self.columns.resize(other.columns.len(), Vec::new());
        for (column, more) in self.columns.iter_mut().zip(&mut other.columns) {
            column.append(more);
        }
        self.times.append(&mut other.times);
    }

    /// For each row, whether all its values are finite.
    pub fn finite_rows(&self) -> Vec<bool> {
        let mut rows = vec![true; self.len()];
        for column in &self.columns {
            for (row, value) in rows.iter_mut().zip(column) {
                *row &= value.is_finite();
            }
        }
        rows
    }

    /// The values of the rows marked, by channel.
    pub fn kept(&self, rows: &[bool]) -> Vec<Vec<f64>> {
        let kept = |column: &Vec<f64>| {
            column.iter().zip(rows).filter(|(_, kept)| **kept).map(|(value, _)| *value).collect()
        };
        self.columns.iter().map(kept).collect()
    }
}

/// Channels of a recording.
pub trait Source {
    /// Replaces the chunk by the next samples; none are left if it stays empty.
    ///
    /// # Errors
    /// Returns an error that names what cannot be read, and its place.
    fn next(&mut self, chunk: &mut Chunk) -> Result<()>;

    /// Reads all samples that are left.
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

    /// The channels' names: those of columns or fields, which may hold commas.
    fn names(&self) -> Vec<&str>;

    /// The channels' origin, as keys and values for the header of a file of spikes.
    fn origin(&self) -> &[(&'static str, String)];

    /// Notes for the user on how the recording is read, a line each.
    fn notes(&self) -> &[Words];
}

impl InputOptions {
    /// Opens the recording at its start. Times of a clock that runs over go on behind it.
    ///
    /// # Errors
    /// Returns an error if there is no such file, column, topic or field, or nothing in it.
    pub fn open(&self) -> Result<Box<dyn Source>> {
        Ok(Box::new(rollover::Unwrapped::new(self.open_as_is()?)))
    }

    fn open_as_is(&self) -> Result<Box<dyn Source>> {
        let of_tables = [
            ("column", !self.column.is_empty()),
            ("columns", !self.columns.is_empty()),
            ("delimiter", self.delimiter.is_some()),
            ("rate", self.rate.is_some()),
        ];
        let of_times = [("time", self.time.is_some()), ("time_unit", self.time_unit.is_some())];
        let kind = if self.is_stdin() { None } else { flight_logs::Kind::of(&self.input)? };
        if let Some(kind) = kind {
            if let Some(named) = self.named_by_topic() {
                return named.open_as_is();
            }
            self.refuse(&of_tables, "a log")?;
            if kind == flight_logs::Kind::Ulog {
                self.refuse(&of_times, "a flight log")?;
            }
            return Ok(Box::new(messages::Channel::open(self, kind)?));
        }
        Ok(Box::new(self.open_table()?))
    }

    /// Opens a table.
    fn open_table(&self) -> Result<csv::Table> {
        let of_logs = [
            ("topic", self.topic.is_some()),
            ("field", !self.field.is_empty()),
            ("fields", !self.fields.is_empty()),
            ("accept_cut", self.accept_cut),
        ];
        if self.is_stdin() {
            self.refuse(&of_logs, "a CSV table")?;
            return csv::Table::open(io::stdin(), "standard input", self);
        }
        let name = self.input.display().to_string();
        let file = File::open(&self.input).map_err(|error| Error::open(&name, error))?;
        self.refuse(&of_logs, "a CSV table")?;
        csv::Table::open(file, &name, self)
    }

    /// Splits columns `TOPIC.FIELD` of one topic into the topic and its fields.
    fn named_by_topic(&self) -> Option<Self> {
        let names: Option<Vec<_>> = self.columns.iter().map(|name| name.split_once('.')).collect();
        let names = names.filter(|_| self.topic.is_none() && self.field.is_empty())?;
        let (topic, _) = *names.first()?;
        if names.iter().any(|(other, _)| *other != topic) {
            return None;
        }
        let field = names.iter().map(|(_, field)| (*field).to_owned()).collect();
        let channel = ChannelOptions {
            topic: Some(topic.to_owned()),
            field,
            columns: Vec::new(),
            ..self.channel.clone()
        };
        Some(Self { channel, ..self.clone() })
    }

    /// These options with all columns of a table, unless some are asked for.
    ///
    /// # Errors
    /// The file cannot be opened.
    pub fn or_all(&self) -> Result<Self> {
        let mut own = self.clone();
        if self.columns().next().is_none()
            && (self.is_stdin() || flight_logs::Kind::of(&self.input)?.is_none())
        {
            own.channel.columns = vec![ALL.to_owned()];
        }
        Ok(own)
    }

    /// Whether it can be read only once.
    pub fn is_stdin(&self) -> bool {
        self.input == Path::new("-")
    }

    /// Its name, for messages.
    pub fn name(&self) -> String {
        if self.is_stdin() { "standard input".to_owned() } else { self.input.display().to_string() }
    }

    /// The columns asked for.
    fn columns(&self) -> impl Iterator<Item = &str> {
        self.column.iter().chain(&self.columns).map(String::as_str)
    }

    /// The fields asked for.
    fn fields(&self) -> impl Iterator<Item = &str> {
        self.field.iter().chain(&self.fields).map(String::as_str)
    }

    /// Refuses several channels.
    ///
    /// # Errors
    /// More than one is asked for.
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

/// Reads a number that must be above 0 and finite.
///
/// # Errors
/// The text is no such number.
pub fn above_zero(text: &str) -> Result<f64> {
    match text.parse() {
        Ok(number) if number > 0.0 && f64::is_finite(number) => Ok(number),
        _ => Err(TableKind::NotAboveZero.into()),
    }
}
