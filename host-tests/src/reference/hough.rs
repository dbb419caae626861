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
