//! The trait of sample types: the numbers that encoders take.

use core::fmt::Debug;

use bytemuck::Pod;
#[cfg(feature = "fixed")]
use fixed::{
    FixedI16, FixedI32,
    types::extra::{LeEqU16, LeEqU32},
};

use super::{
    Arithmetic, Binary, Field, Quiet, Rated, Recursive, SampleKind, Spaced, Stored, Summed,
    Totalled, Windowed, convert,
};

/// A number that comes from a sensor: `f32`, raw `i16` counts, or, with the feature `fixed`,
/// `FixedI16` and `FixedI32` with any fraction.
///
/// - `f32` uses only `+ - * /` and comparisons in a documented order, so that every machine gives
///   the same bits.
/// - Fixed point and counts are exact: the spikes are those of exact arithmetic on the same
///   samples. Values that leave the range of the type saturate.
///
/// The trait is sealed, and its arithmetic is the crate's own:
///
/// ```compile_fail
/// fn widened<S: spikewire::Sample>(sample: S) {
///     sample.widen();
/// }
/// ```
#[allow(private_bounds)] // what seals it
pub trait Sample:
    Copy
    + PartialOrd
    + Default
    + Debug
    + Pod
    + Send
    + Sync
    + Arithmetic
    + Binary
    + Windowed
    + Rated
    + Recursive
    + Spaced
    + Summed
    + Totalled
    + Field
    + Quiet
    + Stored
{
    /// The type, as a value.
    const KIND: SampleKind;

    /// The value as a double, exactly. For set-up, not for the hot path.
    fn to_f64(self) -> f64 {
        convert::to_f64(self)
    }

    /// The nearest value of this type, halves upwards, saturating; NaN gives 0 in fixed point.
    /// For set-up, not for the hot path.
    fn from_f64(value: f64) -> Self {
        convert::from_f64(value)
    }

    /// The bits; those of a 16-bit sample in the low half.
    fn to_bits32(self) -> u32;

    /// The sample of these bits.
    fn from_bits32(bits: u32) -> Self;
}

impl Sample for f32 {
    const KIND: SampleKind = SampleKind::F32;

    fn to_bits32(self) -> u32 {
        self.to_bits()
    }

    fn from_bits32(bits: u32) -> Self {
        Self::from_bits(bits)
    }
}

impl Sample for i16 {
    const KIND: SampleKind = SampleKind::Fixed16 { fraction: 0 };

    fn to_bits32(self) -> u32 {
        self.cast_unsigned().into()
    }

    fn from_bits32(bits: u32) -> Self {
        bits as i16
    }
}

#[cfg(feature = "fixed")]
impl<Frac: LeEqU16 + 'static + Send + Sync> Sample for FixedI16<Frac> {
    const KIND: SampleKind = SampleKind::Fixed16 { fraction: Self::FRAC_NBITS as u8 };

    fn to_bits32(self) -> u32 {
        self.to_bits().cast_unsigned().into()
    }

    fn from_bits32(bits: u32) -> Self {
        Self::from_bits(bits as i16)
    }
}

#[cfg(feature = "fixed")]
impl<Frac: LeEqU32 + 'static + Send + Sync> Sample for FixedI32<Frac> {
    const KIND: SampleKind = SampleKind::Fixed32 { fraction: Self::FRAC_NBITS as u8 };

    fn to_bits32(self) -> u32 {
        self.to_bits().cast_unsigned()
    }

    fn from_bits32(bits: u32) -> Self {
        Self::from_bits(bits as i32)
    }
}
