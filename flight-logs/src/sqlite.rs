//! Reads the tables of an `SQLite` database row by row. See <https://www.sqlite.org/fileformat.html>.

use super::bytes::{self, Bytes, is_packed};
use super::faults::Faults;
use crate::files::{self, File};
use crate::{Error, ErrorKind, Result};
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

/// First bytes of an `SQLite` database.
pub(crate) const START: &[u8] = b"SQLite format 3\0";

/// An open database file, decompressed.
pub(crate) struct Database {
    file: File,
    /// Size of a page in bytes.
    page: u64,
    /// Size of a page in bytes, without the bytes that the database reserves at the end of each page.
    used: u64,
    /// Number of pages in the file. The last one may be incomplete.
    pages: u64,
}

/// A table: the names of its columns, and the number of its root page.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    pub columns: Vec<String>,
    root: u64,
}

/// The rows of a table, read one by one in the order of their row numbers.
#[derive(Debug)]
pub(crate) struct Rows {
    /// Path in the table's tree of pages, from the root down to the current leaf. Each page comes with the index of its
    /// next unread cell, which is a row or a child page.
    stack: Vec<(Page, usize)>,
    /// Number of pages visited so far. If it exceeds the number of pages in the file, pages refer to each other in a
    /// circle.
    visited: u64,
    root: Option<u64>,
}

#[derive(Debug)]
struct Page {
    number: u64,
    bytes: Vec<u8>,
}

/// A row of a table: the values of its columns.
#[derive(Debug)]
pub(crate) struct Row {
    /// Offset in the file of the page that holds the row.
    pub at: u64,
    values: Vec<Value>,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    Null,
    Integer(i64),
    Real(f64),
    /// Bytes of a blob, or of a text.
    Blob(Vec<u8>),
}

impl Database {
    /// Opens a database. A compressed file is first decompressed to a temporary file.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, or is not a database.
    pub(crate) fn open(path: &Path) -> Result<Self> {
        let failed = |kind: fn(io::Error) -> ErrorKind| move |error| Error::of(path, kind(error));
        let mut file = bytes::open(path)?;
        if is_packed(path)? {
            // Pages are read in any order, which a compressed file does not allow.
            let mut unpacked = files::scratch().map_err(failed(ErrorKind::Unpack))?;
            Bytes::open(path)?.copy(&mut unpacked).map_err(failed(ErrorKind::Unpack))?;
            file = unpacked;
        }
        let length = file.seek(SeekFrom::End(0)).map_err(failed(ErrorKind::Read))?;
        let mut head = [0; 100];
        file.seek(SeekFrom::Start(0)).map_err(failed(ErrorKind::Read))?;
        file.read_exact(&mut head).map_err(failed(ErrorKind::ShortHead))?;
        let page = match u16::from_be_bytes([head[16], head[17]]) {
            1 => 1 << 16,
            size => u64::from(size),
        };
        let used = page.saturating_sub(head[20].into());
        if !head.starts_with(START) || !page.is_power_of_two() || used < 480 {
            let what = "not a database of SQLite, or its head is damaged";
            return Err(Error::not_a_log(path.display().to_string(), what));
        }
        Ok(Self { file, page, used, pages: length.div_ceil(page) })
    }

    /// Finds a table by its name; returns `None` if there is no such table.
    ///
    /// # Errors
    /// Returns an error if the database is damaged and damage is refused.
    pub(crate) fn table(&mut self, name: &str, faults: &mut Faults) -> Result<Option<Table>> {
        let mut rows = Rows::of(1);
        while let Some(row) = rows.next(self, faults)? {
            let text = |column| row.text(column);
            if text(0).as_deref() == Some("table") && text(1).as_deref() == Some(name) {
                let root = row.integer(3).and_then(|root| u64::try_from(root).ok());
                let columns = columns(&text(4).unwrap_or_default());
                return Ok(root.map(|root| Table { columns, root }));
            }
        }
        Ok(None)
    }

    fn read(&mut self, number: u64) -> Result<Page, String> {
        if number == 0 || number > self.pages {
            return Err(format!("page {number} is not there; {} are", self.pages));
        }
        let mut bytes = vec![0; self.page as usize];
        let read = self.file.seek(SeekFrom::Start((number - 1) * self.page));
        read.and_then(|_| self.file.read_exact(&mut bytes)).map_err(|error| {
            match error.kind() {
                io::ErrorKind::UnexpectedEof => format!("the file ends within its page {number}"),
                _ => format!("page {number}: {error}"),
            }
        })?;
        bytes.truncate(self.used as usize);
        Ok(Page { number, bytes })
    }

