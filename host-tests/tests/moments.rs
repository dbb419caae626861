//! Mean and deviation: exact in fixed point, within rounding in `f32`.

use crate::common::{drawn_recordings, flights, hostile_recordings};
use fixed::types::{I8F8, I32F0};
use host_tests::compare::{Wire, finite};
use proptest::prelude::*;
use spikewire::{ConfigError, Moments};

fn observed<S: Wire>(x: &[S]) -> Moments<S> {
    let mut moments = Moments::new();
    for &x in x {
        moments.observe(x);
    }
    moments
}

/// Mean and deviation (N-1) by two passes. The first sample is taken off all others before they are summed, so
/// that a large mean costs no digits.
fn two_passes(x: &[f64]) -> (f64, f64) {
    let count = x.len() as f64;
    let above: f64 = x.iter().map(|value| (value - x[0]) / count).sum();
    let squares: f64 = x.iter().map(|value| ((value - x[0]) - above).powi(2)).sum();
    (x[0] + above, (squares / (count - 1.0)).sqrt())
}

fn check<S: Wire>(x: &[S]) {
    let ours = observed(x);
    let recording = finite(x);
    let seen = recording.accepted.len() as u32;
    assert_eq!((ours.seen(), ours.rejected() as usize), (seen, recording.rejected.len()));
    if seen == 0 {
        assert_eq!(ours.mean(), Err(ConfigError::TooFewSamples { seen, needed: 1 }));
    }
    if seen < 2 {
        assert_eq!(ours.deviation(), Err(ConfigError::TooFewSamples { seen, needed: 2 }));
        return;
    }
    let values: Vec<f64> = recording.accepted.iter().map(|&value| value.into()).collect();
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let (mean, deviation) = two_passes(&values);
    let rounding = f64::from(seen) * f64::EPSILON * largest;
    assert!((ours.mean().unwrap() - mean).abs() <= 4.0 * rounding, "mean {mean}");
    // A deviation of nearly nothing keeps the rounding of the values themselves.
    let ours = ours.deviation().unwrap();
    assert!(
        (ours - deviation).abs() <= 1e-12 * deviation + 4.0 * rounding,
        "{ours} for {deviation}"
    );
}

#[test]
fn cases_by_hand() {
    let moments = observed(&[2.0_f32, 4.0, f32::NAN, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0]);
    assert_eq!((moments.seen(), moments.ignored(), moments.rejected()), (8, 0, 1));
    assert_eq!(moments.mean(), Ok(5.0));
    assert!((moments.deviation().unwrap() - (32.0_f64 / 7.0).sqrt()).abs() < 1e-15);
    let quarters = [0.25, 0.5, 0.75].map(I8F8::from_num);
    assert_eq!((observed(&quarters).mean(), observed(&quarters).deviation()), (Ok(0.5), Ok(0.25)));
}

/// A large mean takes no digits from the deviation of whole numbers, at the ends of the range, in any order.
#[test]
fn whole_numbers_are_exact() {
    for top in [i32::MAX, i32::MIN + 1] {
        let x: Vec<_> = (0..100_000).map(|i| I32F0::from_bits(top - i % 2)).collect();
        let (forwards, backwards) =
            (observed(&x), observed(&x.iter().rev().copied().collect::<Vec<_>>()));
        assert_eq!(forwards.mean(), Ok(f64::from(top) - 0.5));
        assert_eq!(forwards.deviation(), Ok((25_000.0_f64 / 99_999.0).sqrt()));
        assert_eq!(forwards.deviation(), backwards.deviation());
    }
    let widest = [i16::MIN, i16::MAX];
    assert_eq!(observed(&widest).mean(), Ok(-0.5));
    assert_eq!(observed(&widest).deviation(), Ok(65_535.0 / 2.0_f64.sqrt()));
}

/// Those after the first 2³²-1 are counted, and change nothing.
#[test]
#[ignore = "minutes"]
fn more_samples_than_it_takes() {
    let mut moments = Moments::<i16>::new();
    (0..u32::MAX).for_each(|_| moments.observe(std::hint::black_box(3)));
    assert_eq!((moments.seen(), moments.ignored()), (u32::MAX, 0));
    (0..2).for_each(|_| moments.observe(9));
    assert_eq!((moments.seen(), moments.ignored()), (u32::MAX, 2));
    assert_eq!(moments.mean(), Ok(3.0));
}

flights!(S: Wire, |x, _unit| check(&x));

#[test]
fn hostile() {
    for x in hostile_recordings() {
        check(&x);
    }
}

drawn_recordings!(S: Wire, 256, (x in S::recordings()) => check(&x));
