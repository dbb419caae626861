//! Finds the header of a table. The header is the first line or, in files of `EuRoC`, TUM-VI and `NumPy`, a comment
//! above the first row. Loggers and their viewers also write lines above it, such as settings.

use super::csv::is_missing;
use super::text::name;
use super::time::{Named, number, of_name};
use csv::{ByteRecord, ReaderBuilder};
use std::collections::VecDeque;
use std::io::{self, BufRead, Read};
use std::ops::Range;

/// The comments at the start of a table, and the lines after them that were read to find the header.
pub(super) struct Start {
    /// The bytes of the comments and of the lines after them. Lines that are left out are empty.
    pub text: Vec<u8>,
    /// Offset in `text` of the first line that is not left out and no comment.
    line: usize,
    /// Offset in `text` of the line after it.
    next: usize,
    /// The delimiter that a line such as `sep=;` names.
    separator: Option<u8>,
    /// Number of the header's line, counted from 1, if other lines than comments stand above it.
    pub header_line: Option<u64>,
    /// The line of the header that the user named.
    pub given_line: Option<u64>,
}

/// The names of a table's columns, and the delimiter between them.
pub(super) struct Header {
    pub names: Vec<String>,
    pub delimiter: u8,
}

/// Longest line that is read at the start of a table, in bytes.
const LONGEST: u64 = 1 << 20;

impl Start {
    /// Reads the start of a table: the comments and empty lines at the top, the first line after them, and one more
    /// line. Reads more lines if the first one is not the header of the second one.
    ///
    /// # Errors
    /// Returns an error if the input cannot be read.
    pub(super) fn read(input: &mut impl BufRead, delimiter: Option<u8>) -> io::Result<Self> {
        let mut start = Self::empty();
        start.read_first(input)?;
        if let Some(separator) = separator(&start.text[start.line..start.next]) {
            let rest = start.text.len() - start.next;
            start.leave_out(start.line..start.next);
            start.separator = Some(separator);
            start.first_of(start.text.len() - rest);
            start.read_line(input)?;
        }
        if !start.is_plain(delimiter) {
            start.search(input, delimiter)?;
        }
        Ok(start)
    }

    /// Reads the start of a table whose first line is known to hold the names.
    ///
    /// # Errors
    /// Returns an error if the input cannot be read.
    pub(super) fn read_plain(input: &mut impl BufRead) -> io::Result<Self> {
        let mut start = Self::empty();
        start.read_first(input)?;
        Ok(start)
    }

    /// Reads the start of a table whose header is line `number`, counted from 1. The lines above it are left out.
    ///
    /// # Errors
    /// Returns an error if the input cannot be read.
    pub(super) fn read_to(input: &mut impl BufRead, number: u64) -> io::Result<Self> {
        let mut start = Self::empty();
        for _ in 1..number {
            input.by_ref().take(LONGEST).read_until(b'\n', &mut start.text)?;
        }
        start.leave_out(0..start.text.len());
        start.line = start.text.len();
        input.by_ref().take(LONGEST).read_until(b'\n', &mut start.text)?;
        // The names may stand in a comment, which is none for the reader of rows then.
        let marks = start.text[start.line..].iter_mut().take_while(|byte| b"#/ ".contains(byte));
        marks.for_each(|byte| *byte = b' ');
        start.next = start.text.len();
        start.given_line = Some(number);
        input.by_ref().take(LONGEST).read_until(b'\n', &mut start.text)?;
        bare_comment(&mut start.text[start.next..]);
        Ok(start)
    }

    fn empty() -> Self {
        let (text, line, next) = (Vec::new(), 0, 0);
        Self { text, line, next, separator: None, header_line: None, given_line: None }
    }

    /// Reads comments and empty lines, the first line after them, and one more line.
    fn read_first(&mut self, input: &mut impl BufRead) -> io::Result<()> {
        loop {
            let line = self.read_line(input)?;
            let is_passed =
                is_comment(&self.text[line..]) || self.text[line..].trim_ascii().is_empty();
            if self.text.len() == line || !is_passed {
                (self.line, self.next) = (line, self.text.len());
                self.read_line(input)?;
                return Ok(());
            }
        }
    }

