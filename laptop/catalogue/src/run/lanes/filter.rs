//! Rate codes with a filter in lanes.

use std::array;

use pulp::Simd;

use super::Code;

/// A rate code with a filter.
pub(super) struct Filter<R> {
    rule: R,
    taps: Vec<f32>,
}

impl<R> Filter<R> {
    pub(super) fn new(rule: R, taps: Vec<f32>) -> Self {
        Self { rule, taps }
    }
}

impl<S: Simd, R: Fits> Code<S> for Filter<R> {
    #[inline(always)]
    fn look_ahead(&self) -> usize {
        self.taps.len() - 1
    }

    #[inline(always)]
    fn encode(&mut self, simd: S, at: usize, rows: &mut [S::f32s], spikes: &mut [S::f32s]) {
        let [none, one] = [0, 1].map(|bits| simd.splat_f32s(f32::from_bits(bits)));
        let taps = &self.taps[..];
        let mut slot = at % taps.len();
        for (start, spike) in spikes.iter_mut().enumerate() {
            let end = rows.len().min(start + taps.len());
            let window = &mut rows[start..end];
            let own = &taps[..window.len()];
            let place = Place { slot, is_whole: own.len() == taps.len() };
            let fits = self.rule.fits(simd, window, own, place);
            if simd.first_true_m32s(fits) < S::F32_LANES {
                for (residual, tap) in window.iter_mut().zip(own) {
                    let tap = simd.select_f32s(fits, simd.splat_f32s(*tap), none);
                    *residual = simd.sub_f32s(*residual, tap);
                }
            }
            *spike = simd.select_f32s(fits, one, none);
            slot = if slot + 1 == taps.len() { 0 } else { slot + 1 };
        }
    }
}

/// The place of a window in the recording.
#[derive(Clone, Copy)]
pub(super) struct Place {
    /// The number of its first sample, modulo the number of taps.
    slot: usize,
    /// Whether it is as long as the filter, as the recording does not end before.
    is_whole: bool,
}

/// A rule for when a sample spikes.
pub(super) trait Fits: Copy {
    /// In which lanes the first sample of a window spikes.
    fn fits<S: Simd>(self, simd: S, window: &[S::f32s], taps: &[f32], place: Place) -> S::m32s;
}

/// After how many taps the lanes are looked at, whether any can still spike.
const LOOK: usize = 8;

/// HSA: every residual reaches its tap.
#[derive(Clone, Copy)]
pub(super) struct Hough;

impl Fits for Hough {
    #[inline(always)]
    fn fits<S: Simd>(self, simd: S, window: &[S::f32s], taps: &[f32], place: Place) -> S::m32s {
        let zero = simd.splat_f32s(0.0);
        if !place.is_whole {
            return simd.less_than_f32s(zero, zero);
        }
        let mut fits = simd.less_than_or_equal_f32s(zero, zero);
        for (window, taps) in window.chunks(LOOK).zip(taps.chunks(LOOK)) {
            for (residual, tap) in window.iter().zip(taps) {
                let reaches = simd.greater_than_or_equal_f32s(*residual, simd.splat_f32s(*tap));
                fits = simd.and_m32s(fits, reaches);
            }
            if simd.first_true_m32s(fits) == S::F32_LANES {
                break;
            }
        }
        fits
    }
}

/// T-HSA: the residuals fall short of their taps by the threshold at most.
#[derive(Clone, Copy)]
pub(super) struct Short(pub(super) f32);

