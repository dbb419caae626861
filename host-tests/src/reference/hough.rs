//! HSA, the Hough spike algorithm.
//!
//! On `r = x - shift`: spike at `i` iff `r[i+j] >= h[j]` for all `j`; then `r[i+j] -= h[j]`. A
//! window past the end never spikes.

use super::Real;

/// Encodes a recording. Without `finish` only whole windows are decided: `L-(F-1)` entries.
pub fn hough<T: Real>(x: &[T], taps: &[T], shift: T, finish: bool) -> Vec<i8> {
    let mut r: Vec<T> = x.iter().map(|&value| value - shift).collect();
    let whole = (x.len() + 1).saturating_sub(taps.len());
    let mut spikes = Vec::with_capacity(x.len());
    for i in 0..whole {
        let window = &mut r[i..i + taps.len()];
        let spike = window.iter().zip(taps).all(|(r, h)| r >= h);
        if spike {
            for (r, &h) in window.iter_mut().zip(taps) {
                *r = *r - h;
            }
        }
        spikes.push(i8::from(spike));
    }
    if finish {
        spikes.resize(x.len(), 0);
    }
    spikes
}

#[cfg(test)]
mod tests {
    use super::hough;
    use crate::reference::{rate_decode, rounded};

    const TAPS: [f64; 3] = [0.25, 1.0, 0.5];

    #[test]
    fn recovers_what_was_made_of_its_own_filter() {
        let spikes = [1, 0, 1, 1, 0, 1, 0, 0];
        let x = rate_decode(&spikes, &TAPS, -2.0);
        assert_eq!(hough(&x, &TAPS, -2.0, true), spikes);
        assert_eq!(hough(&x, &TAPS, -2.0, false), spikes[..6]);
        let (x, taps): (Vec<f32>, Vec<f32>) = (rounded(&x), rounded(&TAPS));
        assert_eq!(hough(&x, &taps, -2.0, true), spikes);
    }

    #[test]
    fn the_comparison_is_not_strict() {
        assert_eq!(hough(&TAPS, &TAPS, 0.0, false), [1]);
        assert_eq!(hough(&[0.25, 1.0, 0.4375], &TAPS, 0.0, false), [0]);
    }

    #[test]
    fn each_spike_is_subtracted_before_the_next_is_decided() {
        // 2 holds two spikes of a filter of one tap of 1, but one spike a sample: 1 is left behind.
        assert_eq!(hough(&[2.0, 2.0, 0.5], &[1.0], 0.0, true), [1, 1, 0]);
        // After the first spike: 0, 1, 2, 0 -> second at 1 leaves 0, 0, 1, 0.
        let x = [1.0, 2.0, 2.0, 0.0];
        assert_eq!(hough(&x, &[1.0, 1.0], 0.0, true), [1, 1, 0, 0]);
    }

    #[test]
    fn a_window_past_the_end_never_spikes() {
        let x = [9.0; 4];
        assert_eq!(hough(&x, &TAPS, 0.0, true), [1, 1, 0, 0]);
        assert_eq!(hough(&x, &TAPS, 0.0, false), [1, 1]);
        assert_eq!(hough(&x[..2], &TAPS, 0.0, true), [0, 0]);
        assert!(hough(&x[..2], &TAPS, 0.0, false).is_empty());
    }
}
