//! A column of a CSV table.

use super::{CHUNK, Chunk, InputOptions, Source, near};
use anyhow::{Context, Result, anyhow, bail};
use csv::{ByteRecord, Reader, ReaderBuilder};
use std::io::Read;

/// Names of columns that hold times or counts unless the user says otherwise.
const TIMES: [&str; 11] = [
    "time_us",
    "time_ms",
    "time_ns",
    "time_s",
    "timestamp",
    "timestamp_us",
    "timestamp_ms",
    "timestamp_ns",
    "timestamp_s",
    "time",
    "t",
];
const COUNTS: [&str; 3] = ["index", "sample", "i"];

/// A column, and perhaps another with the times.
pub(super) struct Table<R> {
    reader: Reader<R>,
    record: ByteRecord,
    file: String,
    column: Column,
    time: Option<(Column, f64)>,
    skip_non_finite: bool,
    rows: u64,
    origin: Vec<(&'static str, String)>,
}

#[derive(Clone)]
struct Column {
    index: usize,
    name: String,
}

impl<R: Read> Table<R> {
    pub(super) fn open(input: R, file: &str, options: &InputOptions) -> Result<Self> {
        let mut reader =
            ReaderBuilder::new().buffer_capacity(1 << 18).comment(Some(b'#')).from_reader(input);
        let header = reader.headers().with_context(|| format!("{file}: line 1"))?;
        let names: Vec<String> = header.iter().map(|name| name.trim().to_owned()).collect();
        if names.is_empty() {
            bail!("{file}: empty; a CSV table starts with a header");
        }
        if names.iter().all(|name| name.parse::<f64>().is_ok()) {
            bail!("{file}: line 1 holds numbers; a CSV table starts with a header");
        }
        let time = match &options.time {
            Some(name) => Some(find(name, &names, file)?),
            None => names
                .iter()
                .position(|name| TIMES.contains(&name.as_str()))
                .map(|index| Column { index, name: names[index].clone() }),
        };
        let column = match &options.column {
            Some(name) => find(name, &names, file)?,
            None => only(&names, time.as_ref(), file)?,
        };
        let time = time.filter(|time| time.index != column.index);
        if let (Some(time), Some(rate)) = (&time, options.rate) {
            bail!("{file}: --rate {rate} contradicts the times that column {} records", time.name);
        }
        let origin = vec![("column", column.name.clone())];
        Ok(Self {
            reader,
            record: ByteRecord::new(),
            file: file.to_owned(),
            column,
            time: time.map(|time| (time.clone(), microseconds(&time.name))),
            skip_non_finite: options.skip_non_finite,
            rows: 0,
            origin,
        })
    }

    fn number(&self, column: &Column) -> Result<f64> {
        let field = self.record.get(column.index).unwrap_or_default().trim_ascii();
        fast_float2::parse(field).map_err(|_| {
            let text = String::from_utf8_lossy(field);
            anyhow!("{}: `{text}` is not a number", self.place(column))
        })
    }

    fn place(&self, column: &Column) -> String {
        let line = self.record.position().map_or(0, csv::Position::line);
        format!("{}: line {line}, column {}", self.file, column.name)
    }
}

impl<R: Read> Source for Table<R> {
    fn next(&mut self, chunk: &mut Chunk) -> Result<()> {
        chunk.values.clear();
        chunk.times.clear();
        while chunk.values.len() < CHUNK {
            if !self
                .reader
                .read_byte_record(&mut self.record)
                .map_err(|error| unreadable(&self.file, &error))?
            {
                break;
            }
            let value = self.number(&self.column)?;
            if !value.is_finite() && !self.skip_non_finite {
                bail!(
                    "{}: {value} is not finite; --skip-non-finite goes on over such values",
                    self.place(&self.column)
                );
            }
            if let Some((column, unit)) = &self.time {
                let time = self.number(column)?;
                if !time.is_finite() {
                    bail!("{}: {time} is not a time", self.place(column));
                }
                chunk.times.push((time * unit).round() as i64);
            }
            chunk.values.push(value);
            self.rows += 1;
        }
        if self.rows == 0 {
            bail!("{}: no samples below the header", self.file);
        }
        Ok(())
    }

    fn origin(&self) -> &[(&'static str, String)] {
        &self.origin
    }
}

fn unreadable(file: &str, error: &csv::Error) -> anyhow::Error {
    match error.kind() {
        csv::ErrorKind::UnequalLengths { pos, expected_len, len } => {
            let line = pos.as_ref().map_or(0, csv::Position::line);
            anyhow!("{file}: line {line} has {len} columns where the header has {expected_len}")
        }
        _ => anyhow!("{file}: {error}"),
    }
}

fn find(asked: &str, names: &[String], file: &str) -> Result<Column> {
    if let Some(index) = names.iter().position(|name| name == asked) {
        return Ok(Column { index, name: asked.to_owned() });
    }
    match asked.parse::<usize>() {
        Ok(number) if (1..=names.len()).contains(&number) => {
            Ok(Column { index: number - 1, name: names[number - 1].clone() })
        }
        Ok(_) => bail!("{file}: no column {asked}; columns are numbered from 1 to {}", names.len()),
        Err(_) => {
            bail!("{file}: no column `{asked}`; {}", near(asked, names.iter().map(String::as_str)))
        }
    }
}

/// The column that is neither a time nor a count, if there is just one.
fn only(names: &[String], time: Option<&Column>, file: &str) -> Result<Column> {
    let is_signal = |&(index, name): &(usize, &String)| {
        time.is_none_or(|time| time.index != index) && !COUNTS.contains(&name.as_str())
    };
    let mut signals = names.iter().enumerate().filter(is_signal);
    match (signals.next(), signals.next()) {
        (Some((index, name)), None) => Ok(Column { index, name: name.clone() }),
        _ => bail!("{file}: --column must say which; there are {}", names.join(", ")),
    }
}

/// Microseconds in the unit that a column's name tells.
fn microseconds(name: &str) -> f64 {
    if name.ends_with("_ns") {
        1e-3
    } else if name.ends_with("_us") || name == "timestamp" {
        1.0
    } else if name.ends_with("_ms") {
        1e3
    } else {
        1e6
    }
}
