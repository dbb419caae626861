//! Histogram and quantiles.

use crate::common::{HOSTILE, drawn_recordings, flights, ranges};
use fixed::types::I8F8;
use host_tests::compare::{Wire, finite};
use host_tests::reference::{even_cell, histogram, quantile_centres};
use proptest::prelude::*;
use spikewire::{ConfigError, Histogram};

fn observed<S: Wire, const B: usize>(min: S, max: S, limit: u16, x: &[S]) -> Histogram<S, B> {
    let mut histogram = Histogram::try_new(min..=max, limit).unwrap();
    for &x in x {
        histogram.observe(x);
    }
    histogram
}

fn check_centres<S: Wire, const B: usize, const M: usize>(ours: &Histogram<S, B>, min: S, max: S) {
    let counts = ours.counts().map(u32::from);
    let expected: Vec<S> = quantile_centres(&counts, min.to_f64(), max.to_f64(), M)
        .into_iter()
        .map(S::nearest)
        .collect();
    let level = expected.windows(2).position(|pair| pair[1] <= pair[0]);
    match (ours.centres::<M>(), level) {
        (Ok(centres), None) => assert_eq!(centres.as_slice(), expected),
        (Err(ConfigError::NotRising { parameter: "centres", index, .. }), Some(level)) => {
            assert_eq!(index, level + 1);
        }
        (ours, _) => panic!("{ours:?} for {expected:?}"),
    }
}

fn check<S: Wire, const B: usize>(min: S, max: S, limit: u16, x: &[S]) {
    let ours = observed::<S, B>(min, max, limit, x);
    let recording = finite(x);
    let accepted: Vec<f64> = recording.accepted.iter().map(|&value| value.into()).collect();
    let counts = histogram(&accepted, min.to_f64(), max.to_f64(), B, limit.into());
    assert_eq!(ours.counts().map(u32::from).as_slice(), counts);
    assert_eq!(ours.seen() as usize, accepted.len());
    assert_eq!(ours.rejected() as usize, recording.rejected.len());
    check_centres::<S, B, 3>(&ours, min, max);
    check_centres::<S, B, 20>(&ours, min, max);
    let mut ours = ours;
    ours.reset();
    assert_eq!(ours, Histogram::new(min..=max, limit));
}

#[test]
fn the_printed_check_values() {
    let mut x = Vec::new();
    for (cell, count) in (0..).zip([0, 1, 6, 30, 90, 30, 6, 1]) {
        x.extend(std::iter::repeat_n(-350 + 100 * cell, count));
    }
    let ours = observed::<i16, 8>(-400, 400, u16::MAX, &x);
    assert_eq!(ours.counts(), &[0, 1, 6, 30, 90, 30, 6, 1]);
    assert_eq!(ours.centres(), Ok([-77, 12, 49, 87, 174]));
    // Even cells of 0..255.
    for (x, cell) in [(50, 0), (51, 1), (101, 1), (102, 2), (203, 3), (204, 4), (255, 4)] {
        assert_eq!(observed::<i16, 5>(0, 255, 9, &[x]).counts()[cell], 1, "{x}");
    }
}

#[test]
fn quantiles_of_any_part() {
    let ours = observed::<f32, 4>(0.0, 4.0, 100, &[0.5, 1.5, 1.6, 2.5]);
    // One more in each cell: 2 3 2 1 of 8.
    let table = [(0, 1, 0.0), (1, 4, 1.0), (1, 2, 5.0 / 3.0), (7, 8, 3.0), (1, 1, 4.0)];
    for (numerator, denominator, value) in table {
        assert_eq!(ours.quantile(numerator, denominator), Some(value));
    }
    assert_eq!((ours.quantile(1, 0), ours.quantile(3, 2)), (None, None));
    // Before any sample they are even.
    let none = Histogram::<f32, 4>::new(0.0..=4.0, 1);
    assert_eq!(none.centres(), Ok([0.5, 1.5, 2.5, 3.5]));
}

/// Where the past fades, the quantiles follow.
#[test]
fn the_past_fades() {
    let mut x = vec![-3.0_f32; 1000];
    x.extend([3.0; 1000]);
    let ours = observed::<_, 16>(-4.0, 4.0, 100, &x);
    assert!(ours.quantile(1, 2).unwrap() > 2.5);
    assert_eq!(ours.counts().iter().filter(|&&count| count > 0).count(), 1);
    let ours = observed::<_, 16>(-4.0, 4.0, u16::MAX, &x);
    assert_eq!(ours.quantile(1, 2), Some(0.0));
}

#[test]
fn constants_and_refusals() {
    static ROLL: Histogram<I8F8, 32> = Histogram::new(I8F8::NEG_ONE..=I8F8::ONE, 1000);
    assert_eq!(ROLL, Histogram::try_new(I8F8::NEG_ONE..=I8F8::ONE, 1000).unwrap());
    let table = [
        (1.0, 1.0, 5, "min and max must rise strictly, but number 1 is 1 after 1"),
        (f32::NAN, 1.0, 5, "min NaN must be finite"),
        (0.0, f32::INFINITY, 5, "max inf must be finite"),
        (0.0, 1.0, 0, "limit 0 must lie in 1..=65535"),
    ];
    for (min, max, limit, message) in table {
        let error = Histogram::<f32, 8>::try_new(min..=max, limit).unwrap_err();
        assert_eq!(error.to_string(), message);
    }
    let error = Histogram::<i16, 8>::new(0..=3, 9).centres::<5>().unwrap_err();
    assert_eq!(error.to_string(), "centres must rise strictly, but number 3 is 2 after 2");
    assert_eq!(
        Histogram::<i16, 8>::new(0..=3, 9).write_centres(&mut []).unwrap_err().to_string(),
        "neurons 0 must lie in 1..=1024"
    );
}

flights!(S: Wire, |x, unit| {
    let at = |value: f64| S::from_f64(value * unit);
    check::<S, 32>(at(-4.0), at(4.0), 1000, &x);
    check::<S, 7>(at(-0.1), at(0.3), u16::MAX, &x);
});

drawn_recordings!(S: Wire, 64, (x in S::recordings(), [min, max] in ranges::<S>(), limit in 1..70_u16) => {
    check::<S, 1>(min, max, limit, &x);
    check::<S, 8>(min, max, limit, &x);
    check::<S, 1000>(min, max, limit, &x);
});

#[test]
fn hostile() {
    check::<f32, 9>(-1e-45, 1e-45, 9, &HOSTILE);
    check::<f32, 9>(f32::MIN, f32::MAX, 9, &HOSTILE);
}

/// The cell of every value, by whole numbers.
#[test]
fn all_65536_inputs() {
    fn check_cells<const B: usize>(min: i16, max: i16) {
        for x in i16::MIN..=i16::MAX {
            let ours = observed::<_, B>(min, max, 9, &[x]);
            let above = i64::from(x.clamp(min, max)) - i64::from(min);
            let cell = above * i64::from(B as u32) / (i64::from(max) - i64::from(min));
            let cell = (cell as usize).min(B - 1);
            assert_eq!(ours.counts()[cell], 1, "{x} of {min}..={max} in {B}");
            assert_eq!(even_cell(x.into(), min.into(), max.into(), B), cell);
        }
    }
    check_cells::<5>(0, 255);
    check_cells::<32>(-20_000, 25_001);
    check_cells::<100>(i16::MIN, i16::MAX);
    check_cells::<7>(-3, 0);
}