    /// Reads a line, and returns its offset in `text`.
    fn read_line(&mut self, input: &mut impl BufRead) -> io::Result<usize> {
        let line = self.text.len();
        input.by_ref().take(LONGEST).read_until(b'\n', &mut self.text)?;
        bare_comment(&mut self.text[line..]);
        Ok(line)
    }

    /// Empties lines, so that they still count as lines.
    fn leave_out(&mut self, lines: Range<usize>) {
        let ends = self.text[lines.clone()].iter().filter(|byte| matches!(byte, b'\r' | b'\n'));
        let ends: Vec<u8> = ends.copied().collect();
        self.text.splice(lines, ends);
    }

    /// Makes the line at this offset the first one.
    fn first_of(&mut self, line: usize) {
        let end = self.text[line..].iter().position(|byte| *byte == b'\n');
        (self.line, self.next) = (line, end.map_or(self.text.len(), |end| line + end + 1));
    }

    /// Returns whether no header needs to be searched: the first line holds names and the second one numbers, or both
    /// hold numbers alone.
    fn is_plain(&self, asked: Option<u8>) -> bool {
        let delimiter = asked.or(self.separator).unwrap_or_else(|| self.delimiter());
        let second = self.text[self.next..].split(|byte| *byte == b'\n').next().unwrap_or_default();
        if second.trim_ascii().is_empty() || self.is_followed_by_comment() {
            return self.next == self.text.len();
        }
        let first = split(&self.text[self.line..self.next], delimiter);
        let second = split(second, delimiter);
        let numbers = |row: &ByteRecord| row.iter().filter(|own| is_number(own, delimiter)).count();
        let (above, below) = (numbers(&first), numbers(&second));
        first.len() == second.len()
            && (above == 0 && below > 0 || above == first.len() && below == second.len())
    }

    /// Searches the header further below, and leaves out the lines above it if it is sure: they are of other columns, or
    /// hold texts where the rows below hold numbers.
    fn search(&mut self, input: &mut impl BufRead, asked: Option<u8>) -> io::Result<()> {
        /// Number of lines and of bytes within which a header is found.
        const MOST_LINES: usize = 256;
        const MOST: usize = 1 << 20;
        for _ in 0..MOST_LINES {
            let line = self.read_line(input)?;
            if line == self.text.len() || line > MOST {
                break;
            }
        }
        let Some(header) = header_among(&self.text, self.line, asked.or(self.separator)) else {
            return Ok(());
        };
        if header > self.line {
            let above = self.text[..header].split_inclusive(|byte| *byte == b'\n').count() as u64;
            self.header_line = Some(above + 1);
            let length = self.text.len();
            self.leave_out(self.line..header);
            self.first_of(header - (length - self.text.len()));
        }
        Ok(())
    }

    /// Returns whether the lines end in CR and LF.
    pub(super) fn is_of_windows(&self) -> bool {
        self.text[..self.next].ends_with(b"\r\n")
    }

    /// Returns whether the second line after the comments at the start is itself a comment.
    pub(super) fn is_followed_by_comment(&self) -> bool {
        is_comment(&self.text[self.next..])
    }

    /// Returns the number of comments after the first line, as far as lines were read.
    pub(super) fn comments_below(&self) -> u64 {
        let lines = self.text[self.next..].split(|byte| *byte == b'\n');
        lines.filter(|line| is_comment(line)).count() as u64
    }

    /// Returns the delimiter that occurs most often in the first line after the comments. If the line contains no
    /// delimiter, returns a blank for aligned columns and a comma for all others.
    pub(super) fn delimiter(&self) -> u8 {
        let header = &self.text[self.line..self.next];
        let row = self.text[self.next..]
            .split_inclusive(|byte| *byte == b'\n')
            .next()
            .unwrap_or_default();
        match self.separator.or_else(|| delimiter(header)) {
            Some(found) => found,
            None if is_aligned(header, row) => b' ',
            None => b',',
        }
    }

