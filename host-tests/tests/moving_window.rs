//! MW, moving window: a spike when the sample leaves the band around the mean of the `N` before.

use crate::common::{drawn_recordings, flights, flown_channels, hostile_recordings};
use fixed::types::{I8F8, I16F16, I32F0};
use host_tests::compare::{
    Wire, assert_same_values, assert_step_spikes, check_step_decoder, decode, encode, finite,
    reals, run, saturated, signs_of,
};
use host_tests::reference::{moving_window, step_decode_from_first};
use proptest::prelude::*;
use spikewire::temporal::MovingWindow;
use spikewire::{Scheme, Spike, dynamic};

/// Encoder and decoder against the reference, unprimed and primed with a window drawn from `fill`.
fn check<S: Wire, const N: usize>(x: &[S], threshold: S, fill: &[S]) {
    let scheme = MovingWindow::<S, N>::try_new(threshold).unwrap();
    let recording = finite(x);
    let expected = moving_window(&recording.accepted, N, threshold.real(), None);
    let unprimed = encode(&scheme, x);
    assert_step_spikes(&unprimed, &recording, &expected);
    check_step_decoder(&scheme, &signs_of(&unprimed.outputs), threshold, threshold);

    let window: [S; N] =
        std::array::from_fn(|i| fill.get(i % fill.len().max(1)).copied().unwrap_or_default());
    let mut encoder = scheme.encoder();
    // What was seen before priming does not count.
    for &x in x.iter().take(N + 1) {
        encoder.encode(x);
    }
    let rejected = encoder.rejected();
    encoder.prime(&window);
    assert_eq!(encoder.rejected(), rejected);
    assert_eq!(encoder.keyframe(), window.last().copied());
    let expected = moving_window(&recording.accepted, N, threshold.real(), Some(&reals(&window)));
    let mut primed = run(&encoder, x);
    primed.rejected -= rejected;
    assert_step_spikes(&primed, &recording, &expected);
}

/// All lengths of the window.
fn check_all<S: Wire>(x: &[S], threshold: S, fill: &[S]) {
    check::<S, 1>(x, threshold, fill);
    check::<S, 2>(x, threshold, fill);
    check::<S, 3>(x, threshold, fill);
    check::<S, 5>(x, threshold, fill);
    check::<S, 6>(x, threshold, fill);
    check::<S, 11>(x, threshold, fill);
    check::<S, 64>(x, threshold, fill);
}

#[test]
fn cases_by_hand() {
    let table: [(&str, &[f32], f32, &[i8]); 8] = [
        ("empty", &[], 1.0, &[]),
        ("shorter than the window", &[9.0], 1.0, &[0]),
        ("silent until the window is full", &[0.0, 9.0, 9.0], 1.0, &[0, 0, 1]),
        ("strictly above the mean", &[0.0, 2.0, 2.0, 3.5], 1.0, &[0, 0, 0, 1]),
        ("strictly below the mean", &[0.0, 2.0, 0.0, -0.5], 1.0, &[0, 0, 0, -1]),
        ("the window moves", &[0.0, 0.0, 4.0, 4.0, 4.0], 1.0, &[0, 0, 1, 1, 0]),
        ("not a number is skipped", &[0.0, f32::NAN, 0.0, 2.0], 1.0, &[0, 0, 0, 1]),
        ("infinity is skipped", &[0.0, 0.0, f32::INFINITY, 1.0], 1.0, &[0, 0, 0, 0]),
    ];
    for (name, x, threshold, expected) in table {
        let scheme = MovingWindow::<f32, 2>::try_new(threshold).unwrap();
        assert_eq!(signs_of(&encode(&scheme, x).outputs), expected, "{name}");
        check::<f32, 2>(x, threshold, &[0.5]);
    }
}

/// Primed with its own first samples, a recording is compared as in the paper.
#[test]
fn primed_with_the_first_window() {
    let x = [0.0_f32, 3.0, 0.0, 1.0, 2.5];
    let scheme = MovingWindow::<f32, 3>::try_new(1.0).unwrap();
    let mut encoder = scheme.encoder();
    encoder.prime(&[0.0, 3.0, 0.0]);
    // Means: 1, then those of the samples before: 3 + 0 + 0, 0 + 0 + 3, 0 + 3 + 0, 3 + 0 + 1.
    assert_eq!(signs_of(&run(&encoder, &x).outputs), [0, 1, 0, 0, 1]);
}

