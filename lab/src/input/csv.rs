//! Columns of a CSV table.

use super::text::{name, shown, text};
use super::time::{Named, Reading, TimeUnit, implausible, number, of_given, of_name};
use super::{ALL, CHUNK, Chunk, InputOptions, Source, near};
use anyhow::{Context, Result, anyhow, bail};
use csv::{ByteRecord, Reader, ReaderBuilder};
use std::collections::VecDeque;
use std::io::{BufRead, BufReader, Cursor, Read};

/// Names of columns that hold counts unless the user says otherwise.
const COUNTS: [&str; 8] =
    ["index", "sample", "i", "", "unnamed: 0", "loopiteration", "lineno", "header.seq"];
/// Rows that are looked at before the first is taken.
const AHEAD: usize = 64;

/// Columns, and perhaps others with the times.
pub(super) struct Table {
    reader: Reader<Box<dyn Read>>,
    ahead: VecDeque<ByteRecord>,
    record: ByteRecord,
    file: String,
    columns: Vec<Column>,
    time: Option<Time>,
    has_decimal_commas: bool,
    skip_non_finite: bool,
    rows: u64,
    origin: Vec<(&'static str, String)>,
    notes: Vec<String>,
}

#[derive(Clone, Debug, PartialEq)]
struct Column {
    index: usize,
    name: String,
}

/// The column with the times.
struct Time {
    column: Column,
    reading: Reading,
    /// Nanoseconds beside whole seconds.
    nanoseconds: Option<Column>,
    has_decimal_commas: bool,
}

impl Table {
    pub(super) fn open(
        input: impl Read + 'static,
        file: &str,
        options: &InputOptions,
    ) -> Result<Self> {
        let (start, input) = first_line(BufReader::with_capacity(1 << 16, text(input, file)?))
            .with_context(|| file.to_owned())?;
        let delimiter = options.delimiter.map_or_else(|| delimiter(&start), |given| given.0);
        let all: Box<dyn Read> = Box::new(Cursor::new(start).chain(input));
        let mut reader = ReaderBuilder::new()
            .buffer_capacity(1 << 18)
            .comment(Some(b'#'))
            .delimiter(delimiter)
            .from_reader(all);
        let header = reader.byte_headers().with_context(|| format!("{file}: line 1"))?;
        let names: Vec<String> = header.iter().map(name).collect();
        if names.is_empty() {
            bail!("{file}: empty; a CSV table starts with a header");
        }
        if names.iter().all(|name| name.parse::<f64>().is_ok()) {
            bail!("{file}: line 1 holds numbers; a CSV table starts with a header");
        }
        let mut table = Self {
            ahead: ahead(&mut reader, file)?,
            reader,
            record: ByteRecord::new(),
            file: file.to_owned(),
            columns: Vec::new(),
            time: None,
            has_decimal_commas: delimiter != b',',
            skip_non_finite: options.skip_non_finite,
            rows: 0,
            origin: Vec::new(),
            notes: Vec::new(),
        };
        let time = table.time_column(&names, options)?;
        table.columns = match options.columns().collect::<Vec<_>>()[..] {
            [] => vec![only(&names, time.as_ref().map(|(column, _)| column), file)?],
            [ALL] => signals(&names, time.as_ref().map(|(column, _)| column)).collect(),
            ref asked => {
                asked.iter().map(|name| find(name, &names, file)).collect::<Result<_>>()?
            }
        };
        if let Some((column, named)) = time.filter(|(time, _)| !table.columns.contains(time)) {
            if let Some(rate) = options.rate {
                let name = &column.name;
                bail!("{file}: `rate` {rate} contradicts the times that column {name} records");
            }
            table.read_times(column, named, &names, options);
        } else if let Some(unit) = options.time_unit {
            bail!(
                "{file}: `time_unit` {unit}: no column is known to hold times; `time` says which"
            );
        }
        let columns = table.columns.iter().map(|column| column.name.as_str());
        table.origin = vec![("column", columns.collect::<Vec<_>>().join(","))];
        Ok(table)
    }

