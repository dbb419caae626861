//! Latency-phase.

use spikewire::timing::{LatencyPhase, PhaseSpikes};

use crate::prelude::*;

/// Latency-phase.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly it.
const SPACING: u16 = 1;

/// The instance that is counted: four neurons, 32 latencies and a period of four slots.
type Four<S> = LatencyPhase<S, 4, 32, 4>;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "latency-phase",
        type_name: "LatencyPhase",
        title: "LPC",
        words: "latency-phase",
        good_for: "channels that share one line, told apart by the phase of their spikes",
        colour: [0x5c, 0x67, 0x7d],
        parameters: &[
            Parameter::count("neurons", "how many carry each sample, from 1 on")
                .with_default("4")
                .searched(Search::Whole(1, 4)),
            Parameter::count(
                "latencies",
                "how many a sample may have, 2 to 255; with the period at most 257",
            )
            .with_default("32")
            .searched(Search::Whole(2, 128)),
            Parameter::count("period", "of the oscillation in slots, a power of 2")
                .with_default("4"),
            Parameter::count("spacing", "from one neuron's peaks to the next's, in slots")
                .with_default("1"),
            Parameter::MIN,
            Parameter::MAX,
        ],
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[InC {
        name: "latency_phase",
        scheme: "timing::LatencyPhase<S, {0}, {1}, {2}>",
        shapes: &[&[4, 32, 4]],
        made: &[Made {
            name: "init",
            words: "`min`, `max`: the range, which must rise. `spacing`: from one neuron's peaks to the next's, in slots.",
            arguments: &[
                Argument::MIN,
                Argument::MAX,
                Argument::number("spacing", "u16", SPACING as f64),
            ],
            value: "timing::LatencyPhase::try_new(min..=max, spacing)",
            flies: Some("latency-phase"),
        }],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = Four::try_new(channel.min..=channel.max, SPACING)?;
        visitor.visit("latency-phase", Self::INFO.words, &scheme, Four::<V::Sample>::START)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let (min, max) = (signal.min, signal.max);
        let scheme = Four::try_new(min..=max, 1)?;
        visitor.neurons::<_, 4>(
            "latency-phase-4x32",
            &scheme,
            &|| Four::<V::Sample>::START,
            spikes_of,
            |signal, slots| transcribed(signal, 32, 4, min, max, slots),
            |slots, _, values| transcribed_decoder(slots, 4, scheme.starts(), max, values),
        )
    }
}

#[cfg(feature = "run")]
impl Build for Scheme {
    const CONSTANT: Option<[&str; 3]> = Some([
        "timing::LatencyPhase",
        "{neurons}, {latencies}, {period}",
        "new({range}, {spacing})",
    ]);

    costs!(LatencyPhase<S, 4, 32, 4>, "latency-phase-4x32", |settings| settings.count("neurons", 1..=255)? as f64 / 4.0);

    fn shape(settings: &Settings) -> Result<Shape> {
        let slots = settings.count("latencies", 2..=255)? + settings.count("period", 1..=255)? - 1;
        Ok(Shape { neurons: settings.count("neurons", 1..=255)?, slots })
    }

    fn build<S: Sample, V: Visit<S>>(settings: &Settings, visitor: V) -> Result<V::Output> {
        let count = |name| settings.count(name, 1..=255);
        let (latencies, period) = (count("latencies")?, count("period")?);
        let (neurons, spacing) = (count("neurons")?, count("spacing")? as u16);
        let scheme = dynamic::LatencyPhase::<S>::try_of(
            neurons,
            latencies,
            period,
            &settings.range()?,
            spacing,
        )?;
        visitor.visit(scheme, dynamic::LatencyPhase::<S>::START)
    }
}

/// Converts a code from the transcription's form: the slot of each neuron.
fn spikes_of<const W: usize, const P: usize>(slots: &[i8]) -> PhaseSpikes<4, W, P> {
    let slots = core::array::from_fn(|i| slots.get(i).map(|&slot| slot as u16));
    PhaseSpikes::new(slots).unwrap_or(PhaseSpikes::SILENT)
}

/// Encodes by the first peak of each neuron at or after the latency, slot by slot, one sample after the other.
#[inline(never)]
pub fn transcribed<S: Plain>(
    input: &[S],
    latencies: i16,
    neurons: usize,
    min: S,
    max: S,
    slots: &mut [i8],
) {
    let range: S::Wide = max.into() - min.into();
    for i in 0..input.len() {
        let cell = (input[i].into() - min.into()) * S::count(latencies) / range;
        let cell = (S::narrow(cell).to_f64() as i16).min(latencies - 1);
        for j in 0..neurons {
            let mut slot = latencies - 1 - cell;
            while slot as usize % neurons != j {
                slot += 1;
            }
            slots[i * neurons + j] = slot as i8;
        }
    }
}

/// Decodes to the middle of the cells whose latencies agree with every spike; `starts` are the lower ends of all cells.
#[inline(never)]
pub fn transcribed_decoder<S: Plain>(
    slots: &[i8],
    neurons: usize,
    starts: &[S],
    max: S,
    values: &mut [S],
) {
    let unit = S::wide(S::MEAN); // of the last place; 0 in floating point
    for i in 0..values.len() {
        let (mut least, mut most) = (0, starts.len() - 1);
        for j in 0..neurons {
            let slot = slots[i * neurons + j] as usize;
            least = least.max((slot + 1).saturating_sub(neurons));
            most = most.min(slot);
        }
        let first = starts[starts.len() - 1 - most].into();
        let end = if least > 0 { starts[starts.len() - least].into() - unit } else { max.into() };
        values[i] = S::narrow((first + end) / S::count(2));
    }
}
