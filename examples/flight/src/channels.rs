//! From a sensor's counts to the samples of a flight's file.

use crate::{CHANNELS, Sample};

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

/// rad of 1°.
const RADIANS: f64 = core::f64::consts::PI / 180.0;
/// m/s² of 1 g.
const G: f64 = 9.806_65;

/// The axis of the sensor that each channel of a flight takes, and its samples for a count.
///
/// An axis is found by the channel's name: `gyro` or `rate`, or `acc`, then `x`, `y` or `z` (or 0, 1, 2) at the end, brackets aside.
/// So `gyro_x`, `accelerometer_m_s2[2]` and `gyroADC[0]` are axes. The unit is that of the file; none means SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Channels<const N: usize> {
    axes: [usize; N],
    scales: [f32; N],
}

impl<const N: usize> Channels<N> {
    /// Finds the channels of a flight by the items of its module: `NAMES`, `UNITS` and `COUNTS`. For constants: a channel
    /// that a sensor does not have fails the build.
    ///
    /// # Panics
    /// Panics if a name is no axis, or a unit is neither `rad/s` nor `deg/s`, `m/s²` nor `g`.
    #[must_use]
    pub const fn new(sensor: Counts, names: [&str; N], units: [&str; N], counts: [f64; N]) -> Self {
        let mut channels = Self { axes: [0; N], scales: [0.0; N] };
        let mut channel = 0;
        while channel < N {
            let axis = axis(names[channel]);
            let Some(axis) = axis else {
                panic!(
                    "a channel of flight.toml has no axis in its name, such as gyro_x or accel_z"
                )
            };
            let Some(unit) = unit(units[channel], axis < 3) else {
                panic!("a unit in flight.toml is neither rad/s, deg/s, m/s² nor g")
            };
            let si = if axis < 3 { sensor.rate } else { sensor.acceleration };
            channels.axes[channel] = axis;
            channels.scales[channel] = (si / unit * counts[channel]) as f32;
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

/// Rates about x, y and z are 0 to 2, accelerations 3 to 5.
const fn axis(name: &str) -> Option<usize> {
    let bytes = name.as_bytes();
    let mut end = bytes.len();
    while end > 0 && matches!(bytes[end - 1], b']' | b')' | b' ') {
        end -= 1;
    }
    let letter = if end > 0 { bytes[end - 1].to_ascii_lowercase() } else { 0 };
    let own = match letter {
        b'x' | b'0' => 0,
        b'y' | b'1' => 1,
        b'z' | b'2' => 2,
        _ => return None,
    };
    if has(bytes, b"acc") {
        Some(CHANNELS / 2 + own)
    } else if has(bytes, b"gyro") || has(bytes, b"rate") {
        Some(own)
    } else {
        None
    }
}

/// How much of an SI unit a unit is.
const fn unit(unit: &str, is_rate: bool) -> Option<f64> {
    let bytes = unit.as_bytes();
    let known: &[(&[u8], f64)] = if is_rate {
        &[(b"", 1.0), (b"rad/s", 1.0), (b"deg/s", RADIANS), ("°/s".as_bytes(), RADIANS)]
    } else {
        &[(b"", 1.0), ("m/s²".as_bytes(), 1.0), (b"m/s^2", 1.0), (b"m/s2", 1.0), (b"g", G)]
    };
    let mut at = 0;
    while at < known.len() {
        if known[at].0.len() == bytes.len() && has(bytes, known[at].0) {
            return Some(known[at].1);
        }
        at += 1;
    }
    None
}

/// Whether a text has a part, in lower case or not.
const fn has(text: &[u8], part: &[u8]) -> bool {
    let mut start = 0;
    while start + part.len() <= text.len() {
        let mut at = 0;
        while at < part.len() && text[start + at].eq_ignore_ascii_case(&part[at]) {
            at += 1;
        }
        if at == part.len() {
            return true;
        }
        start += 1;
    }
    false
}