    /// The column of the times, and what its name says.
    fn time_column(
        &self,
        names: &[String],
        options: &InputOptions,
    ) -> Result<Option<(Column, Named)>> {
        if let Some(asked) = &options.time {
            let column = find(asked, names, &self.file)?;
            let says = of_given(&column.name);
            return Ok(Some((column, says)));
        }
        let is_betaflight = names.iter().any(|name| name == "loopIteration");
        let times = names.iter().enumerate().filter_map(|(index, name)| {
            let says = match of_name(name)? {
                Named::Whole(_) if is_betaflight => Named::Whole(TimeUnit::Us),
                Named::Dates => {
                    Reading::new(Named::Dates, &self.first(index), self.has_decimal_commas)
                        .map(|_| Named::Dates)?
                }
                other => other,
            };
            Some((Column { index, name: name.clone() }, says))
        });
        Ok(times.into_iter().next())
    }

    /// Settles how the times are read, and what is to be said of them.
    fn read_times(
        &mut self,
        column: Column,
        says: Named,
        names: &[String],
        options: &InputOptions,
    ) {
        let first = self.first(column.index);
        let says = options.time_unit.map_or(says, Named::In);
        // What is no time is told where it stands.
        let fallback = Reading::Numbers(options.time_unit.unwrap_or(TimeUnit::S));
        let reading = Reading::new(says, &first, self.has_decimal_commas).unwrap_or(fallback);
        let how = match reading {
            Reading::Numbers(unit) => format!("in {unit}"),
            Reading::Dates => "as dates".to_owned(),
            Reading::Durations => "as durations".to_owned(),
        };
        let nanoseconds = nanoseconds(&column, names);
        let has_decimal_commas = self.has_decimal_commas;
        let time = Time { column, reading, nanoseconds, has_decimal_commas };
        let times: Option<Vec<f64>> = self.ahead.iter().map(|record| time.read(record)).collect();
        let name = &time.column.name;
        let doubt = times.and_then(|times| implausible(&times));
        let doubt =
            doubt.map_or(String::new(), |what| format!(": {what}; is `time_unit` another?"));
        self.notes.push(format!("times {how} from column `{name}`{doubt}"));
        self.time = Some(time);
    }

    /// The first values of a column.
    fn first(&self, index: usize) -> Vec<&[u8]> {
        self.ahead.iter().filter_map(|record| record.get(index)).map(<[u8]>::trim_ascii).collect()
    }

    /// Takes the next row, if there is one.
    fn advance(&mut self) -> Result<bool> {
        if let Some(record) = self.ahead.pop_front() {
            self.record = record;
            return Ok(true);
        }
        let read = self.reader.read_byte_record(&mut self.record);
        read.map_err(|error| unreadable(&self.file, &error))
    }

    fn number(&self, column: &Column) -> Result<f64> {
        let field = self.record.get(column.index).unwrap_or_default().trim_ascii();
        if let Some(number) = number(field, self.has_decimal_commas) {
            return Ok(number);
        }
        if is_missing(field) {
            return Ok(f64::NAN);
        }
        Err(anyhow!("{}: `{}` is not a number", self.place(column), shown(field)))
    }

    fn value(&self, column: &Column) -> Result<f64> {
        let value = self.number(column)?;
        if !value.is_finite() && !self.skip_non_finite {
            let field = self.record.get(column.index).unwrap_or_default().trim_ascii();
            let what = match shown(field) {
                shown if is_missing(field) => format!("`{shown}` is a missing value"),
                shown => format!("{shown} is not finite"),
            };
            bail!("{}: {what}; `skip_non_finite` goes on over such values", self.place(column));
        }
        Ok(value)
    }

