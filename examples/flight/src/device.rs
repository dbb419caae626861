//! An SPI device with the times that its chip asks for.

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::OutputPin;
use embedded_hal::spi::{ErrorType, Operation};
use embedded_hal_async::spi::{SpiBus, SpiDevice};
use embedded_hal_bus::spi::DeviceError;

/// The times of a device, in nanoseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Timing {
    /// From chip select's fall to the first clock edge, and from the last one to its rise.
    pub guard: u32,
    /// From the end of one transaction to the beginning of the next.
    pub pause: u32,
}

impl Timing {
    /// Returns the same times, for a bus with this clock in Hz. For constants. Not every HAL waits for the last half of a clock
    /// before it says that a transfer is done: chip select then rises behind it by the guard time alone.
    ///
    /// # Panics
    /// The guard time is shorter than half a period of the clock.
    #[must_use]
    pub const fn at(self, clock: u32) -> Self {
        let half_periods = 2 * self.guard as u64 * clock as u64;
        assert!(half_periods >= 1_000_000_000, "the guard time is half a period at least");
        self
    }
}

/// A device that has its bus for itself, as `ExclusiveDevice` of `embedded-hal-bus`, with guard times and a pause.
///
/// - **Waiting:** spins, as the times are short; [`Spin`](crate::Spin) never waits less than it is asked for, where a HAL's
///   own delay may.
/// - **Errors:** chip select rises, and the pause is kept, whatever happened. The first error is returned.
/// - **Dropped futures:** chip select rises at once.
#[derive(Debug)]
pub struct Device<B, S, W> {
    bus: B,
    select: S,
    wait: W,
    timing: Timing,
}

impl<B, S: OutputPin, W> Device<B, S, W> {
    /// Takes bus and chip select, which rises.
    ///
    /// # Errors
    /// Chip select cannot be set.
    pub fn new(bus: B, mut select: S, wait: W, timing: Timing) -> Result<Self, S::Error> {
        select.set_high()?;
        Ok(Self { bus, select, wait, timing })
    }

    /// The bus, the pin and what waits.
    pub fn release(self) -> (B, S, W) {
        (self.bus, self.select, self.wait)
    }
}

impl<B: ErrorType, S: OutputPin, W> ErrorType for Device<B, S, W> {
    type Error = DeviceError<B::Error, S::Error>;
}

impl<B: SpiBus, S: OutputPin, W: DelayNs> SpiDevice for Device<B, S, W> {
    async fn transaction(
        &mut self,
        operations: &mut [Operation<'_, u8>],
    ) -> Result<(), Self::Error> {
        let Self { bus, select, wait, timing } = self;
        let select = Selected(select);
        select.0.set_low().map_err(DeviceError::Cs)?;
        wait.delay_ns(timing.guard);
        let done = transfer(bus, wait, operations).await;
        // Or the last byte may still be on its way.
        let flushed = bus.flush().await;
        wait.delay_ns(timing.guard);
        let risen = select.0.set_high();
        wait.delay_ns(timing.pause);
        done.and(flushed).map_err(DeviceError::Spi)?;
        risen.map_err(DeviceError::Cs)
    }
}

async fn transfer<B: SpiBus>(
    bus: &mut B,
    wait: &mut impl DelayNs,
    operations: &mut [Operation<'_, u8>],
) -> Result<(), B::Error> {
    for operation in operations {
        match operation {
            Operation::Read(bytes) => bus.read(bytes).await?,
            Operation::Write(bytes) => bus.write(bytes).await?,
            Operation::Transfer(read, write) => bus.transfer(read, write).await?,
            Operation::TransferInPlace(bytes) => bus.transfer_in_place(bytes).await?,
            Operation::DelayNs(time) => {
                bus.flush().await?;
                wait.delay_ns(*time);
            }
        }
    }
    Ok(())
}

/// Chip select, which rises at the latest when this is dropped.
struct Selected<'a, S: OutputPin>(&'a mut S);

impl<S: OutputPin> Drop for Selected<'_, S> {
    fn drop(&mut self) {
        // Nobody is left who could be told.
        let _ = self.0.set_high();
    }
}
