//! The filters of the rate codes: shapes, scales, and where their sums end.

use crate::common::{between, cases};
use fixed::types::{I1F15, I8F8, I16F16, I32F0};
use host_tests::compare::{Wire, check_rate, check_rate_decoder, reals};
use host_tests::reference::{
    Precise, ben_multiplicative, ben_subtractive, ben_toolbox, doubles, gaussian, hann, hough,
    scaled_to_peak, scaled_to_sum, threshold_hough, triangular,
};
use proptest::prelude::*;
use spikewire::Scheme;
use spikewire::rate::{Bsa, BsaToolbox, Hough, Scale, Shape, Taps, ThresholdHough};

/// The reference's shape of `F` taps.
fn shape<const F: usize>(shape: Shape) -> Vec<Precise> {
    match shape {
        Shape::Triangular => triangular(F),
        Shape::Hann => hann(F),
        Shape::Gaussian { alpha } => gaussian(F, alpha),
    }
}

/// All shapes and scales against the reference, rounded once.
///
/// A shape of an even number of taps has no tap at its top, and its peak scales the top.
fn check<S: Wire, const F: usize>(scale: S) {
    for name in [Shape::Triangular, Shape::Hann, Shape::Gaussian { alpha: 2.5 }] {
        let heights = shape::<F>(name);
        let to_sum = doubles(&scaled_to_sum(&heights, scale.to_f64()));
        let top = |height: &Precise| (height.clone() * scale.to_f64()).to_f64();
        let to_peak: Vec<_> = heights.iter().map(top).collect();
        if F % 2 == 1 {
            assert_eq!(to_peak, doubles(&scaled_to_peak(&heights, scale.to_f64())));
        }
        for (scale, expected) in [(Scale::Sum(scale), to_sum), (Scale::Peak(scale), to_peak)] {
            let Ok(taps) = Taps::<S, F>::try_shaped(name, scale) else {
                // All rounded to 0, or too much for the type.
                let sum: f64 = expected.iter().map(|&tap| S::nearest(tap).to_f64()).sum();
                assert!(sum == 0.0 || sum >= S::ends()[1].into(), "{name:?} {scale:?}");
                continue;
            };
            for (&ours, expected) in taps.as_array().iter().zip(expected) {
                assert_eq!(ours, S::nearest(expected));
            }
        }
    }
}

fn check_all<S: Wire>(scale: S) {
    check::<S, 1>(scale);
    check::<S, 2>(scale);
    check::<S, 3>(scale);
    check::<S, 8>(scale);
    check::<S, 9>(scale);
    check::<S, 15>(scale);
    check::<S, 24>(scale);
    check::<S, 101>(scale);
}

#[test]
fn shapes_by_hand() {
    let triangle = Taps::<f32, 5>::triangular(1.5);
    assert_eq!(*triangle.as_array(), [0.5, 1.0, 1.5, 1.0, 0.5]);
    let triangle = Taps::<f32, 4>::triangular(1.0);
    assert_eq!(*triangle.as_array(), [0.25, 0.75, 0.75, 0.25]);
    let hann = Taps::<i16, 3>::try_shaped(Shape::Hann, Scale::Sum(2000)).unwrap();
    assert_eq!(*hann.as_array(), [500, 1000, 500]);
    let bell =
        Taps::<f32, 3>::try_shaped(Shape::Gaussian { alpha: 2.0 }, Scale::Peak(1.0)).unwrap();
    assert_eq!(*bell.as_array(), [(-2.0_f64).exp() as f32, 1.0, (-2.0_f64).exp() as f32]);
}

#[test]
fn shapes() {
    for scale in [0.001, 0.3, 1.0, 2.0, 77.7] {
        check_all::<f32>(scale as f32);
        check_all(I8F8::from_num(scale).max(I8F8::DELTA));
        check_all(I1F15::saturating_from_num(scale));
        check_all(I16F16::from_num(scale));
        check_all((scale * 400.0) as i16 + 1);
        check_all(I32F0::from_bits((scale * 1e7) as i32));
    }
}

#[test]
fn drawn_shapes() {
    proptest!(cases(128), |(scale in between(1e-3, 1e3))| {
        check_all(scale);
        check_all(I16F16::from_num(scale));
    });
    proptest!(cases(64), |(alpha in (1..90_u8).prop_map(|tenths| f64::from(tenths) / 10.0))| {
        let expected = doubles(&scaled_to_sum(&gaussian(15, alpha), 1.0));
        let taps = Taps::<f32, 15>::try_shaped(Shape::Gaussian { alpha }, Scale::Sum(1.0)).unwrap();
        for (&ours, expected) in taps.as_array().iter().zip(expected) {
            assert_eq!(ours, expected as f32);
        }
    });
}

/// Down to where an exponential is taken for 0.
#[test]
fn the_flanks_of_narrow_bells() {
    let bell = |alpha| Shape::Gaussian { alpha };
    let last = 1380.0_f64.sqrt();
    let about = [last.next_down().next_down(), last.next_down(), last, last.next_up()];
    assert!(about.iter().any(|alpha| alpha * alpha == 1380.0));
    for alpha in (1..80).map(|halves| f64::from(halves) / 2.0).chain(about).chain([50.0, 1e9]) {
        let exact = if alpha * alpha > 1380.0 { 0.0 } else { (-0.5 * alpha * alpha).exp() };
        let [left, middle, right] = [0, 1, 2].map(|k| bell(alpha).at(k, 3));
        assert!(middle == 1.0 && left == right && (left - exact).abs() <= 1e-12 * exact, "{alpha}");
    }
}

