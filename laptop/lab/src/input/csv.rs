//! Reads columns of a CSV table as channels.

mod overview;

pub use overview::{ColumnSummary, Summary, summary};

use super::cut::WholeLines;
use super::flysight::{self, Records};
use super::header::{Header, Start, is_data, units};
use super::inertial;
use super::names::{MOST_ITEMS, fits, is_pattern, items, with_units};
use super::spaces::OneBlank;
use super::text::{decode, name, shown, unpacked};
use super::time::{Named, Reading, TimeUnit, implausible, odd_rate};
use super::time::{microseconds, number, of_given, of_name};
use super::{ALL, CHUNK, Chunk, InputOptions, Source, TableKind, Unnamed, near};
use crate::error::At;
use crate::unit::unit_of_name;
use crate::{Error, ErrorKind, Place, Result, Spot};
use catalogue::run::{Given, Words};
use csv::{ByteRecord, Reader, ReaderBuilder};
use std::cell::Cell;
use std::collections::VecDeque;
use std::io::{self, BufRead, BufReader, Cursor, Read};
use std::rc::Rc;

/// Names of columns that may hold counts rather than samples. A column with such a name that counts upwards is read
/// only if the user names it.
const COUNTS: [&str; 4] = ["loopiteration", "lineno", "header.seq", "field.header.seq"];
/// Further such names, of a table's first column. Elsewhere, `I` is a current.
const FIRST_COUNTS: [&str; 5] = ["index", "sample", "i", "", "unnamed: 0"];
/// Number of rows that are examined first, to find the header and the format of the times.
const AHEAD: usize = 64;

/// A CSV table that is being read: the chosen columns, and the columns with the times, if the table has times.
pub(super) struct Table {
    rows: Rows,
    /// Number of comment lines below the header.
    comments: Rc<Cell<u64>>,
    /// The row of names, and the row of units below it, if there are any. Both may occur again among the samples, where
    /// files were joined.
    header: Vec<ByteRecord>,
    /// Number of such rows among the samples.
    repeated: u64,
    /// A note that tells the user which bytes were left out at the end of a truncated table.
    cut: Rc<Cell<Option<String>>>,
    ahead: VecDeque<ByteRecord>,
    /// The current row.
    record: ByteRecord,
    /// Whether the current row is one of the first rows, which were read in advance.
    was_ahead: bool,
    file: String,
    columns: Vec<Column>,
    time: Option<Time>,
    has_decimal_commas: bool,
    skip_non_finite: bool,
    count: u64,
    origin: Vec<(&'static str, String)>,
    notes: Vec<Words>,
}

#[derive(Clone, Debug, PartialEq)]
struct Column {
    index: usize,
    name: String,
}

/// The column with the times, and the format of its fields.
struct Time {
    column: Column,
    reading: Reading,
    /// Column of nanoseconds, which are added to the whole seconds in `column`. `None` if the times are in a single
    /// column.
    nanoseconds: Option<Column>,
    has_decimal_commas: bool,
}

impl Table {
    /// Opens a table that can be read from a stream: CSV text, JSON lines or a single `NumPy` array.
    ///
    /// # Errors
    /// Returns an error if the input holds no table, or if the table lacks a requested column.
    pub(super) fn open(
        input: impl Read + 'static,
        file: &str,
        options: &InputOptions,
    ) -> Result<Self> {
        let (head, input) = unpacked(input, file)?;
        let cut = Rc::default();
        #[cfg(not(target_family = "wasm"))]
        let input = match super::rows::of_stream(&head, input, file)? {
            Ok(rows) => return Self::of_rows(rows, file, options),
            Err(text) => text,
        };
        let mut text = BufReader::new(decode(&head, input, file)?);
        if flysight::is_start(text.fill_buf().at(|| file)?) {
            let (records, note) = Records::new(text, options.topic.as_deref(), file)?;
            let mut table = Self::of_text(Box::new(records), 0, cut, file, options)?;
            table.notes.insert(0, note);
            return Ok(table);
        }
        options.refuse_topic()?;
        let text: Box<dyn Read> = if options.accept_cut {
            Box::new(WholeLines::new(text, Rc::clone(&cut)))
        } else {
            Box::new(text)
        };
        Self::of_text(text, 0, cut, file, options)
    }

