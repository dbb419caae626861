//! Recordings: one channel of a CSV table or of a flight log, a chunk at a time.

mod clock;
mod csv;
mod names;
mod ulog;

pub(crate) use clock::{Clock, Gap};
pub(crate) use names::near;
pub(crate) use ulog::Log;

use anyhow::{Context, Result, bail};
use clap::Args;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// How many samples a chunk holds.
pub(crate) const CHUNK: usize = 8192;

/// Where samples come from.
#[derive(Args, Clone, Debug)]
pub(crate) struct InputOptions {
    /// CSV table with a header, or PX4 flight log (`ULog`); `-` is a CSV table on standard input
    pub input: PathBuf,
    /// Column of a CSV table, by name or by number from 1
    #[arg(long, help_heading = "Input")]
    pub column: Option<String>,
    /// Column that holds the time: in seconds, or as `_ms`, `_us` or `_ns` at the end of its name say.
    /// `time_us`, `timestamp` (µs) and the like are known
    #[arg(long, help_heading = "Input")]
    pub time: Option<String>,
    /// Topic of a flight log, `:1` after it for its second instance
    #[arg(long, help_heading = "Input")]
    pub topic: Option<String>,
    /// Field of that topic, such as `gyro_rad[0]`
    #[arg(long, help_heading = "Input")]
    pub field: Option<String>,
    /// Samples a second, where no time is recorded
    #[arg(long, value_parser = above_zero, help_heading = "Input")]
    pub rate: Option<f64>,
    /// Report steps in time above this many usual steps
    #[arg(long, default_value_t = 1.5, value_parser = above_zero, help_heading = "Input")]
    pub gap: f64,
    /// Go on over values that are not finite: they emit nothing and are counted
    #[arg(long, help_heading = "Input")]
    pub skip_non_finite: bool,
    /// Take the whole messages of a flight log that is cut short
    #[arg(long, help_heading = "Input")]
    pub accept_cut: bool,
}

/// Samples in order, with their times where there are any.
#[derive(Debug, Default)]
pub(crate) struct Chunk {
    /// The samples, perhaps not finite.
    pub values: Vec<f64>,
    /// Their times in µs: as many, or none at all.
    pub times: Vec<i64>,
}

/// One channel of a recording.
pub(crate) trait Source {
    /// Replaces the chunk by the next samples; none are left if it stays empty.
    ///
    /// # Errors
    /// What cannot be read, and where.
    fn next(&mut self, chunk: &mut Chunk) -> Result<()>;

    /// What the channel is, as keys and values for the header of a file of spikes.
    fn origin(&self) -> &[(&'static str, String)];
}

impl InputOptions {
    /// Opens the recording at its start.
    ///
    /// # Errors
    /// There is no such file, column, topic or field, or nothing in it.
    pub(crate) fn open(&self) -> Result<Box<dyn Source>> {
        let of_logs = [
            ("--topic", self.topic.is_some()),
            ("--field", self.field.is_some()),
            ("--accept-cut", self.accept_cut),
        ];
        let of_tables = [
            ("--column", self.column.is_some()),
            ("--time", self.time.is_some()),
            ("--rate", self.rate.is_some()),
        ];
        if self.is_stdin() {
            self.refuse(&of_logs, "a CSV table")?;
            return Ok(Box::new(csv::Table::open(io::stdin().lock(), "standard input", self)?));
        }
        let name = self.input.display().to_string();
        let file = File::open(&self.input).with_context(|| format!("{name}: cannot be opened"))?;
        if is_flight_log(&self.input)? {
            self.refuse(&of_tables, "a flight log")?;
            return Ok(Box::new(ulog::Channel::open(self)?));
        }
        self.refuse(&of_logs, "a CSV table")?;
        Ok(Box::new(csv::Table::open(file, &name, self)?))
    }

    /// Whether it can be read only once.
    pub(crate) fn is_stdin(&self) -> bool {
        self.input == Path::new("-")
    }

    /// The whole recording.
    ///
    /// # Errors
    /// As [`open`](Self::open), or what cannot be read.
    pub(crate) fn read_all(&self) -> Result<Chunk> {
        let mut source = self.open()?;
        let (mut all, mut chunk) = (Chunk::default(), Chunk::default());
        loop {
            source.next(&mut chunk)?;
            if chunk.values.is_empty() {
                return Ok(all);
            }
            all.values.append(&mut chunk.values);
            all.times.append(&mut chunk.times);
        }
    }

    fn refuse(&self, options: &[(&str, bool)], kind: &str) -> Result<()> {
        match options.iter().find(|(_, is_given)| *is_given) {
            Some((name, _)) => bail!("{}: {kind} takes no {name}", self.input.display()),
            None => Ok(()),
        }
    }
}

/// A number of an option that makes sense above 0 only.
pub(crate) fn above_zero(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if number > 0.0 && f64::is_finite(number) => Ok(number),
        _ => Err("must be a number above 0 and finite".to_owned()),
    }
}

/// Whether a file starts as flight logs do, whatever its name.
pub(crate) fn is_flight_log(path: &Path) -> Result<bool> {
    let mut start = Vec::new();
    let file = File::open(path).with_context(|| format!("{}: cannot be opened", path.display()))?;
    file.take(4).read_to_end(&mut start).with_context(|| format!("{}", path.display()))?;
    Ok(start == b"ULog" || path.extension().is_some_and(|extension| extension == "ulg"))
}
