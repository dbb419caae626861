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
use spikewire::{Scheme, Spike};

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

#[test]
fn waits_for_the_look_ahead() {
    let taps = Taps::try_new([1.0_f32, 1.0, 1.0]).unwrap();
    let scheme = Hough::new(taps);
    assert_eq!((scheme.latency(), Hough::<f32, 3>::LATENCY), (2, 2));
    let mut encoder = scheme.encoder();
    let x = [1.0, f32::NAN, 1.0, 1.0, f32::NAN, 1.0];
    let outputs = x.map(|x| encoder.encode(x));
    assert_eq!(outputs, [None, None, None, Some(Spike::Up), None, Some(Spike::None)]);
    assert_eq!((encoder.rejected(), encoder.keyframe()), (2, None));
    assert!(encoder.finish().eq([Spike::None; 2]));
    assert_eq!(encoder.finish_next(), None);
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

/// Room beyond the spikes is not written to.
#[test]
fn a_decoded_slice_ends_with_its_spikes() {
    let scheme = Hough::new(Taps::try_new([1.0_f32, 2.0, 3.0, 4.0]).unwrap());
    let mut decoder = scheme.decoder();
    let mut values = [-1.0; 8];
    assert_eq!(decoder.decode_slice(&[Spike::Up, Spike::None], &mut values), 2);
    assert_eq!(values, [1.0, 2.0, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0]);
    assert_eq!(decoder.decode(Spike::None), 3.0);
}
