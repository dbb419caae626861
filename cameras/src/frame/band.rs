//! Four pixels compared at once, in lanes of 16 bits.

/// The samples, or levels, about a base for which no event is due: from `down` below it to `up` above.
#[derive(Clone, Copy)]
pub(super) struct Band {
    /// `down` in both lanes.
    down: u32,
    /// `down + up` in both lanes.
    whole: u32,
}

impl Band {
    /// The highest value that a lane takes.
    const MAX: u16 = 0x1FFF;
    const LANES: u32 = 0x0001_0001;
    const SIGNS: u32 = 0x8000_8000;

    /// A band of these thresholds, up to 8191.
    pub(super) const fn new(down: u16, up: u16) -> Self {
        let (down, up) = ((down & Self::MAX) as u32, (up & Self::MAX) as u32);
        Self { down: down * Self::LANES, whole: (down + up) * Self::LANES }
    }

    /// Whether four values lie in the bands of their four bases; all of them up to 8191.
    ///
    /// A value lies in its band if neither `above = value - base + down` nor `down + up - above` is negative. The sign of
    /// a lane shows that; a borrow falsifies only lanes above one that is negative itself.
    #[inline]
    pub(super) const fn holds(self, bases: [u32; 2], values: [u32; 2]) -> bool {
        let [a, b] = bases;
        let [p, q] = values;
        (self.outside(a, p) | self.outside(b, q)) & Self::SIGNS == 0
    }

    /// Sets the sign of each lane that lies outside its band.
    #[inline]
    const fn outside(self, bases: u32, values: u32) -> u32 {
        let above = values.wrapping_sub(bases).wrapping_add(self.down);
        above | self.whole.wrapping_sub(above)
    }
}

/// Four bytes in the lanes of two words: first and third, second and fourth.
#[inline]
pub(super) const fn lanes_of_bytes(four: [u8; 4]) -> [u32; 2] {
    const EVEN: u32 = 0x00FF_00FF;
    let word = u32::from_le_bytes(four);
    [word & EVEN, word >> 8 & EVEN]
}

/// Four numbers in the lanes of two words: first and second, third and fourth.
#[inline]
pub(super) const fn lanes_of_pairs([a, b, c, d]: [u16; 4]) -> [u32; 2] {
    [a as u32 | (b as u32) << 16, c as u32 | (d as u32) << 16]
}

/// How many pixels are compared at once.
pub(super) const FOUR: usize = 4;

/// How many pixels at the start of a row are quiet: whole fours by the one function, and what is left of the row by the
/// other.
#[inline]
pub(super) fn quiet<P: Copy>(
    pixels: &[P],
    samples: &[u8],
    fours: impl FnOnce(&[[P; FOUR]], &[[u8; FOUR]]) -> usize,
    is_quiet: impl Fn(P, u8) -> bool,
) -> usize {
    let (all, last) = pixels.as_chunks::<FOUR>();
    let (all_samples, last_samples) = samples.as_chunks::<FOUR>();
    let quiet = fours(all, all_samples);
    if quiet < all.len().min(all_samples.len()) {
        return quiet.wrapping_mul(FOUR);
    }
    let last = last.iter().zip(last_samples);
    let last = last.take_while(|&(&pixel, &sample)| is_quiet(pixel, sample)).count();
    quiet.wrapping_mul(FOUR).wrapping_add(last)
}

#[cfg(test)]
mod tests {
    use super::{Band, lanes_of_bytes, lanes_of_pairs};

    /// One value in its lane, the other in the rest.
    fn in_lane<T: Copy>(lane: usize, one: T, other: T) -> [T; 4] {
        core::array::from_fn(|at| if at == lane { one } else { other })
    }

    /// Every difference in every lane, beside every kind of neighbour.
    #[test]
    fn four_at_once_see_what_one_sees() {
        for threshold in [1_u8, 2, 10, 127, 128, 253, 254] {
            let band = Band::new(threshold.into(), threshold.into());
            for base in 0..=255_u8 {
                for sample in 0..=255_u8 {
                    for (other_base, other) in [(0, 0), (255, 0), (0, 255), (7, 7)] {
                        let is_in = |base: u8, x: u8| base.abs_diff(x) <= threshold;
                        let expected = is_in(base, sample) && is_in(other_base, other);
                        for lane in 0..4 {
                            let bases = in_lane(lane, base, other_base);
                            let samples = in_lane(lane, sample, other);
                            let holds = band.holds(lanes_of_bytes(bases), lanes_of_bytes(samples));
                            assert_eq!(holds, expected);
                        }
                    }
                }
            }
        }
    }

    /// The widest lanes, at both edges of the band.
    #[test]
    fn numbers_up_to_the_highest() {
        for (down, up) in [(1, 1), (205, 184), (5673, 1), (1, 5673), (8191, 8191)] {
            let band = Band::new(down, up);
            for base in [0_u16, 1, 204, 205, 206, 4096, 5674, 8190, 8191] {
                for value in [0_u16, 1, base, base + 1, base + up, base + up + 1, 5674, 8191]
                    .into_iter()
                    .chain([base.saturating_sub(down), base.saturating_sub(down + 1)])
                    .filter(|&value| value <= 8191)
                {
                    let expected = value <= base + up && base <= value + down;
                    for (other_base, other) in [(0, 0), (8191, 8191)] {
                        for lane in 0..4 {
                            let bases = in_lane(lane, base, other_base);
                            let values = in_lane(lane, value, other);
                            let holds = band.holds(lanes_of_pairs(bases), lanes_of_pairs(values));
                            assert_eq!(holds, expected, "{down} {up} {base} {value}");
                        }
                    }
                }
            }
        }
    }
}
