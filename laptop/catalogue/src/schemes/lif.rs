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
        let scheme =
            IntegrateAndFire::<_, SPIKES>::try_new(channel.fraction(THRESHOLD), POWER)?.leaky();
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
