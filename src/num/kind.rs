//! What the bits of a sample mean: its type, in a byte.

/// The type of a sample, for those who have only its bits: a keyframe, a frame, a file.
///
/// Raw `i16` counts are fixed point without fraction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum SampleKind {
    /// `f32`.
    F32,
    /// Fixed point of 16 bits: `i16` and `FixedI16`.
    Fixed16 {
        /// How many of the bits are fraction, 0 to 16.
        fraction: u8,
    },
    /// Fixed point of 32 bits: `FixedI32`.
    Fixed32 {
        /// How many of the bits are fraction, 0 to 32.
        fraction: u8,
    },
}

const F32: u8 = 0;
/// The byte of a fraction of 0.
const FIXED_16: u8 = 1;
const FIXED_32: u8 = FIXED_16 + MAX_16 + 1;
const MAX_16: u8 = 16;
const MAX_32: u8 = 32;

impl SampleKind {
    /// The kind as a byte below 64: 0 for `f32`, from 1 on 16-bit fixed point by its fraction, from 18
    /// on 32-bit fixed point. A fraction above the largest counts as the largest.
    pub const fn to_byte(self) -> u8 {
        const fn within(fraction: u8, max: u8) -> u8 {
            if fraction > max { max } else { fraction }
        }
        match self {
            Self::F32 => F32,
            Self::Fixed16 { fraction } => FIXED_16 + within(fraction, MAX_16),
            Self::Fixed32 { fraction } => FIXED_32 + within(fraction, MAX_32),
        }
    }

    /// The kind of a byte; `None` above 50.
    pub const fn from_byte(byte: u8) -> Option<Self> {
        const LAST_16: u8 = FIXED_16 + MAX_16;
        const LAST_32: u8 = FIXED_32 + MAX_32;
        match byte {
            F32 => Some(Self::F32),
            FIXED_16..=LAST_16 => Some(Self::Fixed16 { fraction: byte - FIXED_16 }),
            FIXED_32..=LAST_32 => Some(Self::Fixed32 { fraction: byte - FIXED_32 }),
            _ => None,
        }
    }

    /// How many bytes a sample has: 2 or 4.
    pub const fn bytes(self) -> usize {
        match self {
            Self::Fixed16 { .. } => 2,
            Self::F32 | Self::Fixed32 { .. } => 4,
        }
    }
}