    /// Searches the comments for the header: the last comment that contains no number and has as many fields as the
    /// line below the comments. Returns `None` if there is no such comment, or if the line below contains no number.
    /// `asked` is the delimiter, if the user gave one.
    pub(super) fn comment(&self, asked: Option<u8>) -> Option<Header> {
        let line = &self.text[self.line..self.next];
        self.comments_above().into_iter().rev().find_map(|(_, comment)| names(comment, line, asked))
    }

    /// Returns the number of the last comment above the rows that seems to hold names, though not as many as there are
    /// columns: one of them is a name of times.
    pub(super) fn doubtful_comment(&self, asked: Option<u8>) -> Option<u64> {
        let mut comments = self.comments_above().into_iter().rev();
        let (number, _) = comments.find(|(_, comment)| {
            let delimiter = asked.or_else(|| delimiter(comment)).unwrap_or(b' ');
            let names = split(comment, delimiter);
            names.len() > 1
                && names.iter().any(is_time)
                && !names.iter().any(|own| is_number(own, delimiter))
        })?;
        Some(number)
    }

    /// Returns the comments above the first row, each with the number of its line, from 1. There are none if the user
    /// named the header.
    fn comments_above(&self) -> Vec<(u64, &[u8])> {
        let mut comments = Vec::new();
        if self.given_line.is_none() {
            for (number, line) in (1..).zip(self.text[..self.line].split(|&byte| byte == b'\n')) {
                comments.extend(line.strip_prefix(b"#").map(|comment| (number, comment)));
            }
        }
        comments
    }
}

/// Returns the names in a comment above a row, if they are as many as the row has fields. Names that are separated
/// otherwise than the row's fields are taken only behind a word such as `columns:`, or if one of them is a name of times:
/// else three words of a sentence would be the names of three columns.
fn names(comment: &[u8], line: &[u8], asked: Option<u8>) -> Option<Header> {
    let (comment, is_labelled) = without_label(comment);
    let usual = asked
        .or_else(|| delimiter(comment))
        .unwrap_or_else(|| if is_aligned(comment, line) { b' ' } else { b',' });
    let of_row = asked.or_else(|| delimiter(line)).unwrap_or(b' ');
    for delimiter in [usual, of_row] {
        let row = split(line, delimiter);
        let has_number = |row: &ByteRecord| row.iter().any(|own| is_number(own, delimiter));
        if !has_number(&row) {
            continue;
        }
        let candidates =
            [(usual, split(comment, usual)), (b' ', with_units(&split(comment, b' ')))];
        for (separator, names) in candidates {
            let is_sure = is_labelled || separator == delimiter || names.iter().any(is_time);
            if is_sure && names.len() == row.len() && !has_number(&names) {
                return Some(Header { names: names.iter().map(name).collect(), delimiter });
            }
        }
    }
    None
}

/// Removes a word such as `columns:` before the names in a comment. Also returns whether there was one.
fn without_label(comment: &[u8]) -> (&[u8], bool) {
    const LABELS: [&str; 6] =
        ["columns", "column names", "fields", "field names", "names", "header"];
    let end = comment.iter().position(|byte| *byte == b':').unwrap_or(0);
    let label = comment[..end].trim_ascii();
    let is_label = LABELS.iter().any(|own| label.eq_ignore_ascii_case(own.as_bytes()));
    (if is_label { &comment[end + 1..] } else { comment }, is_label)
}

/// Joins units in brackets to the names before them, as in `t (s) x (m)`.
fn with_units(words: &ByteRecord) -> ByteRecord {
    let mut names: Vec<Vec<u8>> = Vec::new();
    for word in words {
        let is_unit = matches!(word, [b'(', .., b')'] | [b'[', .., b']']);
        match names.last_mut().filter(|_| is_unit) {
            Some(name) => name.extend([b" ", word].concat()),
            None => names.push(word.to_vec()),
        }
    }
    names.into()
}

/// Returns whether a field of a header is a name of times.
fn is_time(field: &[u8]) -> bool {
    matches!(of_name(&name(field)), Some(Named::In(_) | Named::Whole(_)))
}

fn is_comment(line: &[u8]) -> bool {
    line.starts_with(b"#")
}

