//! Log intensity: a threshold of contrast, as in a dynamic vision sensor.

use core::num::NonZeroU8;

use super::PixelCode;
use super::band::{Band, FOUR, lanes_of_bytes, lanes_of_pairs, quiet};
use crate::config::{unwrap, within};
use spikewire::ConfigError;

/// The levels of a logarithm: `u8`, 46 of them for a factor of e, or `u16`, 1024.
///
/// Of a sample `v` the level is `S * f(v)`, rounded to the nearest (halves upwards), with `f(v) = v * ln(20) / 20` up
/// to 20 and `ln(v)` above: 0 to 255 in `u8` (S 46) and 0 to 5674 in `u16` (S 1024).
pub trait Level: Copy + Into<u16> + TryFrom<u16> + Sealed {
    /// Levels for a factor of e.
    const SCALE: u16;
    /// The level of a sample.
    fn of(sample: u8) -> Self;
}

/// Only `u8` and `u16` have a table.
pub trait Sealed {
    /// The level 0.
    const ZERO: Self;
    /// The level of the sample 255.
    const TOP: u16;
    /// Four levels in lanes of 16 bits.
    fn lanes(four: [Self; 4]) -> [u32; 2]
    where
        Self: Sized;
}

static FINE: [u16; 256] = table(<u16 as Level>::SCALE);
static COARSE: [u8; 256] = narrowed(&table(<u8 as Level>::SCALE));

impl Level for u16 {
    const SCALE: u16 = 1024;

    #[inline]
    fn of(sample: u8) -> u16 {
        FINE.get(usize::from(sample)).copied().unwrap_or_default()
    }
}

impl Sealed for u16 {
    const ZERO: u16 = 0;
    const TOP: u16 = level(255, <u16 as Level>::SCALE);

    #[inline]
    fn lanes(four: [u16; 4]) -> [u32; 2] {
        lanes_of_pairs(four)
    }
}

impl Level for u8 {
    const SCALE: u16 = 46;

    #[inline]
    fn of(sample: u8) -> u8 {
        COARSE.get(usize::from(sample)).copied().unwrap_or_default()
    }
}

impl Sealed for u8 {
    const ZERO: u8 = 0;
    const TOP: u16 = level(255, <u8 as Level>::SCALE);

    #[inline]
    fn lanes(four: [u8; 4]) -> [u32; 2] {
        lanes_of_bytes(four)
    }
}

const fn level(sample: u8, scale: u16) -> u16 {
    /// Up to this sample a line takes the place of the logarithm, which would go to minus infinity.
    const KNEE: f64 = 20.0;
    let sample = sample as f64;
    let log = if sample <= KNEE { ln(KNEE) * sample / KNEE } else { ln(sample) };
    (scale as f64 * log + 0.5) as u16
}

/// The natural logarithm of 1 to 255, to a few units in the last place: no level of these lies so near to a half.
///
/// With `x = 2^k * m`, `m` from 1 to 2 and `s = (m - 1) / (m + 1)`, it is `k ln 2 + 2 (s + s³/3 + s⁵/5 + ...)`; as `s` is
/// a third at most, the terms left out are below 3⁻⁴¹.
const fn ln(x: f64) -> f64 {
    let (mut power, mut mantissa) = (0.0, x);
    while mantissa >= 2.0 {
        mantissa /= 2.0;
        power += 1.0;
    }
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let (mut sum, mut odd) = (0.0, 39.0);
    while odd > 0.0 {
        sum = sum * s * s + 1.0 / odd;
        odd -= 2.0;
    }
    power * core::f64::consts::LN_2 + 2.0 * s * sum
}

// Constants have no iterators, and every index is compared first.
#[allow(clippy::indexing_slicing)]
const fn table(scale: u16) -> [u16; 256] {
    let mut table = [0; 256];
    let mut sample = 0;
    while sample < table.len() {
        table[sample] = level(sample as u8, scale);
        sample += 1;
    }
    table
}

#[allow(clippy::indexing_slicing)]
const fn narrowed(wide: &[u16; 256]) -> [u8; 256] {
    let mut table = [0; 256];
    let mut sample = 0;
    while sample < table.len() {
        table[sample] = wide[sample] as u8;
        sample += 1;
    }
    table
}

/// The code of a dynamic vision sensor: an event for every step of contrast, ON or OFF.
///
/// Send-on-delta as [`Intensity`](super::Intensity), of the sample's [level](Level) and with a threshold for each
/// direction. Levels come from a table.
///
/// - **Thresholds:** in levels, 1 to 5673 in `u16` and 1 to 254 in `u8`. 205 in `u16` is a contrast of 0.2 (a sample 22 %
///   brighter), as is 9 in `u8`, coarser.
/// - **K:** 1, or [`with_most`](Self::with_most) 1 to 255. **Latency:** 0 frames.
/// - **State:** the base, 2 bytes a pixel in `u16` and 1 in `u8`. **Flash:** 512 and 256 bytes for all encoders.
/// - **Error:** while a pixel's level changes by `K` thresholds a frame at most, the base stays within the threshold of
///   its level.
///
/// Source: Lichtsteiner et al., *A 128×128 vision sensor*, 2008; the curve is that of Hu, Liu, Delbruck, *v2e*, 2021,
/// which fires where a threshold is reached, and this code where it is exceeded.
///
/// ```
/// use spikewire_cameras::frame::{LogIntensity, PixelCode};
///
/// const DVS: LogIntensity<u16> = LogIntensity::<u16>::new(205, 205).with_most(4);
/// let base = DVS.base(100);
/// assert_eq!(DVS.steps(base, 150), 2);
/// assert_eq!(DVS.value(DVS.moved(base, 2)), 149);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct LogIntensity<L> {
    on: L,
    off: L,
    most: NonZeroU8,
}

