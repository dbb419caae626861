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
