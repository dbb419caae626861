//! A sample as its bits.

use crate::Sample;

/// A sample whose bits a keyframe carries: 16 or 32. Sealed, as [`Sample`] is.
pub trait Raw: Sample {
    /// Whether it has 32 bits, not 16.
    const IS_WIDE: bool;

    /// The bits, in the low half if there are 16.
    fn to_raw(self) -> u32;

    /// The sample of these bits.
    fn from_raw(bits: u32) -> Self;
}

impl Raw for f32 {
    const IS_WIDE: bool = true;

    fn to_raw(self) -> u32 {
        self.to_bits()
    }

    fn from_raw(bits: u32) -> Self {
        Self::from_bits(bits)
    }
}

impl Raw for i16 {
    const IS_WIDE: bool = false;

    fn to_raw(self) -> u32 {
        self.cast_unsigned().into()
    }

    fn from_raw(bits: u32) -> Self {
        bits as i16
    }
}

#[cfg(feature = "fixed")]
impl<Frac: fixed::types::extra::LeEqU16 + 'static> Raw for fixed::FixedI16<Frac> {
    const IS_WIDE: bool = false;

    fn to_raw(self) -> u32 {
        self.to_bits().cast_unsigned().into()
    }

    fn from_raw(bits: u32) -> Self {
        Self::from_bits(bits as i16)
    }
}

#[cfg(feature = "fixed")]
impl<Frac: fixed::types::extra::LeEqU32 + 'static> Raw for fixed::FixedI32<Frac> {
    const IS_WIDE: bool = true;

    fn to_raw(self) -> u32 {
        self.to_bits().cast_unsigned()
    }

    fn from_raw(bits: u32) -> Self {
        Self::from_bits(bits as i32)
    }
}
