//! Send-on-delta: step forward with several spikes a sample.

use spikewire::temporal::{SendOnDelta, Steps};

use crate::prelude::*;

/// Send-on-delta.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly it; a threshold is a part of a channel's range.
const THRESHOLD: f64 = 0.02;
const SPIKES: usize = 4;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "sod",
        type_name: "SendOnDelta",
        title: "SoD",
        words: "send-on-delta",
        good_for: "following a signal that jumps by several thresholds a sample",
        is_signed: true,
        steps: StepErrors::Held,
        colour: [0xb8, 0x6b, 0x2f],
        parameters: &[
            Parameter::threshold(
                "the step, above 0: what the distance from the baseline must exceed",
                0.5,
            ),
            Parameter::SPIKES,
            Parameter::START,
        ],
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[InC {
        name: "send_on_delta",
        scheme: "temporal::SendOnDelta<S, {0}>",
        shapes: &[&[SPIKES]],
        made: &[Made {
            name: "init",
            words: "`threshold`: of a spike, above 0.",
            arguments: &[Argument::sample("threshold", Flown::Fraction(THRESHOLD))],
            value: "temporal::SendOnDelta::try_new(threshold)",
            flies: Some("sod"),
        }],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = SendOnDelta::<_, SPIKES>::try_new(channel.fraction(THRESHOLD))?;
        visitor.visit("sod", Self::INFO.words, &scheme, SendOnDelta::<V::Sample, SPIKES>::START)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let threshold = signal.part(0.5);
        let scheme = SendOnDelta::<_, SPIKES>::try_new(threshold)?;
        visitor.coded(
            "sod-4",
            &scheme,
            Steps::count,
            Steps::new,
            |signal, steps| transcribed(signal, 4, threshold, steps),
            |steps, values| transcribed_decoder(steps, threshold, values),
        )
    }
}

#[cfg(feature = "run")]
impl Build for Scheme {
    const CONSTANT: Option<[&str; 3]> =
        Some(["temporal::SendOnDelta", "{spikes}", "new({threshold})"]);

    fn shape(settings: &Settings) -> Result<Shape> {
        Ok(Shape { neurons: 1, slots: settings.count("spikes", 1..=127)? })
    }

    costs!(SendOnDelta<S, 4>, "sod-4", |settings| Self::shape(settings)?.slots as f64 / 4.0);

    fn build<S: Sample, V: Visit<S>>(settings: &Settings, visitor: V) -> Result<V::Output> {
        let most = settings.count("spikes", 1..=127)? as u8;
        let scheme = SendOnDelta::<_, 127>::try_new(settings.signal("threshold")?)?;
        visitor.visit(scheme.try_with_most(most)?, SendOnDelta::<S, 127>::START)
    }
}

/// Encodes by the definition.
#[inline(never)]
pub fn transcribed<S: Plain>(input: &[S], most: i8, threshold: S, steps: &mut [i8]) {
    let threshold = threshold.into();
    let mut base = input[0].into();
    for i in 1..input.len() {
        steps[i] = 0;
        while steps[i] < most && input[i].into() > base + threshold {
            base += threshold;
            steps[i] += 1;
        }
        while steps[i] <= 0 && steps[i] > -most && input[i].into() < base - threshold {
            base -= threshold;
            steps[i] -= 1;
        }
    }
}

/// Decodes by adding up the steps.
#[inline(never)]
pub fn transcribed_decoder<S: Plain>(steps: &[i8], threshold: S, values: &mut [S]) {
    let mut value = S::Wide::default();
    for i in 0..steps.len() {
        for _ in 0..steps[i].unsigned_abs() {
            if steps[i] > 0 {
                value += threshold.into();
            } else {
                value -= threshold.into();
            }
        }
        values[i] = S::narrow(value);
    }
}
