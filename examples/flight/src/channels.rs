//! From a sensor's counts to the samples of a flight's file.

use crate::Sample;
use crate::names::{G, RADIANS, axis};

/// Size of one count of a sensor: in rad/s for the turn rates, in m/s² for the accelerations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counts {
    /// rad/s of a count of a turn rate.
    pub rate: f64,
    /// m/s² of a count of an acceleration.
    pub acceleration: f64,
}

impl Counts {
    /// Returns what a count is, of 2¹⁵ for ranges in °/s and g.
    pub const fn of_ranges(degrees_a_second: f64, g: f64) -> Self {
        Self { rate: degrees_a_second * RADIANS / 32_768.0, acceleration: g * G / 32_768.0 }
    }
}

/// The axis of the sensor that each channel of a flight takes, and its samples for a count.
///
/// An axis is found by the channel's name: `gyro` or `rate`, or `acc`, then `x`, `y` or `z` (or 0, 1, 2) at the end, brackets and
/// a unit aside. So `gyro_x`, `gyro_x_dps`, `accelerometer_m_s2[2]` and `gyroADC[0]` are axes. The unit is that of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Channels<const N: usize> {
    axes: [usize; N],
    scales: [f32; N],
}

impl<const N: usize> Channels<N> {
    /// Finds the channels of a flight by the items of its module: `NAMES`, `SI` and `COUNTS`. For constants: a channel
    /// that a sensor does not have fails the build.
    ///
    /// # Panics
    /// Panics if a name is no axis, or a unit is missing, or is none of turn rates or of accelerations.
    #[must_use]
    pub const fn new(
        sensor: Counts,
        names: [&str; N],
        si: [[f64; 2]; N],
        counts: [f64; N],
    ) -> Self {
        let mut channels = Self { axes: [0; N], scales: [0.0; N] };
        let mut channel = 0;
        while channel < N {
            let axis = axis(names[channel]);
            let Some(axis) = axis else {
                panic!(
                    "a channel of flight.toml has no axis in its name, such as gyro_x or accel_z"
                )
            };
            let [rate, acceleration] = si[channel];
            let (count, unit) =
                if axis < 3 { (sensor.rate, rate) } else { (sensor.acceleration, acceleration) };
            assert!(
                unit > 0.0,
                "a channel's `unit` in flight.toml must be one such as rad/s, deg/s, m/s² or g"
            );
            channels.axes[channel] = axis;
            channels.scales[channel] = (count / unit * counts[channel]) as f32;
            channel += 1;
        }
        channels
    }

    /// Converts the sensor's counts.
    #[must_use]
    pub fn sample<S: OfCounts>(&self, counts: Sample) -> [S; N] {
        let mut scales = self.scales.iter();
        self.axes.map(|axis| {
            let count = counts.get(axis).copied().unwrap_or_default();
            S::of_counts(f32::from(count) * scales.next().copied().unwrap_or_default())
        })
    }
}

/// A sample that a sensor's counts become.
#[diagnostic::on_unimplemented(
    message = "a sensor's counts do not become `{Self}`",
    note = "`sample` in flight.toml may be \"f32\" or \"i16\" here"
)]
pub trait OfCounts: spikewire::Sample {
    /// Converts a value; whole numbers are the nearest one, or the end of their range.
    fn of_counts(value: f32) -> Self;
}

impl OfCounts for f32 {
    fn of_counts(value: f32) -> Self {
        value
    }
}

impl OfCounts for i16 {
    fn of_counts(value: f32) -> Self {
        nearest(value) as i16
    }
}

/// Half away from zero; the conversion then cuts, and ends at the range.
fn nearest(value: f32) -> f32 {
    value + 0.5_f32.copysign(value)
}