    /// Opens a table from a file that is not CSV. `rows` is the table converted to CSV, with a header line that the
    /// file does not have. Line numbers in errors therefore do not count the header line.
    ///
    /// # Errors
    /// See [`open`](Self::open).
    #[cfg(not(target_family = "wasm"))]
    pub(super) fn of_rows(rows: Box<dyn Read>, file: &str, options: &InputOptions) -> Result<Self> {
        options.refuse_topic()?;
        Self::of_text(rows, 1, Rc::default(), file, options)
    }

    /// Opens a table of CSV text. `above` is the number of lines that were added at the start of `text`, such as a
    /// header. The file itself has no such lines.
    fn of_text(
        text: Box<dyn Read>,
        above: u64,
        cut: Rc<Cell<Option<String>>>,
        file: &str,
        options: &InputOptions,
    ) -> Result<Self> {
        let mut input = BufReader::with_capacity(1 << 16, text);
        let asked = options.delimiter.map(|own| own.0);
        let start = match options.header {
            _ if above > 0 => Start::read_plain(&mut input),
            None => Start::read(&mut input, asked),
            Some(line) => Start::read_to(&mut input, line),
        };
        let start = start.at(|| file)?;
        let comment = start.comment(asked);
        let delimiter = if above > 0 {
            b','
        } else {
            asked.or(comment.as_ref().map(|own| own.delimiter)).unwrap_or_else(|| start.delimiter())
        };
        let mut notes = Vec::new();
        if let Some(line) = start.header_line {
            notes
                .push(format!("the header is line {line}; the lines above it are left out").into());
        }
        let given_line = start.given_line;
        let doubtful = start.doubtful_comment(asked);
        let comments = Rc::default();
        let mut rows = Rows::new(start, input, delimiter, above, &comments);
        rows.is_header_given = given_line.is_some();
        rows.leaves_out = options.skip_non_finite;
        let mut ahead = ahead(&mut rows, file)?;
        let Some(first) = ahead.front() else {
            return Err(TableKind::Empty.at(file));
        };
        let is_data = above == 0 && given_line.is_none() && is_data(&ahead, delimiter);
        let doubtful = doubtful.filter(|_| is_data && comment.is_none());
        let mut header = Vec::new();
        let names = match comment {
            Some(Header { names, .. }) if is_data => {
                notes.push("the header is the comment above the first row".into());
                names
            }
            _ if is_data => {
                let last = first.len();
                let what = "no line has names; the columns are called";
                notes.push(match last {
                    1 => format!("{what} 1").into(),
                    _ => format!("{what} 1 to {last}").into(),
                });
                notes.extend(doubtful.map(|line| {
                    let note =
                        format!("the comment in line {line} may hold other names than {last}; ");
                    Words::from(note).setting("header").text(format_args!(" {line} takes them"))
                }));
                (1..=last).map(|number| number.to_string()).collect()
            }
            _ => {
                header.extend(ahead.pop_front());
                let mut names: Vec<_> = header.iter().flatten().map(name).collect();
                // A quoted `#` before the first name, as in EuRoC's header, begins no comment.
                if let Some(first) = names.first_mut()
                    && let Some(bare) = first.strip_prefix('#').map(str::trim_start)
                    && !bare.is_empty()
                {
                    *first = bare.to_owned();
                }
                if let (Some(line), Some(columns)) = (given_line, rows.columns) {
                    notes.extend(fit_names(&mut names, line, columns));
                }
                names
            }
        };
        let mut of_units = Vec::new();
        if above == 0
            && !header.is_empty()
            && let Some(units) = units(&ahead, delimiter)
        {
            header.extend(ahead.pop_front());
            notes.push("the line below the header holds units".into());
            of_units = units;
        }
        // The names of other formats than text stand in no row.
        header.retain(|_| above == 0);
        let count = ahead.len();
        ahead.retain(|row| !header.contains(row));
        let repeated = (count - ahead.len()) as u64;
        let mut table = Self {
            ahead,
            rows,
            comments,
            header,
            repeated,
            cut,
            record: ByteRecord::new(),
            was_ahead: false,
            file: file.to_owned(),
            columns: Vec::new(),
            time: None,
            has_decimal_commas: delimiter != b',',
            skip_non_finite: options.skip_non_finite,
            count: 0,
            origin: Vec::new(),
            notes,
        };
        table.choose(&names, &of_units, options).map_err(|error| with_comment(error, doubtful))?;
        Ok(table)
    }

