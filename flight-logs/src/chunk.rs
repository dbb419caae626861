//! Reads files whose messages lie in chunks or between them.

use super::bytes::Bytes;
use super::faults::Faults;
use super::topic::Topic;
use super::{Entry, Log};
use crate::{Error, ErrorKind, Result};
use std::path::Path;

/// The current chunk, decompressed.
#[derive(Default)]
pub(crate) struct Chunk {
    bytes: Vec<u8>,
    taken: usize,
    /// Offset of the chunk in the file.
    at: u64,
    /// Whether the chunk ends early, which has been counted as a fault already.
    is_cut: bool,
}

impl Chunk {
    /// Begins a chunk of `bytes`, and counts its fault. If the file ends within the chunk the fault is counted
    /// elsewhere.
    ///
    /// # Errors
    /// Returns an error if the chunk is damaged and damage is refused.
    pub(crate) fn begin(
        &mut self,
        at: u64,
        (bytes, fault): (Vec<u8>, Option<String>),
        is_last: bool,
        faults: &mut Faults,
    ) -> Result<()> {
        *self = Self { bytes, taken: 0, at, is_cut: is_last || fault.is_some() };
        fault.filter(|_| !is_last).map_or(Ok(()), |what| faults.skip(at, what))
    }

    /// Returns the bytes of the whole chunk.
    pub(crate) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Returns the bytes that are not read yet.
    pub(crate) fn left(&self) -> &[u8] {
        &self.bytes[self.taken..]
    }

    /// Returns the number of bytes read so far.
    pub(crate) fn taken(&self) -> usize {
        self.taken
    }

    /// Returns the offset of the chunk in the file.
    pub(crate) fn at(&self) -> u64 {
        self.at
    }

    /// Marks the bytes before `end` as read.
    pub(crate) fn take_to(&mut self, end: usize) {
        self.taken = end;
    }

    /// Discards the remaining bytes, and counts them as damage: they form no record.
    ///
    /// # Errors
    /// Returns an error if damage is refused.
    pub(crate) fn leave(&mut self, faults: &mut Faults) -> Result<()> {
        let what = format!("the chunk is damaged at its byte {}", self.taken);
        self.taken = self.bytes.len();
        if self.is_cut { Ok(()) } else { faults.skip(self.at, what) }
    }
}

/// A position in a log of chunks.
pub(crate) struct Walk {
    pub bytes: Bytes,
    pub faults: Faults,
    pub topics: Vec<Topic>,
    /// The current chunk.
    pub chunk: Chunk,
    /// The content of the last message.
    pub message: Vec<u8>,
    /// Whether the last record outside chunks has been read.
    pub is_over: bool,
}

impl Walk {
    /// Opens a log, which must start with the bytes of its version.
    ///
    /// # Errors
    /// Returns an error if the log cannot be read, or if it is of another version, with the text `other`.
    pub(crate) fn open(path: &Path, faults: Faults, version: &[u8], other: &str) -> Result<Self> {
        let (mut bytes, mut start) = (Bytes::open(path)?, Vec::new());
        let taken = bytes.take(version.len() as u64, &mut start);
        taken.map_err(|error| Error::of(path, ErrorKind::Read(error)))?;
        if start != version {
            return Err(Error::not_a_log(faults.file(), other));
        }
        Ok(Self {
            bytes,
            faults,
            topics: Vec::new(),
            chunk: Chunk::default(),
            message: Vec::new(),
            is_over: false,
        })
    }
}

/// A log of records, some of which are chunks of records.
pub(crate) trait Chunked {
    /// A record outside chunks, as it is read.
    type Record;

    /// Returns the position in the log.
    fn walk(&self) -> &Walk;

    /// Returns the position in the log, for changes.
    fn walk_mut(&mut self) -> &mut Walk;

    /// Reads the next record of the chunk; returns the entry if it is a message.
    ///
    /// # Errors
    /// Returns an error if the log is damaged and damage is refused.
    fn of_chunk(&mut self) -> Result<Option<Entry>>;

    /// Reads the next record outside chunks; `None` at the end.
    ///
    /// # Errors
    /// See [`of_chunk`](Self::of_chunk).
    fn record(&mut self) -> Result<Option<Self::Record>>;

    /// Processes a record outside chunks; returns the entry if it is a message.
    ///
    /// # Errors
    /// See [`of_chunk`](Self::of_chunk).
    fn outside(&mut self, record: Self::Record) -> Result<Option<Entry>>;
}

impl<C: Chunked> Log for C {
    fn next(&mut self) -> Result<Option<Entry>> {
        loop {
            let entry = if !self.walk().chunk.left().is_empty() {
                self.of_chunk()?
            } else if self.walk().is_over {
                return Ok(None);
            } else if let Some(record) = self.record()? {
                self.outside(record)?
            } else {
                self.walk_mut().is_over = true;
                None
            };
            if entry.is_some() {
                return Ok(entry);
            }
        }
    }

    fn topics(&self) -> &[Topic] {
        &self.walk().topics
    }

    fn message(&self) -> &[u8] {
        &self.walk().message
    }

    fn faults(&mut self) -> &mut Faults {
        &mut self.walk_mut().faults
    }
}
