//! GRF with probabilistic spiking: neuron `i` fires with probability `r[i]`.
//!
//! The probability is quantised to `n` levels, a power of two, rounding half up. For each neuron in
//! index order whose level is at least 1, one `u32` is drawn; the neuron fires iff its top
//! `log2 n` bits are less than the level. So level `n` always fires, and level 0 draws nothing.

/// Which neurons fire, given their levels.
///
/// # Panics
/// If `n` is not a power of two.
pub fn probabilistic_from_levels(
    levels: &[u16],
    n: u16,
    mut draw: impl FnMut() -> u32,
) -> Vec<bool> {
    assert!(n.is_power_of_two(), "the levels are a power of two");
    levels
        .iter()
        .map(|&level| {
            level >= 1 && u64::from(draw()) >> (32 - n.trailing_zeros()) < u64::from(level)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::probabilistic_from_levels;

    fn from(values: &[u32]) -> impl FnMut() -> u32 {
        let mut values = values.iter().copied();
        move || values.next().expect("no more draws than neurons above level 0")
    }

    #[test]
    fn the_top_bits_are_compared_with_the_level() {
        // Of 16 levels: the top four bits.
        let draws = [0x3fff_ffff, 0x4000_0000, 0xffff_ffff, 0x0fff_ffff];
        let fired = probabilistic_from_levels(&[4, 4, 0, 16, 1], 16, from(&draws));
        assert_eq!(fired, [true, false, false, true, true]);
        assert_eq!(probabilistic_from_levels(&[0, 1], 1, from(&[u32::MAX])), [false, true]);
    }

    #[test]
    fn fires_with_the_probability_of_the_level() {
        // Every top byte once: the neuron of level k fires k times in 256.
        for level in [1, 37, 255, 256] {
            let fired = (0..=255_u32)
                .filter(|byte| probabilistic_from_levels(&[level], 256, || byte << 24)[0])
                .count();
            assert_eq!(fired, usize::from(level));
        }
    }
}
