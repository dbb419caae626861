//! Send-on-delta: step forward with several spikes a sample.

use spikewire::temporal::{SendOnDelta, Steps};

use crate::prelude::*;

/// Send-on-delta.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "sod",
        type_name: "SendOnDelta",
        title: "SoD",
        words: "send-on-delta",
        good_for: "following a signal that jumps by several thresholds a sample",
        is_signed: true,
        steps: crate::Steps::Held,
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
        shapes: &[&[4]],
        made: &[Made {
            name: "init",
            words: "`threshold`: of a spike, above 0.",
            arguments: &[Argument::sample("threshold", Flown::Fraction(0.02))],
            value: "temporal::SendOnDelta::try_new(threshold)",
            flies: Some("sod"),
        }],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = SendOnDelta::<_, 4>::try_new(channel.fraction(0.02))?;
        visitor.visit("sod", Self::INFO.words, &scheme, SendOnDelta::<V::Sample, 4>::START)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let threshold = signal.part(0.5);
        let scheme = SendOnDelta::<_, 4>::try_new(threshold)?;
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

/// The definition.
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

/// Adds up the steps.
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

#[cfg(test)]
mod tests {
    use spikewire::temporal::{SendOnDelta, StepForward};
    use spikewire::{Code, Scheme};

    const FOUR: SendOnDelta<i16, 4> = SendOnDelta::new(10);

    #[test]
    fn check_values() {
        let mut encoder = FOUR.encoder();
        let steps = [0, 9, 35, 95, 90, 10].map(|x| encoder.encode(x).count());
        assert_eq!(steps, [0, 0, 3, 4, 1, -4]);
        assert!(FOUR.try_with_most(5).is_err() && FOUR.try_with_most(0).is_err());
    }

    /// All pairs of a baseline and a sample within 8 bits: the spikes are those that bring the value within a threshold
    /// of the signal, as far as there are enough of them.
    #[test]
    fn all_pairs_of_8_bits() {
        for (base, sample) in (-128..128).flat_map(|a| (-128..128).map(move |b| (a, b))) {
            let (mut encoder, mut decoder) = (FOUR.encoder(), FOUR.decoder());
            encoder.encode(base);
            decoder.resync(base);
            let steps = encoder.encode(sample);
            assert!(
                steps
                    .firings()
                    .map(|firing| firing.slot)
                    .eq(0..steps.count().unsigned_abs().into())
            );
            let value = decoder.decode(steps);
            assert_eq!(Some(value), encoder.keyframe());
            let away = (sample - base).unsigned_abs();
            assert_eq!(
                i16::from(steps.count().unsigned_abs()),
                (away.saturating_sub(1) / 10).min(4) as i16
            );
            assert!(away > 50 || (sample - value).abs() <= 10, "{base} {sample}");
        }
    }

    /// With one spike a sample it is step forward.
    #[test]
    fn one_spike_is_step_forward() {
        let (sod, sf) = (SendOnDelta::<f32, 1>::new(0.3), StepForward::<f32>::new(0.3));
        let (mut sod, mut sf) = (sod.encoder(), sf.encoder());
        for i in 0..1000 {
            let x = (i as f32 * 0.37).sin() * 2.0;
            assert_eq!(sod.encode(x).count(), sf.encode(x).sign());
        }
    }
}