/// What is built at compile time is what is built in flight.
#[test]
fn constants() {
    const BELL: Shape = Shape::Gaussian { alpha: 1.7 };
    static FLOATS: Taps<f32, 15> = Taps::shaped(BELL, Scale::Sum(0.9));
    static WORDS: Taps<I16F16, 24> = Taps::shaped(Shape::Hann, Scale::Peak(I16F16::ONE));
    static COUNTS: Taps<i16, 9> = Taps::triangular(1000);
    static OWN: Taps<f32, 3> = Taps::new([0.1, -0.2, 1e-40]);
    assert_eq!(FLOATS, Taps::try_shaped(BELL, Scale::Sum(0.9)).unwrap());
    assert_eq!(WORDS, Taps::try_shaped(Shape::Hann, Scale::Peak(I16F16::ONE)).unwrap());
    assert_eq!(COUNTS, Taps::try_shaped(Shape::Triangular, Scale::Peak(1000)).unwrap());
    assert_eq!(OWN, Taps::try_new([0.1, -0.2, 1e-40]).unwrap());
}

/// Every rate scheme with samples, shifts and taps at the ends of their type.
fn check_ends<S: Wire, const F: usize>(taps: [S; F], x: &[S], shift: S, threshold: S) {
    let taps = Taps::try_new(taps).unwrap();
    let h = reals(taps.as_array());
    let t = threshold.real();
    let scheme = Hough::new(taps).try_with_shift(shift).unwrap();
    check_rate(&scheme, x, &taps, shift, |r, shift, finish| hough(r, &h, shift, finish));
    let scheme = ThresholdHough::try_new(taps, threshold).unwrap().try_with_shift(shift).unwrap();
    check_rate(&scheme, x, &taps, shift, |r, shift, finish| {
        threshold_hough(r, &h, shift, t, finish)
    });
    let scheme = Bsa::try_subtractive(taps, threshold).unwrap().try_with_shift(shift).unwrap();
    check_rate(&scheme, x, &taps, shift, |r, shift, finish| {
        ben_subtractive(r, &h, shift, t, finish)
    });
    let scheme = Bsa::try_multiplicative(taps, 1.5).unwrap().try_with_shift(shift).unwrap();
    check_rate(&scheme, x, &taps, shift, |r, shift, finish| {
        ben_multiplicative(r, &h, shift, S::ratio(1.5), finish)
    });
    let scheme = BsaToolbox::try_new(taps, 3.9).unwrap().try_with_shift(shift).unwrap();
    check_rate(&scheme, x, &taps, shift, |r, shift, finish| {
        ben_toolbox(r, &h, shift, S::ratio(3.9), finish)
    });
    // The decoder, with a spike at every sample: the sum of all taps above the shift.
    let scheme = Hough::new(taps).try_with_shift(shift).unwrap();
    check_rate_decoder(&scheme.decoder(), &[1; 40], &h, shift);
}

#[test]
fn sixteen_bits_are_always_exact() {
    let (min, max) = (i16::MIN, i16::MAX);
    let x: Vec<_> = [min, max, max, max, 0, min, min, max, -1, 1].repeat(4);
    for shift in [min, -1, 0, max] {
        for threshold in [0, 1, max] {
            check_ends([max; 8], &x, shift, threshold);
            check_ends([min; 8], &x, shift, threshold);
            check_ends([max, min, max], &x, shift, threshold);
            check_ends([1], &x, shift, threshold);
        }
    }
}

#[test]
fn thirty_two_bits_saturate_where_the_taps_leave_no_room() {
    let (min, max) = (i32::MIN, i32::MAX);
    let x: Vec<_> = [min, max, max, max, 0, min, min, max, -1, 1].repeat(4);
    let x: Vec<_> = x.into_iter().map(I32F0::from_bits).collect();
    for shift in [min, -1, 0, max].map(I32F0::from_bits) {
        for threshold in [0, 1, max].map(I32F0::from_bits) {
            check_ends([max].map(I32F0::from_bits), &x, shift, threshold);
            check_ends([max / 2, -max / 2].map(I32F0::from_bits), &x, shift, threshold);
            check_ends([max / 8; 8].map(I32F0::from_bits), &x, shift, threshold);
            check_ends([-max / 8; 8].map(I32F0::from_bits), &x, shift, threshold);
            check_ends([1; 3].map(I32F0::from_bits), &x, shift, threshold);
        }
    }
}

/// One by hand: taps of 2³⁰ in all leave residuals of at most 2³⁰ - 1, which HSA then says.
#[test]
fn the_limit_of_a_residual() {
    let half = I32F0::from_bits(1 << 30);
    let taps = Taps::try_new([half]).unwrap();
    let spikes = host_tests::compare::encode(&Hough::new(taps), &[half, I32F0::MAX]).codes();
    assert!(spikes.iter().all(|spike| !spike.is_fired()));
    let taps = Taps::try_new([half - I32F0::DELTA]).unwrap();
    let spikes = host_tests::compare::encode(&Hough::new(taps), &[half, I32F0::MAX]).codes();
    assert!(spikes.iter().all(|spike| spike.is_fired()));
}
