//! Bins of equal width over a range of values: one multiplication finds the bin of a value.

use super::LACKS_DIVISION;

/// Bins of equal width, numbered upwards from an origin; a value below the origin lies in bin 0.
///
/// Rounding may put a value close to a border into either bin, but into one and the same on every machine, and
/// a larger value never lies in a lower bin. So a table checked at its borders when it is built is right for
/// every value between them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct EvenBins {
    /// A float's bits, or an integer.
    origin: u32,
    /// Bins per unit. For floats their bits. For integers, from the lowest bit: 16 bits of factor, 8 bits of the
    /// shift that reduces a value to 16 bits, and 8 bits of the shift of the product.
    scale: u32,
}

impl EvenBins {
    /// A single bin, which holds all values.
    pub(crate) const ONE: Self = Self { origin: 0, scale: 0 };

    /// Whether there is a single bin.
    #[inline]
    pub(crate) const fn is_one(self) -> bool {
        self.scale == 0
    }

    /// Bins for `f32`; a single one if `1 / width` is not a positive finite `f32`.
    pub(crate) const fn of_floats(origin: f64, width: f64) -> Self {
        let scale = (1.0 / width) as f32;
        if scale > 0.0 && scale < f32::INFINITY {
            Self { origin: (origin as f32).to_bits(), scale: scale.to_bits() }
        } else {
            Self::ONE
        }
    }

    /// `count` bins for integers; origin and width in units of the last place.
    pub(crate) const fn of_integers(origin: f64, width: f64, count: usize) -> Self {
        let range = (width * count as f64) as u64;
        let mut shift = 0_u32;
        while range.wrapping_shr(shift) > 0xffff {
            shift = shift.wrapping_add(1);
        }
        let mut scale = 1_u64.wrapping_shl(shift) as f64 / width;
        let mut fraction = 0;
        while scale < 32_767.0 && fraction < 31 {
            scale *= 2.0;
            fraction += 1;
        }
        if scale < 65_535.0 {
            // Rounded up, so that a multiple of a width is not in the bin below.
            let scale = (scale as u32).wrapping_add(1);
            Self { origin: origin as i32 as u32, scale: fraction << 24 | shift << 16 | scale }
        } else {
            Self::ONE
        }
    }

    /// The bin of a float; 0 for NaN.
    #[inline]
    pub(crate) const fn of_float(self, value: f32) -> usize {
        ((value - f32::from_bits(self.origin)) * f32::from_bits(self.scale)) as u32 as usize
    }

    /// The bin of an integer of 32 bits, in units of the last place.
    #[inline]
    pub(crate) const fn of_integer(self, value: i32) -> usize {
        let Self { origin, scale } = self;
        let above = if value > origin as i32 { (value as u32).wrapping_sub(origin) } else { 0 };
        let above = above >> (scale >> 16 & 31);
        self.of_reduced(if above > 0xffff { 0xffff } else { above })
    }

    /// The bin of an integer of 16 bits, whose distance from the origin fits 32. A Cortex-M0 takes the other form, which
    /// is quicker there in most codes; slices of TTFS and of latency with phase take 3 and 4 % more by it.
    #[inline]
    pub(crate) const fn of_short(self, value: i16) -> usize {
        if LACKS_DIVISION {
            return self.of_integer(value as i32);
        }
        let above = (value as i32).wrapping_sub(self.origin as i32) >> (self.scale >> 16 & 31);
        let above = if above < 0 { 0 } else { above };
        self.of_reduced(if above > 0xffff { 0xffff } else { above } as u32)
    }

    /// The bin of a value this far above the origin, reduced to 16 bits.
    #[inline]
    const fn of_reduced(self, above: u32) -> usize {
        ((above * (self.scale & 0xffff)) >> (self.scale >> 24 & 31)) as usize
    }
}
