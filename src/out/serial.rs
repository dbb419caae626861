//! The sink for UART and USB serial ports.

use embedded_io::{Write, WriteReady};

use super::{Batch, SinkError};
use crate::event::Source;

/// Sends items over an `embedded-io` writer.
///
/// - **Batches:** up to `N` bytes; `N` is at least [`Batch::SHORTEST`]. If the port takes fewer at a time, the sink
///   keeps the rest.
/// - **Errors:** the sink keeps the bytes that the port did not take. The next [`send`](Self::send) goes on from there:
///   no byte is sent twice or left out.
/// - **Waiting:** [`send`](Self::send) and [`flush`](Self::flush) wait as long as the port's own calls do: for ever on
///   a USB port that no host reads. [`try_send`](Self::try_send) never waits.
/// - **Buffers:** a port may itself keep up to a packet; [`flush`](Self::flush) sends it.
/// - **Memory:** `N` bytes, the port and the batch.
///
/// ```
/// use spikewire::{Event, FromEvents, Polarity, Tick, out::SerialSink};
/// use spikewire::link::{Coding, FrameView, Session, Transmitter};
///
/// let mut port = [0; 64];
/// let link = Transmitter::new(Coding::for_channels(6, 1_000), Session::counted(1));
/// let mut sink = SerialSink::<_, _, 512>::new(&mut port[..], link);
///
/// let event = Event { tick: Tick::from_micros(0), address: 5, polarity: Polarity::Up };
/// let sent = sink.send(FromEvents([event].into_iter()));
/// let (frame, length) = FrameView::new(&port)?;
/// assert!(frame.events().eq([event]));
/// assert_eq!(sent, Ok(length));
/// # Ok::<(), spikewire::link::LinkError>(())
/// ```
///
/// Batches too short for a frame do not compile:
///
/// ```compile_fail
/// # use spikewire::{link::{Coding, Session, Transmitter}, out::SerialSink};
/// # let mut port = [0; 64];
/// # let link = Transmitter::new(Coding::for_channels(6, 1_000), Session::counted(1));
/// let sink = SerialSink::<_, _, 5>::new(&mut port[..], link);
/// ```
#[derive(Debug)]
pub struct SerialSink<W, B, const N: usize> {
    port: W,
    batch: B,
    bytes: [u8; N],
    /// The range of `bytes` that waits to be sent.
    start: usize,
    end: usize,
}

impl<W: Write, B: Batch, const N: usize> SerialSink<W, B, N> {
    /// A sink on this port.
    pub const fn new(port: W, batch: B) -> Self {
        const { assert!(N >= B::SHORTEST, "a batch is too short: see Batch::SHORTEST") };
        Self { port, batch, bytes: [0; N], start: 0, end: 0 }
    }

    /// Sends a batch, and returns how many bytes the port took; 0 if there were no items.
    ///
    /// # Errors
    /// Returns an error if the port failed, or takes no more bytes.
    pub fn send(&mut self, mut events: impl Source) -> Result<usize, SinkError<W::Error>> {
        self.refill(&mut events);
        self.write(|_| Ok(true))
    }

    /// Sends the bytes that wait here, and then those that the port keeps. Call it when [`send`](Self::send) has
    /// returned 0, so that the end of a burst goes out.
    ///
    /// # Errors
    /// Returns an error if the port failed, or takes no more bytes.
    pub fn flush(&mut self) -> Result<(), SinkError<W::Error>> {
        self.write(|_| Ok(true))?;
        self.port.flush().map_err(SinkError::Bus)
    }

    /// Takes the next batch, unless bytes of the last one still wait.
    fn refill(&mut self, events: &mut impl Source) {
        if self.start == self.end {
            (self.start, self.end) = (0, self.batch.fill(events, &mut self.bytes));
        }
    }

    /// Writes the waiting bytes while the port is ready, and returns how many it took.
    fn write(
        &mut self,
        is_ready: impl Fn(&mut W) -> Result<bool, W::Error>,
    ) -> Result<usize, SinkError<W::Error>> {
        let before = self.start;
        while let Some(rest) = self.bytes.get(self.start..self.end).filter(|rest| !rest.is_empty())
        {
            if !is_ready(&mut self.port).map_err(SinkError::Bus)? {
                return Err(SinkError::Busy);
            }
            match self.port.write(rest).map_err(SinkError::Bus)? {
                0 => return Err(SinkError::Closed),
                taken => self.start = self.start.wrapping_add(taken.min(rest.len())),
            }
        }
        Ok(self.start.wrapping_sub(before))
    }

    /// The batch, for its counters.
    pub const fn batch(&mut self) -> &mut B {
        &mut self.batch
    }

    /// Number of bytes that wait for the next [`send`](Self::send).
    pub const fn waiting(&self) -> usize {
        self.end.wrapping_sub(self.start)
    }

    /// The port, for other uses.
    pub fn release(self) -> W {
        self.port
    }
}

impl<W: Write + WriteReady, B: Batch, const N: usize> SerialSink<W, B, N> {
    /// Sends a batch without waiting: asks the port before each write.
    ///
    /// # Errors
    /// Returns [`SinkError::Busy`] if the port has no room, and the rest waits for the next call. Otherwise returns
    /// those of [`send`](Self::send).
    pub fn try_send(&mut self, mut events: impl Source) -> Result<usize, SinkError<W::Error>> {
        self.refill(&mut events);
        self.write(W::write_ready)
    }
}
