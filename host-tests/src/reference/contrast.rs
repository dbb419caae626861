//! TBR, temporal contrast.
//!
//! `d[i] = x[i] - x[i-1]`; +1 if `d > threshold`, -1 if `d < -threshold`. The first sample has no
//! predecessor and emits nothing, unless one is given.

use super::Real;

/// Encodes a recording, with the sample before it if there was one.
pub fn temporal_contrast<T: Real>(x: &[T], threshold: T, primed: Option<T>) -> Vec<i8> {
    let mut previous = primed;
    x.iter()
        .map(|&value| {
            let before = previous.replace(value);
            before.map_or(0, |before| {
                let difference = value - before;
                if difference > threshold {
                    1
                } else if difference < -threshold {
                    -1
                } else {
                    0
                }
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::temporal_contrast;

    #[test]
    fn both_comparisons_are_strict() {
        let x = [0.0, 1.0, 2.5, 1.5, 0.25, 0.25];
        assert_eq!(temporal_contrast(&x, 1.0_f64, None), [0, 0, 1, 0, -1, 0]);
        let x = x.map(|value| value as f32);
        assert_eq!(temporal_contrast(&x, 1.0_f32, None), [0, 0, 1, 0, -1, 0]);
    }

    #[test]
    fn a_primed_encoder_compares_the_first_sample() {
        assert_eq!(temporal_contrast(&[2.0, 2.0], 1.0, Some(0.5)), [1, 0]);
        assert_eq!(temporal_contrast(&[2.0, 2.0], 1.0, Some(3.5)), [-1, 0]);
        assert_eq!(temporal_contrast(&[2.0, 2.0], 1.0, None), [0, 0]);
    }

    #[test]
    fn priming_with_x0_minus_the_first_difference_counts_it_twice() {
        let x = [1.0, 3.0, 3.0];
        let before = x[0] - (x[1] - x[0]);
        assert_eq!(temporal_contrast(&x, 1.0, Some(before)), [1, 1, 0]);
    }

    #[test]
    fn nothing_in_nothing_out() {
        assert!(temporal_contrast::<f32>(&[], 1.0, None).is_empty());
    }
}