impl<L: Level> LogIntensity<L> {
    /// A code with these thresholds, in levels, of brighter and darker samples, and one event a pixel and frame.
    ///
    /// # Errors
    /// Returns an error if a threshold is 0, or no less than the whole range of levels.
    pub fn try_new(on: L, off: L) -> Result<Self, ConfigError> {
        let most = f32::from(L::TOP - 1);
        within("ON threshold", f64::from(on.into()), 1.0, most)?;
        within("OFF threshold", f64::from(off.into()), 1.0, most)?;
        Ok(Self { on, off, most: NonZeroU8::MIN })
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
            Ok(most) => Ok(Self { on: self.on, off: self.off, most }),
            Err(error) => Err(error),
        }
    }

    /// The thresholds of brighter and darker samples, in levels.
    pub const fn thresholds(&self) -> (L, L) {
        (self.on, self.off)
    }

    fn levels(&self) -> (i32, i32) {
        (self.on.into().into(), self.off.into().into())
    }
}

macro_rules! constant {
    ($level:ty) => {
        impl LogIntensity<$level> {
            /// A code with these thresholds, in levels, of brighter and darker samples, and one event a pixel and
            /// frame. For constants, where a bad threshold fails the build.
            ///
            /// # Panics
            /// Panics if a threshold is 0, or no less than the whole range of levels.
            pub const fn new(on: $level, off: $level) -> Self {
                let most = (<$level as Sealed>::TOP - 1) as f32;
                unwrap(within("ON threshold", on as f64, 1.0, most));
                unwrap(within("OFF threshold", off as f64, 1.0, most));
                Self { on, off, most: NonZeroU8::MIN }
            }
        }
    };
}
constant!(u8);
constant!(u16);

impl<L: Level> PixelCode for LogIntensity<L> {
    type Base = L;
    type Pixel = L;

    const START: L = L::ZERO;

    fn most(&self) -> NonZeroU8 {
        self.most
    }

    #[inline]
    fn base(&self, sample: u8) -> L {
        L::of(sample)
    }

    #[inline]
    fn begin(&self, sample: u8) -> L {
        L::of(sample)
    }

    #[inline]
    fn base_of(&self, pixel: L) -> L {
        pixel
    }

    #[inline]
    fn steps(&self, pixel: L, sample: u8) -> i16 {
        let thresholds = (self.on.into(), self.off.into());
        super::pixel::steps((pixel.into(), L::of(sample).into()), thresholds, self.most)
    }

    #[inline]
    fn follow(&self, pixel: &mut L, steps: i16) {
        *pixel = self.moved(*pixel, steps);
    }

    #[inline]
    fn moved(&self, base: L, steps: i16) -> L {
        let (on, off) = self.levels();
        let way = i32::from(steps).wrapping_mul(if steps > 0 { on } else { off });
        let moved = i32::from(base.into()).wrapping_add(way).clamp(0, L::TOP.into());
        L::try_from(moved as u16).unwrap_or(base)
    }

    /// The sample whose level is nearest; the lower of two.
    fn value(&self, base: L) -> u8 {
        let twice = 2 * u32::from(base.into());
        let mut value = 0_u8;
        for bit in (0..8).rev() {
            let below = value | ((1 << bit) - 1);
            let edge = |sample| u32::from(L::of(sample).into());
            if twice > edge(below).wrapping_add(edge(below.saturating_add(1))) {
                value |= 1 << bit;
            }
        }
        value
    }

    #[inline]
    fn is_quiet(&self, pixel: L, sample: u8) -> bool {
        let (on, off) = self.levels();
        let level = u32::from(L::of(sample).into());
        let above = level.wrapping_add(off as u32).wrapping_sub(pixel.into().into());
        above <= on.wrapping_add(off) as u32
    }

    #[inline]
    fn quiet(&self, pixels: &[L], samples: &[u8]) -> usize {
        let band = Band::new(self.off.into(), self.on.into());
        let fours = |bases: &[_], samples: &[_]| quiet_fours(band, bases, samples);
        quiet(pixels, samples, fours, |base, sample| self.is_quiet(base, sample))
    }
}

/// How many fours at the start of a row lie in their bands. A function of its own, so that its loop has all registers.
#[inline(never)]
fn quiet_fours<L: Level>(band: Band, bases: &[[L; FOUR]], samples: &[[u8; FOUR]]) -> usize {
    let fours = bases.iter().zip(samples);
    fours
        .take_while(|&(&bases, &samples)| band.holds(L::lanes(bases), L::lanes(samples.map(L::of))))
        .count()
}
