//! Refractory pixels: silent for some frames after an event.

use core::num::NonZeroU8;

use super::PixelCode;
use crate::config::{unwrap, within};
use spikewire::ConfigError;

/// A code whose pixels are silent for some frames after one with events, while their bases stay.
///
/// - **Frames:** 1 to 255. **State:** 1 byte a pixel more than the code's.
/// - **Error:** that of the code while a pixel is not silent. A pixel that changes while it is silent catches up
///   afterwards.
///
/// ```
/// use spikewire_cameras::frame::{Intensity, PixelCode, Refractory};
///
/// const FLOW: Refractory<Intensity> = Refractory::new(Intensity::new(10), 1);
/// let mut pixel = FLOW.begin(100);
/// let events = [120, 130, 130].map(|sample| {
///     let steps = FLOW.steps(pixel, sample);
///     FLOW.follow(&mut pixel, steps);
///     steps
/// });
/// assert_eq!(events, [1, 0, 1]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Refractory<C> {
    code: C,
    frames: u8,
}

impl<C: PixelCode> Refractory<C> {
    /// This code with this many frames of silence after an event, for constants: a bad number fails the build.
    ///
    /// # Panics
    /// Panics if the number is 0.
    pub const fn new(code: C, frames: u8) -> Self {
        unwrap(Self::try_new(code, frames))
    }

    /// This code with this many frames of silence after an event.
    ///
    /// # Errors
    /// Returns an error if the number is 0.
    pub const fn try_new(code: C, frames: u8) -> Result<Self, ConfigError> {
        match within("refractory frames", frames as f64, 1.0, 255.0) {
            Ok(()) => Ok(Self { code, frames }),
            Err(error) => Err(error),
        }
    }
}

/// The state of a pixel and the frames for which it stays silent: one byte more than the state.
#[derive(Clone, Copy, Debug)]
#[repr(C, packed)]
pub struct Resting<P: Copy> {
    pixel: P,
    frames: u8,
}

impl<C: PixelCode> PixelCode for Refractory<C> {
    type Base = C::Base;
    type Pixel = Resting<C::Pixel>;

    const START: Resting<C::Pixel> = Resting { pixel: C::START, frames: 0 };

    fn most(&self) -> NonZeroU8 {
        self.code.most()
    }

    #[inline]
    fn base(&self, sample: u8) -> C::Base {
        self.code.base(sample)
    }

    #[inline]
    fn begin(&self, sample: u8) -> Self::Pixel {
        Resting { pixel: self.code.begin(sample), frames: 0 }
    }

    #[inline]
    fn base_of(&self, pixel: Self::Pixel) -> C::Base {
        self.code.base_of(pixel.pixel)
    }

    #[inline]
    fn steps(&self, pixel: Self::Pixel, sample: u8) -> i16 {
        if pixel.frames > 0 { 0 } else { self.code.steps(pixel.pixel, sample) }
    }

    #[inline]
    fn follow(&self, pixel: &mut Self::Pixel, steps: i16) {
        pixel.frames = if steps == 0 { pixel.frames.saturating_sub(1) } else { self.frames };
        let mut inner = pixel.pixel;
        self.code.follow(&mut inner, steps);
        pixel.pixel = inner;
    }

    #[inline]
    fn moved(&self, base: C::Base, steps: i16) -> C::Base {
        self.code.moved(base, steps)
    }

    #[inline]
    fn value(&self, base: C::Base) -> u8 {
        self.code.value(base)
    }

    #[inline]
    fn is_quiet(&self, pixel: Self::Pixel, sample: u8) -> bool {
        pixel.frames == 0 && self.code.is_quiet(pixel.pixel, sample)
    }
}
