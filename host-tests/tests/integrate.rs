//! Integrate-and-fire against its transcription, and its laws.

use crate::common::refused;
use crate::sigma_delta::{Check, in_every_type};
use fixed::types::I16F16;
use proptest::prelude::*;
use spikewire::rate::IntegrateAndFire;
use spikewire::temporal::Steps;
use spikewire::{Sample, Scheme};

use catalogue::plain::Plain;
use catalogue::schemes::integrate::{transcribed, transcribed_decoder};

pub(crate) use spikewire::rate::IntegrateAndFire as Neuron;

/// Twelve samples of 3, four of -7.
pub(crate) const SIGNAL: [i16; 16] = [3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, -7, -7, -7, -7];

pub(crate) fn counts_of<S: Sample, const K: usize>(
    scheme: &IntegrateAndFire<S, K>,
    x: &[S],
) -> Vec<i8> {
    let mut encoder = scheme.encoder();
    x.iter().map(|&x| encoder.encode(x).count()).collect()
}

/// Recordings within 4000 counts.
pub(crate) fn drawn() -> impl Strategy<Value = Vec<i16>> {
    proptest::collection::vec(-4000_i16..=4000, 1..200)
}

/// Encoder and decoder against the transcriptions, with this threshold in counts.
pub(crate) struct Agrees {
    pub(crate) threshold: i16,
    pub(crate) power: u8,
    pub(crate) is_leaky: bool,
}

impl Check for Agrees {
    fn check<S: Plain>(&mut self, x: &[S], of: impl Fn(i16) -> S) {
        let Self { threshold, power, is_leaky } = *self;
        let threshold = of(threshold);
        let scheme = IntegrateAndFire::<S, 4>::new(threshold, power);
        let scheme = if is_leaky { scheme.leaky() } else { scheme };
        let mut counts = vec![0; x.len()];
        transcribed(x, threshold, is_leaky.then_some(power), 4, &mut counts);
        assert_eq!(counts_of(&scheme, x), counts);
        let mut values = vec![S::default(); x.len()];
        transcribed_decoder(&counts, threshold, power, &mut values);
        let mut decoder = scheme.decoder();
        let ours: Vec<S> = counts.iter().map(|&count| decoder.decode(Steps::new(count))).collect();
        assert_eq!(ours, values);
    }
}

/// How far each decoded value is from the same leaky mean of the samples.
pub(crate) fn mean_error<const K: usize>(
    scheme: IntegrateAndFire<i16, K>,
    x: &[i16],
    reference: i16,
    power: u8,
) -> Vec<f64> {
    let mut decoder = scheme.decoder();
    let mut mean = 0_i32;
    let errors = counts_of(&scheme, x).into_iter().zip(x).map(|(count, &x)| {
        let value = decoder.decode(Steps::new(count));
        mean -= mean.signum() * (mean.abs() >> power);
        mean += i32::from(x) - i32::from(reference);
        (f64::from(value) - f64::from(reference) - f64::from(mean) / f64::from(1 << power)).abs()
    });
    errors.collect()
}

const TEN: Neuron<i16, 1> = Neuron::new(10, 3);

#[test]
fn check_values() {
    let counts = [0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, -1, -1];
    assert_eq!(counts_of(&TEN, &SIGNAL), counts);
}

/// The threshold itself fires, on both sides.
#[test]
fn ties_fire() {
    assert_eq!(counts_of(&TEN, &[9, 1, -9, -1]), [0, 1, 0, -1]);
    assert_eq!(counts_of(&Neuron::<f32, 2>::new(0.5, 1), &[1.0, -1.0, -1.0]), [2, -2, -2]);
}

#[test]
fn what_is_not_finite_is_counted_and_ignored() {
    let scheme = Neuron::<f32, 1>::new(1.0, 3);
    let mut encoder = scheme.encoder();
    let x = [0.75, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.25];
    assert_eq!(x.map(|x| encoder.encode(x).count()), [0, 0, 0, 0, 1]);
    assert_eq!(encoder.rejected(), 3);
    // What would bring the potential beyond all numbers is not taken either.
    assert_eq!([f32::MAX, f32::MAX, -1.0].map(|x| encoder.encode(x).count()), [1, 0, 1]);
    assert_eq!(encoder.rejected(), 4);
}

/// Without an end in sight the potential stays at its end, and comes back.
#[test]
fn integers_do_not_wrap() {
    let scheme = Neuron::<I16F16, 1>::new(I16F16::ONE, 3).with_reference(I16F16::MIN);
    let mut encoder = scheme.encoder();
    for _ in 0..1000 {
        assert_eq!(encoder.encode(I16F16::MAX).count(), 1);
    }
    let scheme = Neuron::<i16, 1>::new(1, 3).with_reference(i16::MIN);
    let mut encoder = scheme.encoder();
    for _ in 0..100_000 {
        assert_eq!(encoder.encode(i16::MAX).count(), 1);
    }
}

#[test]
fn what_makes_no_sense_is_refused_by_name() {
    assert_eq!(refused(Neuron::<f32, 4>::try_new(0.0, 3)), "threshold");
    assert_eq!(refused(Neuron::<f32, 4>::try_new(1e32, 3)), "threshold");
    assert_eq!(refused(Neuron::<f32, 4>::try_new(1.0, 0)), "power of the mean");
    assert_eq!(refused(Neuron::<f32, 4>::try_new(1.0, 16)), "power of the mean");
    assert_eq!(refused(Neuron::<_, 4>::new(1.0, 3).try_with_reference(f32::NAN)), "reference");
    assert_eq!(refused(Neuron::<f32, 4>::new(1.0, 3).try_with_most(5)), "most spikes a sample");
}

#[test]
fn a_sample_has_as_many_slots_as_spikes() {
    assert_eq!(Neuron::<f32, 4>::new(1.0, 3).slots(), 4);
    assert_eq!(Neuron::<f32, 127>::new(1.0, 3).with_most(4).slots(), 4);
}

proptest! {
    #[test]
    fn as_transcribed(x in drawn(), threshold in 1_i16..2000, power in 1_u8..8) {
        in_every_type(&x, Agrees { threshold, power, is_leaky: false });
    }

    /// The spikes tell the integral of the samples, to less than one.
    #[test]
    fn the_integral_never_drifts(x in drawn(), threshold in 512_i16..4000, reference in -90_i16..90) {
        let scheme = Neuron::<i16, 8>::new(threshold, 3).with_reference(reference);
        let (mut sum, mut coded) = (0, 0);
        for (count, x) in counts_of(&scheme, &x).into_iter().zip(x) {
            sum += i32::from(x) - i32::from(reference);
            coded += i32::from(count) * i32::from(threshold);
            prop_assert!((sum - coded).abs() < i32::from(threshold));
        }
    }

    #[test]
    fn the_value_is_near_the_leaky_mean(x in drawn(), threshold in 500_i16..4000, power in 1_u8..10) {
        let scheme = Neuron::<i16, 8>::new(threshold, power);
        let bound = 2.0 * f64::from(threshold) / f64::from(1_u32 << power) + 3.0;
        for error in mean_error(scheme, &x, 0, power) {
            prop_assert!(error < bound, "{} of {}", error, bound);
        }
    }
}
