//! What is built at run time is what a constant is, and can be asked for what it was built from.

use rand_pcg::Pcg32;
use spikewire::population::{NonLinearSlots, Probabilistic, Slots};
use spikewire::rate::{Average, Bernoulli, BsaToolbox, IntegrateAndFire, Shape, Taps};
use spikewire::temporal::{AdaptiveStepForward, SendOnDelta, Steps};
use spikewire::{Conditions, Polarity, Scheme, Spike, dynamic};

#[test]
fn options_at_run_time_are_those_of_constants() {
    const REST: Conditions<f32> = Conditions::new(4, -10.0..=10.0, 1.0);
    const STILL: Conditions<f32> = REST.with_stillness(2.0);
    const STEPS: SendOnDelta<f32, 4> = SendOnDelta::new(0.5);
    const FEWER: SendOnDelta<f32, 4> = STEPS.with_most(2);
    const ADAPTIVE: AdaptiveStepForward<f32> = AdaptiveStepForward::new(0.5, 4);
    const LATER: AdaptiveStepForward<f32> = ADAPTIVE.with_run(5);
    const FIRE: IntegrateAndFire<f32, 4> = IntegrateAndFire::new(0.5, 3);
    const ONCE: IntegrateAndFire<f32, 4> = FIRE.with_most(1);

    assert_eq!(REST.try_with_stillness(2.0), Ok(STILL));
    assert_eq!(STEPS.try_with_most(2), Ok(FEWER));
    assert_ne!(STEPS, FEWER);
    assert_eq!(ADAPTIVE.try_with_run(5), Ok(LATER));
    assert_ne!(ADAPTIVE, LATER);
    assert_eq!(FIRE.try_with_most(1), Ok(ONCE));
    assert_ne!(FIRE, ONCE);
}

#[test]
fn parameters_can_be_asked_for() {
    assert_eq!(BsaToolbox::<f32, 5>::new(Taps::triangular(1.0), 1.25).threshold(), 1.25);
    let window = dynamic::MovingWindow::try_new(0.75_f32, 6).unwrap();
    assert_eq!((window.threshold(), window.count()), (0.75, 6));
    assert_eq!([0, 1, 2].map(|k| Shape::Triangular.at(k, 3)), [0.5, 1.0, 0.5]);
}

#[test]
fn schemes_by_chance_are_compared_by_their_parameters() {
    type Chance = Bernoulli<f32, Pcg32, Average>;
    type Fields = Probabilistic<f32, Pcg32, 5, 256>;
    let one = Chance::new(0.0..=1.0, Average::new(3));
    assert!(one == Chance::new(0.0..=1.0, Average::new(3)));
    assert!(one != Chance::new(0.0..=2.0, Average::new(3)));
    assert!(one != Chance::new(0.0..=1.0, Average::new(4)));
    assert!(Fields::new(0.0..=1.0, 1.5) == Fields::new(0.0..=1.0, 1.5));
    assert!(Fields::new(0.0..=1.0, 1.5) != Fields::new(0.0..=1.0, 2.0));
}

/// A potential of the value times the length of the mean, which leaks from the next sample on.
#[test]
fn a_leaky_decoder_can_be_told_a_value() {
    let scheme = IntegrateAndFire::<i16, 4>::new(100, 4).with_reference(50);
    let mut decoder = scheme.decoder();
    decoder.resync(850);
    let silent = Steps::new(0);
    assert_eq!([(); 3].map(|()| decoder.decode(silent)), [800, 753, 709]);
}

#[test]
fn codes_say_whether_they_are_empty() {
    let scheme = Slots::<f32, 5, 8>::new(0.0..=1.0, 1.5);
    let mut encoder = scheme.encoder();
    assert!(!encoder.encode(0.5).is_empty());
    assert!(encoder.encode(900.0).is_empty());
    let scheme = NonLinearSlots::<f32, 5, 8>::companded(0.0..=1.0, 2.0, 1.5);
    let mut encoder = scheme.encoder();
    assert!(!encoder.encode(0.5).is_empty());
    assert!(encoder.encode(900.0).is_empty());
    assert_eq!([Polarity::Up, Polarity::Down].map(Spike::from), [Spike::Up, Spike::Down]);
}
