//! Rank order coding.

use spikewire::population::RankOrder;

use super::grf_slots::spikes_of;
use crate::prelude::*;

/// Rank order coding.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly it.
const NEURONS: usize = 15;
const SPIKES: usize = 3;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "rank-order",
        type_name: "RankOrder",
        title: "Rank order",
        words: "rank order",
        good_for: "a value finer than the neurons, by who fires first",
        colour: [0x6d, 0x4c, 0x41],
        parameters: &[
            Parameter::new(
                "centres",
                Kind::Text,
                Unit::Signal,
                "`linear`, or a rising list such as `-1,-0.2,0,0.2,1`",
            )
            .with_default("linear"),
            Parameter::neurons("15"),
            Parameter::MIN,
            Parameter::MAX,
            Parameter::count("spikes", "how many neurons fire for a sample, 1 to all, at most 256")
                .with_example("3")
                .with_paper(Paper::Text("3"))
                .searched(Search::Whole(1, 16)),
        ],
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[InC {
        name: "rank_order",
        scheme: "population::RankOrder<S, {0}, {1}>",
        shapes: &[&[NEURONS, SPIKES]],
        made: &[
            Made {
                name: "init",
                words: "`centres`: of the neurons, rising.",
                arguments: &[Argument::CENTRES],
                value: "population::RankOrder::try_new(centres)",
                flies: None,
            },
            Made {
                name: "init_linear",
                words: "`min`, `max`: the range, which must rise. The centres are evenly spaced.",
                arguments: &[Argument::MIN, Argument::MAX],
                value: "population::RankOrder::try_linear(min..=max)",
                flies: Some("rank-order"),
            },
        ],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = RankOrder::<_, NEURONS, SPIKES>::try_linear(channel.min..=channel.max)?;
        let start = RankOrder::<V::Sample, NEURONS, SPIKES>::START;
        visitor.visit(Self::INFO.name, Self::INFO.words, &scheme, start)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let (min, max) = (signal.min, signal.max);
        let scheme = RankOrder::<_, 15, 3>::try_linear(min..=max)?;
        visitor.neurons::<_, 15>(
            "rank-order-15x3",
            &scheme,
            &|| RankOrder::<V::Sample, 15, 3>::START,
            spikes_of,
            |signal, ranks| transcribed(signal, scheme.centres(), 3, ranks),
            |ranks, _, values| transcribed_decoder(ranks, scheme.centres(), min, max, values),
        )
    }
}

#[cfg(feature = "run")]
impl Build for Scheme {
    /// Makes settings; a list of centres determines the neurons.
    fn resolve(asked: &Resolve) -> Result<Settings> {
        let Some(mut settings) = asked.own_centres(&["linear"])? else { return asked.all() };
        asked.settle("spikes", &mut settings)?;
        Ok(settings)
    }

    fn shape(settings: &Settings) -> Result<Shape> {
        let neurons = match settings.preset("centres")? {
            Some("linear") => settings.neurons()?,
            _ => settings.numbers("centres")?.len(),
        };
        Ok(Shape { neurons, slots: settings.count("spikes", 1..=dynamic::LEVELS)? })
    }

    costs!(RankOrder<S, 15, 3>, "rank-order-15x3", |settings| {
        let Shape { neurons, slots } = Self::shape(settings)?;
        (neurons as f64 / 15.0).max(slots as f64 / 3.0)
    });

    fn constant(settings: &Settings, rust: &Rust) -> Result<Constant> {
        let Shape { neurons, slots } = Self::shape(settings)?;
        let value = match settings.preset("centres")? {
            Some("linear") => format!("linear({})", rust.range(settings)?),
            _ => format!("new({})", rust.signals(settings, "centres")?),
        };
        rust.constant("population::RankOrder", &format!("{neurons}, {slots}"), &value)
    }

    population!(|settings| {
        let spikes = settings.count("spikes", 1..=dynamic::LEVELS)?;
        let scheme = match settings.preset("centres")? {
            Some("linear") => {
                let (neurons, range) = (settings.neurons()?, settings.range()?);
                dynamic::RankOrder::<S, M>::try_linear(neurons, spikes, &range)?
            }
            _ => dynamic::RankOrder::try_new(spikes, &settings.signals("centres")?)?,
        };
        (scheme.state(), scheme)
    });
}

/// Encodes by choosing the nearest centre that has not fired, repeatedly; of two equally near ones the lower. Writes
/// the rank of each neuron, or -1, one sample after the other.
#[inline(never)]
pub fn transcribed<S: Plain>(input: &[S], centres: &[S], spikes: usize, ranks: &mut [i8]) {
    for i in 0..input.len() {
        let ranks = &mut ranks[i * centres.len()..(i + 1) * centres.len()];
        ranks.fill(-1);
        for rank in 0..spikes {
            let mut winner = centres.len();
            for j in 0..centres.len() {
                // Above the middle of the two, the upper is nearer.
                if ranks[j] < 0
                    && (winner == centres.len()
                        || input[i].into() + input[i].into()
                            > centres[winner].into() + centres[j].into())
                {
                    winner = j;
                }
            }
            ranks[winner] = rank as i8;
        }
    }
}

/// Decodes to the middle of the values that are nearer to each neuron that fired than to all that fired after it or not
/// at all.
#[inline(never)]
pub fn transcribed_decoder<S: Plain>(
    ranks: &[i8],
    centres: &[S],
    min: S,
    max: S,
    values: &mut [S],
) {
    for i in 0..values.len() {
        let ranks = &ranks[i * centres.len()..(i + 1) * centres.len()];
        // Twice the ends.
        let (mut low, mut high) = (min.into() + min.into(), max.into() + max.into());
        for l in 0..centres.len() {
            for r in l + 1..centres.len() {
                let middle = centres[l].into() + centres[r].into();
                let is_lower = ranks[l] >= 0 && (ranks[r] < 0 || ranks[l] < ranks[r]);
                let is_upper = ranks[r] >= 0 && (ranks[l] < 0 || ranks[r] < ranks[l]);
                if is_lower && middle < high {
                    high = middle;
                }
                if is_upper && middle > low {
                    low = middle;
                }
            }
        }
        values[i] = S::narrow((low + high) / S::count(4));
    }
}
