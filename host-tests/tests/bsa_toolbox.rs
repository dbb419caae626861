//! BSA as the paper's toolbox has it: `e1 = sum |r[i+j+1] - h[j]|`, `e2 = sum |r[i+j]|`, a spike if
//! `e1 <= e2 * threshold`; then `r[i+j+2] -= h[j]`. The last `F` samples never spike.

use crate::common::rate::{
    all_lengths, drawn_recordings, few_lengths, least, pairs_of_8_bits, spikes_of, triangle,
};
use crate::common::{between, flights, hostile_recordings};
use fixed::types::I8F8;
use host_tests::compare::{Wire, check_rate, encode, reals, signs_of};
use host_tests::reference::ben_toolbox;
use proptest::prelude::*;
use spikewire::rate::{BsaToolbox, Taps};
use spikewire::{Scheme, Spike};

/// Encoder and decoder against the reference.
fn check<S: Wire, const F: usize>(taps: &Taps<S, F>, x: &[S], threshold: f32, shift: S) {
    let scheme = BsaToolbox::try_new(*taps, threshold).unwrap().try_with_shift(shift).unwrap();
    let h = reals(taps.as_array());
    check_rate(&scheme, x, taps, shift, |r, shift, finish| {
        ben_toolbox(r, &h, shift, S::ratio(threshold), finish)
    });
}

#[test]
fn cases_by_hand() {
    // With the taps 1, 1/2 and the shift 0.
    let table: [(&str, &[f32], f32, &[i8]); 7] = [
        ("empty", &[], 1.0, &[]),
        ("as long as the filter", &[1.0, 1.0], 1.0, &[0, 0]),
        ("compared one later: e1 = 0, e2 = 1", &[0.0, 1.0, 0.5], 0.5, &[1, 0, 0]),
        ("exactly: e1 = 0.5, e2 = 1", &[0.0, 1.0, 1.0], 0.5, &[1, 0, 0]),
        ("just not", &[0.0, 1.0, 1.01], 0.5, &[0, 0, 0]),
        // The spike at 0 leaves 2, 0, 0.5, 1 from 1 on, so that e1 = 1 + 0, e2 = 2 at 1.
        ("subtracted two later", &[1.0, 2.0, 1.0, 1.0, 1.0], 0.75, &[1, 1, 0, 0, 0]),
        ("not a number is skipped", &[0.0, f32::NAN, 1.0, 0.5], 0.5, &[1, 0, 0]),
    ];
    let taps = Taps::try_new([1.0_f32, 0.5]).unwrap();
    for (name, x, threshold, expected) in table {
        let scheme = BsaToolbox::try_new(taps, threshold).unwrap();
        assert_eq!(signs_of(&encode(&scheme, x).codes()), expected, "{name}");
        check(&taps, x, threshold, 0.0);
    }
}

#[test]
fn waits_for_the_look_ahead() {
    let taps = Taps::try_new([1.0_f32, 1.0]).unwrap();
    let scheme = BsaToolbox::try_new(taps, 1.0).unwrap();
    assert_eq!((scheme.latency(), BsaToolbox::<f32, 2>::LATENCY), (2, 2));
    let mut encoder = scheme.encoder();
    let outputs = [1.0, f32::NAN, 1.0, 1.0, 9.0].map(|x| encoder.encode(x));
    assert_eq!(outputs, [None, None, None, Some(Spike::Up), Some(Spike::None)]);
    assert_eq!((encoder.rejected(), encoder.keyframe()), (1, None));
    assert!(encoder.finish().eq([Spike::None; 2]));
    assert_eq!(encoder.finish_next(), None);
}

flights!(S: Wire, |x, unit| {
    few_lengths!(check, S, &triangle(unit), &x, 1.15, least(&x));
    few_lengths!(check, S, &triangle(0.1 * unit), &x, 0.9, least(&x));
});

#[test]
fn hostile() {
    for x in hostile_recordings() {
        for threshold in [0.000_1, 0.5, 1.15, 3.999] {
            all_lengths!(check, f32, &triangle(1.0), &x, threshold, -1.0);
            all_lengths!(check, f32, &triangle(1.0), &x, threshold, -1e31);
        }
    }
}

fn thresholds() -> impl Strategy<Value = f32> {
    let all = between(0.000_062, 3.999);
    prop_oneof![between(0.1, 1.5), all, Just(1.0_f32)]
}

drawn_recordings!(check, 128, threshold: thresholds());

/// Filters of one and two taps on all pairs of 8 bits, between two samples that bring the decision
/// out.
#[test]
fn all_pairs_of_8_bits() {
    fn check<const F: usize>(taps: [i16; F], threshold: f32) {
        let taps = Taps::try_new(taps.map(I8F8::from_bits)).unwrap();
        let h = reals(taps.as_array());
        let scheme = BsaToolbox::try_new(taps, threshold).unwrap();
        for [a, b] in pairs_of_8_bits() {
            let x = [30, a, b, 50].map(I8F8::from_bits);
            let expected = ben_toolbox(&x.map(Wire::real), &h, 0.0, I8F8::ratio(threshold), true);
            assert_eq!(spikes_of(&scheme, &x), expected, "{a} {b}");
        }
    }
    check([1], 1.0);
    check([127], 0.5);
    check([1, 1], 0.25);
    check([3, -2], 3.0);
    check([50, 100], 0.4);
}