/// The value of the first sample is known: its spike, which only a window primed with the first samples can
/// make, changes nothing. `5, 0, 0, …` decodes from 5 on, not from 6.
#[test]
fn the_first_spike_changes_nothing() {
    let x = [5.0_f32, 0.0, 0.0, 0.0, 0.0];
    let scheme = MovingWindow::<f32, 2>::new(1.0);
    let mut encoder = scheme.encoder();
    encoder.prime(&x[..2]);
    let spikes = run(&encoder, &x).outputs;
    // Means: 2.5 for the first window, then 2.5 of 5 and 0, then 0.
    assert_eq!(signs_of(&spikes), [1, -1, -1, 0, 0]);
    assert_eq!(decoded_from_first(&scheme, &spikes, x[0]), [5.0, 4.0, 3.0, 3.0, 3.0]);
}

/// The values of a whole recording: the first sample itself, and what a decoder makes of it and the later
/// spikes.
fn decoded_from_first<S: Wire, const N: usize>(
    scheme: &MovingWindow<S, N>,
    spikes: &[Spike],
    first: S,
) -> Vec<S> {
    let mut decoder = scheme.decoder();
    decoder.resync(first);
    [vec![first], decode(&decoder, &spikes[1..])].concat()
}

/// In every type, against the reference: a recording primed with its own first window.
#[test]
fn whole_recordings_from_their_first_sample() {
    fn check<S: Wire, const N: usize>(x: &[S], threshold: S) -> bool {
        let scheme = MovingWindow::<S, N>::try_new(threshold).unwrap();
        let mut encoder = scheme.encoder();
        encoder.prime(x);
        encoder.prime(&x[..N]);
        let spikes = run(&encoder, x).outputs;
        let signs = moving_window(&reals(x), N, threshold.real(), Some(&reals(&x[..N])));
        assert_eq!(signs_of(&spikes), signs);
        let expected = step_decode_from_first(&signs, threshold.real(), x[0].real());
        let ours = decoded_from_first(&scheme, &spikes, x[0]);
        assert_same_values(&ours, &saturated::<S>(&expected));
        signs[0] != 0
    }
    fn count<S: Wire, const N: usize>(threshold: S) -> usize {
        flown_channels(1.0).iter().filter(|x| check::<S, N>(&x[..300], threshold)).count()
    }
    let thresholds = (0.01_f32, I16F16::from_num(0.01), I8F8::DELTA);
    let count =
        count::<_, 6>(thresholds.0) + count::<_, 6>(thresholds.1) + count::<_, 2>(thresholds.2);
    assert!(count > 3, "{count} recordings spiked at their first sample");
}

/// The last `N` of a longer past fill the window; a shorter one is ignored, as is what comes before them. A window that is
/// not finite is counted, and ignored.
#[test]
fn pasts_of_any_length() {
    let scheme = MovingWindow::<f32, 2>::new(1.0);
    let mut encoder = scheme.encoder();
    for (past, rejected, keyframe) in [
        (&[][..], 0, None),
        (&[9.0], 0, None),
        (&[f32::NAN], 0, None),
        (&[1.0, f32::NAN], 1, None),
        (&[f32::NAN, 9.0, 1.0, 2.0], 1, Some(2.0)),
        (&[f32::INFINITY, 9.0], 2, Some(2.0)),
    ] {
        encoder.prime(past);
        assert_eq!((encoder.rejected(), encoder.keyframe()), (rejected, keyframe), "{past:?}");
    }
    assert_eq!(encoder.encode(2.5), Spike::None);
    assert_eq!(encoder.encode(3.5), Spike::Up);
}

#[test]
fn integers_do_not_wrap() {
    fn ends<S: Wire + Ord, const N: usize>(min: S, max: S) {
        let scheme = MovingWindow::<S, N>::try_new(max).unwrap();
        for (first, then, expected) in
            [(min, max, Spike::Up), (max, min, Spike::Down), (max, max, Spike::None)]
        {
            let mut encoder = scheme.encoder();
            encoder.prime(&[first; N]);
            assert_eq!(encoder.encode(then), expected, "{first:?} {then:?}");
        }
    }
    ends::<i16, 1>(i16::MIN, i16::MAX);
    ends::<i16, 16_384>(i16::MIN, i16::MAX);
    ends::<I8F8, 16_384>(I8F8::MIN, I8F8::MAX);
    ends::<I16F16, 16_384>(I16F16::MIN, I16F16::MAX);
    ends::<I32F0, 16_384>(I32F0::MIN, I32F0::MAX);
}

