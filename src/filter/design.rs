//! Coefficients from corners, by the bilinear transform, whose corner is exactly that of the analogue filter.

use crate::error::{positive, tri, within};
use crate::num::curve::sin_pi_at;
use crate::num::{DoubleDouble, Section, coefficient};
use crate::{ConfigError, Sample, SampleKind};

/// Corners, over the rate. Lower ones would need more bits than states have.
const LOWEST: f32 = 0.001;
const HIGHEST: f32 = 0.49;

/// How sharp a second-order section may be.
const BLUNTEST: f32 = 0.1;
const SHARPEST: f32 = 100.0;

/// The `q` of Butterworth's filter, which is flat up to the corner.
pub(super) const BUTTERWORTH: f32 = core::f32::consts::FRAC_1_SQRT_2;

/// Checks a corner and the rate of the samples, both in Hz.
pub(super) const fn check(name: &'static str, corner: f32, rate: f32) -> Result<(), ConfigError> {
    tri!(positive("rate", rate as f64));
    tri!(positive(name, corner as f64));
    within(name, corner as f64, rate * LOWEST, rate * HIGHEST)
}

/// Checks how sharp a section is.
pub(super) const fn check_q(q: f32) -> Result<(), ConfigError> {
    within("q", q as f64, BLUNTEST, SHARPEST)
}

/// The numerator of a second-order section.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Numerator {
    /// `(1 + 1/z)²`.
    LowPass,
    /// `1 - 2 cos(2 pi corner / rate) / z + 1 / z²`.
    Notch,
}

/// A second-order section of checked parameters.
///
/// With `s` and `c`, the sine and the cosine of `pi corner / rate`, and `alpha = s c / q`: the gain is
/// `4 s² / (1 + alpha)`, the damping `2 alpha / (1 + alpha)`, and the first tap `s² / (1 + alpha)` of a low-pass,
/// `1 / (1 + alpha)` of a notch.
pub(super) const fn section<S: Sample>(
    numerator: Numerator,
    corner: f32,
    rate: f32,
    q: f32,
) -> Section<S::Coefficient> {
    let t = over(corner, rate);
    let sine = sin_pi_at(t);
    let square = sine.times(sine);
    let cosine = sin_pi_at(DoubleDouble::new(0.5).minus(t));
    let alpha = sine.times(cosine).over_double(q as f64);
    let whole = alpha.plus(DoubleDouble::ONE);
    let tap = match (numerator, S::KIND) {
        (Numerator::LowPass, SampleKind::F32) => DoubleDouble::new(0.25),
        (Numerator::LowPass, _) => square.over(whole),
        (Numerator::Notch, SampleKind::F32) => DoubleDouble::new(0.25).over(square),
        (Numerator::Notch, _) => DoubleDouble::ONE.over(whole),
    };
    Section {
        gain: coefficient::<S>(square.scaled(4.0).over(whole)),
        damping: coefficient::<S>(alpha.scaled(2.0).over(whole)),
        tap: coefficient::<S>(tap),
    }
}

/// The gain of a first-order low-pass of checked parameters: `2 s (sqrt(1 + s²) - s)`, where `s` is the sine of
/// `pi corner / rate`.
pub(super) const fn first_order<S: Sample>(corner: f32, rate: f32) -> S::Coefficient {
    let sine = sin_pi_at(over(corner, rate));
    let root = sine.times(sine).plus(DoubleDouble::ONE).sqrt();
    coefficient::<S>(sine.scaled(2.0).times(root.minus(sine)))
}

const fn over(corner: f32, rate: f32) -> DoubleDouble {
    DoubleDouble::new(corner as f64).over(DoubleDouble::new(rate as f64))
}
