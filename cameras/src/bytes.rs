//! A cursor that writes into the caller's buffer and cannot panic.

/// A buffer, and how much of it is written.
#[derive(Debug)]
pub(crate) struct Cursor<'a> {
    bytes: &'a mut [u8],
    written: usize,
}

impl<'a> Cursor<'a> {
    pub(crate) fn new(bytes: &'a mut [u8]) -> Self {
        Self { bytes, written: 0 }
    }

    pub(crate) fn written(&self) -> usize {
        self.written
    }

    /// Appends all of `source`; writes nothing and returns `None` if it does not fit.
    pub(crate) fn put(&mut self, source: &[u8]) -> Option<()> {
        let end = self.written.checked_add(source.len())?;
        let target = self.bytes.get_mut(self.written..end)?;
        // A loop, since a copy of slices must compare their lengths, and can panic.
        for (target, &source) in target.iter_mut().zip(source) {
            *target = source;
        }
        self.written = end;
        Some(())
    }

    /// Appends a byte so many times, or as often as it fits, and returns how often.
    pub(crate) fn repeat(&mut self, byte: u8, times: usize) -> usize {
        let rest = self.bytes.get_mut(self.written..).unwrap_or_default();
        let times = times.min(rest.len());
        rest.get_mut(..times).unwrap_or_default().fill(byte);
        self.written = self.written.wrapping_add(times);
        times
    }
}
