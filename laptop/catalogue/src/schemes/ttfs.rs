//! Time to first spike.

use spikewire::Scheme as _;
use spikewire::timing::{FirstSpike, Slot};

use crate::prelude::*;

/// Time to first spike.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly it.
const SLOTS: usize = 16;
const RATIO: f32 = 32.0;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "ttfs",
        type_name: "FirstSpike",
        title: "TTFS",
        words: "time to first spike",
        good_for: "a value by one spike's time, the larger the earlier",
        colour: [0x2b, 0x2d, 0x42],
        parameters: &[
            Parameter::new(
                "edges",
                Kind::Text,
                Unit::Signal,
                "`linear`, `log`, or a rising list such as `0.1,0.3,1`, each of which is a slot",
            )
            .with_default("linear")
            .searched(Search::Words(&["linear", "log"])),
            Parameter::count("slots", "sub-timesteps a sample, 2 to 256")
                .with_default("16")
                .searched(Search::Whole(2, 64)),
            Parameter::new(
                "ratio",
                Kind::Number,
                Unit::None,
                "of `log`, the range over the part of it that has no spike, above 1",
            )
            .with_default("32")
            .searched(Search::Log(2.0, 1000.0)),
            Parameter::MIN,
            Parameter::MAX,
        ],
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[InC {
        name: "first_spike",
        scheme: "timing::FirstSpike<S, {0}>",
        shapes: &[&[SLOTS]],
        made: &[
            Made {
                name: "init",
                words: "`min`, `max`: the range, which must rise. `edges`: the lower ends of the slots' values, rising; values below the first have no spike.",
                arguments: &[Argument::MIN, Argument::MAX, Argument::new("edges", "[S; {0}]")],
                value: "timing::FirstSpike::try_new(min..=max, edges)",
                flies: None,
            },
            Made {
                name: "init_linear",
                words: "`min`, `max`: the range, which must rise. All slots stand for as much of it.",
                arguments: &[Argument::MIN, Argument::MAX],
                value: "timing::FirstSpike::try_linear(min..=max)",
                flies: Some("ttfs"),
            },
            Made {
                name: "init_logarithmic",
                words: "`min`, `max`: the range, which must rise. `ratio`: of the largest value that has a spike to the smallest, above 1.",
                arguments: &[
                    Argument::MIN,
                    Argument::MAX,
                    Argument::number("ratio", "f32", RATIO as f64),
                ],
                value: "timing::FirstSpike::try_logarithmic(min..=max, ratio)",
                flies: Some("ttfs-log"),
            },
        ],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = FirstSpike::<_, SLOTS>::try_linear(channel.min..=channel.max)?;
        visitor.visit("ttfs", Self::INFO.words, &scheme, FirstSpike::<V::Sample, SLOTS>::START)?;
        let scheme = FirstSpike::<_, SLOTS>::try_logarithmic(channel.min..=channel.max, RATIO)?;
        visitor.visit(
            "ttfs-log",
            "time to first spike, logarithmic",
            &scheme,
            FirstSpike::<V::Sample, SLOTS>::START,
        )
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let (min, max) = (signal.min, signal.max);
        let scheme = FirstSpike::<_, 16>::try_linear(min..=max)?;
        visitor.coded(
            "ttfs-16",
            &scheme,
            index_of,
            slot_of,
            |signal, slots| transcribed(signal, 16, min, max, slots),
            |slots, values| transcribed_decoder(slots, scheme.values(), min, values),
        )?;
        let scheme = FirstSpike::<_, 16>::try_logarithmic(min..=max, 32.0)?;
        let silence = scheme.decoder().held().unwrap_or_default();
        visitor.coded(
            "ttfs-log-16",
            &scheme,
            index_of,
            slot_of,
            |signal, slots| transcribed_log(signal, 16, 32.0, min, max, slots),
            |slots, values| transcribed_decoder(slots, scheme.values(), silence, values),
        )
    }
}

#[cfg(feature = "run")]
impl Build for Scheme {
    fn ram<S: Sample>(_: &Settings) -> Result<usize> {
        Ok(state::<FirstSpike<S, 16>>())
    }

    /// Returns the codec that stands for any number of slots, which are found by bisection.
    fn counted(settings: &Settings) -> Result<Counted> {
        let codec =
            if settings.preset("edges")? == Some("linear") { "ttfs-16" } else { "ttfs-log-16" };
        Ok(Counted::at_most(codec, Self::shape(settings)?.slots as f64 / 16.0))
    }