    fn place(&self, column: &Column) -> String {
        let line = self.record.position().map_or(0, csv::Position::line);
        format!("{}: line {line}, column {}", self.file, column.name)
    }
}

impl Time {
    /// The time, in µs.
    fn read(&self, record: &ByteRecord) -> Option<f64> {
        let field = |column: &Column| record.get(column.index).unwrap_or_default().trim_ascii();
        let time = self.reading.read(field(&self.column), self.has_decimal_commas)?;
        match &self.nanoseconds {
            Some(column) => Some(time + Reading::Numbers(TimeUnit::Ns).read(field(column), false)?),
            None => Some(time),
        }
    }
}

impl Source for Table {
    fn next(&mut self, chunk: &mut Chunk) -> Result<()> {
        chunk.clear(self.columns.len());
        while chunk.len() < CHUNK && self.advance()? {
            for (column, values) in self.columns.iter().zip(&mut chunk.columns) {
                values.push(self.value(column)?);
            }
            if let Some(time) = &self.time {
                let Some(microseconds) = time.read(&self.record) else {
                    let field = self.record.get(time.column.index).unwrap_or_default();
                    let text = shown(field.trim_ascii());
                    bail!("{}: `{text}` is not a time", self.place(&time.column));
                };
                chunk.times.push(microseconds.round() as i64);
            }
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

    fn notes(&self) -> &[String] {
        &self.notes
    }
}

/// Whether a field is a spelling of a missing value, such as `NA`.
fn is_missing(field: &[u8]) -> bool {
    const WORDS: [&str; 8] = ["", "na", "n/a", "#n/a", "<na>", "null", "none", "-"];
    WORDS.iter().any(|word| field.eq_ignore_ascii_case(word.as_bytes()))
}

/// The text up to the end of the header's line, and the rest of it.
fn first_line<R: BufRead>(mut input: R) -> Result<(Vec<u8>, R)> {
    const LONGEST: u64 = 1 << 20;
    let mut start = Vec::new();
    loop {
        let line = start.len();
        input.by_ref().take(LONGEST).read_until(b'\n', &mut start)?;
        let is_comment = start[line..].starts_with(b"#") || start[line..].trim_ascii().is_empty();
        if start.len() == line || !is_comment {
            return Ok((start, input));
        }
    }
}

/// Finds the delimiter that separates most names of the header.
fn delimiter(start: &[u8]) -> u8 {
    let header = start.trim_ascii_end().rsplit(|&byte| byte == b'\n').next().unwrap_or_default();
    let mut is_quoted = false;
    let mut counts = [(b',', 0), (b';', 0), (b'\t', 0), (b'|', 0)];
    for byte in header {
        is_quoted ^= *byte == b'"';
        for (delimiter, count) in &mut counts {
            *count += u32::from(!is_quoted && byte == delimiter);
        }
    }
    // The comma where there is no other.
    counts.into_iter().rev().max_by_key(|&(_, count)| count).map_or(b',', |(found, _)| found)
}

fn ahead(reader: &mut Reader<Box<dyn Read>>, file: &str) -> Result<VecDeque<ByteRecord>> {
    let mut records = VecDeque::new();
    let mut record = ByteRecord::new();
    while records.len() < AHEAD
        && reader.read_byte_record(&mut record).map_err(|error| unreadable(file, &error))?
    {
        records.push_back(record.clone());
    }
    Ok(records)
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

/// The nanoseconds that ROS writes beside whole seconds.
fn nanoseconds(seconds: &Column, names: &[String]) -> Option<Column> {
    let lower = seconds.name.to_lowercase();
    let stem = lower.strip_suffix("secs").or_else(|| lower.strip_suffix("sec"))?;
    let is_rest = |name: &str| {
        name.strip_prefix(stem).is_some_and(|word| matches!(word, "nsecs" | "nsec" | "nanosec"))
    };
    let index = names.iter().position(|name| is_rest(&name.to_lowercase()))?;
    Some(Column { index, name: names[index].clone() })
}

fn find(asked: &str, names: &[String], file: &str) -> Result<Column> {
    let asked = asked.trim();
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

/// The columns that are neither times nor counts.
fn signals(names: &[String], time: Option<&Column>) -> impl Iterator<Item = Column> {
    let is_signal = move |&(index, name): &(usize, &String)| {
        time.is_none_or(|time| time.index != index)
            && !COUNTS.contains(&name.to_lowercase().as_str())
    };
    let signals = names.iter().enumerate().filter(is_signal);
    signals.map(|(index, name)| Column { index, name: name.clone() })
}

/// The column that is neither a time nor a count, if there is just one.
fn only(names: &[String], time: Option<&Column>, file: &str) -> Result<Column> {
    let mut signals = signals(names, time);
    match (signals.next(), signals.next()) {
        (Some(column), None) => Ok(column),
        _ => bail!("{file}: `column` must say which; there are {}", names.join(", ")),
    }
}
