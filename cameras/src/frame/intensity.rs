//! Grey levels: step forward and send-on-delta of each pixel.

use core::num::NonZeroU8;

use super::PixelCode;
use super::band::{Band, FOUR, lanes_of_bytes, quiet};
use crate::config::{unwrap, within};
use spikewire::ConfigError;

/// Step forward or send-on-delta of a pixel: an event for every threshold by which the sample lies beyond the base.
///
/// While `x > base + threshold` and there were fewer than `K` events: an event up, and `base += threshold`; downwards
/// alike. The first sample is the base and sends nothing.
///
/// - **Threshold:** 1 to 254 grey levels; the paper's figure has 1 and 10, with one event a frame. **K:** 1, or
///   [`with_most`](Self::with_most) 1 to 255.
/// - **Latency:** 0 frames. **State:** the base, 1 byte a pixel.
/// - **Work:** four pixels at once where nothing changes.
/// - **Error:** while a pixel changes by `K * threshold` a frame at most, the base stays within the threshold of its
///   samples.
///
/// Source: Dupeyroux et al. 2022, section V; Miskowicz, *Send-on-delta concept*, 2006.
///
/// ```
/// use spikewire_cameras::frame::{Intensity, PixelCode};
///
/// const PAPER: Intensity = Intensity::new(10);
/// assert_eq!(PAPER.steps(100, 110), 0); // strictly above
/// assert_eq!(PAPER.steps(100, 150), 1);
/// assert_eq!(PAPER.with_most(4).steps(100, 50), -4);
/// assert_eq!(Intensity::try_new(0).unwrap_err().to_string(), "threshold 0 must lie in 1..=254");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Intensity {
    threshold: u8,
    most: NonZeroU8,
}

impl Intensity {
    /// A code with this threshold, in grey levels, and one event a pixel and frame. For constants, where a bad
    /// threshold fails the build.
    ///
    /// # Panics
    /// Panics if the threshold is not within 1 to 254.
    pub const fn new(threshold: u8) -> Self {
        unwrap(Self::try_new(threshold))
    }

    /// A code with this threshold, in grey levels, and one event a pixel and frame.
    ///
    /// # Errors
    /// Returns an error if the threshold is not within 1 to 254.
    pub const fn try_new(threshold: u8) -> Result<Self, ConfigError> {
        match within("threshold", threshold as f64, 1.0, 254.0) {
            Ok(()) => Ok(Self { threshold, most: NonZeroU8::MIN }),
            Err(error) => Err(error),
        }
    }

    /// This code with at most this many events a pixel and frame, for constants: a bad number fails the build.
    ///
    /// # Panics
    /// Panics if the number is 0.
    #[must_use]
    pub const fn with_most(self, most: u8) -> Self {
        unwrap(self.try_with_most(most))
    }

    /// This code with at most this many events a pixel and frame.
    ///
    /// # Errors
    /// Returns an error if the number is 0.
    pub const fn try_with_most(self, most: u8) -> Result<Self, ConfigError> {
        match super::pixel::most(most) {
            Ok(most) => Ok(Self { most, ..self }),
            Err(error) => Err(error),
        }
    }

    /// The threshold, in grey levels.
    pub const fn threshold(&self) -> u8 {
        self.threshold
    }
}

impl PixelCode for Intensity {
    type Base = u8;
    type Pixel = u8;

    const START: u8 = 0;

    fn most(&self) -> NonZeroU8 {
        self.most
    }

    #[inline]
    fn base(&self, sample: u8) -> u8 {
        sample
    }

    #[inline]
    fn begin(&self, sample: u8) -> u8 {
        sample
    }

    #[inline]
    fn base_of(&self, pixel: u8) -> u8 {
        pixel
    }

    #[inline]
    fn steps(&self, pixel: u8, sample: u8) -> i16 {
        let threshold = self.threshold.into();
        super::pixel::steps((pixel.into(), sample.into()), (threshold, threshold), self.most)
    }

    #[inline]
    fn follow(&self, pixel: &mut u8, steps: i16) {
        *pixel = self.moved(*pixel, steps);
    }

    #[inline]
    fn moved(&self, base: u8, steps: i16) -> u8 {
        let way = i32::from(steps).wrapping_mul(self.threshold.into());
        i32::from(base).wrapping_add(way).clamp(0, 255) as u8
    }

    #[inline]
    fn value(&self, base: u8) -> u8 {
        base
    }

    #[inline]
    fn is_quiet(&self, pixel: u8, sample: u8) -> bool {
        pixel.abs_diff(sample) <= self.threshold
    }

    #[inline]
    fn quiet(&self, pixels: &[u8], samples: &[u8]) -> usize {
        let band = Band::new(self.threshold.into(), self.threshold.into());
        let fours = |bases: &[_], samples: &[_]| quiet_fours(band, bases, samples);
        quiet(pixels, samples, fours, |base, sample| self.is_quiet(base, sample))
    }
}

/// How many fours at the start of a row lie in their bands. A function of its own, so that its loop has all registers.
#[inline(never)]
fn quiet_fours(band: Band, bases: &[[u8; FOUR]], samples: &[[u8; FOUR]]) -> usize {
    let fours = bases.iter().zip(samples);
    fours
        .take_while(|&(&bases, &samples)| {
            band.holds(lanes_of_bytes(bases), lanes_of_bytes(samples))
        })
        .count()
}
