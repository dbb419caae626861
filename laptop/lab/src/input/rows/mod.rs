//! Converts tables in other formats (JSON lines and arrays, `NumPy` arrays and Parquet) to the lines of a CSV table.
//!
//! The same rules for columns, times and missing values thus apply to all tables. A number that the file stores as text
//! keeps its digits. A binary number becomes the shortest text that reads back as the same number.

mod json;
mod numpy;
#[cfg(feature = "datasets")]
mod parquet;

use crate::Result;
use crate::input::TableKind;
use std::fs::File;
use std::io::{self, Read, Seek};
use std::path::Path;

/// First bytes of a file with one `NumPy` array.
const NPY: &[u8] = b"\x93NUMPY";
/// First bytes of an archive of `NumPy` arrays.
const NPZ: &[u8] = b"PK\x03\x04";
/// First bytes of a Parquet file.
#[cfg(feature = "datasets")]
const PARQUET: &[u8] = b"PAR1";

/// A table in a format other than CSV. Its rows are converted to lines of CSV.
trait Rows {
    /// Appends the next row to `text` as a line of CSV, with its line end. Returns false at the end of the table.
    fn next(&mut self, text: &mut Vec<u8>) -> io::Result<bool>;
}

/// A reader that converts a table's rows to CSV, and returns the CSV text as bytes.
struct Lines<T> {
    rows: T,
    text: Vec<u8>,
    at: usize,
}

impl<T: Rows> Lines<T> {
    /// Makes a reader whose CSV text starts with a header line. The header line holds `names`.
    fn new(names: impl IntoIterator<Item = String>, rows: T) -> Self {
        let mut text = Vec::new();
        for name in names {
            quote(&name, &mut text);
            text.push(b',');
        }
        end(&mut text);
        Self { rows, text, at: 0 }
    }
}

impl<T: Rows> Read for Lines<T> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        const MUCH: usize = 1 << 14;
        if self.at == self.text.len() {
            self.text.clear();
            self.at = 0;
            while self.text.len() < MUCH && self.rows.next(&mut self.text)? {}
        }
        let read = (&self.text[self.at..]).read(bytes)?;
        self.at += read;
        Ok(read)
    }
}

/// Replaces the comma at the end of a row by a line end.
fn end(text: &mut Vec<u8>) {
    match text.last_mut() {
        Some(last) => *last = b'\n',
        None => text.push(b'\n'),
    }
}

/// Appends `own` to `text` as a field of CSV, in quotes if necessary.
fn quote(own: &str, text: &mut Vec<u8>) {
    let is_plain = !own.contains([',', '"', '\n', '\r']) && !own.starts_with('#');
    if is_plain {
        text.extend(own.as_bytes());
        return;
    }
    text.push(b'"');
    for byte in own.bytes() {
        if byte == b'"' {
            text.push(b'"');
        }
        text.push(byte);
    }
    text.push(b'"');
}

/// Returns the table in an `.npz` archive or a Parquet file as CSV. These formats need random access. Returns `None` if
/// the first bytes of the file belong to neither format.
///
/// # Errors
/// Returns an error if the file is damaged, or holds no table.
pub(super) fn of_file(path: &Path, name: &str) -> Result<Option<Box<dyn Read>>> {
    let mut file = File::open(path)?;
    let mut start = Vec::new();
    file.by_ref().take(NPY.len() as u64).read_to_end(&mut start)?;
    file.rewind()?;
    if start.starts_with(NPZ) {
        return numpy::archive(file).map(Some).map_err(|error| error.at(name));
    }
    #[cfg(feature = "datasets")]
    if start.starts_with(PARQUET) {
        return parquet::open(file).map(Some).map_err(|error| error.at(name));
    }
    Ok(None)
}

/// Converts JSON lines, a JSON array of objects or a `NumPy` array to CSV. `head` holds the first bytes of the input. If these bytes belong to
/// none of these formats, returns `Ok(Err(input))` with the input unchanged.
///
/// # Errors
/// Returns an error if the first line or the header cannot be read, or holds no table.
pub(super) fn of_stream(
    head: &[u8],
    input: impl Read + 'static,
    name: &str,
) -> Result<Result<Box<dyn Read>, Box<dyn Read>>> {
    let read = if head.starts_with(NPY) {
        numpy::array(input)
    } else if head.trim_ascii_start().starts_with(b"{") {
        json::lines(input)
    } else if let Some(rest) = head.trim_ascii_start().strip_prefix(b"[")
        && rest.trim_ascii_start().starts_with(b"{")
    {
        json::array(input)
    } else {
        return Ok(Err(Box::new(input)));
    };
    read.map(Ok).map_err(|error| error.at(name))
}

/// Makes the error for a table that cannot be read, for the reason `what`.
fn odd(what: impl Into<String>) -> crate::Error {
    TableKind::OddTable { what: what.into() }.into()
}
