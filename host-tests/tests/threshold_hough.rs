//! T-HSA, the threshold Hough spike algorithm: `error = sum over j of max(0, h[j] - r[i+j])`; a spike
//! if `error <= threshold`; then `r[i+j] -= h[j]`.

use crate::common::rate::{
    all_lengths, drawn_recordings, few_lengths, least, pairs_of_8_bits, spikes_of, triangle,
};
use crate::common::{Drawn, between, cases, flights, hostile_recordings};
use fixed::types::I8F8;
use host_tests::compare::{Wire, check_rate, encode, reals, signs_of};
use host_tests::reference::threshold_hough;
use proptest::collection::vec;
use proptest::prelude::*;
use spikewire::rate::{Hough, Taps, ThresholdHough};

/// Encoder and decoder against the reference.
fn check<S: Wire, const F: usize>(taps: &Taps<S, F>, x: &[S], threshold: S, shift: S) {
    let scheme = ThresholdHough::try_new(*taps, threshold).unwrap().try_with_shift(shift).unwrap();
    let h = reals(taps.as_array());
    check_rate(&scheme, x, taps, shift, |r, shift, finish| {
        threshold_hough(r, &h, shift, threshold.real(), finish)
    });
}

#[test]
fn cases_by_hand() {
    // With the taps 1/4, 1, 1/2 and the shift 0.
    let table: [(&str, &[f32], f32, &[i8]); 9] = [
        ("empty", &[], 0.5, &[]),
        ("exactly the threshold", &[0.25, 0.75, 0.25, -9.0], 0.5, &[1, 0, 0, 0]),
        ("a little more", &[0.25, 0.75, 0.2, -9.0], 0.5, &[0, 0, 0, 0]),
        ("too much is no excuse for too little", &[9.0, 9.0, 0.0, -9.0], 0.25, &[0, 0, 0, 0]),
        ("nothing fits a zero", &[0.0, 0.0, 0.0], 0.0, &[0, 0, 0]),
        ("past the end nothing is missing", &[0.0, 0.0, 0.0], 0.25, &[0, 0, 1]),
        ("even in the last two", &[0.0, 0.0, 0.0], 1.25, &[0, 1, 1]),
        ("a single sample", &[0.1], 0.25, &[1]),
        ("not a number is skipped", &[0.25, 1.0, f32::NAN, 0.5, -9.0], 0.0, &[1, 0, 0, 0]),
    ];
    let taps = Taps::try_new([0.25_f32, 1.0, 0.5]).unwrap();
    for (name, x, threshold, expected) in table {
        let scheme = ThresholdHough::try_new(taps, threshold).unwrap();
        assert_eq!(signs_of(&encode(&scheme, x).codes()), expected, "{name}");
        check(&taps, x, threshold, 0.0);
    }
}

/// A threshold that the first spike's shortfall hits exactly, in numbers so large that the order of a sum decides.
#[test]
fn a_threshold_that_a_large_shortfall_hits() {
    const LARGE: f32 = (1 << 30) as f32;
    let numbers = |count| vec(0.0..LARGE, count);
    proptest!(cases(256), |(taps in numbers(15), x in numbers(40))| {
        let short = |window: &[f32]| {
            window.iter().zip(&taps).fold(0.0, |sum, (x, tap)| sum + (tap - x).max(0.0))
        };
        let least = x.windows(15).map(short).fold(f32::INFINITY, f32::min);
        let taps = Taps::try_new(taps.as_slice().try_into().unwrap()).unwrap();
        for threshold in [least.next_down().max(0.0), least, least.next_up()] {
            check::<f32, 15>(&taps, &x, threshold, 0.0);
        }
    });
}

flights!(S: Wire, |x, unit| {
    few_lengths!(check, S, &triangle(0.1 * unit), &x, S::from_f64(0.05 * unit), least(&x));
    few_lengths!(check, S, &triangle(unit), &x, S::from_f64(0.85 * unit), least(&x));
});

#[test]
fn hostile() {
    for x in hostile_recordings() {
        for threshold in [0.0, -0.0, 1e-45, 1.0, f32::MAX] {
            all_lengths!(check, f32, &triangle(1.0), &x, threshold, -1.0);
            all_lengths!(check, f32, &triangle(1.0), &x, threshold, -1e31);
        }
    }
}

fn thresholds<S: Wire + Drawn>() -> impl Strategy<Value = S> {
    prop_oneof![Just(S::default()), S::positive()]
}

drawn_recordings!(check, 128, threshold: thresholds::<S>());

/// Thresholds that a window just keeps, and just misses, when it is summed first tap first: another
/// order of the sum would decide some of them otherwise.
#[test]
fn at_the_limit() {
    let taps = proptest::array::uniform8(between(0.1, 1.0));
    let x = proptest::collection::vec(-1.0_f32..1.5, 8..40);
    proptest!(cases(512), |(x in x, taps in taps, window in any::<prop::sample::Index>())| {
        let window = &x[window.index(x.len() - 7)..][..8];
        let lacks = taps.iter().zip(window).map(|(tap, x)| (x - tap).abs() - (x - tap));
        let limit = lacks.fold(0.0, |sum: f32, lack| sum + lack) / 2.0;
        let taps = Taps::try_new(taps).unwrap();
        for threshold in [limit.next_down().max(0.0), limit, limit.next_up()] {
            check(&taps, &x, threshold, 0.0);
        }
    });
}

/// In flight, where windows are whole, a threshold of 0 makes it HSA.
#[test]
fn without_tolerance_it_is_the_hough_spiker() {
    proptest!(cases(128), |((x, taps) in crate::common::rate::recordings::<f32>())| {
        let taps = crate::common::rate::first_taps::<f32, 8>(&taps);
        let outputs = encode(&ThresholdHough::try_new(taps, 0.0).unwrap(), &x).outputs;
        prop_assert_eq!(outputs, encode(&Hough::new(taps), &x).outputs);
    });
}

/// The same at both ends of the range: the largest samples over the largest taps.
#[test]
fn without_tolerance_at_the_ends() {
    for tap in [1e30, -1e30] {
        let taps = Taps::try_new([tap; 8]).unwrap();
        for x in hostile_recordings() {
            for shift in [0.0, 1e31, -1e31] {
                let nearly =
                    ThresholdHough::try_new(taps, 0.0).unwrap().try_with_shift(shift).unwrap();
                let whole = Hough::new(taps).try_with_shift(shift).unwrap();
                assert_eq!(encode(&nearly, &x).outputs, encode(&whole, &x).outputs, "{x:?}");
            }
        }
    }
}

/// Filters of one and two taps on all pairs of 8 bits, the tail included.
#[test]
fn all_pairs_of_8_bits() {
    fn check<const F: usize>(taps: [i16; F], threshold: i16) {
        let taps = Taps::try_new(taps.map(I8F8::from_bits)).unwrap();
        let threshold = I8F8::from_bits(threshold);
        let h = reals(taps.as_array());
        let scheme = ThresholdHough::try_new(taps, threshold).unwrap();
        for pair in pairs_of_8_bits() {
            let pair = pair.map(I8F8::from_bits);
            let expected = threshold_hough(&pair.map(Wire::real), &h, 0.0, threshold.real(), true);
            assert_eq!(spikes_of(&scheme, &pair), expected, "{pair:?}");
        }
    }
    check([1], 0);
    check([127], 5);
    check([1, 1], 0);
    check([3, -2], 1);
    check([50, 100], 40);
    check([50, 100], i16::MAX);
}
