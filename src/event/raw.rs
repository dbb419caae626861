//! A sample as its bits.

use crate::{Sample, SampleKind};

/// A sample whose bits a keyframe carries: 16 or 32. Sealed, as [`Sample`] is.
pub trait Raw: Sample {
    /// The type.
    const KIND: SampleKind;

    /// The bits, in the low half if there are 16.
    fn to_bits32(self) -> u32;

    /// The sample of these bits.
    fn from_bits32(bits: u32) -> Self;
}

impl Raw for f32 {
    const KIND: SampleKind = SampleKind::F32;

    fn to_bits32(self) -> u32 {
        self.to_bits()
    }

    fn from_bits32(bits: u32) -> Self {
        Self::from_bits(bits)
    }
}

impl Raw for i16 {
    const KIND: SampleKind = SampleKind::Fixed16 { fraction: 0 };

    fn to_bits32(self) -> u32 {
        self.cast_unsigned().into()
    }

    fn from_bits32(bits: u32) -> Self {
        bits as i16
    }
}

#[cfg(feature = "fixed")]
impl<Frac: fixed::types::extra::LeEqU16 + 'static> Raw for fixed::FixedI16<Frac> {
    const KIND: SampleKind = SampleKind::Fixed16 { fraction: Self::FRAC_NBITS as u8 };

    fn to_bits32(self) -> u32 {
        self.to_bits().cast_unsigned().into()
    }

    fn from_bits32(bits: u32) -> Self {
        Self::from_bits(bits as i16)
    }
}

#[cfg(feature = "fixed")]
impl<Frac: fixed::types::extra::LeEqU32 + 'static> Raw for fixed::FixedI32<Frac> {
    const KIND: SampleKind = SampleKind::Fixed32 { fraction: Self::FRAC_NBITS as u8 };

    fn to_bits32(self) -> u32 {
        self.to_bits().cast_unsigned()
    }

    fn from_bits32(bits: u32) -> Self {
        Self::from_bits(bits as i32)
    }
}
