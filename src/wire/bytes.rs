//! A cursor that writes into the caller's buffer and cannot panic.

/// A buffer, and how much of it is written.
#[derive(Debug)]
pub(crate) struct Cursor<'a> {
    bytes: &'a mut [u8],
    written: usize,
    /// At most the buffer's length.
    limit: usize,
}

impl<'a> Cursor<'a> {
    pub(crate) fn new(bytes: &'a mut [u8]) -> Self {
        let limit = bytes.len();
        Self { bytes, written: 0, limit }
    }

    /// Begins behind this many bytes, which are [replaced](Self::replace) later, and ends at this limit, or so many bytes
    /// before the buffer does.
    #[inline]
    pub(crate) fn begin(&mut self, written: usize, limit: usize, left: usize) {
        let most = self.bytes.len().saturating_sub(left);
        self.limit = limit.min(most);
        self.written = written.min(most);
    }

    /// How many bytes there is room for.
    pub(crate) fn room(&self) -> usize {
        self.limit.saturating_sub(self.written)
    }

    pub(crate) fn written(&self) -> usize {
        self.written
    }

    /// Appends all of `source`; writes nothing and returns `None` if it does not fit.
    pub(crate) fn put(&mut self, source: &[u8]) -> Option<()> {
        let end = self.written.checked_add(source.len()).filter(|&end| end <= self.limit)?;
        let target = self.bytes.get_mut(self.written..end)?;
        for (target, &source) in target.iter_mut().zip(source) {
            *target = source;
        }
        self.written = end;
        Some(())
    }

    /// Appends so many of these bytes, for which there is room; the others are written behind them, and not appended. One
    /// store for all takes less than one for each.
    #[inline]
    pub(crate) fn put_some(&mut self, source: [u8; 4], count: usize) {
        let rest = self.bytes.get_mut(self.written..).unwrap_or_default();
        if let Some(slot) = rest.first_chunk_mut() {
            *slot = source;
            self.written = self.written.wrapping_add(count);
        }
    }

    /// The bytes written.
    pub(crate) fn as_slice(&self) -> &[u8] {
        self.bytes.get(..self.written).unwrap_or_default()
    }

    /// Takes the bytes written, for the lifetime of the buffer, and leaves none. (To consume the cursor instead would copy
    /// whatever it is a part of.)
    pub(crate) fn take(&mut self) -> &'a [u8] {
        let bytes: &'a mut [u8] = core::mem::take(&mut self.bytes);
        bytes.get(..self.written).unwrap_or_default()
    }

    /// Inserts a byte before one that is written, beyond the limit if need be; nothing if the buffer is full.
    pub(crate) fn insert(&mut self, at: usize, byte: u8) {
        let end = self.written.saturating_add(1);
        if let Some(moved) = self.bytes.get_mut(at..end) {
            let mut carried = byte;
            for slot in moved {
                core::mem::swap(slot, &mut carried);
            }
            self.written = end;
        }
    }

    /// Replaces a byte already written.
    pub(crate) fn replace(&mut self, at: usize, byte: u8) {
        if let Some(target) = self.bytes.get_mut(at) {
            *target = byte;
        }
    }

    /// Forgets what was written after the first `length` bytes.
    pub(crate) fn truncate(&mut self, length: usize) {
        self.written = self.written.min(length);
    }
}
