//! Calibration: what the schemes need to know of a recording before it flies.
//!
//! Everything is compared by bits but the deviation. The crate sums squares in one pass, as it cannot
//! keep a recording; the reference takes two. Where all squares are exact, so is the comparison's
//! bound: the variance may differ by the rounding of the two sums, a few 2⁻⁵³ of the mean square.

use crate::common::{drawn_recordings, flight_channels, flights, hostile_recordings};
use fixed::types::I16F16;
use host_tests::compare::{Wire, finite};
use host_tests::flight::calibrated;
use host_tests::reference::{Moments, calibrate};
use proptest::prelude::*;
use spikewire::temporal::TemporalContrast;
use spikewire::{Calibration, ConfigError, Differences};

/// The same mean, and a variance that differs by no more than rounding.
fn assert_moments(ours: Differences, reference: Moments, count: f64) {
    assert_eq!(ours.mean + 0.0, reference.mean + 0.0);
    let [ours, variance] = [ours.deviation, reference.deviation].map(|value| value * value);
    let mean_square = variance + reference.mean * reference.mean;
    let bound = 4.0 * count * f64::EPSILON * mean_square;
    assert!((ours - variance).abs() <= bound, "{ours} for {variance}");
}

fn check<S: Wire>(x: &[S]) {
    let ours = calibrated(x);
    let recording = finite(x);
    let count = recording.accepted.len();
    assert_eq!(ours.seen() as usize, count);
    assert_eq!(ours.rejected() as usize, recording.rejected.len());
    assert_eq!(ours.min().is_some(), count > 0);
    let too_few = ConfigError::TooFewSamples { seen: count as u32, needed: 3 };
    if count < 3 {
        assert_eq!(ours.differences(), Err(too_few));
        assert_eq!(ours.magnitudes(), Err(too_few));
    }
    let Some(reference) = calibrate(&recording.accepted) else { return };
    assert_eq!(ours.min().map(S::to_f64), Some(reference.minimum));
    assert_eq!(ours.max().map(S::to_f64), Some(reference.maximum));
    if count >= 3 {
        assert_moments(ours.differences().unwrap(), reference.differences, count as f64);
        assert_moments(ours.magnitudes().unwrap(), reference.magnitudes, count as f64);
    }
}

#[test]
fn cases_by_hand() {
    // Differences 1, 3, -2: mean 2/3, squares 14.
    let calibration = calibrated(&[0.0_f32, 1.0, f32::NAN, 4.0, 2.0, f32::INFINITY]);
    assert_eq!((calibration.min(), calibration.max()), (Some(0.0), Some(4.0)));
    assert_eq!((calibration.seen(), calibration.rejected()), (4, 2));
    let differences = calibration.differences().unwrap();
    assert_eq!(differences.mean, 2.0 / 3.0);
    assert!((differences.deviation.powi(2) - (14.0 - 4.0 / 3.0) / 2.0).abs() < 1e-15);
    let magnitudes = calibration.magnitudes().unwrap();
    assert_eq!((magnitudes.mean, magnitudes.deviation), (2.0, 1.0));
    assert_eq!(magnitudes.threshold(0.5).unwrap(), 2.5);

    let empty = Calibration::<f32>::default();
    assert_eq!((empty.min(), empty.max(), empty.seen()), (None, None, 0));
}

/// A ramp from 10 to 0 has the signed threshold -1, which no encoder takes, and 1 by magnitudes.
#[test]
fn a_falling_ramp() {
    let ramp: Vec<_> = (0..=10).rev().map(|i| i as f32).collect();
    let calibration = calibrated(&ramp);
    assert_eq!(
        TemporalContrast::from_calibration(&calibration, 1.0),
        Err(ConfigError::NotPositive { parameter: "threshold", value: -1.0 })
    );
    assert_eq!(TemporalContrast::from_magnitudes(&calibration, 1.0).unwrap().threshold(), 1.0);
}

/// The threshold in the sample's type is the reference's, rounded.
#[test]
fn thresholds_of_the_flights() {
    for channel in flight_channels() {
        let reference = calibrate(&channel).unwrap();
        let calibration = calibrated(&channel);
        let thresholds = [
            (TemporalContrast::from_calibration(&calibration, 0.5), reference.differences),
            (TemporalContrast::from_magnitudes(&calibration, 0.5), reference.magnitudes),
        ];
        for (scheme, moments) in thresholds {
            let expected = moments.threshold(0.5) as f32;
            assert_eq!(scheme.unwrap().threshold().to_bits(), expected.to_bits());
        }

        let fixed: Vec<_> = channel.iter().map(|&x| I16F16::from_num(x)).collect();
        let expected = calibrate(&host_tests::compare::reals(&fixed)).unwrap();
        let scheme = TemporalContrast::from_magnitudes(&calibrated(&fixed), 0.5).unwrap();
        let expected = I16F16::nearest(expected.magnitudes.threshold(0.5));
        assert_eq!(scheme.threshold(), expected);
    }
}

flights!(S: Wire, |x, _unit| check(&x));

#[test]
fn hostile() {
    for x in hostile_recordings() {
        check(&x);
    }
}

drawn_recordings!(S: Wire, 256, (x in S::recordings()) => check(&x));