/// Turns the mark `//` at the start of a line into `#`, the only one that the reader of rows knows.
fn bare_comment(line: &mut [u8]) {
    if let [first @ b'/', second @ b'/', ..] = line {
        (*first, *second) = (b'#', b' ');
    }
}

/// Returns the delimiter that a line such as `sep=;` names. Spreadsheets read and write such lines.
fn separator(line: &[u8]) -> Option<u8> {
    let line = line.trim_ascii_end();
    let line = line.strip_prefix(b"\"").and_then(|own| own.strip_suffix(b"\"")).unwrap_or(line);
    match *line {
        [b's' | b'S', b'e' | b'E', b'p' | b'P', b'=', separator] => Some(separator),
        // The end of the line was taken for blanks.
        [b's' | b'S', b'e' | b'E', b'p' | b'P', b'='] => Some(b'\t'),
        _ => None,
    }
}

/// Finds the header among lines of text from the offset `from` on: the first line that holds texts where the rows below
/// hold numbers, and that has as many fields. A row of units may stand between. Returns the header's offset, or `None`
/// if there is none for sure.
fn header_among(text: &[u8], from: usize, asked: Option<u8>) -> Option<usize> {
    let mut offset = from;
    let mut lines: Vec<(usize, &[u8])> = Vec::new();
    for line in text[from..].split_inclusive(|byte| *byte == b'\n') {
        if !line.trim_ascii().is_empty() && !is_comment(line) {
            lines.push((offset, line));
        }
        offset += line.len();
    }
    let delimiter = asked.or_else(|| delimiter(lines.last()?.1))?;
    let rows: Vec<ByteRecord> = lines.iter().map(|(_, line)| split(line, delimiter)).collect();
    let table = Pattern::of_most(&rows[rows.len() / 2..], delimiter)?;
    let header = (0..rows.len()).find(|row| table.is_header(&rows[*row..]))?;
    Some(lines[header].0)
}

/// The columns that most rows of a table have.
struct Pattern {
    columns: usize,
    /// Indices of the columns that hold numbers or missing values.
    numeric: Vec<usize>,
    delimiter: u8,
}

impl Pattern {
    /// Finds the columns of a table. Returns `None` if there is but one column, if one of ten rows has other columns, or
    /// if no column holds numbers. The last row may be cut.
    fn of_most(rows: &[ByteRecord], delimiter: u8) -> Option<Self> {
        let same = |columns: usize| rows.iter().filter(|row| row.len() == columns).count();
        let columns = rows.iter().map(ByteRecord::len).max_by_key(|columns| same(*columns))?;
        if columns < 2 || same(columns) * 10 < rows.len() * 9 {
            return None;
        }
        let mut table = Self { columns, numeric: Vec::new(), delimiter };
        for column in 0..columns {
            let mut fields = rows.iter().filter_map(|row| row.get(column));
            let mut has_number = false;
            let are_values = fields.all(|field| {
                has_number |= is_number(field, delimiter);
                table.is_value(field)
            });
            if are_values && has_number {
                table.numeric.push(column);
            }
        }
        (!table.numeric.is_empty()).then_some(table)
    }

    fn is_value(&self, field: &[u8]) -> bool {
        is_number(field, self.delimiter) || is_missing(field.trim_ascii())
    }

    /// Returns the fields of a row in the columns of numbers, and none if the row has other columns.
    fn fields<'a>(&'a self, row: Option<&'a ByteRecord>) -> impl Iterator<Item = &'a [u8]> {
        let row = row.filter(|row| row.len() == self.columns);
        self.numeric.iter().filter_map(move |column| row?.get(*column))
    }

    fn is_row(&self, row: Option<&ByteRecord>) -> bool {
        self.fields(row).all(|field| self.is_value(field))
            && self.fields(row).any(|field| is_number(field, self.delimiter))
    }

    fn is_text(&self, row: Option<&ByteRecord>) -> bool {
        self.fields(row).count() > 0
            && self.fields(row).all(|field| !is_number(field, self.delimiter))
    }

