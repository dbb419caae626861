//! The type of a sample as a value: floating point, or fixed point with a fraction.

/// The type of a sample, as a number of six bits that a link can carry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum SampleKind {
    /// `f32`.
    F32,
    /// A signed integer of 16 bits, such as `i16` or `FixedI16`.
    Fixed16 {
        /// How many bits stand after the binary point, 0 to 16.
        fraction: u8,
    },
    /// A signed integer of 32 bits, such as `FixedI32`.
    Fixed32 {
        /// How many bits stand after the binary point, 0 to 32.
        fraction: u8,
    },
}

impl SampleKind {
    const FIXED16: u8 = 1;
    const FIXED32: u8 = Self::FIXED16 + 17;

    /// A number below 64: 0 for `f32`, 1 to 17 for 16 bits, 18 to 50 for 32 bits.
    pub const fn to_byte(self) -> u8 {
        match self {
            Self::F32 => 0,
            Self::Fixed16 { fraction } => Self::FIXED16 + if fraction > 16 { 16 } else { fraction },
            Self::Fixed32 { fraction } => Self::FIXED32 + if fraction > 32 { 32 } else { fraction },
        }
    }

    /// The type of this number; `None` from 51 on.
    pub const fn from_byte(byte: u8) -> Option<Self> {
        match byte {
            0 => Some(Self::F32),
            Self::FIXED16..Self::FIXED32 => Some(Self::Fixed16 { fraction: byte - Self::FIXED16 }),
            Self::FIXED32..=50 => Some(Self::Fixed32 { fraction: byte - Self::FIXED32 }),
            _ => None,
        }
    }

    /// How many bytes a sample takes: 2 or 4.
    pub const fn size(self) -> usize {
        match self {
            Self::Fixed16 { .. } => 2,
            Self::F32 | Self::Fixed32 { .. } => 4,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::SampleKind;

    #[test]
    fn every_number_is_one_type() {
        let kinds: std::vec::Vec<_> = (0..=u8::MAX).filter_map(SampleKind::from_byte).collect();
        assert_eq!(kinds.len(), 1 + 17 + 33);
        for (byte, kind) in (0..).zip(kinds) {
            assert_eq!(kind.to_byte(), byte);
        }
    }
}
