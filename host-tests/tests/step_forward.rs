//! SF, step forward: a spike when the sample leaves `base ± threshold`, and the base follows by one
//! threshold.

use crate::common::{drawn_recordings, flights, hostile_recordings};
use fixed::types::{I8F8};
use host_tests::compare::{
    Wire, assert_step_spikes, check_step_decoder, encode, finite, run, saturated, signs_of,
};
use host_tests::reference::{step_decode_within, step_forward};
use proptest::prelude::*;
use spikewire::temporal::{AdaptiveStepForward, StepForward};
use spikewire::{ConfigError, Scheme, Spike};

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

/// Of a longer past only the last value counts; an empty one changes nothing.
#[test]
fn pasts_of_any_length() {
    let scheme = StepForward::new(1.0_f32);
    let mut encoder = scheme.encoder();
    encoder.prime(&[]);
    assert_eq!((encoder.rejected(), encoder.keyframe()), (0, None));
    encoder.prime(&[f32::NAN, 9.0, 2.0]);
    assert_eq!((encoder.rejected(), encoder.keyframe()), (0, Some(2.0)));
    encoder.prime(&[]);
    assert_eq!(encoder.encode(3.5), Spike::Up);
}

#[test]
fn a_rejected_priming_value_is_counted_and_ignored() {
    let scheme = StepForward::try_new(1.0_f32).unwrap();
    let mut encoder = scheme.encoder();
    encoder.prime(&[f32::NAN]);
    assert_eq!((encoder.rejected(), encoder.keyframe()), (1, None));
    encoder.prime(&[5.0]);
    encoder.prime(&[f32::NEG_INFINITY]);
    assert_eq!((encoder.rejected(), encoder.keyframe()), (2, Some(5.0)));
    assert_eq!(encoder.encode(7.0), Spike::Up);
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

/// All pairs of base and sample within 8 bits, in the middle and at both ends of the type: the spike
/// and the base that it leaves.
#[test]
fn all_pairs_of_8_bits() {
    for (from, to) in [(-128, 127), (i16::MIN, i16::MIN + 255), (i16::MAX - 255, i16::MAX)] {
        for threshold in [1, 2, 100, 255, i16::MAX] {
            let scheme = StepForward::try_new(I8F8::from_bits(threshold)).unwrap();
            let step = scheme.threshold().real();
            let [lowest, highest] = I8F8::ends();
            for base in (from..=to).map(I8F8::from_bits) {
                let mut encoder = scheme.encoder();
                for x in (from..=to).map(I8F8::from_bits) {
                    encoder.prime(&[base]);
                    let expected = step_forward(&[x.real()], step, Some(base.real()));
                    let left = step_decode_within(&expected, step, base.real(), lowest, highest);
                    assert_eq!([encoder.encode(x).sign()], *expected, "{x} at {base}");
                    assert_eq!(encoder.keyframe().map(Wire::real), Some(left[0]));
                    // An exact base never leaves the type.
                    assert_eq!(saturated::<I8F8>(&left), left);
                }
            }
        }
    }
}

/// A sample that is not finite is a silent one, after which the step is the smallest again, as it is for a decoder; and
/// slices count it as samples do.
#[test]
fn adaptive_step_forward_takes_what_is_not_finite_as_silence() {
    use spikewire::Spike::{None as Silent, Up};
    static ADAPTIVE: AdaptiveStepForward<f32> = AdaptiveStepForward::new(1.0, 4);
    let spikes = |samples: &[f32]| {
        let mut encoder = ADAPTIVE.encoder();
        let one_by_one: Vec<Spike> = samples.iter().map(|&sample| encoder.encode(sample)).collect();
        let mut slices = ADAPTIVE.encoder();
        let mut together = vec![Silent; samples.len()];
        slices.encode_slice(samples, &mut together);
        assert_eq!((&together, slices.rejected()), (&one_by_one, encoder.rejected()));
        (one_by_one, encoder.rejected(), encoder.keyframe())
    };
    let far = 1_000.0;
    let (told, rejected, _) = spikes(&[0.0, far, far, f32::NAN, far, far, far]);
    assert_eq!((told, rejected), (vec![Silent, Up, Up, Silent, Up, Up, Up], 1));
    for at in 1..12 {
        for bad in [f32::NAN, f32::INFINITY] {
            let mut samples = vec![0.0];
            samples.extend([20.0; 12]);
            samples[at] = bad;
            samples.extend([20.0; 40]);
            let (told, rejected, held) = spikes(&samples);
            let mut decoder = ADAPTIVE.decoder();
            let last = told.iter().map(|&spike| decoder.decode(spike)).last();
            assert_eq!((last, rejected), (held, 1), "{at}");
        }
    }
}