    /// Returns whether the first of these rows holds names: it is followed by a row of numbers, perhaps with a row of
    /// units between.
    fn is_header(&self, rows: &[ByteRecord]) -> bool {
        let names = self.fields(rows.first()).filter(|field| !is_missing(field.trim_ascii()));
        let is_followed =
            self.is_row(rows.get(1)) || self.is_text(rows.get(1)) && self.is_row(rows.get(2));
        self.is_text(rows.first()) && names.count() * 2 > self.numeric.len() && is_followed
    }
}

/// Returns the units that the row below a header holds, one for each column, or `None` if it is a row of samples: a row
/// of units has no number, but stands above numbers, and has a text above one of them.
pub(super) fn units(rows: &VecDeque<ByteRecord>, delimiter: u8) -> Option<Vec<String>> {
    /// Units are short.
    const LONGEST: usize = 16;
    let (first, second) = (rows.front()?, rows.get(1)?);
    let is_number = |field: &[u8]| is_number(field, delimiter);
    let is_unit = |(place, field): (usize, &[u8])| {
        !is_missing(field.trim_ascii()) && second.get(place).is_some_and(is_number)
    };
    let are_units = first.iter().all(|field| !is_number(field) && field.len() <= LONGEST)
        && first.iter().enumerate().any(is_unit);
    let bare = |field: &[u8]| {
        let unit = name(field);
        let within = |open, close| unit.strip_prefix(open)?.strip_suffix(close).map(str::to_owned);
        within('(', ')').or_else(|| within('[', ']')).unwrap_or(unit)
    };
    are_units.then(|| first.iter().map(bare).collect())
}

/// Returns whether the first row of a table holds samples rather than names. A row without numbers holds names. A row
/// with a number holds samples, with one exception: if a text of the first row stands above a number of the second row,
/// the text is the name of a column, and the first row holds names.
pub(super) fn is_data(rows: &VecDeque<ByteRecord>, delimiter: u8) -> bool {
    let Some(first) = rows.front() else { return false };
    let is_number = |field: &[u8]| is_number(field, delimiter);
    let is_name = |(place, field): (usize, &[u8])| {
        let below = rows.get(1).and_then(|row| row.get(place));
        // pandas writes an index as the first column, and leaves its name empty.
        let is_text = if is_missing(field.trim_ascii()) { place == 0 } else { !is_number(field) };
        is_text && below.is_some_and(is_number)
    };
    first.iter().any(is_number) && !first.iter().enumerate().any(is_name)
}

fn is_number(field: &[u8], delimiter: u8) -> bool {
    number(field.trim_ascii(), delimiter != b',').is_some()
}

/// Returns whether a header and the row below are aligned by blanks: both have the same number of words, at least two,
/// and all words of the row are numbers.
fn is_aligned(header: &[u8], row: &[u8]) -> bool {
    let (names, row) = (split(header, b' '), split(row, b' '));
    names.len() > 1 && names.len() == row.len() && row.iter().all(|own| is_number(own, b' '))
}

/// Splits a line into the fields of a CSV record.
fn split(line: &[u8], delimiter: u8) -> ByteRecord {
    if delimiter == b' ' {
        let words = line.split(u8::is_ascii_whitespace);
        return words.filter(|word| !word.is_empty()).collect();
    }
    let mut record = ByteRecord::new();
    let mut builder = ReaderBuilder::new();
    let mut reader = builder.has_headers(false).delimiter(delimiter).from_reader(line.trim_ascii());
    // Reading from memory cannot fail, and a single record has no record before it to differ from in length.
    let _ = reader.read_byte_record(&mut record);
    record
}

/// Returns the delimiter that occurs most often in a line, outside of quotes. Returns `None` if the line has no
/// delimiter except blanks.
fn delimiter(header: &[u8]) -> Option<u8> {
    let mut is_quoted = false;
    let mut counts = [(b',', 0), (b';', 0), (b'\t', 0), (b'|', 0)];
    for byte in header.trim_ascii_end() {
        is_quoted ^= *byte == b'"';
        for (delimiter, count) in &mut counts {
            *count += u32::from(!is_quoted && byte == delimiter);
        }
    }
    // The comma comes last in reverse, and `max_by_key` returns the last of equals.
    let most = counts.into_iter().rev().max_by_key(|&(_, count)| count);
    most.filter(|&(_, count)| count > 0).map(|(found, _)| found)
}
