//! What a port is given, and where it lies.

use std::{convert::Infallible, ops::Range};

use embedded_io_async::{ErrorType, Write};
use flight::Bounced;

use crate::finish;

/// A port whose DMA reaches some addresses alone.
struct Port<'a> {
    reached: Range<*const u8>,
    sent: &'a mut Vec<u8>,
}

impl ErrorType for Port<'_> {
    type Error = Infallible;
}

impl Write for Port<'_> {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        let Range { start, end } = bytes.as_ptr_range();
        assert!(self.reached.start <= start && end <= self.reached.end, "DMA does not reach it");
        self.sent.extend(bytes);
        Ok(bytes.len())
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

#[test]
fn every_frame_leaves_from_memory_that_dma_reaches() {
    let (mut memory, mut sent) = ([0; 16], Vec::new());
    let port = Port { reached: memory.as_ptr_range(), sent: &mut sent };
    let mut port = Bounced::new(port, &mut memory);
    let frames: Vec<Vec<u8>> = (0..40).map(|length| (0..length).collect()).collect();
    for frame in &frames {
        finish(port.write_all(frame)).unwrap();
        finish(port.flush()).unwrap();
    }
    assert_eq!(sent, frames.concat());
}
