//! Temporal contrast (TBR).

#![allow(clippy::needless_range_loop)] // index by index, as the pseudo-code

use spikewire::Start;
use spikewire::temporal::TemporalContrast;

use crate::plain::Plain;
use crate::{Channel, Count, Entry, Flight, Info, Kind, Paper, Parameter, Scaled, Unit};

/// Temporal contrast.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "tbr",
        title: "TBR",
        words: "temporal contrast (TBR)",
        good_for: "changes, as an event camera sees them; drifts",
        is_signed: true,
        has_first_value: true,
        parameters: &[
            Parameter::new(
                "threshold",
                Kind::Number,
                Unit::Signal,
                "what the difference from the sample before must exceed, above 0",
            ),
            Parameter::new(
                "factor",
                Kind::Number,
                Unit::None,
                "in the place of --threshold: the differences' mean and this many of their standard deviations",
            )
            .with_paper(Paper::Text("0.5")),
            Parameter::new(
                "magnitudes",
                Kind::Flag,
                Unit::None,
                "with --factor: mean and deviation of the differences' magnitudes",
            ),
            Parameter::new(
                "step",
                Kind::Text,
                Unit::Signal,
                "step of the decoder, as a number or as `2x` the threshold; `1x` unless given",
            )
            .with_paper(Paper::Text("2x")),
            Parameter::START,
        ],
    };

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = TemporalContrast::from_magnitudes(&channel.calibration, 0.5)?;
        visitor.visit("tbr", Self::INFO.words, &scheme, TemporalContrast::START)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = TemporalContrast::from_magnitudes(&signal.calibration, 0.5)?;
        let threshold = scheme.threshold();
        visitor.steps("tbr", &scheme, scheme.step(), |signal, spikes| {
            transcribed(signal, threshold, spikes);
        })
    }
}

/// The paper's algorithm 6.
#[inline(never)]
pub fn transcribed<S: Plain>(input: &[S], threshold: S, spikes: &mut [i8]) {
    let threshold = threshold.into();
    for i in 1..input.len() {
        let difference = input[i].into() - input[i - 1].into();
        spikes[i] = if difference > threshold {
            1
        } else if difference < S::Wide::default() - threshold {
            -1
        } else {
            0
        };
    }
}
