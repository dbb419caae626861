//! Leaky integrate and fire (LIF).

use spikewire::rate::IntegrateAndFire;
use spikewire::temporal::Steps;

use super::integrate::{PARAMETERS, transcribed, transcribed_decoder};
use crate::prelude::*;

#[cfg(feature = "run")]
use super::integrate;

/// Leaky integrate and fire.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly it; a threshold is a part of a channel's range.
const THRESHOLD: f64 = 0.2;
const POWER: u8 = 3;
const SPIKES: usize = 8;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "lif",
        type_name: "LeakyIntegrateAndFire",
        title: "LIF",
        words: "leaky integrate and fire (LIF)",
        good_for: "a mean that forgets, silent for what stays small",
        is_signed: true,
        colour: [0x3f, 0x7f, 0x93],
        parameters: PARAMETERS,
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[InC {
        name: "leaky_integrate_and_fire",
        scheme: "rate::IntegrateAndFire<S, {0}>",
        shapes: &[&[SPIKES]],
        made: &[Made {
            name: "init",
            words: "`threshold`: what samples add up to at a spike, above 0; `power`: mean and leak are over 2^power samples, 1 to 15; `reference`: the value without spikes.",
            arguments: &[
                Argument::sample("threshold", Flown::Fraction(THRESHOLD)),
                Argument::number("power", "u8", POWER as f64),
                Argument::sample("reference", Flown::Number(0.0)),
            ],
            value: "Ok(rate::IntegrateAndFire::try_new(threshold, power)?.try_with_reference(reference)?.leaky())",
            flies: Some("lif"),
        }],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = IntegrateAndFire::<_, SPIKES>::try_new(channel.fraction(THRESHOLD), POWER)?.leaky();
        let start = IntegrateAndFire::<V::Sample, SPIKES>::START;
        visitor.visit("lif", Self::INFO.words, &scheme, start)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let threshold = signal.part(1.0);
        let scheme = IntegrateAndFire::<_, 4>::try_new(threshold, 4)?.leaky();
        visitor.coded(
            "lif",
            &scheme,
            Steps::count,
            Steps::new,
            |signal, counts| transcribed(signal, threshold, Some(4), 4, counts),
            |counts, values| transcribed_decoder(counts, threshold, 4, values),
        )
    }
}

#[cfg(feature = "run")]
impl Build for Scheme {
    const CONSTANT: Option<[&str; 3]> = Some([
        "rate::IntegrateAndFire",
        "{spikes}",
        "new({threshold}, {power}).leaky().with_reference({reference})",
    ]);

    costs!(IntegrateAndFire<S, 127>, "lif");

    fn shape(settings: &Settings) -> Result<Shape> {
        integrate::shape(settings)
    }

    fn build<S: Sample, V: Visit<S>>(settings: &Settings, visitor: V) -> Result<V::Output> {
        visitor.visit(integrate::built(settings)?.leaky(), IntegrateAndFire::<S, 127>::START)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use spikewire::Scheme;

    use crate::schemes::integrate::tests::{Neuron, SIGNAL, agrees, counts_of, drawn, mean_error};

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
            agrees(&x, threshold, power, true);
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
}
