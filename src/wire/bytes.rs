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

    /// Keeps the buffer free from `limit` on.
    #[cfg(feature = "link")]
    pub(crate) fn set_limit(&mut self, limit: usize) {
        self.limit = limit.min(self.bytes.len());
    }

    /// How many bytes there is room for.
    #[cfg(feature = "link")]
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

    /// Appends a byte so many times, or as often as it fits, and returns how often.
    pub(crate) fn repeat(&mut self, byte: u8, times: usize) -> usize {
        let room = self.limit.saturating_sub(self.written);
        let (start, times) = (self.written, times.min(room));
        self.written = start.wrapping_add(times);
        self.bytes.get_mut(start..self.written).unwrap_or_default().fill(byte);
        times
    }

    /// The bytes written.
    #[cfg(feature = "link")]
    pub(crate) fn as_slice(&self) -> &[u8] {
        self.bytes.get(..self.written).unwrap_or_default()
    }

    /// The bytes written, for the lifetime of the buffer.
    #[cfg(feature = "link")]
    pub(crate) fn into_slice(self) -> &'a [u8] {
        self.bytes.get(..self.written).unwrap_or_default()
    }

    /// Replaces a byte already written.
    #[cfg(feature = "link")]
    pub(crate) fn replace(&mut self, at: usize, byte: u8) {
        if let Some(target) = self.bytes.get_mut(at) {
            *target = byte;
        }
    }

    /// Forgets what was written after the first `length` bytes.
    #[cfg(feature = "link")]
    pub(crate) fn truncate(&mut self, length: usize) {
        self.written = self.written.min(length);
    }
}
