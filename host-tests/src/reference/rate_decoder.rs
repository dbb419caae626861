//! The decoder of the rate schemes: `y[i] = shift + sum_j s[i-j]*h[j]`, `i-j >= 0`.
//!
//! The taps are added up from 0, those of the oldest spike first (the largest `j`), and the shift
//! comes last.

use super::Real;

/// Decodes spikes: anything but 0 is one.
pub fn rate_decode<T: Real>(spikes: &[i8], taps: &[T], shift: T) -> Vec<T> {
    (0..spikes.len())
        .map(|i| {
            let mut sum = T::ZERO;
            for (j, &h) in taps.iter().enumerate().take(i + 1).rev() {
                if spikes[i - j] != 0 {
                    sum = sum + h;
                }
            }
            shift + sum
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::rate_decode;

    #[test]
    fn every_spike_starts_the_filter() {
        let taps = [0.25, 1.0, 0.5];
        let decoded = [2.25, 3.0, 2.75, 3.25, 3.5, 2.5];
        assert_eq!(rate_decode(&[1, 0, 1, 1, 0, 0], &taps, 2.0), decoded);
        assert_eq!(rate_decode(&[1], &taps, 2.0), [2.25]);
        assert!(rate_decode(&[], &taps, 2.0).is_empty());
    }

    #[test]
    fn the_oldest_spike_is_added_first_and_the_shift_last() {
        let taps = [0.1_f32, 0.2, 0.3];
        let decoded = rate_decode(&[1, 1, 1, 1], &taps, 0.7);
        assert_eq!(decoded[2], 0.7 + ((taps[2] + taps[1]) + taps[0]));
        assert_eq!(decoded[3], decoded[2]);
    }
}
