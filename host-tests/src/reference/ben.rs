//! BSA, Ben's spike algorithm, on `r = x - shift`.
//!
//! Aligned (Schrauwen & Van Campenhout 2003): `e1 = sum |r[i+j]-h[j]|`, `e2 = sum |r[i+j]|`; spike
//! at `i` iff `e1 <= e2 - threshold` (subtractive) or `e1 <= e2*threshold` (multiplicative); then
//! `r[i+j] -= h[j]`. At the end of a recording both sums are cut to what is left.
//!
//! Toolbox: `e1` over `r[i+j+1]-h[j]`, `e2` over `r[i+j]`, spike iff `e1 <= e2*threshold`, and the
//! subtraction at `r[i+j+2]`, left out beyond the last sample; for `i < L-F` only.
//!
//! `e1` and `e2` are summed apart, from 0: over a whole window by rising `(i+j) mod F`, the sample's
//! number; over a window that is cut by rising `j`. The subtractive form compares `e1 - e2` with
//! `-threshold`.

use super::Real;
use super::rate::{decided, encode};

/// Encodes a recording by the aligned form, `e1 <= e2 - threshold`. Without `finish` only whole
/// windows are decided: `L-(F-1)` entries.
pub fn ben_subtractive<T: Real>(
    x: &[T],
    taps: &[T],
    shift: T,
    threshold: T,
    finish: bool,
) -> Vec<i8> {
    aligned(x, taps, shift, finish, |e1, e2| e1 - e2 <= -threshold)
}

/// Encodes a recording by the aligned form, `e1 <= e2*threshold`. Without `finish` only whole
/// windows are decided: `L-(F-1)` entries.
pub fn ben_multiplicative<T: Real>(
    x: &[T],
    taps: &[T],
    shift: T,
    threshold: T,
    finish: bool,
) -> Vec<i8> {
    aligned(x, taps, shift, finish, |e1, e2| e1 <= e2 * threshold)
}

/// Encodes a recording by the toolbox's form. Without `finish` there are `L-F` entries; with it
/// `L`, the last `F` of them silent.
pub fn ben_toolbox<T: Real>(x: &[T], taps: &[T], shift: T, threshold: T, finish: bool) -> Vec<i8> {
    let mut r: Vec<T> = x.iter().map(|&value| value - shift).collect();
    let mut spikes = Vec::with_capacity(x.len());
    for i in 0..x.len().saturating_sub(taps.len()) {
        let (mut e1, mut e2) = (T::ZERO, T::ZERO);
        for j in by_slot(i + 1, taps.len()) {
            e1 = e1 + (r[i + 1 + j] - taps[j]).magnitude();
        }
        for j in by_slot(i, taps.len()) {
            e2 = e2 + r[i + j].magnitude();
        }
        let spike = e1 <= e2 * threshold;
        if spike {
            for (r, &h) in r.iter_mut().skip(i + 2).zip(taps) {
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

/// The places in a window of the samples from `first` on, by the samples' numbers modulo `length`.
fn by_slot(first: usize, length: usize) -> impl Iterator<Item = usize> {
    (0..length).map(move |slot| (slot + length - first % length) % length)
}

/// The windows of the aligned form: `fits` compares `e1` with `e2`.
fn aligned<T: Real>(
    x: &[T],
    taps: &[T],
    shift: T,
    finish: bool,
    fits: impl Fn(T, T) -> bool,
) -> Vec<i8> {
    encode(x, taps, shift, decided(x.len(), taps.len(), finish), |i, window| {
        let is_whole = window.len() == taps.len();
        let order: Vec<_> =
            if is_whole { by_slot(i, taps.len()).collect() } else { (0..window.len()).collect() };
        let (mut e1, mut e2) = (T::ZERO, T::ZERO);
        for j in order {
            e1 = e1 + (window[j] - taps[j]).magnitude();
            e2 = e2 + window[j].magnitude();
        }
        fits(e1, e2)
    })
}

#[cfg(test)]
mod tests {
    use super::{ben_subtractive, by_slot};

    #[test]
    fn whole_windows_are_summed_by_the_samples_numbers() {
        // The window at 1 holds the samples 1, 2 and 3, of which 3 is in place 0: 2^24 takes up
        // neither 1, as it would if they came first.
        let large = 16_777_216.0_f32;
        let (x, taps) = ([0.0, 1.0, 1.0, large], [0.0, 0.0, large]);
        assert!(by_slot(1, 3).eq([2, 0, 1]));
        assert_eq!(ben_subtractive(&x, &taps, 0.0, large - 2.0, false), [0, 1]);
        assert_eq!(ben_subtractive(&x, &taps, 0.0, large, false), [0, 0]);
        assert_eq!(ben_subtractive(&x[1..], &taps, 0.0, large, false), [1]);
    }
}