    /// Chooses the columns to read and that of the times. `units` are those of the row below the header.
    ///
    /// # Errors
    /// Returns an error if a column is missing, or if the unit of its times is unknown.
    fn choose(&mut self, names: &[String], units: &[String], options: &InputOptions) -> Result<()> {
        let asked: Vec<&str> = options.columns().collect();
        let mut chosen = None;
        if !matches!(asked[..], [] | [ALL]) {
            let mut columns: Vec<Column> = Vec::new();
            for name in &asked {
                columns.append(&mut named(name, names, units, &self.file)?);
            }
            chosen = Some(columns);
        }
        let time = self.time_column(names, units, chosen.as_deref(), options)?;
        let mut is_found = false;
        self.columns = if let Some(columns) = chosen {
            columns
        } else {
            let signals = self.signals(names, time.as_ref().map(|(column, _)| column));
            let sensor = match options.unnamed {
                Unnamed::Inertial | Unnamed::InertialOrAll if asked.is_empty() => sensor(&signals),
                _ => Vec::new(),
            };
            // A command that reads all columns otherwise has left none out.
            let is_all = options.unnamed == Unnamed::InertialOrAll && sensor.len() == signals.len();
            is_found = !sensor.is_empty() && !is_all;
            match options.unnamed {
                _ if !asked.is_empty() => signals,
                _ if !sensor.is_empty() => sensor,
                Unnamed::One | Unnamed::Inertial => vec![only(signals, names, &self.file)?],
                Unnamed::InertialOrAll | Unnamed::All => signals,
            }
        };
        self.note_names(names);
        if let Some((column, says)) = time.filter(|(time, _)| !self.columns.contains(time)) {
            self.read_times(column, says, names, options)?;
        } else if let Some(unit) = options.time_unit {
            return Err(TableKind::NoTimes.of(Given::new("time_unit", unit)).at(&self.file));
        }
        for column in &mut self.columns {
            column.name = with_unit(column, units);
        }
        self.origin = vec![("column", self.names().join(","))];
        if is_found {
            self.notes.insert(0, self.note_found());
        }
        Ok(())
    }

    /// Returns the note that says which columns are read, as the user named none.
    fn note_found(&self) -> Words {
        let names: Vec<String> = self.names().into_iter().map(str::to_owned).collect();
        let units: Vec<_> =
            names.iter().map(|name| unit_of_name(name).map(str::to_owned)).collect();
        let first = self
            .time
            .iter()
            .flat_map(|time| self.ahead.iter().filter_map(|record| time.read(record)));
        let times: Vec<i128> = first.collect();
        let rate = match times[..] {
            [first, .., last] if last > first => {
                let seconds = (last - first) as f64 * 1e-12;
                format!(", {:.0} Hz in the first rows", (times.len() - 1) as f64 / seconds)
            }
            _ => String::new(),
        };
        let note = format!("{}: reads {}{rate}; ", self.file, with_units(&names, &units));
        Words::from(note).setting("columns").text(" chooses others")
    }

    /// Finds the column with the times, and the format of times that the column's name suggests. If several columns hold
    /// times, the sensor's own stamps come before the times of arrival, and else the times that stand nearest to the
    /// left of the first chosen column. `units` are those of the row below the header.
    fn time_column(
        &mut self,
        names: &[String],
        units: &[String],
        chosen: Option<&[Column]>,
        options: &InputOptions,
    ) -> Result<Option<(Column, Named)>> {
        if let Some(asked) = &options.time {
            let column = find(asked, names, &self.file)?;
            let says = of_given(&with_unit(&column, units));
            return Ok(Some((column, says)));
        }
        let mut times = self.columns_of_times(names, units);
        if times.len() < 2 {
            return Ok(times.pop());
        }
        let first = times.first().cloned();
        times.retain(|(column, _)| self.rises(column.index));
        let before = |(time, _): &(Column, Named)| {
            chosen.and_then(<[Column]>::first).is_none_or(|chosen| time.index < chosen.index)
        };
        let stamp = times.iter().find(|(column, _)| is_stamp(&column.name));
        let nearest = times.iter().rfind(|time| chosen.is_some() && before(time));
        let Some(taken) = stamp.or(nearest).or(times.first()).cloned() else { return Ok(first) };
        if times.len() > 1 {
            let all: Vec<&str> = times.iter().map(|(column, _)| column.name.as_str()).collect();
            let (all, read) = (all.join(", "), &taken.0.name);
            let note = format!("columns {all} hold times, and those of `{read}` are read; ");
            self.notes.push(Words::from(note).setting("time").text(" says if others are meant"));
        }
        Ok(Some(taken))
    }

