//! SF, step forward: a spike when the sample leaves `base ± threshold`, and the base follows by one
//! threshold.

use crate::common::{drawn_recordings, flights, hostile_recordings};
use host_tests::compare::{
    Wire, assert_step_spikes, check_step_decoder, encode, finite, run, signs_of,
};
use host_tests::reference::step_forward;
use proptest::prelude::*;
use spikewire::temporal::StepForward;
use spikewire::{ConfigError, Scheme};

/// Encoder and decoder against the reference, unprimed and primed.
fn check<S: Wire>(x: &[S], threshold: S, primed: S) {
    let scheme = StepForward::try_new(threshold);
    if threshold.to_f64() > 1e31 {
        assert!(matches!(scheme, Err(ConfigError::OutOfRange { parameter: "threshold", .. })));
        return;
    }
    let scheme = scheme.unwrap();
    let recording = finite(x);
    let expected = step_forward(&recording.accepted, threshold.real(), None);
    let unprimed = encode(&scheme, x);
    assert_step_spikes(&unprimed, &recording, &expected);
    check_step_decoder(&scheme, &signs_of(&unprimed.outputs), threshold, primed);

    let mut encoder = scheme.encoder();
    encoder.prime(&[primed]);
    let expected = step_forward(&recording.accepted, threshold.real(), Some(primed.real()));
    assert_step_spikes(&run(&encoder, x), &recording, &expected);
}

#[test]
fn cases_by_hand() {
    let table: [(&str, &[f32], f32, &[i8]); 10] = [
        ("empty", &[], 1.0, &[]),
        ("the first is the base", &[9.0], 1.0, &[0]),
        ("strictly above", &[0.0, 1.0, 1.5], 1.0, &[0, 0, 1]),
        ("strictly below", &[0.0, -1.0, -1.5], 1.0, &[0, 0, -1]),
        ("one step a sample", &[0.0, 3.5, 3.5, 3.5, 3.5], 1.0, &[0, 1, 1, 1, 0]),
        ("slow drift is seen", &[0.0, 0.75, 1.5, 2.25], 1.0, &[0, 0, 1, 1]),
        ("down goes down", &[0.0, -1.5, -1.5, -0.5], 1.0, &[0, -1, 0, 0]),
        ("not a number is skipped", &[0.0, f32::NAN, 2.0, 2.0], 1.0, &[0, 0, 1, 0]),
        ("infinity leaves the base", &[0.0, f32::INFINITY, 0.5], 1.0, &[0, 0, 0]),
        ("a bad first is no base", &[f32::NAN, 9.0, 9.5], 1.0, &[0, 0, 0]),
    ];
    for (name, x, threshold, expected) in table {
        let scheme = StepForward::try_new(threshold).unwrap();
        assert_eq!(signs_of(&encode(&scheme, x).outputs), expected, "{name}");
        check(x, threshold, 0.25);
    }
}

#[test]
fn integers_do_not_wrap() {
    let (min, max) = (i16::MIN, i16::MAX);
    let table = [
        (min, max, vec![max; 4], vec![1, 1, 0, 0], max - 1),
        (max, max, vec![min; 4], vec![-1, -1, 0, 0], min + 1),
        (max - 1, 1, vec![max, max], vec![0, 0], max - 1),
        (max - 2, 1, vec![max, max], vec![1, 0], max - 1),
        (min + 2, 1, vec![min, min], vec![-1, 0], min + 1),
    ];
    for (base, threshold, x, expected, left) in table {
        let scheme = StepForward::try_new(threshold).unwrap();
        let mut encoder = scheme.encoder();
        encoder.prime(&[base]);
        let spikes: Vec<_> = x.iter().map(|&x| encoder.encode(x).sign()).collect();
        assert_eq!((spikes, encoder.keyframe()), (expected, Some(left)), "{base} {threshold}");
    }
}

flights!(S: Wire, |x, unit| for threshold in [0.01, 0.15, 0.5] {
    check(&x, S::from_f64(threshold * unit), x[0]);
});

#[test]
fn hostile() {
    for x in hostile_recordings() {
        for threshold in [1e-45, 0.5, 1.0, 1e31, f32::MAX] {
            check(&x, threshold, -0.0);
        }
    }
}

/// No threshold that is allowed makes a band that infinity lies within.
#[test]
fn largest_bands() {
    for base in [f32::MAX, f32::MIN] {
        let x = [base, f32::INFINITY, base, f32::NEG_INFINITY, f32::NAN, f32::MAX, f32::MIN];
        for threshold in [1e-45, 1.0, 1e31, 1e31_f32.next_up()] {
            check(&x, threshold, base);
        }
    }
}

drawn_recordings!(S: Wire, 256, (x in S::recordings(), threshold in S::positive(), primed in S::value()) => {
    check(&x, threshold, primed);
});
