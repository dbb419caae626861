//! BSA aligned: with `e1 = sum |r[i+j] - h[j]|` and `e2 = sum |r[i+j]|` a spike if
//! `e1 <= e2 - threshold` or `e1 <= e2 * threshold`; then `r[i+j] -= h[j]`.

use crate::common::rate::{
    all_lengths, drawn_recordings, few_lengths, least, pairs_of_8_bits, spikes_of, triangle,
};
use crate::common::{Drawn, between, flights, hostile_recordings};
use fixed::types::I8F8;
use host_tests::compare::{Wire, check_rate, decode, encode, reals, signs_of};
use host_tests::reference::{ben_multiplicative, ben_subtractive};
use proptest::prelude::*;
use spikewire::Scheme;
use spikewire::rate::{Bsa, Scale, Shape, Taps};

/// Both criteria against the reference, encoder and decoder.
fn check<S: Wire, const F: usize>(taps: &Taps<S, F>, x: &[S], threshold: S, ratio: f32, shift: S) {
    let h = reals(taps.as_array());
    let scheme = Bsa::try_subtractive(*taps, threshold).unwrap().try_with_shift(shift).unwrap();
    check_rate(&scheme, x, taps, shift, |r, shift, finish| {
        ben_subtractive(r, &h, shift, threshold.real(), finish)
    });
    let scheme = Bsa::try_multiplicative(*taps, ratio).unwrap().try_with_shift(shift).unwrap();
    check_rate(&scheme, x, taps, shift, |r, shift, finish| {
        ben_multiplicative(r, &h, shift, S::ratio(ratio), finish)
    });
}

#[test]
fn subtractive_by_hand() {
    // With the taps 1/4, 1, 1/2 and the shift 0.
    let table: [(&str, &[f32], f32, &[i8]); 8] = [
        ("empty", &[], 0.5, &[]),
        ("e1 = 0, e2 = 1.75", &[0.25, 1.0, 0.5], 1.75, &[1, 0, 0]),
        ("e1 = 0.125, e2 = 1.625", &[0.25, 1.0, 0.375], 1.5, &[1, 0, 0]),
        ("just not", &[0.25, 1.0, 0.375], 1.501, &[0, 0, 0]),
        ("too much counts too", &[0.25, 3.0, 0.5], 1.75, &[1, 0, 0]),
        ("a cut window: e1 = 0.25, e2 = 1.5", &[0.0, 0.5, 1.0], 1.25, &[0, 1, 0]),
        ("a single sample: e1 = 0, e2 = 0.25", &[0.25], 0.25, &[1]),
        ("not a number is skipped", &[0.25, 1.0, f32::NAN, 0.5], 1.75, &[1, 0, 0]),
    ];
    let taps = Taps::try_new([0.25_f32, 1.0, 0.5]).unwrap();
    for (name, x, threshold, expected) in table {
        let scheme = Bsa::try_subtractive(taps, threshold).unwrap();
        assert_eq!(signs_of(&encode(&scheme, x).codes()), expected, "{name}");
        check(&taps, x, threshold, 0.5, 0.0);
    }
}

#[test]
fn multiplicative_by_hand() {
    // With the taps 1/4, 1, 1/2 and the shift 0.
    let table: [(&str, &[f32], f32, &[i8]); 6] = [
        ("empty", &[], 0.5, &[]),
        ("0 is a part of anything", &[0.25, 1.0, 0.5], 0.0625, &[1, 0, 0]),
        ("e1 = 0.5, e2 = 2", &[0.5, 1.25, 0.25], 0.375, &[1, 0, 0]),
        ("exactly a quarter", &[0.25, 1.5, 0.25], 0.375, &[1, 0, 0]),
        ("a cut window: e1 = 0.25, e2 = 1.5", &[0.0, 0.5, 1.0], 0.1875, &[0, 1, 0]),
        ("the tail: e1 = 0.25, e2 = 0.5", &[0.5], 0.5, &[1]),
    ];
    let taps = Taps::try_new([0.25_f32, 1.0, 0.5]).unwrap();
    for (name, x, threshold, expected) in table {
        let scheme = Bsa::try_multiplicative(taps, threshold).unwrap();
        assert_eq!(signs_of(&encode(&scheme, x).codes()), expected, "{name}");
        check(&taps, x, 0.5, threshold, 0.0);
    }
}

