//! `spikewire decode`: decodes spikes to values, in constant memory.

use anyhow::{Context, Result, anyhow, bail};
use catalogue::run::{Event, SampleType};
use clap::Args;
use flight_logs::Kind;
use lab::Place;
use lab::bank::Bank;
use lab::dataset::restore;
use lab::input::text;
use lab::output::{Output, is_table};
use lab::spikes::{Header, Item, Messages, Reader, Spikes};
use lab::timeline::Timeline;
use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Decode a file of spikes that `encode` wrote, a Parquet file of spikes that `dataset` wrote, or a ROS log with
/// messages of `spyke_msgs`, from the toolbox by Dupeyroux et al. (2022). The scheme and its parameters are read from
/// the file itself.
///
/// Writes a table with the columns `index` and `value`. In place of `value`, a table of several channels has a column
/// for each channel, with the name of the channel. If times were recorded, the column `time_us` follows. Times are
/// exact at events and at gaps, and evenly spaced in between.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire encode --scheme sf --threshold 0.1 --channels gyro_x flight.csv -o spikes.csv
  spikewire decode spikes.csv -o decoded.csv
  spikewire decode --spikes dataset/events/flight-0123456789ab.parquet -o spikes.csv")]
pub(crate) struct Decode {
    /// File of spikes, a ROS bag or MCAP file with spikes, or a Parquet file of spikes in a data set; `-` reads a file
    /// of spikes from standard input
    #[arg(default_value = "-")]
    spikes: PathBuf,
    /// Read the undamaged part of a log that is cut short or damaged
    #[arg(long)]
    accept_cut: bool,
    /// CSV file to write. Its columns are `index`, then `value` or one column for each channel, then `time_us` if times
    /// were recorded; default: standard output
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Instead of values, write the spikes of a Parquet file, in the format of `encode`
    #[arg(long = "spikes")]
    is_restored: bool,
}

const BUFFER: usize = 1 << 18;

/// Runs the command.
///
/// # Errors
/// Returns an error if the file of spikes is invalid, or if the output cannot be written.
pub(crate) fn run(options: &Decode) -> Result<()> {
    let Decode { spikes, output, accept_cut, is_restored } = options;
    if let Some(output) = output {
        is_table(output, "")?;
    }
    let is_stdin = spikes == Path::new("-");
    let kind = if is_stdin { None } else { Kind::of(spikes)? };
    let open = || Output::open(output.as_deref(), spikes);
    if let Some(kind) = kind {
        let (log, header) = Messages::open(spikes, kind, *accept_cut)?;
        return decode(log, &header, &spikes.display().to_string(), open);
    }
    if *accept_cut {
        bail!("{}: a file of spikes takes no --accept-cut", spikes.display());
    }
    let is_part = spikes.extension().is_some_and(|ending| ending == "parquet");
    if *is_restored {
        if !is_part {
            bail!("{}: --spikes takes a Parquet file of a data set", spikes.display());
        }
        return Ok(restore(spikes, open)?.finish()?);
    }
    if is_part {
        let restored = NamedTempFile::new()?;
        restore(spikes, || Output::to(Some(restored.path())))?.finish()?;
        let name = spikes.display().to_string();
        let input = BufReader::with_capacity(BUFFER, File::open(restored.path())?);
        let (reader, header) = Reader::open(input, &name)?;
        return decode(reader, &header, &name, open);
    }
    let (input, name): (Box<dyn Read>, _) = if is_stdin {
        (Box::new(io::stdin()), "standard input".to_owned())
    } else {
        let name = spikes.display().to_string();
        let file = File::open(spikes).with_context(|| format!("{name}: cannot be opened"))?;
        (Box::new(file), name)
    };
    let input = BufReader::with_capacity(BUFFER, text(input, &name)?);
    let (reader, header) = Reader::open(input, &name)?;
    decode(reader, &header, &name, open)
}

fn decode(
    mut reader: impl Spikes,
    header: &Header,
    file: &str,
    open: impl FnOnce() -> lab::Result<Output>,
) -> Result<()> {
    /// Number of items in a batch. The collected events are decoded as soon as this many events, or this many sample
    /// times, have been read.
    const BATCH: usize = 4096;
    let bank = Bank::new(header.scheme, &header.channels).with_context(|| file.to_owned())?;
    let mut decoding = Decoding::new(bank, header, reader.is_timed(), open()?)?;
    let mut events: Vec<Event> = Vec::new();
    loop {
        let decoded = match reader.next()? {
            Item::Event { event, time } => {
                if let Some(time) = time {
                    decoding.timeline.learn(event.sample, time);
                }
                // The events of one sample must be decoded in one batch.
                let is_next = events.last().is_some_and(|last| last.sample < event.sample);
                let decoded = if events.len() >= BATCH && is_next {
                    decoding.advance(event.sample, &mut events)
                } else {
                    Ok(())
                };
                events.push(event);
                decoded
            }
            Item::Time { sample, time } => {
                decoding.timeline.learn(sample, time);
                if decoding.timeline.ahead() > BATCH {
                    decoding.advance(sample, &mut events)
                } else {
                    Ok(())
                }
            }
            Item::Rejected { first, count } => {
                decoding.advance(first, &mut events).and_then(|()| decoding.skip(count))
            }
            Item::End { samples } => {
                reader.notes().iter().for_each(|note| say!("{note}"));
                decoding
                    .advance(samples, &mut events)
                    .map_err(|error| error.at(&reader.place()))?;
                return Ok(decoding.output.finish()?);
            }
        };
        decoded.map_err(|error| error.at(&reader.place()))?;
    }
}

