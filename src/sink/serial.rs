//! Events over a UART or USB serial port.

use embedded_io::Write;

use super::{Batch, SinkError};
use crate::EventSource;

/// Sends events over an `embedded-io` writer.
///
/// - **Batches:** up to `N` bytes, at least [`Batch::SHORTEST`]. A port may take fewer at a time; the
///   rest is kept.
/// - **Errors** come back with what was not taken kept: the next [`send`](Self::send) goes on there, so
///   that no byte is sent twice or left out.
/// - **Memory:** `N` bytes, and those of its parts.
///
/// ```
/// use spikewire::{Event, Polarity, format::{Edvs, EdvsTime}, sink::{Formatted, SerialSink}};
///
/// let mut port = [0; 4];
/// let format = Edvs::new(EdvsTime::None).encoder();
/// let mut sink = SerialSink::<_, _, 64>::new(&mut port[..], Formatted::new(format));
///
/// let event = Event { tick: 0, address: 5, polarity: Polarity::Up };
/// assert_eq!(sink.send([event, event].into_iter()), Ok(4));
/// assert_eq!(port, [0x80, 0x85, 0x80, 0x85]);
/// ```
///
/// Batches too short for an event do not compile:
///
/// ```compile_fail
/// # use spikewire::{format::{Edvs, EdvsTime}, sink::{Formatted, SerialSink}};
/// # let mut port = [0; 4];
/// let format = Edvs::new(EdvsTime::None).encoder();
/// let sink = SerialSink::<_, _, 5>::new(&mut port[..], Formatted::new(format));
/// ```
#[derive(Debug)]
pub struct SerialSink<W, B, const N: usize> {
    port: W,
    batch: B,
    bytes: [u8; N],
    /// What of the bytes waits to be sent.
    start: usize,
    end: usize,
}

impl<W: Write, B: Batch, const N: usize> SerialSink<W, B, N> {
    /// A sink on this port.
    pub const fn new(port: W, batch: B) -> Self {
        const { assert!(N >= B::SHORTEST, "a batch is too short: see Batch::SHORTEST") };
        Self { port, batch, bytes: [0; N], start: 0, end: 0 }
    }

    /// Sends a batch, and says how many bytes the port took; 0 if there was nothing to send.
    ///
    /// # Errors
    /// The port failed, or takes no more bytes.
    pub fn send(&mut self, mut events: impl EventSource) -> Result<usize, SinkError<W::Error>> {
        if self.start == self.end {
            (self.start, self.end) = (0, self.batch.fill(&mut events, &mut self.bytes));
        }
        let before = self.start;
        while let Some(rest) = self.bytes.get(self.start..self.end).filter(|rest| !rest.is_empty())
        {
            match self.port.write(rest) {
                Ok(0) => return Err(SinkError::Closed),
                Ok(taken) => self.start += taken.min(rest.len()),
                Err(error) => return Err(SinkError::Bus(error)),
            }
        }
        Ok(self.start - before)
    }

    /// What makes the bytes: for keyframes and counters.
    pub const fn batch(&mut self) -> &mut B {
        &mut self.batch
    }

    /// How many bytes wait for the next [`send`](Self::send).
    pub const fn waiting(&self) -> usize {
        self.end - self.start
    }

    /// The port, for other uses.
    pub fn release(self) -> W {
        self.port
    }
}
