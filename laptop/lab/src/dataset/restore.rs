//! Restores the text file of spikes that `encode` would have written for a log of a data set.

use super::DatasetKind;
use super::manifest::{EVENTS, VALUES};
use super::parts::{FIRST, GAP, HEADER, RATE, TIME};
use crate::error::At;
use crate::input::{Chunk, Clock};
use crate::output::Output;
use crate::spikes::{Header, Record, Writer};
use crate::{Error, Result};
use catalogue::run::Event;
use parquet::column::reader::ColumnReader;
use parquet::file::reader::{FileReader, SerializedFileReader};
use spikewire::Polarity;
use std::fs::File;
use std::path::{Path, PathBuf};

/// Writes a log's spikes as text, byte for byte as the command `encode` does. `part` is the log's Parquet file of
/// spikes in a data set. The log's file of samples must be in the same data set. Returns the output, which the caller
/// must finish.
///
/// # Errors
/// Returns an error if the files are not those of a data set, or if the output cannot be written.
pub fn restore(part: &Path, output: impl FnOnce() -> Result<Output>) -> Result<Output> {
    let name = part.display().to_string();
    restore_from(part, output).at(|| name)
}

fn restore_from(part: &Path, output: impl FnOnce() -> Result<Output>) -> Result<Output> {
    let beside = beside(part).ok_or_else(|| other("its directory is not `events`"))?;
    let values = Part::open(&beside)?;
    let events = Part::open(part)?;
    let lines = values.about(HEADER).ok_or_else(|| other("no header"))?;
    let lines = lines.lines().filter_map(|line| line.split_once('='));
    let lines = lines.map(|(key, value)| (key.to_owned(), value.to_owned())).collect();
    let header = Header::parse(lines)?;
    let shape = match header.channels.first() {
        Some(settings) => header.scheme.shape(settings)?,
        None => return Err(other("no channel")),
    };
    let (slots, neurons) = (shape.slots as u64, shape.neurons as i32);
    let is_timed = values.column(TIME).is_some();
    let mut clock = values.clock(is_timed)?;
    let mut writer = Box::new(Writer::new(output()?, &header, is_timed)?);
    let mut rows = Rows::new(&events)?;
    let (mut sample, mut finite, mut spikes) = (0, 0, Vec::new());
    for group in 0..values.file.num_row_groups() {
        let mut chunk = values.chunk(group, is_timed)?;
        let is_finite = chunk.finite_rows();
        let steps = clock.observe(&chunk.times);
        writer.observe(&mut chunk, &steps)?;
        let mut row = 0;
        let first = finite;
        finite += is_finite.iter().filter(|own| **own).count() as u64;
        let mut seen = first;
        while let Some(spike) = rows.next_before((sample + is_finite.len() as u64) * slots)? {
            let at =
                (spike.index / slots).checked_sub(sample).ok_or_else(|| other("out of order"))?;
            let at = at as usize;
            if at < row || is_finite.get(at) != Some(&true) {
                return Err(other("a spike without a sample"));
            }
            seen += is_finite[row..at].iter().filter(|own| **own).count() as u64;
            row = at;
            let neuron = u16::try_from(spike.channel * neurons + spike.neuron);
            spikes.push(Event {
                sample: seen,
                slot: (spike.index % slots) as u16,
                neuron: neuron.map_err(|_| other("no such neuron"))?,
                polarity: if spike.polarity > 0 { Polarity::Up } else { Polarity::Down },
            });
        }
        sample += is_finite.len() as u64;
        writer.write(&mut spikes, finite)?;
    }
    if rows.next_before(u64::MAX)?.is_some() {
        return Err(other("spikes behind the last sample"));
    }
    Ok(writer.finish(&mut spikes)?.0)
}

fn other(what: &str) -> Error {
    DatasetKind::NoPart { what: what.to_owned() }.into()
}

/// Returns the path of the file of samples that belongs to the file of spikes `part`.
fn beside(part: &Path) -> Option<PathBuf> {
    let part = part.canonicalize().ok()?;
    let events = part.parent().filter(|own| own.ends_with(EVENTS))?;
    Some(events.parent()?.join(VALUES).join(part.file_name()?))
}

/// A Parquet file that is being read.
struct Part {
    file: SerializedFileReader<File>,
}

impl Part {
    fn open(path: &Path) -> Result<Self> {
        let open = |error| Error::open(path.display().to_string(), error);
        let file = SerializedFileReader::new(File::open(path).map_err(open)?);
        Ok(Self { file: file.map_err(|error| other(&error.to_string()))? })
    }

    fn about(&self, key: &str) -> Option<&str> {
        let all = self.file.metadata().file_metadata().key_value_metadata()?;
        all.iter().find(|own| own.key == key)?.value.as_deref()
    }

    fn column(&self, name: &str) -> Option<usize> {
        let columns = self.file.metadata().file_metadata().schema_descr().columns();
        columns.iter().position(|own| own.name() == name)
    }