    /// Returns the columns of times by their names, each with the format of times that the name suggests.
    fn columns_of_times(&self, names: &[String], units: &[String]) -> Vec<(Column, Named)> {
        let is_betaflight = names.iter().any(|name| name == "loopIteration");
        let mut times = Vec::new();
        for column in all(names) {
            let says = match of_name(&with_unit(&column, units)) {
                Some(Named::Whole(_)) if is_betaflight => Named::Whole(TimeUnit::Us),
                Some(Named::Dates) => {
                    let first = self.first(column.index);
                    let dates = Reading::new(Named::Dates, &first, self.has_decimal_commas);
                    if dates.is_none() || !times.is_empty() {
                        continue;
                    }
                    Named::Dates
                }
                Some(says) => says,
                None => continue,
            };
            times.push((column, says));
        }
        // Nanoseconds beside whole seconds are no times of their own.
        let rests: Vec<Column> =
            times.iter().filter_map(|(column, _)| nanoseconds(column, names)).collect();
        times.retain(|(column, _)| !rests.contains(column));
        times
    }

    /// Returns whether the numbers of a column rise in the first rows, as times do.
    fn rises(&self, index: usize) -> bool {
        // Dates have been read by their name.
        let Some(numbers) = self.first_numbers(index) else { return true };
        numbers.is_sorted() && numbers.first() < numbers.last()
    }

    /// Returns the numbers of a column in the first rows, or `None` if a field is no number.
    fn first_numbers(&self, index: usize) -> Option<Vec<f64>> {
        let fields = self.first(index).into_iter();
        fields.map(|field| number(field, self.has_decimal_commas)).collect()
    }

    /// Returns the columns of signals: all columns except the column of times and the columns of counts. Notes the
    /// columns of counts, as they are left out.
    fn signals(&mut self, names: &[String], time: Option<&Column>) -> Vec<Column> {
        let mut signals = Vec::new();
        let mut counts = Vec::new();
        for column in all(names).filter(|own| time.is_none_or(|time| time.index != own.index)) {
            if self.is_count(&column) {
                counts.push(format!("`{}`", column.name));
            } else {
                signals.push(column);
            }
        }
        if !counts.is_empty() {
            let what = "counts the rows and is left out unless it is named";
            self.notes.push(format!("column {} {what}", counts.join(", ")).into());
        }
        signals
    }

    /// Returns whether a column counts the rows, by its name and by its numbers in the first rows.
    fn is_count(&self, column: &Column) -> bool {
        let name = column.name.to_lowercase();
        let is_named = COUNTS.contains(&name.as_str())
            || column.index == 0 && column.name != "I" && FIRST_COUNTS.contains(&name.as_str());
        is_named
            && self.first_numbers(column.index).is_some_and(|numbers| {
                numbers.iter().all(|number| number.fract() == 0.0)
                    && numbers.windows(2).all(|pair| pair[0] < pair[1])
            })
    }

    /// Notes the chosen columns whose name stands for several columns.
    fn note_names(&mut self, names: &[String]) {
        let mut twice: Vec<&str> = Vec::new();
        let mut notes = Vec::new();
        for column in &self.columns {
            let same = names.iter().filter(|name| **name == column.name).count();
            if same > 1 && !twice.contains(&column.name.as_str()) {
                twice.push(&column.name);
                let read = self.columns.iter().filter(|own| own.name == column.name);
                let read: Vec<String> = read.map(|own| (own.index + 1).to_string()).collect();
                let (name, count) = (&column.name, read.len());
                let which =
                    if count == 1 { "the one that is read is" } else { "those that are read are" };
                let read = read.join(", ");
                notes.push(
                    format!("{same} columns are called `{name}`; {which} column {read}").into(),
                );
            }
        }
        self.notes.append(&mut notes);
    }