impl Fits for Short {
    /// Adds in two sums, and in the order of the taps where rounding matters, as the crate's scheme does.
    #[inline(always)]
    fn fits<S: Simd>(self, simd: S, window: &[S::f32s], taps: &[f32], _: Place) -> S::m32s {
        const ABOVE: f32 = 1.0 + 1.0 / 1024.0;
        let limit = simd.splat_f32s(self.0);
        let beyond = simd.splat_f32s(self.0 * ABOVE);
        let mut sums = [simd.splat_f32s(0.0); 2];
        for (window, taps) in window.chunks(LOOK).zip(taps.chunks(LOOK)) {
            let ((pairs, last), (pairs_of_taps, last_tap)) =
                (window.as_chunks::<2>(), taps.as_chunks::<2>());
            for (pair, taps) in pairs.iter().zip(pairs_of_taps) {
                let [one, other] = array::from_fn(|at| lack(simd, pair[at], taps[at]));
                sums = [simd.add_f32s(sums[0], one), simd.add_f32s(sums[1], other)];
            }
            if let ([residual], [tap]) = (last, last_tap) {
                sums[0] = simd.add_f32s(sums[0], lack(simd, *residual, *tap));
            }
            let sum = simd.add_f32s(sums[0], sums[1]);
            if simd.first_true_m32s(simd.less_than_or_equal_f32s(sum, beyond)) == S::F32_LANES {
                break;
            }
        }
        let sum = simd.add_f32s(sums[0], sums[1]);
        let fits = simd.less_than_or_equal_f32s(simd.mul_f32s(sum, simd.splat_f32s(ABOVE)), limit);
        let may_fit = simd.less_than_or_equal_f32s(sum, beyond);
        if simd.first_true_m32s(simd.xor_m32s(fits, may_fit)) == S::F32_LANES {
            return fits;
        }
        let mut sum = simd.splat_f32s(0.0);
        for (residual, tap) in window.iter().zip(taps) {
            sum = simd.add_f32s(sum, lack(simd, *residual, *tap));
        }
        simd.less_than_or_equal_f32s(sum, limit)
    }
}

/// Returns by how much a residual falls short of its tap. The crate's scheme adds up twice this amount, which rounds
/// alike.
#[inline(always)]
fn lack<S: Simd>(simd: S, residual: S::f32s, tap: f32) -> S::f32s {
    simd.max_f32s(simd.sub_f32s(simd.splat_f32s(tap), residual), simd.splat_f32s(0.0))
}

/// The sums of `|residual - tap|` and of `|residual|`, in the order of the slots of the crate's ring.
#[inline(always)]
fn errors<S: Simd>(simd: S, window: &[S::f32s], taps: &[f32], place: Place) -> [S::f32s; 2] {
    let late = if place.is_whole && place.slot > 0 { taps.len() - place.slot } else { 0 };
    let [(early, early_taps), (late, late_taps)] =
        [(&window[..late], &taps[..late]), (&window[late..], &taps[late..])];
    let mut errors = array::from_fn(|_| simd.splat_f32s(0.0));
    for (window, taps) in [(late, late_taps), (early, early_taps)] {
        for (residual, tap) in window.iter().zip(taps) {
            let [with, without] = &mut errors;
            let left = simd.sub_f32s(*residual, simd.splat_f32s(*tap));
            *with = simd.add_f32s(*with, simd.abs_f32s(left));
            *without = simd.add_f32s(*without, simd.abs_f32s(*residual));
        }
    }
    errors
}

/// BSA with a threshold.
#[derive(Clone, Copy)]
pub(super) struct Less(pub(super) f32);

impl Fits for Less {
    #[inline(always)]
    fn fits<S: Simd>(self, simd: S, window: &[S::f32s], taps: &[f32], place: Place) -> S::m32s {
        let [with, without] = errors(simd, window, taps, place);
        simd.less_than_or_equal_f32s(simd.sub_f32s(with, without), simd.splat_f32s(-self.0))
    }
}

/// BSA with a factor.
#[derive(Clone, Copy)]
pub(super) struct Part(pub(super) f32);

impl Fits for Part {
    #[inline(always)]
    fn fits<S: Simd>(self, simd: S, window: &[S::f32s], taps: &[f32], place: Place) -> S::m32s {
        let [with, without] = errors(simd, window, taps, place);
        simd.less_than_or_equal_f32s(with, simd.mul_f32s(without, simd.splat_f32s(self.0)))
    }
}