    /// Returns the content of a row, `length` bytes. The content starts in `cell`, and may continue on overflow pages.
    fn payload(&mut self, cell: &[u8], length: u64) -> Result<Vec<u8>, String> {
        if length > self.pages * self.page {
            return Err(format!("a row of {length} bytes is larger than the file"));
        }
        let most = self.used - 35;
        let least = (self.used - 12) * 32 / 255 - 23;
        let here = if length <= most {
            length
        } else {
            let here = least + (length - least) % (self.used - 4);
            if here <= most { here } else { least }
        };
        let short = || "a row ends before its content".to_owned();
        let (content, mut rest) = cell.split_at_checked(here as usize).ok_or_else(short)?;
        let mut content = content.to_vec();
        let mut left = length - here;
        let mut page;
        while left > 0 {
            let next = rest.first_chunk().ok_or_else(short)?;
            page = self.read(u32::from_be_bytes(*next).into())?;
            let count = left.min(self.used - 4) as usize;
            content.extend(page.bytes.get(4..4 + count).ok_or_else(short)?);
            left -= count as u64;
            rest = &page.bytes;
        }
        Ok(content)
    }
}

impl Table {
    pub(crate) fn rows(&self) -> Rows {
        Rows::of(self.root)
    }

    /// Returns the index of the column `name`.
    pub(crate) fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column == name)
    }
}

impl Rows {
    fn of(root: u64) -> Self {
        Self { stack: Vec::new(), visited: 0, root: Some(root) }
    }

    /// Reads the next row; returns `None` after the last. Damaged pages are skipped if damage is accepted.
    ///
    /// # Errors
    /// Returns an error if a page is damaged and damage is refused.
    pub(crate) fn next(
        &mut self,
        database: &mut Database,
        faults: &mut Faults,
    ) -> Result<Option<Row>> {
        loop {
            match self.step(database) {
                Ok(Step::Row(row)) => return Ok(Some(row)),
                Ok(Step::Other) => {}
                Ok(Step::End) => return Ok(None),
                Err((page, what)) => {
                    faults.skip(page.saturating_sub(1).saturating_mul(database.page), what)?;
                }
            }
        }
    }

    fn step(&mut self, database: &mut Database) -> Result<Step, (u64, String)> {
        if let Some(root) = self.root.take() {
            self.go(database, root)?;
        }
        let Some((page, cell)) = self.stack.last_mut() else { return Ok(Step::End) };
        let (number, at) = (page.number, *cell);
        *cell += 1;
        let fault = |what: &str| (number, format!("page {number}: {what}"));
        match page.cell(at) {
            Ok(Cell::Row { start }) => {
                let row = (|| {
                    let mut left = page.bytes.get(start..)?;
                    let (length, id) = (varint(&mut left)?, varint(&mut left)?);
                    Some((left.to_vec(), length, id as i64))
                })();
                let (cell, length, id) = row.ok_or_else(|| fault("a row has no length"))?;
                let content = database.payload(&cell, length).map_err(|what| fault(&what))?;
                let values = values(&content, id).ok_or_else(|| fault("a row ends too early"))?;
                Ok(Step::Row(Row { at: (number - 1) * database.page, values }))
            }
            Ok(Cell::Child(child)) => self.go(database, child.into()).map(|()| Step::Other),
            Ok(Cell::End) => {
                self.stack.pop();
                Ok(Step::Other)
            }
            Err(what) => {
                self.stack.pop();
                Err(fault(what))
            }
        }
    }

    fn go(&mut self, database: &mut Database, number: u64) -> Result<(), (u64, String)> {
        const DEEPEST: usize = 32;
        self.visited += 1;
        if self.stack.len() >= DEEPEST || self.visited > database.pages {
            self.stack.clear();
            return Err((number, "the table's pages lead to each other".to_owned()));
        }
        let page = database.read(number).map_err(|what| (number, what))?;
        self.stack.push((page, 0));
        Ok(())
    }
}

enum Step {
    Row(Row),
    Other,
    End,
}

enum Cell {
    Row { start: usize },
    Child(u32),
    End,
}

impl Page {
    /// Returns the cell at index `index` of the page: a row on a leaf page, the number of a child page on an inner
    /// page. After the last cell, returns [`Cell::End`].
    fn cell(&self, index: usize) -> Result<Cell, &'static str> {
        const SHORT: &str = "a cell is outside of it";
        // The first page begins with the file's header.
        let start = if self.number == 1 { 100 } else { 0 };
        let u16_at = |at: usize| {
            let bytes = self.bytes.get(at..)?.first_chunk()?;
            Some(usize::from(u16::from_be_bytes(*bytes)))
        };
        let u32_at = |at: usize| Some(u32::from_be_bytes(*self.bytes.get(at..)?.first_chunk()?));
        let count = u16_at(start + 3).ok_or(SHORT)?;
        let is_leaf = match self.bytes.get(start) {
            Some(13) => true,
            Some(5) => false,
            _ => return Err("it is no page of a table"),
        };
        let cells = start + if is_leaf { 8 } else { 12 };
        match index {
            _ if index < count => {
                let cell = u16_at(cells + 2 * index).ok_or(SHORT)?;
                if is_leaf {
                    Ok(Cell::Row { start: cell })
                } else {
                    u32_at(cell).map(Cell::Child).ok_or(SHORT)
                }
            }
            _ if index == count && !is_leaf => u32_at(start + 8).map(Cell::Child).ok_or(SHORT),
            _ => Ok(Cell::End),
        }
    }
}

