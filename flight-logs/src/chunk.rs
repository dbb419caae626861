//! Files whose messages lie in chunks, or outside of them.

use super::bytes::Bytes;
use super::faults::Faults;
use super::topic::Topic;
use super::{Entry, Log};
use crate::{Error, ErrorKind, Result};
use std::path::Path;

/// The chunk that is being read, unpacked.
#[derive(Default)]
pub(crate) struct Chunk {
    bytes: Vec<u8>,
    taken: usize,
    /// The chunk's place in the file.
    at: u64,
    /// Whether the chunk ends too early, which is counted already.
    is_cut: bool,
}

impl Chunk {
    /// Begins a chunk of `bytes`, and counts its fault unless the file ends within it, which is counted elsewhere.
    ///
    /// # Errors
    /// Returns an error if the chunk is damaged and that is not accepted.
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

    /// The bytes of the whole chunk.
    pub(crate) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The bytes that are still to be read.
    pub(crate) fn left(&self) -> &[u8] {
        &self.bytes[self.taken..]
    }

    /// The number of bytes read so far.
    pub(crate) fn taken(&self) -> usize {
        self.taken
    }

    /// The place of the chunk in the file.
    pub(crate) fn at(&self) -> u64 {
        self.at
    }

    /// Reads on up to this byte.
    pub(crate) fn take_to(&mut self, end: usize) {
        self.taken = end;
    }

    /// Gives up the bytes that are left, which make no record, and counts them as damage.
    ///
    /// # Errors
    /// Damage was not accepted.
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
    /// The chunk that is being read.
    pub chunk: Chunk,
    /// The content of the message that came last.
    pub message: Vec<u8>,
    /// Whether the last record outside of chunks was read.
    pub is_over: bool,
}

impl Walk {
    /// Opens a log that starts with the bytes of its version.
    ///
    /// # Errors
    /// Returns an error if the log cannot be read, or says so if it is of another version.
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
    /// A record outside of chunks, once it is read.
    type Record;

    /// The position in the log.
    fn walk(&self) -> &Walk;

    /// The position in the log, to be changed.
    fn walk_mut(&mut self) -> &mut Walk;

    /// Takes the next record of the chunk; gives the entry of a message.
    ///
    /// # Errors
    /// Returns an error if the log is damaged and that is not accepted.
    fn of_chunk(&mut self) -> Result<Option<Entry>>;

    /// Reads the next record outside of chunks; `None` at the end.
    ///
    /// # Errors
    /// See [`of_chunk`](Self::of_chunk).
    fn record(&mut self) -> Result<Option<Self::Record>>;

    /// Takes a record outside of chunks; gives the entry of a message.
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
