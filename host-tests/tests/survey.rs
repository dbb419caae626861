//! The survey before arming: its verdicts, and the laws of the thresholds that it gives.

use crate::common::{between, cases, flown_channels};
use fixed::types::{I8F8, I16F16};
use host_tests::compare::Wire;
use proptest::prelude::*;
use spikewire::{Conditions, ConfigError, Fit, Spike, Start, Survey, Unfit};

fn watched<S: Wire, const B: usize>(conditions: Conditions<S>, x: &[S]) -> Survey<S, B> {
    let mut survey = Survey::new(conditions);
    for &x in x {
        survey.observe(x);
    }
    survey
}

const REST: Conditions<f32> = Conditions::new(4, -10.0..=10.0, 1.0).with_stillness(2.0);

#[test]
fn verdicts() {
    let verdict = |x: &[f32]| watched::<_, 8>(REST, x).verdict().map(|_| ());
    for (x, expected) in [
        (&[][..], Err(Unfit::TooFewSamples { seen: 0, needed: 4 })),
        (&[0.5, 1.0, 0.5], Err(Unfit::TooFewSamples { seen: 3, needed: 4 })),
        (&[0.5, 1.0, 0.5, 1.0], Ok(())),
        (&[0.5, 0.5, 0.5, 0.5], Err(Unfit::Constant)),
        (&[9.0, 9.5, 10.0, 9.5], Err(Unfit::Saturated { samples: 1 })),
        (&[-10.0, -10.0, -12.0, -10.0], Err(Unfit::Saturated { samples: 4 })),
        (&[0.0, 1.0, 2.0, 1.0], Ok(())), // as far as allowed
        (&[8.0, 9.0, 8.0, 9.0], Ok(())),
        (&[0.0, 1.0, 2.5, 1.0], Err(Unfit::Moving { distance: 2.5, stillness: 2.0 })),
        (&[0.0, 1.0, f32::NAN, 1.0, 0.0], Err(Unfit::NotFinite { samples: 1 })),
    ] {
        assert_eq!(verdict(x), expected, "{x:?}");
    }
    let may_move = Conditions::new(4, -10.0..=10.0, 1.0);
    assert!(watched::<_, 8>(may_move, &[0.0, 1.0, 2.5, 1.0]).verdict().is_ok());
    assert_eq!(
        Unfit::Moving { distance: 2.5, stillness: 2.0 }.to_string(),
        "the samples spread over 2.5, at rest 2 at most"
    );
}

#[test]
fn a_reset_forgets_all() {
    let mut survey = watched::<f32, 8>(REST, &[0.0, f32::NAN, 11.0]);
    survey.reset();
    for x in [0.5, 1.0, 0.5, 1.0] {
        survey.observe(x);
    }
    let fit = survey.verdict().unwrap();
    assert_eq!(fit.moments().mean(), Ok(0.75));
    assert_eq!(fit.calibration().max(), Some(1.0));
    assert_eq!(fit.changes().counts(), &[0, 0, 0, 0, 3, 0, 0, 0]); // all of 0.5
    assert_eq!(fit.levels().seen(), 4);
}

#[test]
fn conditions_by_name() {
    for (conditions, expected) in [
        (Conditions::try_new(2, -1.0..=1.0, 1.0_f32), "samples 2 must lie in 3..=4294967300"),
        (Conditions::try_new(3, 1.0..=-1.0, 1.0), "min and max must rise"),
        (Conditions::try_new(3, f32::NAN..=1.0, 1.0), "min NaN must be finite"),
        (Conditions::try_new(3, -1.0..=1.0, 0.0), "largest change 0 must be above 0"),
        (REST.try_with_stillness(0.0), "stillness 0 must be above 0"),
    ] {
        let said = conditions.unwrap_err().to_string();
        assert!(said.starts_with(expected), "{said}");
    }
}