/// Sums change between 32 and 64 bits where samples become large, and back.
#[test]
fn the_width_of_a_sum_does_not_show() {
    for end in [1 << 22, 1 << 25, 1 << 26, 1 << 27, 1 << 28, 1 << 29, i32::MAX] {
        let swing = (0..200).map(|i| [i, end, -end, end - 1, -end - 1][i as usize % 5]);
        let stay = [end - 1, -end, 3, end].into_iter().flat_map(|value| [value; 100]);
        let x: Vec<_> = swing.chain(stay).map(I32F0::from_bits).collect();
        for threshold in [1, end / 2 + 1, end] {
            check_all(&x, I32F0::from_bits(threshold), &x[..5]);
        }
    }
}

#[test]
fn the_keyframe_is_the_last_sample_of_a_full_window() {
    let scheme = MovingWindow::<f32, 3>::try_new(1.0).unwrap();
    let mut encoder = scheme.encoder();
    for (i, x) in [3.0, -1.5, f32::NAN, 2.0, 7.0, 1.0, 5.0, 4.0].into_iter().enumerate() {
        encoder.encode(x);
        assert_eq!(encoder.keyframe(), (i >= 3).then_some(x), "{i}");
    }
}

flights!(S: Wire, |x, unit| for threshold in [0.01, 0.25] {
    check_all(&x, S::from_f64(threshold * unit), &x);
});

#[test]
fn hostile() {
    for x in hostile_recordings() {
        for threshold in [1e-45, 0.5, 1.0, f32::MAX] {
            check_all(&x, threshold, &[1.0, -0.0, 3.0]);
        }
    }
}

/// The most samples that there may be, one by one and in slices. Slices must not forget the sample in the last slot, or
/// keep it: at the end it has left the window, so that the mean is 0, and -1 is within its band.
#[test]
fn the_longest_window() {
    static LONGEST: MovingWindow<i16, 16_384> = MovingWindow::new(1);
    let mut x = vec![0; 3 * 16_384];
    (x[16_383], x[20_000]) = (1000, 3);
    *x.last_mut().unwrap() = -1;
    let mut one_by_one = LONGEST.encoder();
    let expected: Vec<_> = x.iter().map(|&x| one_by_one.encode(x)).collect();
    assert_eq!(expected.iter().filter(|spike| spike.is_fired()).count(), 1);
    let mut in_slices = LONGEST.encoder();
    let mut spikes = vec![Spike::None; x.len()];
    for (x, spikes) in x.chunks(9999).zip(spikes.chunks_mut(9999)) {
        in_slices.encode_slice(x, spikes);
    }
    assert_eq!(spikes, expected);
}

/// A window chosen at run time takes a past, and forgets no sample that it rejected.
#[test]
fn a_past_leaves_the_count_of_rejected_samples() {
    let scheme = dynamic::MovingWindow::try_new(1.0_f32, 2).unwrap();
    let mut encoder = scheme.encoder();
    encoder.encode(f32::NAN);
    encoder.prime(&[3.0, 4.0]);
    assert_eq!((encoder.rejected(), encoder.keyframe()), (1, Some(4.0)));
}

/// The sum must not remember samples that have left the window.
#[test]
fn does_not_drift() {
    let scheme = MovingWindow::<f32, 6>::try_new(1e-3).unwrap();
    let mut encoder = scheme.encoder();
    for i in 0..100_000 {
        encoder.encode(if i % 3 == 0 { 1e7 } else { -0.1 });
    }
    for _ in 0..12 {
        encoder.encode(0.1);
    }
    assert_eq!(encoder.encode(0.1), Spike::None);
    assert_eq!(encoder.encode(0.102), Spike::Up);
}

drawn_recordings!(S: Wire, 96, (x in S::recordings(), threshold in S::positive(), fill in proptest::collection::vec(S::value(), 0..7)) => {
    check_all(&x, threshold, &fill);
});
