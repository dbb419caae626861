//! Finds the header of a table. The header is the first line or, in files of `EuRoC`, TUM-VI and `NumPy`, a comment
//! above the first row.

use super::csv::is_missing;
use super::text::name;
use super::time::number;
use csv::{ByteRecord, ReaderBuilder};
use std::collections::VecDeque;
use std::io::{self, BufRead, Read};

/// The comments at the start of a table, and the two lines after them.
pub(super) struct Start {
    /// The bytes of the comments and of the two lines after them, as in the file.
    pub text: Vec<u8>,
    /// Offset in `text` of the first line that is not a comment.
    line: usize,
    /// Offset in `text` of the second line after the comments.
    next: usize,
}

/// The names of a table's columns, and the delimiter between them.
pub(super) struct Header {
    pub names: Vec<String>,
    pub delimiter: u8,
}

impl Start {
    /// Reads the start of a table: the comments and empty lines at the top, the first line after them, and one more
    /// line.
    ///
    /// # Errors
    /// Returns an error if the input cannot be read.
    pub(super) fn read(input: &mut impl BufRead) -> io::Result<Self> {
        const LONGEST: u64 = 1 << 20;
        let mut text = Vec::new();
        loop {
            let line = text.len();
            input.by_ref().take(LONGEST).read_until(b'\n', &mut text)?;
            let is_passed = text[line..].starts_with(b"#") || text[line..].trim_ascii().is_empty();
            if text.len() == line || !is_passed {
                let next = text.len();
                input.by_ref().take(LONGEST).read_until(b'\n', &mut text)?;
                return Ok(Self { text, line, next });
            }
        }
    }

    /// Returns whether the lines end in CR and LF.
    pub(super) fn is_of_windows(&self) -> bool {
        self.text[..self.next].ends_with(b"\r\n")
    }

    /// Returns whether the second line after the comments at the start is itself a comment.
    pub(super) fn is_followed_by_comment(&self) -> bool {
        self.text[self.next..].starts_with(b"#")
    }

    /// Returns the delimiter that occurs most often in the first line after the comments. If the line contains no
    /// delimiter, returns a blank for aligned columns and a comma for all others.
    pub(super) fn delimiter(&self) -> u8 {
        let (header, row) = (&self.text[self.line..self.next], &self.text[self.next..]);
        match delimiter(header) {
            Some(found) => found,
            None if is_aligned(header, row) => b' ',
            None => b',',
        }
    }

    /// Searches the comments for the header: the last comment that contains no number and has as many fields as the
    /// line below the comments. Returns `None` if there is no such comment, or if the line below contains no number.
    /// `asked` is the delimiter, if the user gave one.
    pub(super) fn comment(&self, asked: Option<u8>) -> Option<Header> {
        let (above, line) = (&self.text[..self.line], &self.text[self.line..self.next]);
        let comments = above.split(|&byte| byte == b'\n').filter_map(|own| own.strip_prefix(b"#"));
        comments.rev().find_map(|comment| {
            let delimiter = asked
                .or_else(|| delimiter(comment))
                .unwrap_or_else(|| if is_aligned(comment, line) { b' ' } else { b',' });
            let (names, row) = (split(comment, delimiter), split(line, delimiter));
            let has_number = |row: &ByteRecord| row.iter().any(|own| is_number(own, delimiter));
            let is_header = names.len() == row.len() && has_number(&row) && !has_number(&names);
            is_header.then(|| Header { names: names.iter().map(name).collect(), delimiter })
        })
    }
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
