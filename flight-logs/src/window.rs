//! A window of the next bytes of a log, for formats whose messages are short.

use crate::Result;
use crate::bytes::Bytes;
use crate::faults::Faults;

/// Number of bytes in the window, except near the end of the file. In the formats that use a window, no message is
/// longer than this.
pub(crate) const AHEAD: usize = 4096;

/// The next bytes of a file, read but not yet decoded.
pub(crate) struct Window {
    bytes: Bytes,
    held: Vec<u8>,
    /// Index in `held` of the first byte that is not decoded.
    at: usize,
    /// Offset in the file of the first byte of `held`.
    start: u64,
    is_read: bool,
}

impl Window {
    pub(crate) fn new(bytes: Bytes) -> Self {
        Self { bytes, held: Vec::new(), at: 0, start: 0, is_read: false }
    }

    /// Reads bytes until the window holds at least [`AHEAD`] bytes, or the file ends. Bytes that cannot be read or
    /// decompressed count as damage, and nothing is read after them.
    ///
    /// # Errors
    /// Returns an error at such bytes if damage is refused.
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

    /// Returns the bytes in the window, at least [`AHEAD`] of them except near the end of the file.
    pub(crate) fn left(&self) -> &[u8] {
        &self.held[self.at..]
    }

    /// Returns the offset in the file of the window's first byte.
    pub(crate) fn offset(&self) -> u64 {
        self.start + self.at as u64
    }

    /// Removes `count` bytes from the front of the window, or all if there are fewer.
    pub(crate) fn pass(&mut self, count: usize) {
        self.at = self.held.len().min(self.at.saturating_add(count));
    }

    /// Returns whether fewer than [`AHEAD`] bytes of the file remain. The window then holds all of them.
    pub(crate) fn is_at_end(&self) -> bool {
        self.is_read && self.left().len() < AHEAD
    }
}