    fn constant(settings: &Settings, rust: &Rust) -> Result<Constant> {
        let (range, slots) = (rust.range(settings)?, Self::shape(settings)?.slots.to_string());
        let value = match settings.preset("edges")? {
            Some("linear") => format!("linear({range})"),
            Some("log") => format!("logarithmic({range}, {:?})", settings.number("ratio")? as f32),
            _ => format!("new({range}, {})", rust.signals(settings, "edges")?),
        };
        rust.constant("timing::FirstSpike", &slots, &value)
    }

    /// Makes settings. A list of edges determines the number of slots; a ratio is needed for logarithmic edges.
    fn resolve(asked: &Resolve) -> Result<Settings> {
        let edges = asked.needed("edges")?;
        let unused: &[&'static str] = match edges.word() {
            Some("log") => &[],
            None => &["slots", "ratio"],
            Some(_) => &["ratio"],
        };
        if let Some(option) = unused.iter().find(|name| asked.user(name).is_some()) {
            let kind = ErrorKind::TakesNoOther { other: option };
            return Err(Error::of(Given::new("edges", edges), kind));
        }
        let mut settings = Settings::default();
        for name in ["edges", "slots", "ratio", "min", "max"] {
            if !unused.contains(&name) {
                asked.settle(name, &mut settings)?;
            }
        }
        Ok(settings)
    }

    fn shape(settings: &Settings) -> Result<Shape> {
        let slots = match settings.preset("edges")? {
            None => settings.numbers("edges")?.len(),
            Some(_) => settings.count("slots", 2..=dynamic::LEVELS)?,
        };
        Ok(Shape { neurons: 1, slots })
    }

    fn build<S: Sample, V: Visit<S>>(settings: &Settings, visitor: V) -> Result<V::Output> {
        let (range, slots) = (settings.range()?, Self::shape(settings)?.slots);
        let scheme = match settings.preset("edges")? {
            Some("linear") => dynamic::FirstSpike::<S>::try_linear_of(slots, &range)?,
            Some("log") => {
                let ratio = settings.number("ratio")? as f32;
                dynamic::FirstSpike::try_logarithmic_of(slots, &range, ratio)?
            }
            None => dynamic::FirstSpike::try_new_of(&settings.signals("edges")?, &range)?,
            Some(word) => {
                let given = Given::listed("edges", Some(word));
                return Err(Error::of(given, ErrorKind::NoSuchEdges));
            }
        };
        visitor.visit(scheme, dynamic::FirstSpike::<S>::START)
    }
}

/// Converts a slot to the transcription's form.
pub fn index_of<const N: usize>(slot: Option<Slot<N>>) -> i8 {
    slot.map_or(-1, |slot| slot.index() as i8)
}

/// Converts a slot from the transcription's form.
pub fn slot_of<const N: usize>(index: i8) -> Option<Slot<N>> {
    Slot::new(index as u16)
}

/// Encodes by a threshold that falls in each slot, from half a step below the maximum to half a step above the minimum.
#[inline(never)]
pub fn transcribed<S: Plain>(input: &[S], count: i16, min: S, max: S, slots: &mut [i8]) {
    let range: S::Wide = max.into() - min.into();
    for i in 0..input.len() {
        let doubled = (input[i].into() - min.into()) * S::count(2 * (count - 1));
        let mut slot = 0;
        while slot < count - 1 && doubled <= range * S::count(2 * (count - 1 - slot) - 1) {
            slot += 1;
        }
        slots[i] = slot as i8;
    }
}

/// Encodes by a threshold that decays from the maximum, solved for the time, in `f32` for every sample type. Writes -1
/// if the threshold is never crossed.
#[inline(never)]
pub fn transcribed_log<S: Plain>(
    input: &[S],
    count: i16,
    ratio: f32,
    min: S,
    max: S,
    slots: &mut [i8],
) {
    let (min, max) = (min.to_f64() as f32, max.to_f64() as f32);
    for i in 0..input.len() {
        let part = (input[i].to_f64() as f32 - min) / (max - min);
        let time = -f32::from(count) * libm::logf(part) / libm::logf(ratio);
        slots[i] = if time < f32::from(count) { time as i8 } else { -1 };
    }
}

/// Decodes with a table of values for the slots, the last slot first; `silence` is the value for none.
#[inline(never)]
pub fn transcribed_decoder<S: Plain>(slots: &[i8], table: &[S], silence: S, values: &mut [S]) {
    for i in 0..slots.len() {
        values[i] =
            if slots[i] >= 0 { table[table.len() - 1 - slots[i] as usize] } else { silence };
    }
}
