//! Options that choose the recording and its channels, and options for converting events between formats.

use anyhow::Result;
use clap::Args;
use clap::builder::{MapValueParser, PossibleValuesParser, TypedValueParser};
use flight_logs::{Kind, Packing};
use lab::input::{self, Delimiter, TimeUnit, above_zero};
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
    /// Column of a CSV table, by name or by number from 1; `encode` takes several
    #[arg(long, help_heading = "Input")]
    column: Vec<String>,
    /// Several columns at once: `gyro_x,gyro_y,gyro_z`, or `all`; in a log, names have the form `TOPIC.FIELD`
    #[arg(
        long,
        visible_alias = "channel",
        value_delimiter = ',',
        value_name = "NAMES",
        help_heading = "Input"
    )]
    columns: Vec<String>,
    /// Column of a table, or field of a log such as `header.stamp`, that holds the time. Default in a table: the column
    /// whose name means time in tables of Betaflight, `ArduPilot`, PX4, ROS or pandas; in a ROS log: the time at which
    /// a message was recorded
    #[arg(long, value_name = "COLUMN", help_heading = "Input")]
    time: Option<String>,
    /// Unit of the time column; default: the unit in its name, such as `time (us)` or `stamp_ns`, or else a guess from
    /// its values
    #[arg(long, value_name = "UNIT", value_parser = units(), help_heading = "Input")]
    time_unit: Option<TimeUnit>,
    /// Separator of columns: `,` `;` `|` `tab` `space`; default: the one that the header uses
    #[arg(long, help_heading = "Input")]
    delimiter: Option<Delimiter>,
    /// Topic of a log; `:1` after it selects the second instance of a sensor
    #[arg(long, help_heading = "Input")]
    topic: Option<String>,
    /// Field of the topic, such as `gyro_rad[0]` or `angular_velocity.x`; `encode` takes several
    #[arg(long, help_heading = "Input")]
    field: Vec<String>,
    /// Several fields of the topic at once: `gyro_rad[0],gyro_rad[1]`
    #[arg(long, value_delimiter = ',', value_name = "NAMES", help_heading = "Input")]
    fields: Vec<String>,
    /// Sample rate in Hz, for a recording without times
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

/// Returns a parser of a unit of time: `s`, `ms`, `us` or `ns`.
fn units() -> MapValueParser<PossibleValuesParser, fn(String) -> TimeUnit> {
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
            topic: options.topic,
            field: options.field,
            fields: options.fields,
            rate: options.rate,
            gap: options.gap,
            skip_non_finite: options.skip_non_finite,
            accept_cut: options.accept_cut,
        };
        input::InputOptions { input: input.to_owned(), channel }
    }
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