    /// Rebuilds the clock with which the log was encoded. The metadata of the file give the sample rate, and the
    /// multiple of the usual step above which a step in time counts as a gap. The table of the file gives the times of
    /// the first samples.
    fn clock(&self, is_timed: bool) -> Result<Clock> {
        let number = |key| self.about(key).and_then(|own| own.parse::<f64>().ok());
        let first = number(FIRST).ok_or_else(|| other("no number of first samples"))? as usize;
        let mut times = Vec::new();
        for group in 0..self.file.num_row_groups() {
            if !is_timed || times.len() >= first {
                break;
            }
            times.append(&mut self.longs(group, TIME)?);
        }
        times.truncate(first);
        let gap = number(GAP).ok_or_else(|| other("no bound of gaps"))?;
        Ok(Clock::new(&times, number(RATE), gap))
    }

    /// Reads a row group of samples.
    fn chunk(&self, group: usize, is_timed: bool) -> Result<Chunk> {
        let rows = self.file.get_row_group(group)?;
        let count = rows.metadata().num_rows() as usize;
        let mut chunk = Chunk::default();
        if is_timed {
            chunk.times = self.longs(group, TIME)?;
        }
        for column in usize::from(is_timed)..rows.num_columns() {
            let ColumnReader::DoubleColumnReader(mut reader) = rows.get_column_reader(column)?
            else {
                return Err(other("a channel is not of doubles"));
            };
            let mut values = Vec::with_capacity(count);
            reader.read_records(count, None, None, &mut values)?;
            chunk.columns.push(values);
        }
        let lengths =
            chunk.columns.iter().map(Vec::len).chain(is_timed.then_some(chunk.times.len()));
        if lengths.into_iter().any(|own| own != count) {
            return Err(other("columns of different lengths"));
        }
        Ok(chunk)
    }

    fn longs(&self, group: usize, name: &str) -> Result<Vec<i64>> {
        let rows = self.file.get_row_group(group)?;
        let count = rows.metadata().num_rows() as usize;
        let place = self.column(name).ok_or_else(|| other("a column is missing"))?;
        let ColumnReader::Int64ColumnReader(mut reader) = rows.get_column_reader(place)? else {
            return Err(other("a column is not of 64 bits"));
        };
        let mut values = Vec::with_capacity(count);
        reader.read_records(count, None, None, &mut values)?;
        Ok(values)
    }

    fn ints(&self, group: usize, name: &str) -> Result<Vec<i32>> {
        let rows = self.file.get_row_group(group)?;
        let count = rows.metadata().num_rows() as usize;
        let Some(place) = self.column(name) else { return Ok(vec![0; count]) };
        let ColumnReader::Int32ColumnReader(mut reader) = rows.get_column_reader(place)? else {
            return Err(other("a column is not of 32 bits"));
        };
        let mut values = Vec::with_capacity(count);
        reader.read_records(count, None, None, &mut values)?;
        Ok(values)
    }
}

/// A row of a Parquet file of spikes.
#[derive(Clone, Copy)]
struct Spike {
    index: u64,
    channel: i32,
    neuron: i32,
    polarity: i32,
}

/// A reader of the rows of a Parquet file of spikes. One row group is in memory at a time.
struct Rows<'a> {
    part: &'a Part,
    /// Index of the next row group (a block of rows in a Parquet file) to read.
    group: usize,
    spikes: std::vec::IntoIter<Spike>,
    next: Option<Spike>,
}

impl<'a> Rows<'a> {
    fn new(part: &'a Part) -> Result<Self> {
        let mut rows = Self { part, group: 0, spikes: Vec::new().into_iter(), next: None };
        rows.advance()?;
        Ok(rows)
    }

    /// Returns the next spike if the index of its sample is below `end`, and otherwise `None`.
    fn next_before(&mut self, end: u64) -> Result<Option<Spike>> {
        let Some(spike) = self.next.filter(|own| own.index < end) else { return Ok(None) };
        self.advance()?;
        Ok(Some(spike))
    }

    fn advance(&mut self) -> Result<()> {
        self.next = self.spikes.next();
        while self.next.is_none() && self.group < self.part.file.num_row_groups() {
            let own = self.group;
            self.group += 1;
            let index = self.part.longs(own, "index")?;
            let (channel, neuron) =
                (self.part.ints(own, "channel")?, self.part.ints(own, "neuron")?);
            let polarity = self.part.ints(own, "polarity")?;
            let spikes = index.into_iter().zip(channel).zip(neuron).zip(polarity);
            let spikes = spikes.map(|(((index, channel), neuron), polarity)| Spike {
                index: index as u64,
                channel,
                neuron,
                polarity,
            });
            self.spikes = spikes.collect::<Vec<_>>().into_iter();
            self.next = self.spikes.next();
        }
        Ok(())
    }
}
