//! T-HSA, the threshold Hough spike algorithm.
//!
//! On `r = x - shift`: `error = sum over j of max(0, h[j] - r[i+j])`; spike at `i` iff
//! `error <= threshold`; then `r[i+j] -= h[j]`. At the end of a recording, samples past the end
//! cost nothing, so that a tail of zeros can spike.
//!
//! What is summed, for `j` ascending, is `|r-h| - (r-h)`, twice the error, which is compared with
//! `threshold + threshold`.

use super::Real;
use super::rate::{decided, encode};

/// Encodes a recording. Without `finish` only whole windows are decided: `L-(F-1)` entries.
pub fn threshold_hough<T: Real>(
    x: &[T],
    taps: &[T],
    shift: T,
    threshold: T,
    finish: bool,
) -> Vec<i8> {
    let windows = decided(x.len(), taps.len(), finish);
    encode(x, taps, shift, windows, |_, window| {
        let error = window
            .iter()
            .zip(taps)
            .fold(T::ZERO, |error, (&r, &h)| error + ((r - h).magnitude() - (r - h)));
        error <= threshold + threshold
    })
}

#[cfg(test)]
mod tests {
    use super::threshold_hough;

    #[test]
    fn what_was_taken_too_much_is_missing_later() {
        // The spike at 0 leaves -1 at 1, so that 1 is short by 2 and not by 1.
        let x = [1.0, 0.0, 1.0];
        assert_eq!(threshold_hough(&x, &[1.0, 1.0], 0.0, 1.0, false), [1, 0]);
        assert_eq!(threshold_hough(&x, &[1.0, 1.0], 0.0, 2.0, false), [1, 1]);
    }

    #[test]
    fn errors_are_summed_first_tap_first_and_doubled() {
        let taps = [0.1_f32, 0.2, 0.3];
        let threshold = 0.6_f32;
        let spikes = (0.1 + 0.1) + (0.2 + 0.2) + (0.3 + 0.3) <= 0.6_f32 + 0.6;
        let expected = [i8::from(spikes)];
        assert_eq!(threshold_hough(&[0.0; 3], &taps, 0.0, threshold, false), expected);
    }
}