impl Row {
    pub(crate) fn integer(&self, column: usize) -> Option<i64> {
        match self.values.get(column)? {
            Value::Integer(integer) => Some(*integer),
            Value::Real(real) => Some(*real as i64),
            _ => None,
        }
    }

    pub(crate) fn text(&self, column: usize) -> Option<String> {
        match self.values.get(column)? {
            Value::Blob(bytes) => Some(String::from_utf8_lossy(bytes).into_owned()),
            _ => None,
        }
    }

    /// Takes the bytes out of a column; returns `None` if the column holds a number or NULL.
    pub(crate) fn take_bytes(&mut self, column: usize) -> Option<Vec<u8>> {
        match self.values.get_mut(column)? {
            Value::Blob(bytes) => Some(std::mem::take(bytes)),
            _ => None,
        }
    }
}

/// Parses the values in a row's content. `id` is the number of the row. If the first column is the table's primary key,
/// `SQLite` stores NULL in place of the row's number; the column's value is then `id`.
fn values(content: &[u8], id: i64) -> Option<Vec<Value>> {
    let mut head = content;
    let length = usize::try_from(varint(&mut head)?).ok()?;
    let start = content.len() - head.len();
    let mut kinds = content.get(start..length)?;
    let mut left = content.get(length..)?;
    let mut take = |count: usize| {
        let (first, rest) = left.split_at_checked(count)?;
        left = rest;
        Some(first)
    };
    let mut values = Vec::new();
    while !kinds.is_empty() {
        let kind = varint(&mut kinds)?;
        values.push(match kind {
            0 if values.is_empty() => Value::Integer(id),
            0 => Value::Null,
            1..=4 => Value::Integer(integer(take(kind as usize)?)),
            5 => Value::Integer(integer(take(6)?)),
            6 => Value::Integer(integer(take(8)?)),
            7 => Value::Real(f64::from_be_bytes(*take(8)?.first_chunk()?)),
            8 | 9 => Value::Integer(kind as i64 - 8),
            12.. => Value::Blob(take(usize::try_from((kind - 12) / 2).ok()?)?.to_vec()),
            _ => return None,
        });
    }
    Some(values)
}

/// Parses a two's complement integer, big-endian.
fn integer(bytes: &[u8]) -> i64 {
    let start = if bytes.first().is_some_and(|first| first & 0x80 != 0) { -1 } else { 0 };
    bytes.iter().fold(start, |number, byte| (number << 8) | i64::from(*byte))
}

/// Removes an `SQLite` varint from the front of `bytes`: seven bits in each byte, high bits first, at most nine bytes.
fn varint(bytes: &mut &[u8]) -> Option<u64> {
    let mut number = 0_u64;
    for index in 0..9 {
        let (&byte, rest) = bytes.split_first()?;
        *bytes = rest;
        if index == 8 {
            return Some((number << 8) | u64::from(byte));
        }
        number = (number << 7) | u64::from(byte & 0x7f);
        if byte & 0x80 == 0 {
            return Some(number);
        }
    }
    None
}

/// Returns the names of the columns in a statement `CREATE TABLE name(column type, column type)`.
fn columns(statement: &str) -> Vec<String> {
    let inside = statement.split_once('(').map_or("", |(_, inside)| inside);
    let names = inside.split(',').filter_map(|column| column.split_whitespace().next());
    names.map(|name| name.trim_matches(['"', '`', '[', ']', ')']).to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::{Value, columns, integer, values, varint};

    #[test]
    fn numbers_and_rows() {
        for (mut bytes, number) in [
            (&[0x7f][..], 0x7f),
            (&[0x81, 0x00], 0x80),
            (&[0xff; 9], u64::MAX),
            (&[0x80, 0x80, 0x01], 1),
        ] {
            assert_eq!(varint(&mut bytes), Some(number));
            assert!(bytes.is_empty());
        }
        assert_eq!(varint(&mut &[0x81][..]), None);
        assert_eq!((integer(&[0xff, 0xfe]), integer(&[1, 0])), (-2, 256));
        let row = [5, 0, 1, 9, 17, 0xfb, b'h', b'i'];
        let blob = Value::Blob(b"hi".to_vec());
        let expected = [Value::Integer(7), Value::Integer(-5), Value::Integer(1), blob];
        assert_eq!(values(&row, 7).as_deref(), Some(&expected[..]));
        assert_eq!(values(&row[..6], 7), None);
    }

    #[test]
    fn columns_of_a_statement() {
        let statement = "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL, \"data\" BLOB)";
        assert_eq!(columns(statement), ["id", "topic_id", "data"]);
    }
}
