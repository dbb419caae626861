//! HSA, the Hough spike algorithm.
//!
//! On `r = x - shift`: spike at `i` iff `r[i+j] >= h[j]` for all `j`; then `r[i+j] -= h[j]`. A
//! window past the end never spikes.

use super::Real;
use super::rate::{decided, encode};

/// Encodes a recording. Without `finish` only whole windows are decided: `L-(F-1)` entries.
pub fn hough<T: Real>(x: &[T], taps: &[T], shift: T, finish: bool) -> Vec<i8> {
    let whole = decided(x.len(), taps.len(), false);
    let holds = |_, window: &[T]| window.iter().zip(taps).all(|(r, h)| r >= h);
    let mut spikes = encode(x, taps, shift, whole, holds);
    if finish {
        spikes.resize(x.len(), 0);
    }
    spikes
}
