//! T-HSA, the threshold Hough spike algorithm.
//!
//! On `r = x - shift`: `error = sum over j of max(0, h[j] - r[i+j])`; spike at `i` iff
//! `error <= threshold`; then `r[i+j] -= h[j]`. At the end of a recording, samples past the end
//! cost nothing, so that a tail of zeros can spike.
//!
//! What is summed, for `j` ascending, is `|r-h| - (r-h)`, twice the error, which is compared with
//! `threshold + threshold`.

use super::Real;

/// Encodes a recording. Without `finish` only whole windows are decided: `L-(F-1)` entries.
pub fn threshold_hough<T: Real>(
    x: &[T],
    taps: &[T],
    shift: T,
    threshold: T,
    finish: bool,
) -> Vec<i8> {
    let mut r: Vec<T> = x.iter().map(|&value| value - shift).collect();
    let whole = (x.len() + 1).saturating_sub(taps.len());
    let decided = if finish { x.len() } else { whole };
    let mut spikes = Vec::with_capacity(decided);
    for i in 0..decided {
        let end = x.len().min(i + taps.len());
        let window = &mut r[i..end];
        let mut error = T::ZERO;
        for (&r, &h) in window.iter().zip(taps) {
            error = error + ((r - h).magnitude() - (r - h));
        }
        let spike = error <= threshold + threshold;
        if spike {
            for (r, &h) in window.iter_mut().zip(taps) {
                *r = *r - h;
            }
        }
        spikes.push(i8::from(spike));
    }
    spikes
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
