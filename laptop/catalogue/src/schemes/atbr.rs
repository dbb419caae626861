//! Adaptive temporal contrast.

use spikewire::Spike;
use spikewire::temporal::AdaptiveContrast;

use crate::prelude::*;

/// Adaptive temporal contrast.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly it; a threshold is a part of a channel's range.
const THRESHOLD: f64 = 0.001;
const DOUBLINGS: u8 = 5;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "atbr",
        type_name: "AdaptiveContrast",
        title: "Adaptive TBR",
        words: "adaptive temporal contrast",
        good_for: "changes whose size differs much between rest and flight; drifts",
        is_signed: true,
        steps: StepErrors::Drifting,
        colour: [0x6c, 0x8f, 0xc9],
        parameters: &[
            Parameter::threshold(
                "the smallest threshold, above 0: what a change from sample to sample must exceed at rest",
                0.1,
            ),
            Parameter::count("doublings", "how often the threshold doubles at most, 0 to 15")
                .with_example("4")
                .with_paper(Paper::Text("4"))
                .searched(Search::Whole(0, 8)),
            Parameter::START,
        ],
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[InC {
        name: "adaptive_contrast",
        scheme: "temporal::AdaptiveContrast<S>",
        shapes: &[&[]],
        made: &[Made {
            name: "init",
            words: "`threshold`: the smallest, above 0; `doublings`: how often it doubles at most, 0 to 15.",
            arguments: &[
                Argument::sample("threshold", Flown::Fraction(THRESHOLD)),
                Argument::number("doublings", "u8", DOUBLINGS as f64),
            ],
            value: "temporal::AdaptiveContrast::try_new(threshold, doublings)",
            flies: Some("atbr"),
        }],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = AdaptiveContrast::try_new(channel.fraction(THRESHOLD), DOUBLINGS)?;
        visitor.visit("atbr", Self::INFO.words, &scheme, AdaptiveContrast::START)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let threshold = signal.part(0.1);
        let scheme = AdaptiveContrast::try_new(threshold, 4)?;
        visitor.coded(
            "atbr",
            &scheme,
            Spike::sign,
            spike_of,
            |signal, spikes| transcribed(signal, threshold, 4, spikes),
            |spikes, values| transcribed_decoder(spikes, threshold, 4, values),
        )
    }
}

#[cfg(feature = "run")]
impl Build for Scheme {
    const CONSTANT: Option<[&str; 3]> =
        Some(["temporal::AdaptiveContrast", "", "new({threshold}, {doublings})"]);

    costs!(AdaptiveContrast<S>, "atbr");

    fn build<S: Sample, V: Visit<S>>(settings: &Settings, visitor: V) -> Result<V::Output> {
        let doublings = settings.count("doublings", 0..=15)? as u8;
        let scheme = AdaptiveContrast::try_new(settings.signal("threshold")?, doublings)?;
        visitor.visit(scheme, AdaptiveContrast::<S>::START)
    }
}

/// Returns the exponent before the spike at `i`.
fn exponent(spikes: &[i8], i: usize, doublings: u8) -> u8 {
    let mut count = 0;
    for j in i.saturating_sub(16)..i {
        if spikes[j] != 0 {
            count += 1;
        }
    }
    doublings.min(count * (doublings + 1) / 16)
}

/// Encodes by the definition.
#[inline(never)]
pub fn transcribed<S: Plain>(input: &[S], threshold: S, doublings: u8, spikes: &mut [i8]) {
    for i in 1..input.len() {
        let threshold = S::doubled(threshold.into(), exponent(spikes, i, doublings));
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

/// Decodes by adding up the thresholds.
#[inline(never)]
pub fn transcribed_decoder<S: Plain>(spikes: &[i8], threshold: S, doublings: u8, values: &mut [S]) {
    let mut value = S::Wide::default();
    for i in 0..spikes.len() {
        let threshold = S::doubled(threshold.into(), exponent(spikes, i, doublings));
        if spikes[i] == 1 {
            value += threshold;
        } else if spikes[i] == -1 {
            value -= threshold;
        }
        values[i] = S::narrow(value);
    }
}
