//! Bursts whose spikes double in weight.

use spikewire::Spike;
use spikewire::rate::{Average, WeightedBurst};

use crate::prelude::*;

#[cfg(feature = "run")]
use spikewire::rate::Window;

/// Bursts whose spikes double in weight.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly it; the weight is a part of a channel's range.
const WEIGHT: f64 = 0.14;
const DOUBLINGS: u8 = 3;
const POWER: u8 = 4;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "burst-weighted",
        type_name: "WeightedBurst",
        title: "Weighted burst",
        words: "bursts of doubling weight",
        good_for: "a mean from one neuron, where few spikes may tell little and many in a row much",
        colour: [0xa8, 0x6f, 0x9c],
        parameters: &[
            Parameter::MIN,
            Parameter::MAX,
            Parameter::new(
                "weight",
                Kind::Number,
                Unit::Signal,
                "what the first spike of a burst weighs, above 0; after DOUBLINGS, max - min at least",
            )
            .with_paper(Paper::Signal(0.8))
            .with_example("1")
            .searched(Search::Log(0.02, 1.0)),
            Parameter::count("doublings", "how often the weight doubles at most, 0 to 14",
            )
            .with_default("3")
            .searched(Search::Whole(0, 6)),
            Parameter::MEAN,
            Parameter::POWER,
        ],
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[InC {
        name: "weighted_burst",
        scheme: "rate::WeightedBurst<S, rate::Average>",
        shapes: &[&[]],
        made: &[Made {
            name: "init",
            words: "`min`, `max`: the range, which must rise. `weight`: of a burst's first spike; `doublings`: of the weight, 0 to 14; `power`: the decoder's average is over about 2^power samples, 1 to 15.",
            arguments: &[
                Argument::MIN,
                Argument::MAX,
                Argument::sample("weight", Flown::Fraction(WEIGHT)),
                Argument::number("doublings", "u8", DOUBLINGS as f64),
                Argument::number("power", "u8", POWER as f64),
            ],
            value: "rate::WeightedBurst::try_new(min..=max, weight, doublings, rate::Average::try_new(power)?)",
            flies: Some("burst-weighted"),
        }],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let (range, unit) = (channel.min..=channel.max, channel.fraction(WEIGHT));
        let scheme = WeightedBurst::try_new(range, unit, DOUBLINGS, const { Average::new(POWER) })?;
        let start = WeightedBurst::<V::Sample, Average>::START;
        visitor.visit("burst-weighted", Self::INFO.words, &scheme, start)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let (min, max, unit) = (signal.min, signal.max, signal.part(0.8));
        visitor.coded(
            "burst-weighted",
            &WeightedBurst::try_new(min..=max, unit, 3, Average::new(4))?,
            Spike::sign,
            spike_of,
            |signal, spikes| transcribed(signal, min, max, unit, 3, spikes),
            |spikes, values| {
                plain::average_decode(spikes, min, max, (unit.into(), 3), 4, values);
            },
        )
    }
}

#[cfg(feature = "run")]
impl Build for Scheme {
    const CONSTANT: Option<[&str; 3]> =
        Some(["rate::WeightedBurst", "{averaging}", "new({range}, {weight}, {doublings}, {mean})"]);

    costs!(WeightedBurst<S, Average>, "burst-weighted");

    fn build<S: Sample, V: Visit<S>>(settings: &Settings, visitor: V) -> Result<V::Output> {
        let (range, weight) = (settings.range()?, settings.signal("weight")?);
        let doublings = settings.count("doublings", 0..=14)? as u8;
        if settings.takes_window()? {
            let scheme =
                WeightedBurst::<S, _>::try_new(range, weight, doublings, settings.window()?)?;
            return visitor.visit(scheme, WeightedBurst::<S, Window<128>>::START);
        }
        let scheme = WeightedBurst::<S, _>::try_new(range, weight, doublings, settings.average()?)?;
        visitor.visit(scheme, WeightedBurst::<S, Average>::START)
    }
}