/// The state of decoding one file of spikes.
struct Decoding {
    bank: Bank,
    output: Output,
    is_single: bool,
    is_timed: bool,
    timeline: Timeline,
    /// Index of the next sample to write. Samples that the encoder skipped are counted, as they are written too (as
    /// NaN).
    next: u64,
    /// Number of samples that the encoder skipped because a value was missing, among those with indices below `next`.
    skipped: u64,
    columns: Vec<Vec<f64>>,
    line: Vec<u8>,
}

enum Failure {
    Code(Event),
    Output(io::Error),
}

impl Failure {
    fn at(self, place: &Place) -> anyhow::Error {
        match self {
            Self::Code(event) => {
                anyhow!(
                    "{place}or before: sample {} has events that no encoder emits together",
                    event.sample
                )
            }
            Self::Output(error) => error.into(),
        }
    }
}

impl Decoding {
    fn new(bank: Bank, header: &Header, is_timed: bool, mut output: Output) -> Result<Self> {
        let names = names(header).join(",");
        writeln!(output, "index,{names}{}", if is_timed { ",time_us" } else { "" })?;
        Ok(Self {
            bank,
            output,
            is_single: header.sample == SampleType::F32,
            is_timed,
            timeline: Timeline::new(header.rate),
            next: 0,
            skipped: 0,
            columns: vec![Vec::new(); header.channels.len()],
            line: Vec::new(),
        })
    }

    /// Decodes and writes all remaining samples before index `end`. `events` must hold all events of these samples. If
    /// the function succeeds, it empties `events`.
    fn advance(&mut self, end: u64, events: &mut Vec<Event>) -> Result<(), Failure> {
        const MOST: u64 = 8192;
        for event in events.iter_mut() {
            event.sample = event.sample.saturating_sub(self.skipped);
        }
        let mut left = events.as_slice();
        while self.next < end {
            let count = (end - self.next).min(MOST);
            let stop = self.next - self.skipped + count;
            let (now, later) = left.split_at(left.partition_point(|event| event.sample < stop));
            self.columns.iter_mut().for_each(Vec::clear);
            self.bank.decode(count as usize, now, &mut self.columns).map_err(|event| {
                Failure::Code(Event { sample: event.sample + self.skipped, ..event })
            })?;
            self.write().map_err(Failure::Output)?;
            left = later;
        }
        events.clear();
        Ok(())
    }

    /// Writes `count` rows with NaN, for samples that the encoder skipped because a value was missing.
    fn skip(&mut self, count: u64) -> Result<(), Failure> {
        const MOST: u64 = 8192;
        self.skipped += count;
        let mut left = count;
        while left > 0 {
            let now = left.min(MOST);
            for column in &mut self.columns {
                column.clear();
                column.resize(now as usize, f64::NAN);
            }
            self.write().map_err(Failure::Output)?;
            left -= now;
        }
        Ok(())
    }

    fn write(&mut self) -> io::Result<()> {
        self.line.clear();
        let (mut whole, mut decimals) = (itoa::Buffer::new(), zmij::Buffer::new());
        let rows = self.columns.first().map_or(0, Vec::len);
        for row in 0..rows {
            self.line.extend(whole.format(self.next).as_bytes());
            for column in &self.columns {
                let value = column[row];
                self.line.push(b',');
                let text = if self.is_single {
                    decimals.format(value as f32)
                } else {
                    decimals.format(value)
                };
                self.line.extend(text.as_bytes());
            }
            if self.is_timed {
                self.line.push(b',');
                self.line.extend(whole.format(self.timeline.at(self.next)).as_bytes());
            }
            self.line.push(b'\n');
            self.next += 1;
        }
        self.output.write_all(&self.line)
    }
}

/// Returns the names of the value columns: `value` for one channel, or the recording's column names for several.
fn names(header: &Header) -> Vec<String> {
    let count = header.channels.len();
    if count == 1 {
        return vec!["value".to_owned()];
    }
    let note = header.notes.iter().find(|(key, _)| matches!(*key, "column" | "field"));
    let names: Vec<String> =
        note.map_or(Vec::new(), |(_, names)| names.split(',').map(str::to_owned).collect());
    if names.len() == count { names } else { (0..count).map(|n| format!("value{n}")).collect() }
}
