//! Reads the records of one kind from a file of a `FlySight` 2 as a table.
//!
//! Such a file begins with `$FLYS`. It names the columns and units of each kind in lines such as
//! `$COL,IMU,time,wx,wy` and `$UNIT,IMU,s,deg/s,deg/s`. Behind the line `$DATA`, each line is a record, such as
//! `$IMU,12.5,0.1,0.2`.

use super::{LogKind, near};
use crate::Result;
use crate::error::At;
use catalogue::run::Words;
use std::io::{self, BufRead, Read};

const START: &[u8] = b"$FLYS";
/// The records that are read unless others are chosen: those of the inertial sensor.
const USUAL: &str = "IMU";

/// Returns whether a file that begins with these bytes is one of a `FlySight` 2.
pub(super) fn is_start(bytes: &[u8]) -> bool {
    bytes.starts_with(START)
}

/// A reader of the lines of one kind, without the names of the kind. All other lines are empty, so that each keeps its
/// number.
pub(super) struct Records<R> {
    input: R,
    kind: String,
    /// The current line.
    line: Vec<u8>,
    /// Number of bytes of the line that were passed on.
    place: usize,
    /// The lines above the records, which were read to find the kinds.
    header: io::Cursor<Vec<u8>>,
}

impl<R: BufRead> Records<R> {
    /// Makes a reader of the records of the kind `topic`. Also returns a note for the user on the kinds.
    ///
    /// # Errors
    /// Returns an error if the input cannot be read, or if it has no such records.
    pub(super) fn new(mut input: R, topic: Option<&str>, file: &str) -> Result<(Self, Words)> {
        /// Longest header, in bytes.
        const LONGEST: u64 = 1 << 16;
        let mut header = Vec::new();
        let mut kinds: Vec<String> = Vec::new();
        loop {
            let start = header.len();
            input.by_ref().take(LONGEST).read_until(b'\n', &mut header).at(|| file)?;
            let line = String::from_utf8_lossy(&header[start..]);
            let kind = line.strip_prefix("$COL,").and_then(|rest| rest.split(',').next());
            kinds.extend(kind.map(str::to_owned));
            let is_over = line.is_empty() || line.starts_with("$DATA");
            if is_over || header.len() as u64 > LONGEST {
                break;
            }
        }
        let usual = kinds.iter().find(|kind| *kind == USUAL).or(kinds.first());
        let asked = topic.unwrap_or(usual.map_or(USUAL, String::as_str));
        if !kinds.iter().any(|kind| kind == asked) {
            let near = near(asked, kinds.iter().map(String::as_str));
            return Err(LogKind::NoTopic { topic: asked.to_owned(), near }.at(file));
        }
        let note = format!("a file of a FlySight 2: records {asked} of {}; ", kinds.join(", "));
        let note = Words::from(note).setting("topic").text(" chooses others");
        let kind = asked.to_owned();
        let header = io::Cursor::new(header);
        Ok((Self { input, kind, line: Vec::new(), place: 0, header }, note))
    }

    /// Reads the next line; returns false at the end.
    fn next_line(&mut self) -> io::Result<bool> {
        let mut line = Vec::new();
        self.header.read_until(b'\n', &mut line)?;
        if !line.ends_with(b"\n") {
            self.input.read_until(b'\n', &mut line)?;
        }
        let is_there = !line.is_empty();
        self.place = 0;
        let end =
            if line.ends_with(b"\r\n") { line.len() - 2 } else { line.len().saturating_sub(1) };
        let end = if line.ends_with(b"\n") { end } else { line.len() };
        match self.start_of_fields(&line) {
            Some(start) => drop(line.drain(..start)),
            None => drop(line.drain(..end)),
        }
        self.line = line;
        Ok(is_there)
    }

    /// Returns the offset of a line's fields, if the line is of the chosen kind.
    fn start_of_fields(&self, line: &[u8]) -> Option<usize> {
        let rest = line.strip_prefix(b"$")?;
        let rest =
            rest.strip_prefix(b"COL,").or_else(|| rest.strip_prefix(b"UNIT,")).unwrap_or(rest);
        let fields = rest.strip_prefix(self.kind.as_bytes())?.strip_prefix(b",")?;
        Some(line.len() - fields.len())
    }
}

impl<R: BufRead> Read for Records<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        if self.place == self.line.len() && !self.next_line()? {
            return Ok(0);
        }
        let rest = &self.line[self.place..];
        let count = rest.len().min(bytes.len());
        bytes[..count].copy_from_slice(&rest[..count]);
        self.place += count;
        Ok(count)
    }
}
