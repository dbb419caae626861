//! Adaptive step forward.

use spikewire::temporal::AdaptiveStepForward;

use crate::prelude::*;

/// Adaptive step forward.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly it; a threshold is a part of a channel's range.
const THRESHOLD: f64 = 0.02;
const DOUBLINGS: u8 = 4;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "asf",
        type_name: "AdaptiveStepForward",
        title: "Adaptive SF",
        words: "adaptive step forward",
        good_for: "following a signal that jumps, with one spike a sample at most",
        is_signed: true,
        steps: StepErrors::Held,
        colour: [0x5b, 0x8c, 0x3a],
        parameters: &[
            Parameter::threshold(
                "the smallest step, above 0: what the distance from the baseline must exceed at rest",
                0.5,
            ),
            Parameter::count("doublings", "how often the step doubles at most, 0 to 30")
                .with_example("3")
                .with_paper(Paper::Text("3"))
                .searched(Search::Whole(0, 8)),
            Parameter::count("run", "how many spikes in one direction double the step, 1 to 8")
                .with_default("2")
                .searched(Search::Whole(1, 4)),
            Parameter::START,
        ],
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[InC {
        name: "adaptive_step_forward",
        scheme: "temporal::AdaptiveStepForward<S>",
        shapes: &[&[]],
        made: &[Made {
            name: "init",
            words: "`threshold`: the smallest, above 0; `doublings`: how often it doubles at most, 0 to 30.",
            arguments: &[
                Argument::sample("threshold", Flown::Fraction(THRESHOLD)),
                Argument::number("doublings", "u8", DOUBLINGS as f64),
            ],
            value: "temporal::AdaptiveStepForward::try_new(threshold, doublings)",
            flies: Some("asf"),
        }],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = AdaptiveStepForward::try_new(channel.fraction(THRESHOLD), DOUBLINGS)?;
        visitor.visit("asf", Self::INFO.words, &scheme, AdaptiveStepForward::START)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let threshold = signal.part(0.5);
        let scheme = AdaptiveStepForward::try_new(threshold, 3)?;
        visitor.coded(
            "asf",
            &scheme,
            spikewire::Spike::sign,
            spike_of,
            |signal, spikes| transcribed(signal, threshold, 2, 3, spikes),
            |spikes, values| transcribed_decoder(spikes, threshold, 2, 3, values),
        )
    }
}

#[cfg(feature = "run")]
impl Build for Scheme {
    const CONSTANT: Option<[&str; 3]> = Some([
        "temporal::AdaptiveStepForward",
        "",
        "new({threshold}, {doublings}).with_run({run})",
    ]);

    costs!(AdaptiveStepForward<S>, "asf");

    fn build<S: Sample, V: Visit<S>>(settings: &Settings, visitor: V) -> Result<V::Output> {
        let doublings = settings.count("doublings", 0..=30)? as u8;
        let run = settings.count("run", 1..=8)? as u8;
        let scheme = AdaptiveStepForward::try_new(settings.signal("threshold")?, doublings)?;
        visitor.visit(scheme.try_with_run(run)?, AdaptiveStepForward::<S>::START)
    }
}

/// Returns the exponent after the spike at `i`.
fn adapted(spikes: &[i8], i: usize, run: usize, doublings: u8, exponent: u8) -> u8 {
    let mut is_run = spikes[i] != 0 && i + 1 >= run;
    for j in 1..run {
        is_run = is_run && spikes[i - j] == spikes[i];
    }
    if is_run { doublings.min(exponent + 1) } else { exponent.saturating_sub(1) }
}

/// Encodes by the definition.
#[inline(never)]
pub fn transcribed<S: Plain>(
    input: &[S],
    threshold: S,
    run: usize,
    doublings: u8,
    spikes: &mut [i8],
) {
    let mut base = input[0].into();
    let mut exponent = 0;
    for i in 1..input.len() {
        let step = S::doubled(threshold.into(), exponent);
        if input[i].into() > base + step {
            spikes[i] = 1;
            base += step;
        } else if input[i].into() < base - step {
            spikes[i] = -1;
            base -= step;
        } else {
            spikes[i] = 0;
        }
        exponent = adapted(spikes, i, run, doublings, exponent);
    }
}

/// Decodes by adding up the steps.
#[inline(never)]
pub fn transcribed_decoder<S: Plain>(
    spikes: &[i8],
    threshold: S,
    run: usize,
    doublings: u8,
    values: &mut [S],
) {
    let mut value = S::Wide::default();
    let mut exponent = 0;
    for i in 0..spikes.len() {
        if spikes[i] == 1 {
            value += S::doubled(threshold.into(), exponent);
        } else if spikes[i] == -1 {
            value -= S::doubled(threshold.into(), exponent);
        }
        values[i] = S::narrow(value);
        exponent = adapted(spikes, i, run, doublings, exponent);
    }
}
