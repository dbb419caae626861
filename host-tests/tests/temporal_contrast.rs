//! TBR, temporal contrast: `d = x[i] - x[i-1]`; up if `d > threshold`, down if `d < -threshold`.

use crate::common::{drawn_recordings, flights, hostile_recordings};
use host_tests::compare::{
    Wire, assert_step_spikes, check_step_decoder, encode, finite, run, signs_of,
};
use host_tests::reference::temporal_contrast;
use proptest::prelude::*;
use spikewire::Scheme;
use spikewire::temporal::TemporalContrast;

/// Encoder and decoder against the reference, unprimed and primed.
fn check<S: Wire>(x: &[S], threshold: S, step: S, primed: S) {
    let scheme = TemporalContrast::try_new(threshold).unwrap().try_with_step(step).unwrap();
    let recording = finite(x);
    let expected = temporal_contrast(&recording.accepted, threshold.real(), None);
    let unprimed = encode(&scheme, x);
    assert_step_spikes(&unprimed, &recording, &expected);
    check_step_decoder(&scheme, &signs_of(&unprimed.outputs), step, primed);

    let mut encoder = scheme.encoder();
    encoder.prime(&[primed]);
    let expected = temporal_contrast(&recording.accepted, threshold.real(), Some(primed.real()));
    assert_step_spikes(&run(&encoder, x), &recording, &expected);
}

#[test]
fn cases_by_hand() {
    let table: [(&str, &[f32], f32, &[i8]); 9] = [
        ("empty", &[], 1.0, &[]),
        ("the first has no predecessor", &[9.0], 1.0, &[0]),
        ("strictly above", &[0.0, 1.0, 2.5], 1.0, &[0, 0, 1]),
        ("strictly below", &[0.0, -1.0, -2.5], 1.0, &[0, 0, -1]),
        ("slow drift is never seen", &[0.0, 0.75, 1.5, 2.25], 1.0, &[0, 0, 0, 0]),
        ("a jump counts once", &[0.0, 9.0, 9.0], 1.0, &[0, 1, 0]),
        ("not a number is skipped", &[0.0, f32::NAN, 2.0], 1.0, &[0, 0, 1]),
        ("infinity is skipped", &[0.0, f32::INFINITY, 0.0], 1.0, &[0, 0, 0]),
        ("the difference may overflow", &[f32::MIN, f32::MAX, f32::MIN], f32::MAX, &[0, 1, -1]),
    ];
    for (name, x, threshold, expected) in table {
        let scheme = TemporalContrast::try_new(threshold).unwrap();
        assert_eq!(signs_of(&encode(&scheme, x).outputs), expected, "{name}");
        check(x, threshold, threshold, 0.5);
    }
}

#[test]
fn integers_do_not_wrap() {
    let (min, max) = (i16::MIN, i16::MAX);
    let table = [
        ([min, max], max, [0, 1]),
        ([max, min], max, [0, -1]),
        ([0, max], max, [0, 0]),
        ([-1, max], max, [0, 1]),
        ([0, min], max, [0, -1]),
        ([-1, min], max, [0, 0]),
    ];
    for (x, threshold, expected) in table {
        let scheme = TemporalContrast::try_new(threshold).unwrap();
        assert_eq!(signs_of(&encode(&scheme, &x).outputs), expected, "{x:?}");
    }
}

#[test]
fn the_keyframe_is_the_last_sample() {
    let scheme = TemporalContrast::try_new(1.0_f32).unwrap();
    let mut encoder = scheme.encoder();
    assert_eq!(encoder.keyframe(), None);
    for x in [3.0, -1.5, f32::NAN, 2.0] {
        encoder.encode(x);
        let expected = if x.is_nan() { -1.5 } else { x };
        assert_eq!(encoder.keyframe(), Some(expected));
    }
}

flights!(S: Wire, |x, unit| for threshold in [0.01, 0.15, 0.5] {
    let [threshold, step] = [1.0, 2.0].map(|times| S::from_f64(times * threshold * unit));
    check(&x, threshold, step, x[0]);
});

#[test]
fn hostile() {
    for x in hostile_recordings() {
        for threshold in [1e-45, 0.5, 1.0, f32::MAX] {
            check(&x, threshold, threshold, -0.0);
        }
    }
}

drawn_recordings!(S: Wire, 256, (x in S::recordings(), threshold in S::positive(), step in S::positive(), primed in S::value()) => {
    check(&x, threshold, step, primed);
});
