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
    /// Offset in the file of the first of the blank bytes before the window. They are no damage if the file ends with
    /// them.
    blank: Option<u64>,
}

impl Window {
    pub(crate) fn new(bytes: Bytes) -> Self {
        Self { bytes, held: Vec::new(), at: 0, start: 0, is_read: false, blank: None }
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

    /// Returns the number of equal bytes at index `at` of the window, if they are erased flash or a file that is longer
    /// than its log: bytes of 0 or 0xff, as many as no message begins with, or up to the end of the file.
    pub(crate) fn blank(&self, at: usize) -> Option<usize> {
        /// A message may well hold fewer equal bytes, but does not begin with them.
        const ENOUGH: usize = 16;
        let rest = self.left().get(at..)?;
        let first = *rest.first().filter(|first| matches!(first, 0 | 0xff))?;
        let count = rest.iter().take_while(|byte| **byte == first).count();
        (count >= ENOUGH || self.is_read && count == rest.len()).then_some(count)
    }

    /// Removes blank bytes from the front of the window, except for the last `few`, with which a message may begin.
    /// Returns false if there are none.
    pub(crate) fn pass_blank(&mut self, few: usize) -> bool {
        let Some(count) = self.blank(0) else { return false };
        let is_end = self.is_read && count == self.left().len();
        let passed = if is_end { count } else { count.saturating_sub(few) };
        self.blank.get_or_insert(self.offset());
        self.pass(passed);
        passed > 0
    }

    /// Returns the offset of the first of the blank bytes just before the window, if there are any, and forgets them.
    pub(crate) fn end_blank(&mut self) -> Option<u64> {
        self.blank.take()
    }

    /// Returns whether fewer than [`AHEAD`] bytes of the file remain. The window then holds all of them.
    pub(crate) fn is_at_end(&self) -> bool {
        self.is_read && self.left().len() < AHEAD
    }
}
