//! A window of a few bytes that moves through a log.

use crate::Result;
use crate::bytes::Bytes;
use crate::faults::Faults;

/// Number of bytes in the window, unless the file ends. No message of a format that is read through a window is longer.
pub(crate) const AHEAD: usize = 4096;

/// Bytes read from a file that are not decoded yet.
pub(crate) struct Window {
    bytes: Bytes,
    held: Vec<u8>,
    /// Index in `held` of the first byte that is not decoded; the offset in the file of the first byte of `held`
    /// follows.
    at: usize,
    start: u64,
    is_read: bool,
}

impl Window {
    pub(crate) fn new(bytes: Bytes) -> Self {
        Self { bytes, held: Vec::new(), at: 0, start: 0, is_read: false }
    }

    /// Reads until the window holds [`AHEAD`] bytes, or the file ends.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read or decompressed, and damage is refused.
    pub(crate) fn fill(&mut self, faults: &mut Faults) -> Result<()> {
        const MORE: u64 = 1 << 16;
        if self.is_read || self.held.len() - self.at >= AHEAD {
            return Ok(());
        }
        self.held.drain(..self.at);
        self.start += self.at as u64;
        self.at = 0;
        let mut more = Vec::new();
        let at = self.bytes.at();
        match self.bytes.take(MORE, &mut more) {
            Ok(is_whole) => self.is_read = !is_whole,
            Err(error) => {
                faults.end(at, error)?;
                self.is_read = true;
            }
        }
        self.held.append(&mut more);
        Ok(())
    }

    /// Returns the bytes in the window.
    pub(crate) fn left(&self) -> &[u8] {
        &self.held[self.at..]
    }

    /// Returns the offset in the file of the first byte in the window.
    pub(crate) fn place(&self) -> u64 {
        self.start + self.at as u64
    }

    /// Skips this many bytes, or all in the window if there are fewer.
    pub(crate) fn pass(&mut self, count: usize) {
        self.at = self.held.len().min(self.at.saturating_add(count));
    }

    /// Returns whether the bytes in the window are the last of the file.
    pub(crate) fn is_at_end(&self) -> bool {
        self.is_read && self.left().len() < AHEAD
    }
}