#[test]
fn thresholds_by_hand() {
    // Changes 1, 1, 1, 5, 1, 1, 1, 5: two of eight are above 1.
    let x = [0, 1, 2, 3, 8, 7, 6, 5, 0];
    let survey = watched::<i16, 8>(Conditions::new(9, -100..=100, 8), &x);
    let fit = survey.verdict().unwrap();
    assert_eq!(fit.step_forward(0.5).unwrap().threshold(), 4); // the mean change is 2
    for (spikes, threshold) in [(1.0, 1), (0.99, 2), (0.25, 2), (0.24, 6), (0.01, 6)] {
        assert_eq!(fit.temporal_contrast(spikes).unwrap().threshold(), threshold, "{spikes}");
    }
    for spikes in [0.0, -0.5, 1.5, f32::NAN] {
        assert!(fit.step_forward(spikes).is_err() && fit.temporal_contrast(spikes).is_err());
    }
    // A quarter of the changes is in the last cell, so that no border is known to be above enough of them.
    let survey = watched::<i16, 8>(Conditions::new(9, -100..=100, 4), &x);
    assert_eq!(
        survey.verdict().unwrap().temporal_contrast(0.1),
        Err(ConfigError::OutOfRange {
            parameter: "spikes a sample",
            value: 0.1,
            min: 0.25,
            max: 1.0
        })
    );
}

fn spikes<P: Start<Output = Spike>>(scheme: &P, x: &[P::Sample]) -> usize {
    let mut encoder = scheme.encoder();
    x.iter().filter(|&&x| encoder.encode(x) != Spike::None).count()
}

/// On the samples seen, no threshold gives more spikes than was asked for.
fn check<S: Wire>(fit: Fit<'_, S, 64>, x: &[S], share: f32) {
    let most = share * (x.len() - 1) as f32;
    if let Ok(scheme) = fit.step_forward(share) {
        // The threshold is rounded to a half of the last place, and every spike moves by it.
        let wanted = fit.calibration().magnitudes().unwrap().mean / f64::from(share);
        let rounding = wanted / scheme.threshold().to_f64();
        let spikes = spikes(&scheme, x);
        assert!(
            spikes as f64 <= f64::from(most) * rounding.max(1.0) * (1.0 + 1e-5),
            "{spikes} of {most}"
        );
    }
    if let Ok(scheme) = fit.temporal_contrast(share) {
        let spikes = spikes(&scheme, x);
        assert!(spikes as f32 <= most * (1.0 + 1e-5), "{spikes} of {most}");
    }
}

fn check_flights<S: Wire>(unit: f64, limit: f64) {
    let [least, most, change] = [-limit, limit, 16.0].map(S::from_f64);
    let conditions = Conditions::try_new(788, least..=most, change).unwrap();
    let mut fit_channels = 0;
    for x in flown_channels::<S>(unit) {
        let survey = watched::<S, 64>(conditions, &x);
        // At rest some channels do not move by a unit of 16 bits.
        let Ok(fit) = survey.verdict() else { continue };
        fit_channels += 1;
        for share in [0.001, 0.01, 0.02, 0.1, 0.5, 1.0] {
            check(fit, &x, share);
        }
    }
    assert!(fit_channels >= 6);
}

#[test]
fn shares_of_the_flights() {
    check_flights::<f32>(1.0, 160.0);
    check_flights::<I16F16>(1.0, 160.0);
    check_flights::<I8F8>(1.0, 127.0);
    check_flights::<i16>(100.0, 16_000.0);
}

#[test]
fn shares_of_drawn_signals() {
    let conditions = Conditions::new(3, i16::MIN..=i16::MAX, 60);
    let cases = &cases(512);
    proptest!(cases, |(
        steps in proptest::collection::vec(-80..=80_i16, 3..200),
        share in between(0.005, 1.0),
    )| {
        let x: Vec<i16> = steps.iter().scan(0_i16, |x, step| { *x += step; Some(*x) }).collect();
        let survey = watched::<i16, 64>(conditions, &x);
        if let Ok(fit) = survey.verdict() {
            check(fit, &x, share);
        }
    });
}