/// `0.5 + 0.4 sin(2π·0.01 i)`, 1000 samples, 24 Hann taps of unit sum: the spikes and the error over
/// samples 30..970, as printed in the schemes' page.
#[test]
fn the_printed_check_values() {
    let taps = Taps::<f32, 24>::try_shaped(Shape::Hann, Scale::Sum(1.0)).unwrap();
    let angle = |i| std::f64::consts::TAU * 0.01 * f64::from(i);
    let x: Vec<_> = (0..1000).map(|i| (0.5 + 0.4 * angle(i).sin()) as f32).collect();
    let table = [
        (0.0, 713, 0.2425, 5e-5),
        (0.5, 598, 0.1222, 5e-5),
        (0.9, 505, 0.0183, 5e-5),
        (0.955, 493, 0.00707, 5e-6),
    ];
    for (threshold, spikes, error, half_a_digit) in table {
        let scheme = Bsa::try_subtractive(taps, threshold).unwrap();
        let codes = encode(&scheme, &x).codes();
        assert_eq!(codes.iter().filter(|code| code.is_fired()).count(), spikes, "{threshold}");
        let values = decode(&scheme.decoder(), &codes);
        let squares = (30..970).map(|i| (f64::from(x[i]) - f64::from(values[i])).powi(2));
        let measured = (squares.sum::<f64>() / 940.0).sqrt();
        assert!((measured - error).abs() <= half_a_digit, "{threshold}: {measured}");
        check(&taps, &x, threshold, 1.0, 0.0);
    }
}

flights!(S: Wire, |x, unit| {
    few_lengths!(check, S, &triangle(0.1 * unit), &x, S::from_f64(0.3 * unit), 0.7, least(&x));
});

#[test]
fn hostile() {
    for x in hostile_recordings() {
        for (threshold, ratio) in [(0.0, 1.0), (-0.0, 0.5), (1e-45, 3.999), (f32::MAX, 0.001)] {
            all_lengths!(check, f32, &triangle(1.0), &x, threshold, ratio, -1.0);
            all_lengths!(check, f32, &triangle(1.0), &x, threshold, ratio, -1e31);
        }
    }
}

fn thresholds<S: Wire + Drawn>() -> impl Strategy<Value = S> {
    let threshold = prop_oneof![Just(S::default()), S::positive(), S::tap()];
    threshold.prop_filter("not negative", |value| *value >= S::default())
}

/// Any ratio that is allowed, exact multiples of 2⁻¹⁴ and halves between them often.
fn ratios() -> impl Strategy<Value = f32> {
    let grid = (2..131_070_u32).prop_map(|halves| halves as f32 / 32_768.0);
    prop_oneof![grid, between(0.1, 1.5), between(0.000_062, 3.999)]
}

drawn_recordings!(check, 96, threshold: thresholds::<S>(), ratio: ratios());

/// Filters of one and two taps on all pairs of 8 bits, the tail included.
#[test]
fn all_pairs_of_8_bits() {
    fn check<const F: usize>(taps: [i16; F], threshold: i16, ratio: f32) {
        let taps = Taps::try_new(taps.map(I8F8::from_bits)).unwrap();
        let threshold = I8F8::from_bits(threshold);
        let h = reals(taps.as_array());
        let schemes = [
            Bsa::try_subtractive(taps, threshold).unwrap(),
            Bsa::try_multiplicative(taps, ratio).unwrap(),
        ];
        for pair in pairs_of_8_bits() {
            let pair = pair.map(I8F8::from_bits);
            let r = pair.map(Wire::real);
            let expected = [
                ben_subtractive(&r, &h, 0.0, threshold.real(), true),
                ben_multiplicative(&r, &h, 0.0, I8F8::ratio(ratio), true),
            ];
            for (scheme, expected) in schemes.iter().zip(expected) {
                assert_eq!(spikes_of(scheme, &pair), expected, "{scheme:?} {pair:?}");
            }
        }
    }
    check([1], 0, 1.0);
    check([2], 1, 0.5); // 4 - 2 is exactly half of 4
    check([127], 5, 0.5);
    check([1, 1], 0, 0.25);
    check([3, -2], 1, 3.0);
    check([10, 20], 10, 0.5);
    check([50, 100], 40, 0.4);
    check([50, 100], i16::MAX, 0.000_1);
}
