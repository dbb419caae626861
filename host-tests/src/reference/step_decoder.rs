//! The decoder of the temporal schemes: `y[i] = y[i-1] + step*s[i]`, from a known start.
//!
//! Of a whole recording the first value is known, `y[0] = x[0]`, and a spike of the first sample changes
//! nothing. Only a moving window that is primed with the recording's first window can spike there.

use super::{Real, clamped};

/// Decodes signed spikes; `start` is the value before the first of them.
pub fn step_decode<T: Real>(spikes: &[i8], step: T, start: T) -> Vec<T> {
    accumulate(spikes, step, start, |value| value)
}

/// Decodes the spikes of a whole recording, whose first value is known.
pub fn step_decode_from_first<T: Real>(spikes: &[i8], step: T, first: T) -> Vec<T> {
    let Some((_, later)) = spikes.split_first() else { return Vec::new() };
    std::iter::once(first).chain(step_decode(later, step, first)).collect()
}

/// As [`step_decode`], on numbers that end at `lowest` and `highest`: every sum is clamped, as a
/// saturating fixed-point addition does it.
pub fn step_decode_within<T: Real>(
    spikes: &[i8],
    step: T,
    start: T,
    lowest: T,
    highest: T,
) -> Vec<T> {
    accumulate(spikes, step, start, |value| clamped(value, lowest, highest))
}

fn accumulate<T: Real>(spikes: &[i8], step: T, start: T, keep: impl Fn(T) -> T) -> Vec<T> {
    let mut value = start;
    spikes
        .iter()
        .map(|&spike| {
            if spike > 0 {
                value = keep(value + step);
            } else if spike < 0 {
                value = keep(value - step);
            }
            value
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{step_decode, step_decode_from_first, step_decode_within};

    #[test]
    fn adds_up_the_spikes() {
        let spikes = [0, 1, 1, 0, -1, -1, -1];
        let expected = [2.0, 2.5, 3.0, 3.0, 2.5, 2.0, 1.5];
        assert_eq!(step_decode(&spikes, 0.5, 2.0), expected);
        assert_eq!(step_decode(&spikes, 0.5_f32, 2.0), expected.map(|value| value as f32));
    }

    #[test]
    fn the_first_value_is_known_and_its_spike_changes_nothing() {
        for first in [-1, 0, 1] {
            assert_eq!(step_decode_from_first(&[first, -1, 0, 1], 0.5, 5.0), [5.0, 4.5, 4.5, 5.0]);
        }
        assert!(step_decode_from_first::<f32>(&[], 0.5, 5.0).is_empty());
    }

    #[test]
    fn each_step_rounds_in_single_precision() {
        let sum = (0.1_f32 + 0.1_f32) + 0.1_f32;
        assert_eq!(step_decode(&[1, 1, 1], 0.1_f32, 0.0)[2], sum);
    }

    #[test]
    fn clamps_after_every_step_and_so_loses_what_was_beyond() {
        let decoded = step_decode_within(&[1, 1, 1, -1, -1, -1, -1], 1.0, 0.0, -1.0, 1.75);
        assert_eq!(decoded, [1.0, 1.75, 1.75, 0.75, -0.25, -1.0, -1.0]);
    }
}