    /// Decides the format of the times in `column`, and adds a note on the format for the user. `says` is the format
    /// that the column's name suggests.
    ///
    /// # Errors
    /// Returns an error that asks for the unit if it is a guess, and would give a rate that no inertial sensor has.
    fn read_times(
        &mut self,
        column: Column,
        says: Named,
        names: &[String],
        options: &InputOptions,
    ) -> Result<()> {
        let first = self.first(column.index);
        let says = options.time_unit.map_or(says, Named::In);
        // If no format fits, the first field that is not a time becomes an error with its line.
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
        let times: Option<Vec<i128>> = self.ahead.iter().map(|record| time.read(record)).collect();
        let name = &time.column.name;
        if let (Some(times), Reading::Numbers(unit), Named::Whole(_)) = (&times, reading, says)
            && let Some(rate) = odd_rate(times)
        {
            let column = name.clone();
            return Err(TableKind::WhichUnit { column, unit, rate }.at(&self.file));
        }
        let doubt = times.and_then(|times| implausible(&times));
        let mut note = Words::from(format!("times {how} from column `{name}`"));
        if let Some(what) = doubt {
            note = note.text(format_args!(": {what}; is ")).setting("time_unit").text(" another?");
        }
        self.notes.push(note);
        self.time = Some(time);
        Ok(())
    }

    /// Returns the fields of a column in the first rows, which were read in advance to find the format of the times.
    fn first(&self, index: usize) -> Vec<&[u8]> {
        self.ahead.iter().filter_map(|record| record.get(index)).map(<[u8]>::trim_ascii).collect()
    }

    /// Goes to the next row of samples; returns false at the end of the table.
    fn advance(&mut self) -> Result<bool> {
        while self.next_row()? {
            if !self.header.contains(&self.record) {
                return Ok(true);
            }
            self.repeated += 1;
        }
        if self.repeated > 0 {
            self.notes
                .push(format!("{} lines repeat the header and are left out", self.repeated).into());
        }
        Ok(false)
    }

    /// Goes to the next row, even if it repeats the header; returns false at the end of the table.
    fn next_row(&mut self) -> Result<bool> {
        let record = self.ahead.pop_front();
        self.was_ahead = record.is_some();
        if let Some(record) = record {
            self.record = record;
            return Ok(true);
        }
        let is_there = self.rows.next(&mut self.record, &self.file)?;
        let comments = if is_there { 0 } else { self.comments.take() };
        if comments > 0 {
            let what = "below the header begin with # or // and are left out";
            self.notes.push(format!("{comments} lines {what}").into());
        }
        if !is_there {
            self.notes.extend(std::mem::take(&mut self.rows.left_out).note());
            self.notes.extend(self.cut.take().map(Words::from));
        }
        Ok(is_there)
    }

    fn number(&self, column: &Column) -> Result<f64> {
        let field = self.record.get(column.index).unwrap_or_default().trim_ascii();
        if let Some(number) = number(field, self.has_decimal_commas) {
            return Ok(number);
        }
        if is_missing(field) {
            return Ok(f64::NAN);
        }
        Err(TableKind::NotANumber { value: shown(field) }.at(self.place(column)))
    }

    fn value(&self, column: &Column) -> Result<f64> {
        let value = self.number(column)?;
        if !value.is_finite() && !self.skip_non_finite {
            let field = self.record.get(column.index).unwrap_or_default().trim_ascii();
            let kind = match shown(field) {
                value if is_missing(field) => TableKind::Missing { value },
                value => TableKind::NotFinite { value },
            };
            return Err(kind.at(self.place(column)));
        }
        Ok(value)
    }

    /// Makes the error of a row whose time cannot be read.
    fn no_time(&self, time: &Time) -> Error {
        let field = self.record.get(time.column.index).unwrap_or_default();
        let value = shown(field.trim_ascii());
        TableKind::NotATime { value }.at(self.place(&time.column))
    }

    fn place(&self, column: &Column) -> Place {
        Place::spot(&self.file, Spot::Column(self.line(), column.name.clone()))
    }

    /// Returns the line at which the current row begins, counted from 1.
    fn line(&self) -> u64 {
        let record = &self.record;
        if self.was_ahead { line(record) } else { self.rows.line(record) }
    }
}

impl Time {
    /// Returns the time of a row, in ps. Returns `None` if the row's text in a column of times is not a valid time.
    fn read(&self, record: &ByteRecord) -> Option<i128> {
        let field = |column: &Column| record.get(column.index).unwrap_or_default().trim_ascii();
        let time = self.reading.read(field(&self.column), self.has_decimal_commas)?;
        match &self.nanoseconds {
            Some(column) => Some(
                time.saturating_add(Reading::Numbers(TimeUnit::Ns).read(field(column), false)?),
            ),
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
                let Some(picoseconds) = time.read(&self.record) else {
                    return Err(self.no_time(time));
                };
                chunk.times.push(microseconds(picoseconds));
            }
            self.count += 1;
        }
        if self.count == 0 {
            return Err(TableKind::NoSamples.at(&self.file));
        }
        Ok(())
    }

