//! What the rate schemes' encoders share: each window that holds the filter spikes, and the filter is taken off it.

use super::Real;

/// How many windows are decided: with `finish` also those that the end of a recording cuts.
pub(super) fn decided(samples: usize, taps: usize, finish: bool) -> usize {
    if finish { samples } else { (samples + 1).saturating_sub(taps) }
}

/// Decides so many windows of `x - shift`, by their number and what earlier spikes have left of them.
pub(super) fn encode<T: Real>(
    x: &[T],
    taps: &[T],
    shift: T,
    windows: usize,
    fits: impl Fn(usize, &[T]) -> bool,
) -> Vec<i8> {
    let mut r: Vec<T> = x.iter().map(|&value| value - shift).collect();
    let mut spikes = Vec::with_capacity(x.len());
    for i in 0..windows {
        let end = x.len().min(i + taps.len());
        let window = &mut r[i..end];
        let spike = fits(i, window);
        if spike {
            for (r, &h) in window.iter_mut().zip(taps) {
                *r = *r - h;
            }
        }
        spikes.push(i8::from(spike));
    }
    spikes
}
