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
