//! The sinks for SPI, blocking and asynchronous.

use core::convert::Infallible;

use embedded_hal::digital::{ErrorType, InputPin};

use super::{Batch, SinkError};
use crate::event::Source;

/// The ready pin of a receiver that has none: always high.
#[derive(Clone, Copy, Debug, Default)]
pub struct AlwaysReady;

impl ErrorType for AlwaysReady {
    type Error = Infallible;
}

impl InputPin for AlwaysReady {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(true)
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(false)
    }
}

/// The code that both sinks share; `$asynchronous` and `$wait` are empty for the blocking one.
macro_rules! spi_sink {
    ($(#[$documentation:meta])* $name:ident, $device:path, [$($asynchronous:tt)?], [$($wait:tt)*]) => {
        $(#[$documentation])*
        ///
        /// - **Batches:** up to `N` bytes, in one transaction; `N` is at least [`Batch::SHORTEST`].
        /// - **Ready pin:** high when the receiver takes bytes; invert a busy pin. It is read once a batch, and
        ///   never waited for.
        /// - **Errors:** the sink keeps the batch, and the next [`send`](Self::send) sends all of it again. A bus
        ///   that failed halfway may have delivered a part before, which the checksum and the number of a link's
        ///   frame sort out.
        /// - **Memory:** `N` bytes, the device, the pin and the batch.
        #[derive(Debug)]
        pub struct $name<D, B, const N: usize, R = AlwaysReady> {
            device: D,
            batch: B,
            ready: R,
            bytes: [u8; N],
            /// How many bytes of a batch wait to be sent.
            waiting: usize,
        }

        impl<D, B: Batch, const N: usize> $name<D, B, N> {
            /// A sink for a receiver that is always ready.
            pub const fn new(device: D, batch: B) -> Self {
                const { assert!(N >= B::SHORTEST, "a batch is too short: see Batch::SHORTEST") };
                Self { device, batch, ready: AlwaysReady, bytes: [0; N], waiting: 0 }
            }
        }

        impl<D: $device, B: Batch, const N: usize, R: InputPin> $name<D, B, N, R> {
            /// A sink for a receiver with a ready pin.
            pub const fn with_ready(device: D, batch: B, ready: R) -> Self {
                const { assert!(N >= B::SHORTEST, "a batch is too short: see Batch::SHORTEST") };
                Self { device, batch, ready, bytes: [0; N], waiting: 0 }
            }

            /// Sends a batch, and returns how many bytes it had; 0 if there were no items.
            ///
            /// # Errors
            /// Returns an error if the receiver is not ready, its pin cannot be read, or the bus failed.
            pub $($asynchronous)? fn send(
                &mut self,
                mut events: impl Source,
            ) -> Result<usize, SinkError<D::Error>> {
                if self.waiting == 0 {
                    self.waiting = self.batch.fill(&mut events, &mut self.bytes);
                }
                let Some(bytes) = self.bytes.get(..self.waiting).filter(|bytes| !bytes.is_empty())
                else {
                    return Ok(0);
                };
                match self.ready.is_high() {
                    Ok(true) => {}
                    Ok(false) => return Err(SinkError::Busy),
                    Err(_) => return Err(SinkError::Pin),
                }
                self.device.write(bytes)$($wait)*.map_err(SinkError::Bus)?;
                Ok(core::mem::take(&mut self.waiting))
            }

            /// The batch, for its counters.
            pub const fn batch(&mut self) -> &mut B {
                &mut self.batch
            }

            /// How many bytes wait for the next [`send`](Self::send).
            pub const fn waiting(&self) -> usize {
                self.waiting
            }

            /// The device and the pin, for other uses.
            pub fn release(self) -> (D, R) {
                (self.device, self.ready)
            }
        }
    };
}

spi_sink! {
    /// Sends items over an `embedded-hal` SPI device.
    ///
    /// With the batch of the example of [`Batch`], a byte an event:
    ///
    /// ```
    /// use embedded_hal_mock::eh1::spi::{Mock, Transaction};
    /// use spikewire::{Event, FromEvents, Polarity, Source, Tick, out::{Batch, SpiSink}};
    /// # struct Addresses;
    /// # impl Batch for Addresses {
    /// #     const SHORTEST: usize = 1;
    /// #     fn fill(&mut self, events: &mut impl Source, bytes: &mut [u8]) -> usize {
    /// #         let pairs = bytes.iter_mut().zip(core::iter::from_fn(|| events.take_event()));
    /// #         pairs.map(|(byte, event)| *byte = event.address as u8).count()
    /// #     }
    /// # }
    ///
    /// let spi = Mock::new(&[
    ///     Transaction::transaction_start(),
    ///     Transaction::write_vec(vec![5, 5]),
    ///     Transaction::transaction_end(),
    /// ]);
    /// let mut sink = SpiSink::<_, _, 64>::new(spi, Addresses);
    ///
    /// let event = Event { tick: Tick::from_micros(0), address: 5, polarity: Polarity::Up };
    /// assert_eq!(sink.send(FromEvents([event; 2].into_iter())), Ok(2));
    /// # sink.release().0.done();
    /// ```
    ///
    /// Batches too short for a frame of a link do not compile:
    ///
    /// ```compile_fail
    /// # use embedded_hal_mock::eh1::spi::Mock;
    /// # use spikewire::{link::{Coding, Session, Transmitter}, out::SpiSink};
    /// # let link = Transmitter::new(Coding::for_channels(6, 1_000), Session::counted(1));
    /// let spi = Mock::<u8>::new(&[]);
    /// let sink = SpiSink::<_, _, 5>::new(spi, link);
    /// ```
    SpiSink, embedded_hal::spi::SpiDevice, [], []
}

#[cfg(feature = "async")]
spi_sink! {
    /// Sends items over an `embedded-hal-async` SPI device; see [`SpiSink`].
    ///
    /// If the future of a `send` is dropped, the sink keeps the batch, and the next `send` sends all of it again.
    /// Until then a device such as the `ExclusiveDevice` of `embedded-hal-bus` leaves chip select low: the receiver
    /// sees part of a batch and then all of it in one selection, after which the reader of a link resynchronises.
    AsyncSpiSink, embedded_hal_async::spi::SpiDevice, [async], [.await]
}