    fn names(&self) -> Vec<&str> {
        self.columns.iter().map(|column| column.name.as_str()).collect()
    }

    fn origin(&self) -> &[(&'static str, String)] {
        &self.origin
    }

    fn notes(&self) -> &[Words] {
        &self.notes
    }
}
/// Gives each of `columns` one name: leaves out the names of the header in `line` that have no column, and calls the
/// columns without a name by their number. Returns a note if the header had more names or fewer.
fn fit_names(names: &mut Vec<String>, line: u64, columns: usize) -> Option<Words> {
    let count = names.len();
    if count == columns {
        return None;
    }
    let rest = if count > columns {
        format!("the first {columns} are taken")
    } else {
        "the columns behind them are called by their number".to_owned()
    };
    names.truncate(columns);
    names.extend((count + 1..=columns).map(|number| number.to_string()));
    Some(format!("line {line} has {count} names for {columns} columns; {rest}").into())
}

/// Returns whether a field is a spelling of a missing value, such as `NA`.
pub(super) fn is_missing(field: &[u8]) -> bool {
    const WORDS: [&str; 10] = ["", "na", "n/a", "#n/a", "<na>", "null", "none", "-", "--", "?"];
    // As C writes NaN under Windows: `1.#QNAN`, `-1.#IND` and, of later versions, `-nan(ind)`.
    const STARTS: [&str; 5] = ["1.#qnan", "1.#snan", "1.#ind", "nan(", "-nan"];
    let bare = field.strip_prefix(b"-").unwrap_or(field);
    let begins = |start: &&str| {
        [field, bare].iter().any(|own| {
            own.get(..start.len()).is_some_and(|own| own.eq_ignore_ascii_case(start.as_bytes()))
        })
    };
    WORDS.iter().any(|word| field.eq_ignore_ascii_case(word.as_bytes()))
        || STARTS.iter().any(begins)
}

/// A reader of a table's rows that knows the line at which each row begins.
struct Rows {
    reader: Reader<Box<dyn Read>>,
    /// Whether the table's lines end in CR and LF. If they do, the CSV reader counts the LF as part of the next line.
    is_of_windows: bool,
    /// Number of lines that were added at the start of the text, such as a header. The file itself has no such lines.
    above: u64,
    /// Number of fields of the first row, which all rows must have. If the user named the header, that of the row below
    /// it.
    columns: Option<usize>,
    /// Whether the first row is a header that the user named.
    is_header_given: bool,
    /// Number of the line of the first row.
    first_line: u64,
    /// Number of rows that were read.
    count: u64,
    /// Whether rows with another number of fields are left out.
    leaves_out: bool,
    left_out: LeftOut,
}

/// The rows that were left out, as they have another number of fields than the header.
#[derive(Clone, Copy, Debug, Default)]
struct LeftOut {
    count: u64,
    /// Line of the first one.
    first: u64,
}

impl LeftOut {
    fn note(self) -> Option<Words> {
        let Self { count, first } = self;
        let what =
            "have another number of columns than the header and are left out, the first in line";
        (count > 0).then(|| format!("{count} lines {what} {first}").into())
    }
}

impl Rows {
    /// Makes a reader of the rows in `start`, followed by the rows in `input`. The reader counts comment lines in
    /// `count`. `above` is the number of lines at the beginning of `start` that are not in the file, such as a header
    /// that was added.
    fn new(
        start: Start,
        input: impl Read + 'static,
        delimiter: u8,
        above: u64,
        count: &Rc<Cell<u64>>,
    ) -> Self {
        let is_of_windows = start.is_of_windows();
        // With an end of line appended, the last line ends as all others do; an empty line is not a row.
        let end: &[u8] = if is_of_windows { b"\r\n" } else { b"\n" };
        count.set(start.comments_below());
        let rest = Comments { input, before: b'\n', held: None, count: count.clone() };
        let all = Cursor::new(start.text).chain(rest).chain(end);
        let all: Box<dyn Read> =
            if delimiter == b' ' { Box::new(OneBlank::new(all)) } else { Box::new(all) };
        let reader = ReaderBuilder::new()
            .buffer_capacity(1 << 18)
            .comment(Some(b'#'))
            .has_headers(false)
            .flexible(true)
            .delimiter(delimiter)
            .from_reader(all);
        Self {
            reader,
            is_of_windows,
            above,
            columns: None,
            is_header_given: false,
            first_line: 0,
            count: 0,
            leaves_out: false,
            left_out: LeftOut::default(),
        }
    }