/// The definition.
#[inline(never)]
pub fn transcribed<S: Plain>(
    input: &[S],
    min: S,
    max: S,
    unit: S,
    doublings: u8,
    spikes: &mut [i8],
) {
    let mut sum = S::Wide::default();
    let mut gain = 0;
    for i in 0..input.len() {
        sum += plain::above_min(input[i], min, max);
        let weight = S::doubled(unit.into(), gain);
        if sum >= weight {
            spikes[i] = 1;
            sum -= weight;
            gain = doublings.min(gain + 1);
        } else {
            spikes[i] = 0;
            gain = 0;
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use spikewire::rate::{Average, SigmaDelta, WeightedBurst, Window};
    use spikewire::{ConfigError, Scheme};

    use super::{Plain, plain, transcribed};
    use crate::schemes::sigma_delta::tests::{Check, drawn, in_every_type, spikes_of, values_of};

    const BYTE: WeightedBurst<i16, Window> = WeightedBurst::new(0..=255, 40, 3, Window::new(0));

    #[test]
    fn check_values() {
        let spikes = spikes_of(&BYTE, &[100; 12]);
        // The window of one sample gives what each spike means.
        let values = [40, 80, 160, 0, 40, 80, 160, 0, 40, 80, 160, 320];
        assert_eq!(values_of(&BYTE, &spikes), values);
    }

    #[test]
    fn ties_fire() {
        assert_eq!(spikes_of(&BYTE, &[39, 1, 80, 159, 1]), [0, 1, 1, 0, 1]);
    }

    #[test]
    fn what_is_not_finite_is_counted_and_ignored() {
        let scheme = WeightedBurst::<f32, _>::new(0.0..=1.0, 1.0, 0, Average::new(3));
        let mut encoder = scheme.encoder();
        let x = [0.75, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.25];
        assert_eq!(x.map(|x| encoder.encode(x).sign()), [0, 0, 0, 0, 1]);
        assert_eq!(encoder.rejected(), 3);
        encoder.reset();
        assert_eq!((encoder.rejected(), encoder.encode(0.75).sign()), (0, 0));
    }

    /// The decoder sees no spike, so that the burst ends for both: of 10 that are left the next spikes tell 2 and 4.
    #[test]
    fn what_is_not_finite_ends_a_burst() {
        let scheme = WeightedBurst::<f32, _>::new(0.0..=8.0, 2.0, 2, Average::new(3));
        let mut encoder = scheme.encoder();
        let x = [8.0, 8.0, f32::NAN, 0.0, 0.0];
        assert_eq!(x.map(|x| encoder.encode(x).sign()), [1, 1, 0, 1, 1]);
    }

    #[test]
    fn what_makes_no_sense_is_refused_by_name() {
        let parameter = |min, max, unit, doublings| match WeightedBurst::<f32, _>::try_new(
            min..=max,
            unit,
            doublings,
            Average::new(1),
        ) {
            Err(
                ConfigError::NotFinite { parameter, .. }
                | ConfigError::NotPositive { parameter, .. }
                | ConfigError::NotRising { parameter, .. }
                | ConfigError::OutOfRange { parameter, .. },
            ) => parameter,
            other => panic!("{other:?}"),
        };
        assert_eq!(parameter(1.0, 0.0, 1.0, 0), "min and max");
        assert_eq!(parameter(0.0, 1.0, 0.0, 0), "weight");
        assert_eq!(parameter(0.0, 1.0, f32::NAN, 0), "weight");
        assert_eq!(parameter(0.0, 1.0, 1.0, 15), "doublings");
        assert_eq!(parameter(0.0, 1.0, 0.49, 1), "largest weight");
        assert_eq!(parameter(0.0, 1.0, 1e31, 1), "largest weight");
        assert!(WeightedBurst::try_new(0.0..=1.0, 0.5, 1, Average::new(1)).is_ok());
        let whole = i16::MIN..=i16::MAX;
        assert!(WeightedBurst::try_new(whole.clone(), 32_767, 1, Average::new(1)).is_err());
        assert!(WeightedBurst::try_new(whole, 16_384, 2, Average::new(1)).is_ok());
    }

    struct Agrees(u8, u8);

    impl Check for Agrees {
        fn check<S: Plain>(&mut self, x: &[S], of: impl Fn(i16) -> S) {
            let (min, max, unit) = (of(-1000), of(3000), of(4000 >> self.1));
            let scheme = WeightedBurst::new(min..=max, unit, self.1, Average::new(self.0));
            let mut spikes = vec![0; x.len()];
            transcribed(x, min, max, unit, self.1, &mut spikes);
            assert_eq!(spikes_of(&scheme, x), spikes);
            let mut values = vec![S::default(); x.len()];
            let weight = (unit.into(), self.1);
            plain::average_decode(&spikes, min, max, weight, self.0, &mut values);
            assert_eq!(values_of(&scheme, &spikes), values);
        }
    }

    proptest! {
        #[test]
        fn as_transcribed(x in drawn(), power in 1_u8..8, doublings in 0_u8..6) {
            in_every_type(&x, Agrees(power, doublings));
        }

        /// What is not told yet stays below one largest weight more than there are doublings; a window sums what its
        /// spikes mean.
        #[test]
        fn what_is_not_told_is_bounded(x in drawn(), doublings in 0_u8..6, power in 0_u8..6) {
            let unit = 4000_i16.div_euclid(1 << doublings) + 1;
            let one = WeightedBurst::new(-1000_i16..=3000, unit, doublings, Window::<1>::new(0));
            let spikes = spikes_of(&one, &x);
            let mut gain = 0;
            let told: Vec<i64> = spikes.iter().map(|&spike| {
                let weight = (i64::from(spike) * i64::from(unit)) << gain;
                gain = if spike == 1 { doublings.min(gain + 1) } else { 0 };
                weight
            }).collect();
            let most = (i64::from(doublings + 1) * i64::from(unit)) << doublings;
            let mut left = 0;
            for (told, x) in told.iter().zip(x) {
                left += i64::from(x.clamp(-1000, 3000)) + 1000 - told;
                prop_assert!((0..most).contains(&left), "{} of {}", left, most);
            }
            let window = WeightedBurst::new(-1000_i16..=3000, unit, doublings, Window::<1>::new(power));
            let values = values_of(&window, &spikes);
            for (i, value) in values.into_iter().enumerate() {
                let first = (i + 1).saturating_sub(1 << power);
                let sum: i64 = told[first..=i].iter().sum();
                let half = (1_i64 << power) / 2;
                prop_assert_eq!(i64::from(value), ((sum + half) >> power) - 1000);
            }
        }

        /// Without doublings, with the range as the unit, it is sigma-delta.
        #[test]
        fn without_doublings_it_is_sigma_delta(x in drawn()) {
            let burst = WeightedBurst::new(-1000_i16..=3000, 4000, 0, Average::new(1));
            let regular = SigmaDelta::new(-1000_i16..=3000, Average::new(1));
            prop_assert_eq!(spikes_of(&burst, &x), spikes_of(&regular, &x));
        }
    }
}
