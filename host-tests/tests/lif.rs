//! Leaky integrate-and-fire, on the recordings of integrate-and-fire.

use proptest::prelude::*;
use spikewire::Scheme;

use crate::integrate::{Agrees, Neuron, SIGNAL, counts_of, drawn, mean_error};
use crate::sigma_delta::in_every_type;

const TEN: Neuron<i16, 1> = Neuron::new(10, 3).leaky();

#[test]
fn check_values() {
    let counts = [0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1, 0, -1];
    assert_eq!(counts_of(&TEN, &SIGNAL), counts);
}

/// What leaks is as much as what comes in, before it reaches the threshold.
#[test]
fn a_small_signal_is_silent() {
    let scheme = Neuron::<i16, 1>::new(800, 3).leaky();
    assert_eq!(counts_of(&scheme, &[90; 500]), [0; 500]);
    assert_ne!(counts_of(&scheme, &[110; 500]), [0; 500]);
}

proptest! {
    #[test]
    fn as_transcribed(x in drawn(), threshold in 1_i16..2000, power in 1_u8..8) {
        in_every_type(&x, Agrees { threshold, power, is_leaky: true });
    }

    #[test]
    fn the_value_is_near_the_leaky_mean(x in drawn(), threshold in 512_i16..4000, power in 1_u8..10, reference in -90_i16..90) {
        let scheme = Neuron::<i16, 8>::new(threshold, power).leaky().with_reference(reference);
        let bound = f64::from(threshold) / f64::from(1_u32 << power) + 3.0;
        for error in mean_error(scheme, &x, reference, power) {
            prop_assert!(error < bound, "{} of {}", error, bound);
        }
    }
}

#[test]
fn a_reset_encoder_starts_anew() {
    let mut encoder = TEN.encoder();
    encoder.encode(9);
    encoder.reset();
    assert_eq!(encoder.encode(9).count(), 0);
}