    /// Reads the next row; returns false at the end of the table. A row may end in more delimiters than the first one,
    /// with nothing behind them, as some loggers write.
    fn next(&mut self, record: &mut ByteRecord, file: &str) -> Result<bool> {
        loop {
            let read = self.reader.read_byte_record(record);
            if !read.map_err(|error| TableKind::Unreadable { error }.at(file))? {
                return Ok(false);
            }
            self.count += 1;
            if self.count == 1 {
                self.first_line = self.line(record);
                if self.is_header_given {
                    return Ok(true);
                }
            }
            let expected = *self.columns.get_or_insert(record.len());
            let columns = record.len();
            if columns == expected {
                return Ok(true);
            }
            let mut rest = record.iter().skip(expected);
            if columns > expected && rest.all(|field| field.trim_ascii().is_empty()) {
                record.truncate(expected);
                return Ok(true);
            }
            let (line, columns, expected) = (self.line(record), columns as u64, expected as u64);
            // That the first row of all differs from the header is no fault of a row.
            if self.count == 2 && !self.is_header_given {
                let header = self.first_line;
                return Err(TableKind::OtherHeader { line, columns, expected, header }.at(file));
            }
            if !self.leaves_out {
                return Err(TableKind::Uneven { line, columns, expected }.at(file));
            }
            if self.left_out.count == 0 {
                self.left_out.first = line;
            }
            self.left_out.count += 1;
        }
    }

    /// Returns the number of the line at which the row in `record` begins. This row must be the row that was read last.
    /// The position stored in `record` is not used: it counts comments above the row as part of the row.
    fn line(&self, record: &ByteRecord) -> u64 {
        let within = record.as_slice().split(|byte| *byte == b'\n').skip(1).count() as u64;
        let ends = within + u64::from(!self.is_of_windows);
        self.reader.position().line().saturating_sub(ends + self.above).max(1)
    }
}

/// A reader that passes on its input, and counts the lines that begin with `#` or `//`. It passes on `//` as `#`, which
/// alone begins a comment for the reader of rows.
struct Comments<R> {
    input: R,
    /// The last byte that was passed on.
    before: u8,
    /// A `/` at the start of a line, as long as the byte after it is not read.
    held: Option<u8>,
    count: Rc<Cell<u64>>,
}

impl<R: Read> Read for Comments<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        if bytes.len() < 2 {
            // The reader of rows has a large buffer; no byte would be left for the one that is held.
            return Err(io::Error::other("no room for a byte that is held"));
        }
        let start = usize::from(self.held.is_some());
        bytes[..start].copy_from_slice(self.held.take().as_slice());
        let read = self.input.read(&mut bytes[start..])?;
        let is_over = read == 0;
        let mut end = start + read;
        for place in 0..end {
            let (own, next) = (bytes[place], bytes.get(place + 1).filter(|_| place + 1 < end));
            if self.before == b'\n' && own == b'/' {
                match next {
                    Some(b'/') => (bytes[place], bytes[place + 1]) = (b'#', b' '),
                    None if !is_over => {
                        self.held = Some(own);
                        end = place;
                        break;
                    }
                    _ => {}
                }
            }
            self.count
                .set(self.count.get() + u64::from(self.before == b'\n' && bytes[place] == b'#'));
            self.before = bytes[place];
        }
        // Nothing but the byte that is held was read.
        if end == 0 && !is_over { self.read(bytes) } else { Ok(end) }
    }
}

/// Reads the first rows, at most [`AHEAD`]. The caller finds the header and the format of the times in them. The
/// position of each returned row is set to the line at which the row begins.
fn ahead(rows: &mut Rows, file: &str) -> Result<VecDeque<ByteRecord>> {
    let mut records = VecDeque::new();
    let mut record = ByteRecord::new();
    while records.len() < AHEAD && rows.next(&mut record, file)? {
        let mut position = csv::Position::new();
        position.set_line(rows.line(&record));
        record.set_position(Some(position));
        records.push_back(record.clone());
    }
    Ok(records)
}

/// Returns the number of the line at which a row begins, counted from 1. The row must come from [`ahead`].
fn line(record: &ByteRecord) -> u64 {
    record.position().map_or(1, csv::Position::line)
}

