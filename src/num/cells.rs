//! Even cells on the line of values: one multiplication tells about where a value lies.

/// Cells of one width, counted upwards from an origin; what lies below it lies in the first.
///
/// Rounding decides which of two cells a value close to their border lies in, on every machine alike; and no
/// value lies in a lower cell than a smaller one. So what is true of the borders that a table is made of,
/// asked when it is made, holds for all the values between them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Cells {
    /// A float's bits, or an integer.
    origin: u32,
    /// Cells for 1: a float's bits; of integers 16 bits of them, 8 bits of the shift that leaves 16 bits of
    /// a value, and 8 bits of the shift that ends the product.
    scale: u32,
}

impl Cells {
    /// All values lie in the first.
    pub(crate) const ONE: Self = Self { origin: 0, scale: 0 };

    /// Whether all values lie in the first.
    #[inline]
    pub(crate) const fn is_one(self) -> bool {
        self.scale == 0
    }

    pub(crate) const fn of_floats(origin: f64, width: f64) -> Self {
        let scale = (1.0 / width) as f32;
        if scale > 0.0 && scale < f32::INFINITY {
            Self { origin: (origin as f32).to_bits(), scale: scale.to_bits() }
        } else {
            Self::ONE
        }
    }

    /// So many, in units of the last place.
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
            // Rounded up, so that a multiple of a width is not in the cell below.
            let scale = (scale as u32).wrapping_add(1);
            Self { origin: origin as i32 as u32, scale: fraction << 24 | shift << 16 | scale }
        } else {
            Self::ONE
        }
    }

    /// The cell of a float; 0 for what is not a number.
    #[inline]
    pub(crate) const fn of_float(self, value: f32) -> usize {
        ((value - f32::from_bits(self.origin)) * f32::from_bits(self.scale)) as u32 as usize
    }

    #[inline]
    pub(crate) const fn of_integer(self, value: i32) -> usize {
        let Self { origin, scale } = self;
        let above = if value > origin as i32 { (value as u32).wrapping_sub(origin) } else { 0 };
        let above = above >> (scale >> 16 & 31);
        let above = if above > 0xffff { 0xffff } else { above };
        ((above * (scale & 0xffff)) >> (scale >> 24 & 31)) as usize
    }
}
