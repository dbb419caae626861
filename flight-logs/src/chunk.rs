//! Reads logs that consist of records, some of which are chunks that contain further records: ROS 1 bags and MCAP
//! files.

use super::bytes::Bytes;
use super::faults::Faults;
use super::topic::Topic;
use super::{Entry, Log};
use crate::{Error, ErrorKind, Result};
use std::path::Path;

/// The current chunk, decompressed, and the position in it.
#[derive(Default)]
pub(crate) struct Chunk {
    bytes: Vec<u8>,
    taken: usize,
    /// Offset of the chunk in the file.
    at: u64,
    /// Whether the chunk is known to be incomplete. If so, its fault has already been counted.
    is_cut: bool,
}

impl Chunk {
    /// Makes `bytes` the current chunk, which starts at offset `at` in the file. Counts `fault`, if there is one, as
    /// damage. Set `is_last` if the file ends within the chunk; then `fault` is ignored, because the caller has already
    /// counted the missing bytes.
    ///
    /// # Errors
    /// Returns an error if a fault is counted and damage is refused.
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

    /// Returns all bytes of the chunk, decompressed.
    pub(crate) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Returns the bytes of the chunk that are not read yet.
    pub(crate) fn left(&self) -> &[u8] {
        &self.bytes[self.taken..]
    }

    /// Returns how many bytes of the chunk have been read so far.
    pub(crate) fn taken(&self) -> usize {
        self.taken
    }

    /// Returns the offset of the chunk in the file.
    pub(crate) fn at(&self) -> u64 {
        self.at
    }

    /// Marks all bytes of the chunk before index `end` as read.
    pub(crate) fn take_to(&mut self, end: usize) {
        self.taken = end;
    }

    /// Discards the rest of the chunk, whose bytes form no record. Counts the discarded bytes as damage, unless the
    /// chunk is known to be incomplete.
    ///
    /// # Errors
    /// Returns an error if damage is refused.
    pub(crate) fn leave(&mut self, faults: &mut Faults) -> Result<()> {
        let what = format!("the chunk is damaged at its byte {}", self.taken);
        self.taken = self.bytes.len();
        if self.is_cut { Ok(()) } else { faults.skip(self.at, what) }
    }
}

/// State of reading a log that consists of records and chunks.
pub(crate) struct Walk {
    pub bytes: Bytes,
    pub faults: Faults,
    pub topics: Vec<Topic>,
    /// The current chunk; empty between chunks.
    pub chunk: Chunk,
    /// Content of the message that was read last.
    pub message: Vec<u8>,
    /// Whether the last record outside chunks has been read.
    pub is_over: bool,
}

impl Walk {
    /// Opens a log, which must start with the bytes `version`.
    ///
    /// # Errors
    /// Returns an error if the log cannot be read. Returns an error with the text `other` if the log does not start
    /// with `version`.
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

/// A log that consists of records, some of which are chunks of records. A type that implements this trait also
/// implements [`Log`].
pub(crate) trait Chunked {
    /// A record outside of chunks, as the function `record` returns it.
    type Record;

    /// Returns the state of reading: file, faults, topics, current chunk and last message.
    fn walk(&self) -> &Walk;

    /// Returns the state of reading, as a mutable reference.
    fn walk_mut(&mut self) -> &mut Walk;

    /// Reads the next record in the current chunk. If the record is a message, returns its entry and stores its content
    /// in [`Walk::message`].
    ///
    /// # Errors
    /// Returns an error if the log is damaged and damage is refused.
    fn of_chunk(&mut self) -> Result<Option<Entry>>;

    /// Reads the next record outside of chunks; returns `None` at the end of the log.
    ///
    /// # Errors
    /// Returns an error if the log is damaged and damage is refused.
    fn record(&mut self) -> Result<Option<Self::Record>>;

    /// Processes a record outside of chunks. If the record is a message, returns its entry. If the record is a chunk,
    /// makes it the current chunk.
    ///
    /// # Errors
    /// Returns an error if the log is damaged and damage is refused.
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
