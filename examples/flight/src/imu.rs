//! The contract of a sensor.

use embedded_hal_async::delay::DelayNs;
use spikewire::Start;

use crate::{Fault, Plan};

/// Number of channels of an IMU.
pub const CHANNELS: usize = 6;

/// Rates about x, y and z, then accelerations along them, in the sensor's counts.
pub type Sample = [i16; CHANNELS];

/// A sensor with a data-ready line, whose samples are coded in its own counts.
///
/// Counts need no floating point, and lose nothing: every core codes them alike.
pub trait Imu {
    /// The code of the channels.
    type Scheme: Start<Sample = i16> + 'static;

    /// One scheme for each channel, with its threshold in counts.
    const SCHEMES: [&'static Self::Scheme; CHANNELS];

    /// Timing of the samples, and the limits within which the sensor counts as alive.
    const PLAN: Plan;

    /// Resets the sensor, configures it, and reads back what was written. May be called at any time.
    ///
    /// # Errors
    /// Returns an error if the sensor is missing, is another one, or does not keep a setting.
    fn start(&mut self, delay: &mut impl DelayNs) -> impl Future<Output = Result<(), Fault>>;

    /// Reads the samples that wait, oldest first.
    ///
    /// # Errors
    /// Returns an error if the bus failed, or if what came is no sample of this sensor.
    fn read(
        &mut self,
    ) -> impl Future<Output = Result<Burst<impl ExactSizeIterator<Item = Option<Sample>>>, Fault>>;

    /// Empties a FIFO that ran over. Sensors without one need nothing.
    fn recover(&mut self) -> impl Future<Output = ()> {
        async {}
    }
}

/// Samples from one read.
#[derive(Clone, Copy, Debug)]
pub struct Burst<I> {
    /// Number of samples that the sensor held before the read. The last of them is its newest.
    pub held: usize,
    /// The oldest samples. `None` is a place without a valid sample.
    pub samples: I,
}

impl<I: ExactSizeIterator> Burst<I> {
    /// Number of samples that the sensor still holds.
    pub fn left(&self) -> usize {
        self.held.saturating_sub(self.samples.len())
    }
}

/// The schemes of a sensor, one for each channel.
pub type Schemes<I> = [&'static <I as Imu>::Scheme; CHANNELS];
