//! HSA, the Hough spike algorithm: a spike at `i` if `r[i+j] >= h[j]` for all `j`; then
//! `r[i+j] -= h[j]`.

use crate::common::rate::{
    all_lengths, drawn_recordings, few_lengths, least, pairs_of_8_bits, spikes_of, triangle,
};
use crate::common::{flights, hostile_recordings};
use fixed::types::I8F8;
use host_tests::compare::{Wire, check_rate, encode, reals, signs_of};
use host_tests::reference::hough;
use proptest::prelude::*;
use spikewire::rate::{Hough, Taps};

/// Encoder and decoder against the reference.
fn check<S: Wire, const F: usize>(taps: &Taps<S, F>, x: &[S], shift: S) {
    let scheme = Hough::new(*taps).try_with_shift(shift).unwrap();
    let h = reals(taps.as_array());
    check_rate(&scheme, x, taps, shift, |r, shift, finish| hough(r, &h, shift, finish));
}

#[test]
fn cases_by_hand() {
    // With the taps 1/4, 1, 1/2 and the shift 0.
    let table: [(&str, &[f32], &[i8]); 9] = [
        ("empty", &[], &[]),
        ("shorter than the filter", &[9.0, 9.0], &[0, 0]),
        ("exactly the filter", &[0.25, 1.0, 0.5], &[1, 0, 0]),
        ("a little less", &[0.25, 0.999, 0.5], &[0, 0, 0]),
        ("each spike takes its filter", &[0.25, 1.25, 1.5, 0.5], &[1, 1, 0, 0]),
        ("and leaves the rest", &[0.5, 2.0, 1.0], &[1, 0, 0]),
        ("a cut window never spikes", &[0.0, 9.0, 9.0, 9.0], &[0, 1, 0, 0]),
        ("not a number is skipped", &[0.25, f32::NAN, 1.0, 0.5], &[1, 0, 0]),
        ("infinity is skipped", &[f32::INFINITY, 0.25, 1.0, 0.5], &[1, 0, 0]),
    ];
    let taps = Taps::try_new([0.25_f32, 1.0, 0.5]).unwrap();
    for (name, x, expected) in table {
        assert_eq!(signs_of(&encode(&Hough::new(taps), x).codes()), expected, "{name}");
        check(&taps, x, 0.0);
    }
}

flights!(S: Wire, |x, unit| {
    few_lengths!(check, S, &triangle(0.1 * unit), &x, least(&x));
    few_lengths!(check, S, &triangle(unit), &x, least(&x));
});

#[test]
fn hostile() {
    for x in hostile_recordings() {
        for shift in [0.0, -0.0, -1.0, -1e31] {
            all_lengths!(check, f32, &triangle(1.0), &x, shift);
        }
    }
}

drawn_recordings!(check, 128);

/// Filters of one and two taps on all pairs of 8 bits, the tail included.
#[test]
fn all_pairs_of_8_bits() {
    fn check<const F: usize>(taps: [i16; F]) {
        let taps = Taps::try_new(taps.map(I8F8::from_bits)).unwrap();
        let h = reals(taps.as_array());
        let scheme = Hough::new(taps);
        for pair in pairs_of_8_bits() {
            let pair = pair.map(I8F8::from_bits);
            assert_eq!(
                spikes_of(&scheme, &pair),
                hough(&pair.map(Wire::real), &h, 0.0, true),
                "{pair:?}"
            );
        }
    }
    check([1]);
    check([127]);
    check([-5]);
    check([1, 1]);
    check([3, -2]);
    check([0, 100]);
}
