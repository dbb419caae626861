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

/// Encodes by the definition.
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
