//! SF, step forward.
//!
//! `base = x[0]`; if `x > base + threshold`: +1 and `base = base + threshold`; if
//! `x < base - threshold`: -1 and `base = base - threshold`. While `|dx| <= threshold` in every
//! sample, the base stays within the threshold of the input.

use super::Real;

/// Encodes a recording, from a known base or else from its first sample, which then is silent.
pub fn step_forward<T: Real>(x: &[T], threshold: T, primed: Option<T>) -> Vec<i8> {
    let Some(mut base) = primed.or_else(|| x.first().copied()) else {
        return Vec::new();
    };
    let mut spikes = Vec::with_capacity(x.len());
    for (i, &value) in x.iter().enumerate() {
        if primed.is_none() && i == 0 {
            spikes.push(0);
        } else if value > base + threshold {
            base = base + threshold;
            spikes.push(1);
        } else if value < base - threshold {
            base = base - threshold;
            spikes.push(-1);
        } else {
            spikes.push(0);
        }
    }
    spikes
}

#[cfg(test)]
mod tests {
    use super::step_forward;
    use crate::reference::step_decode;

    #[test]
    fn the_base_follows_by_one_threshold_a_sample_in_both_directions() {
        // Bases: 0, 0, 1, 2, 2, 1, 0, 0.
        let x = [0.0, 1.0, 5.0, 5.0, 2.5, 0.5, 0.5, 0.5];
        let expected = [0, 0, 1, 1, 0, -1, 0, 0];
        assert_eq!(step_forward(&x, 1.0_f64, None), expected);
        assert_eq!(step_forward(&x.map(|v| v as f32), 1.0_f32, None), expected);
    }

    #[test]
    fn a_primed_encoder_compares_the_first_sample() {
        assert_eq!(step_forward(&[3.0, 3.0, 3.0], 1.0, Some(0.5)), [1, 1, 0]);
        assert_eq!(step_forward(&[0.0, 0.0], 1.0, Some(1.5)), [-1, 0]);
        assert!(step_forward::<f64>(&[], 1.0, Some(0.5)).is_empty());
        assert!(step_forward::<f64>(&[], 1.0, None).is_empty());
    }

    #[test]
    fn stays_within_the_threshold_of_a_slow_input() {
        // Steps of at most a threshold, on a grid of eighths: exact.
        let mut value = 0_i32;
        let x: Vec<f64> = (0_i32..2000)
            .map(|i| {
                value += (i * i * 7 + i * 3) % 17 - 8;
                f64::from(value) / 8.0
            })
            .collect();
        let spikes = step_forward(&x, 1.0, None);
        for (value, decoded) in x.iter().zip(step_decode(&spikes, 1.0, x[0])) {
            assert!((value - decoded).abs() <= 1.0);
        }
    }
}