/// Finds the column of nanoseconds that belongs to a column of whole seconds, such as `nsecs` to `secs`. ROS writes
/// times as such pairs of columns.
fn nanoseconds(seconds: &Column, names: &[String]) -> Option<Column> {
    let lower = seconds.name.to_lowercase();
    let stem = lower.strip_suffix("secs").or_else(|| lower.strip_suffix("sec"))?;
    let is_rest = |name: &str| {
        name.strip_prefix(stem).is_some_and(|word| matches!(word, "nsecs" | "nsec" | "nanosec"))
    };
    let index = names.iter().position(|name| is_rest(&name.to_lowercase()))?;
    Some(Column { index, name: names[index].clone() })
}

/// Returns the columns that a name stands for: one, or all that fit a pattern such as `gyro_*` or `gyro[0..3]`.
fn named(asked: &str, names: &[String], units: &[String], file: &str) -> Result<Vec<Column>> {
    if let Some(column) = all(names).find(|own| own.name == asked || with_unit(own, units) == asked)
    {
        return Ok(vec![column]);
    }
    let mut columns = Vec::new();
    for item in items(asked, MOST_ITEMS) {
        if !is_pattern(&item) {
            columns.push(find(&item, names, file)?);
            continue;
        }
        let before = columns.len();
        columns.extend(all(names).filter(|own| fits(&item, &own.name)));
        if columns.len() == before {
            let near = near(asked, names.iter().map(String::as_str));
            return Err(TableKind::NoColumn { name: item, near, comment: None }.at(file));
        }
    }
    Ok(columns)
}

/// Returns the columns with the three axes or more of the inertial sensor, or none.
fn sensor(signals: &[Column]) -> Vec<Column> {
    let names: Vec<String> = signals.iter().map(|own| own.name.clone()).collect();
    let axes = inertial::axes("", &names);
    let columns = axes.iter().filter_map(|axis| signals.iter().find(|own| own.name == *axis));
    if axes.len() < 3 { Vec::new() } else { columns.cloned().collect() }
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
        Ok(_) => {
            let number = asked.to_owned();
            Err(TableKind::NoColumnNumber { number, columns: names.len() }.at(file))
        }
        Err(_) => {
            let near = near(asked, names.iter().map(String::as_str));
            Err(TableKind::NoColumn { name: asked.to_owned(), near, comment: None }.at(file))
        }
    }
}

/// Returns all columns of a table.
fn all(names: &[String]) -> impl Iterator<Item = Column> {
    names.iter().enumerate().map(|(index, name)| Column { index, name: name.clone() })
}

/// Returns a column's name with the unit that the row below the header gives, such as `gyro_x (deg/s)`.
fn with_unit(column: &Column, units: &[String]) -> String {
    match units.get(column.index).filter(|unit| !unit.is_empty()) {
        Some(unit) => format!("{} ({unit})", column.name),
        None => column.name.clone(),
    }
}

/// Returns whether a name is that of a sensor's own stamps, and not of the times at which its samples arrived.
fn is_stamp(name: &str) -> bool {
    const STAMPS: [&str; 4] = ["header.stamp", "timestamp_sample", "time_usec", "timeus"];
    let name = name.to_lowercase();
    STAMPS.iter().any(|stamp| name.contains(stamp))
}

/// Adds to the error of a missing column that the comment in a line may hold its name.
fn with_comment(mut error: Error, line: Option<u64>) -> Error {
    if let (ErrorKind::Table(TableKind::NoColumn { comment, .. }), Some(_)) =
        (&mut *error.kind, line)
    {
        *comment = line;
    }
    error
}

/// Lists the first 20 names and the number of further names, because a table may have a million columns.
pub(super) fn first_of(names: &[String]) -> String {
    const MOST: usize = 20;
    let first = names.get(..MOST).unwrap_or(names).join(", ");
    match names.len().saturating_sub(MOST) {
        0 => first,
        more => format!("{first} and {more} more"),
    }
}

/// Returns the only column of signals.
///
/// # Errors
/// Returns an error if there is no such column, or if there are several.
fn only(signals: Vec<Column>, names: &[String], file: &str) -> Result<Column> {
    match <[Column; 1]>::try_from(signals) {
        Ok([column]) => Ok(column),
        Err(_) => Err(TableKind::WhichColumn { columns: first_of(names) }.at(file)),
    }
}
