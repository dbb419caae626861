//! Adaptive step forward.

use spikewire::temporal::AdaptiveStepForward;

use crate::prelude::*;

/// Adaptive step forward.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "asf",
        type_name: "AdaptiveStepForward",
        title: "Adaptive SF",
        words: "adaptive step forward",
        good_for: "following a signal that jumps, with one spike a sample at most",
        is_signed: true,
        steps: Steps::Held,
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
                Argument::sample("threshold", Flown::Fraction(0.02)),
                Argument::number("doublings", "u8", 4.0),
            ],
            value: "temporal::AdaptiveStepForward::try_new(threshold, doublings)",
            flies: Some("asf"),
        }],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = AdaptiveStepForward::try_new(channel.fraction(0.02), 4)?;
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

/// The exponent behind the spike at `i`.
fn adapted(spikes: &[i8], i: usize, run: usize, doublings: u8, exponent: u8) -> u8 {
    let mut is_run = spikes[i] != 0 && i + 1 >= run;
    for j in 1..run {
        is_run = is_run && spikes[i - j] == spikes[i];
    }
    if is_run { doublings.min(exponent + 1) } else { exponent.saturating_sub(1) }
}

/// The definition.
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

/// Adds up the steps.
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

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use proptest::prelude::*;
    use spikewire::temporal::{AdaptiveStepForward, StepForward};
    use spikewire::{ConfigError, Encoder, Scheme, Spike, Start};

    type Asf = AdaptiveStepForward<i16>;

    #[test]
    fn check_values() {
        let scheme = Asf::new(1, 4);
        let (mut encoder, mut decoder) = (scheme.encoder(), scheme.decoder());
        let mut signal = [40; 15];
        signal[0] = 0;
        let values = signal.map(|x| decoder.decode(encoder.encode(x)));
        assert_eq!(values, [0, 1, 2, 4, 8, 16, 32, 32, 32, 36, 38, 38, 38, 39, 39]);
    }

    #[test]
    fn what_makes_no_sense_is_refused_by_name() {
        let parameter = |scheme: Result<Asf, ConfigError>| match scheme.unwrap_err() {
            ConfigError::NotPositive { parameter, .. }
            | ConfigError::OutOfRange { parameter, .. } => parameter,
            error => panic!("{error}"),
        };
        assert_eq!(parameter(Asf::try_new(0, 4)), "threshold");
        assert_eq!(parameter(Asf::try_new(1, 31)), "doublings");
        assert_eq!(parameter(Asf::try_new(1, 15)), "largest step");
        assert_eq!(parameter(Asf::new(1, 4).try_with_run(0)), "run");
        assert_eq!(parameter(Asf::new(1, 4).try_with_run(9)), "run");
        assert!(Asf::try_new(1, 14).is_ok() && Asf::try_new(16_383, 1).is_ok());
        assert!(Asf::try_new(16_384, 1).is_err());
        assert!(AdaptiveStepForward::<f32>::try_new(1e31, 1).is_err());
        assert!(AdaptiveStepForward::<f32>::try_new(f32::NAN, 1).is_err());
    }

    /// All states that a signal reaches which moves by a threshold at most: it is never more than two thresholds away.
    #[test]
    fn a_slow_signal_is_followed_within_two_thresholds() {
        for (threshold, doublings, run) in (1..=4)
            .flat_map(|a| [1, 3, 6].into_iter().flat_map(move |b| (1..=8).map(move |c| (a, b, c))))
        {
            let scheme = Asf::new(threshold, doublings).with_run(run);
            let mut encoder = scheme.encoder();
            encoder.prime(&[0]);
            // A state is how far the sample is from the value, and the rest of the encoder's state as it prints.
            let mut seen = HashSet::new();
            let mut open = vec![(0_i16, *encoder.state())];
            while let Some((x, state)) = open.pop() {
                for x in x - threshold..=x + threshold {
                    let mut encoder = Encoder::with_state(&scheme, state);
                    let spike = encoder.encode(x);
                    let text = format!("{:?}", encoder.state());
                    let base = base_in(&text);
                    let away = x - base;
                    assert!(
                        away.abs() <= 2 * threshold,
                        "{threshold} {doublings} {run}: {away} {spike:?}"
                    );
                    let rest = text.split_once("pace").map(|(_, rest)| rest.to_owned());
                    // Near 0, so that the search ends.
                    if base.abs() <= 300 && seen.insert((away, rest)) {
                        open.push((x, *encoder.state()));
                    }
                }
            }
            assert!(seen.len() > 4, "{}", seen.len());
        }
    }

    fn base_in(state: &str) -> i16 {
        let (_, rest) = state.split_once("base: ").unwrap();
        rest.split_once(',').unwrap().0.parse().unwrap()
    }

    /// A jump from rest is followed as fast as said, and never overshot.
    #[test]
    fn jumps_are_caught_up_with() {
        for (doublings, run) in (1..=6).flat_map(|a| (2..=4).map(move |b| (a, b))) {
            for jump in (0_i16..3000).step_by(7) {
                let scheme = Asf::new(3, doublings).with_run(run);
                let (mut encoder, mut decoder) = (scheme.encoder(), scheme.decoder());
                decoder.decode(encoder.encode(0));
                let steps = (jump as u16).div_ceil(3 << doublings) + 3 * u16::from(doublings);
                let value = (0..steps).fold(0, |_, _| decoder.decode(encoder.encode(jump)));
                assert!((0..=3).contains(&(jump - value)), "{doublings} {run} {jump}: {value}");
            }
        }
    }

    proptest! {
        /// Without doublings it is step forward.
        #[test]
        fn without_doublings_it_is_step_forward(x in proptest::collection::vec(any::<i16>(), 1..100), threshold in 1_i16..) {
            let (asf, sf) = (Asf::new(threshold, 0), StepForward::new(threshold));
            let (mut asf, mut sf) = (asf.encoder(), sf.encoder());
            for x in x {
                prop_assert_eq!(asf.encode(x), sf.encode(x));
            }
        }

        /// A sample that is not finite counts as a silent one at both ends.
        #[test]
        fn lost_samples_leave_both_ends_alike(
            x in proptest::collection::vec(prop_oneof![4 => -40.0_f32..40.0, 1 => Just(f32::NAN)], 1..100),
        ) {
            let scheme = AdaptiveStepForward::<f32>::new(0.5, 5);
            let (mut encoder, mut decoder) = (scheme.encoder(), scheme.decoder());
            encoder.encode(0.0);
            for x in x {
                let value = decoder.decode(encoder.encode(x));
                prop_assert!(encoder.keyframe().is_none_or(|keyframe| keyframe == value));
            }
        }

        /// A decoder that lost spikes is right again, to the bit, from the next keyframe on, and there is one within
        /// as many samples of rest as there are doublings, and one.
        #[test]
        fn keyframes_make_up_for_lost_spikes(x in proptest::collection::vec(-200.0_f32..200.0, 1..100), lost in 0..100_usize) {
            let scheme = AdaptiveStepForward::<f32>::new(0.7, 5);
            let (mut encoder, mut whole, mut lossy) = (scheme.encoder(), scheme.decoder(), scheme.decoder());
            whole.resync(x[0]);
            lossy.resync(x[0]);
            let mut is_right = true;
            for (i, x) in x.into_iter().enumerate() {
                let spike = encoder.encode(x);
                let value = whole.decode(spike);
                let is_lost = i == lost && spike.is_fired();
                is_right &= !is_lost;
                lossy.decode(if is_lost { Spike::None } else { spike });
                if let Some(keyframe) = encoder.keyframe() {
                    prop_assert_eq!(keyframe.to_bits(), value.to_bits());
                    lossy.resync(keyframe);
                    is_right = true;
                }
                prop_assert!(!is_right || lossy.held() == Some(value));
            }
            let rest = whole.held().unwrap();
            for _ in 0..6 {
                encoder.encode(rest);
            }
            prop_assert_eq!(encoder.keyframe(), Some(rest));
        }
    }

    #[test]
    fn an_empty_state_is_12_bytes() {
        assert_eq!(size_of_val(&AdaptiveStepForward::<f32>::START), 12);
    }
}
