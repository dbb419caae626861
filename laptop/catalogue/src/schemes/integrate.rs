//! Integrate and fire (IF).

use spikewire::rate::IntegrateAndFire;
use spikewire::temporal::Steps;

use crate::prelude::*;

/// Integrate and fire.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly it; a threshold is a part of a channel's range.
const THRESHOLD: f64 = 0.2;
const POWER: u8 = 3;
const SPIKES: usize = 8;

/// Parameters of the neuron, with and without a leak.
pub(super) const PARAMETERS: &[Parameter] = &[
    Parameter::new(
        "threshold",
        Kind::Number,
        Unit::Signal,
        "what the samples add up to at a spike, above 0",
    )
    .with_paper(Paper::Signal(1.0))
    .with_example("0.5")
    .searched(Search::Log(0.02, 8.0)),
    Parameter::new("reference", Kind::Number, Unit::Signal, "the value without spikes")
        .with_default("0")
        .searched(Search::Around(0.0, 1.0)),
    Parameter::count(
        "power",
        "the decoder's mean is over about 2^POWER samples, and so long a leak lasts: 1 to 15",
    )
    .with_default("4")
    .searched(Search::Whole(1, 8)),
    Parameter::SPIKES,
];

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "if",
        type_name: "IntegrateAndFire",
        title: "IF",
        words: "integrate and fire (IF)",
        good_for: "a mean, and an integral that never drifts: a gyroscope's angle",
        is_signed: true,
        colour: [0x2f, 0x9e, 0x8f],
        parameters: PARAMETERS,
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[InC {
        name: "integrate_and_fire",
        scheme: "rate::IntegrateAndFire<S, {0}>",
        shapes: &[&[SPIKES]],
        made: &[Made {
            name: "init",
            words: "`threshold`: what samples add up to at a spike, above 0; `power`: the decoder's mean is over 2^power samples, 1 to 15; `reference`: the value without spikes.",
            arguments: &[
                Argument::sample("threshold", Flown::Fraction(THRESHOLD)),
                Argument::number("power", "u8", POWER as f64),
                Argument::sample("reference", Flown::Number(0.0)),
            ],
            value: "rate::IntegrateAndFire::try_new(threshold, power)?.try_with_reference(reference)",
            flies: Some("if"),
        }],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = IntegrateAndFire::<_, SPIKES>::try_new(channel.fraction(THRESHOLD), POWER)?;
        let start = IntegrateAndFire::<V::Sample, SPIKES>::START;
        visitor.visit("if", Self::INFO.words, &scheme, start)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let threshold = signal.part(1.0);
        let scheme = IntegrateAndFire::<_, 4>::try_new(threshold, 4)?;
        visitor.coded(
            "if",
            &scheme,
            Steps::count,
            Steps::new,
            |signal, counts| transcribed(signal, threshold, None, 4, counts),
            |counts, values| transcribed_decoder(counts, threshold, 4, values),
        )
    }
}

/// Returns the shape: one neuron, whose spikes are in consecutive slots.
#[cfg(feature = "run")]
pub(super) fn shape(settings: &Settings) -> Result<Shape> {
    Ok(Shape { neurons: 1, slots: settings.count("spikes", 1..=127)? })
}

/// Builds the neuron, with room for the largest number of spikes.
#[cfg(feature = "run")]
pub(super) fn built<S: Sample>(settings: &Settings) -> Result<IntegrateAndFire<S, 127>> {
    let power = settings.count("power", 1..=15)? as u8;
    let scheme = IntegrateAndFire::try_new(settings.signal("threshold")?, power)?;
    let scheme = scheme.try_with_reference(settings.signal("reference")?)?;
    Ok(scheme.try_with_most(shape(settings)?.slots as u8)?)
}

#[cfg(feature = "run")]
impl Build for Scheme {
    const CONSTANT: Option<[&str; 3]> = Some([
        "rate::IntegrateAndFire",
        "{spikes}",
        "new({threshold}, {power}).with_reference({reference})",
    ]);

    costs!(IntegrateAndFire<S, 127>, "if");

    fn shape(settings: &Settings) -> Result<Shape> {
        shape(settings)
    }

    fn build<S: Sample, V: Visit<S>>(settings: &Settings, visitor: V) -> Result<V::Output> {
        visitor.visit(built(settings)?, IntegrateAndFire::<S, 127>::START)
    }
}

/// Encodes by the definition, with 0 as the reference.
#[inline(never)]
pub fn transcribed<S: Plain>(
    input: &[S],
    threshold: S,
    leak: Option<u8>,
    most: i8,
    counts: &mut [i8],
) {
    let (zero, threshold) = (S::Wide::default(), threshold.into());
    let mut potential = zero;
    for i in 0..input.len() {
        if let Some(power) = leak {
            potential = leaked::<S>(potential, power);
        }
        potential += input[i].into();
        counts[i] = 0;
        while potential >= threshold && counts[i] < most {
            potential -= threshold;
            counts[i] += 1;
        }
        while potential <= zero - threshold && counts[i] <= 0 && counts[i] > -most {
            potential += threshold;
            counts[i] -= 1;
        }
    }
}

/// Subtracts the `2^power`th part, rounded alike for both signs.
fn leaked<S: Plain>(potential: S::Wide, power: u8) -> S::Wide {
    let zero = S::Wide::default();
    if potential < zero {
        potential + S::halved(zero - potential, power)
    } else {
        potential - S::halved(potential, power)
    }
}

/// Decodes by the leaky mean, with 0 as the reference.
#[inline(never)]
pub fn transcribed_decoder<S: Plain>(counts: &[i8], threshold: S, power: u8, values: &mut [S]) {
    let mut potential = S::Wide::default();
    for i in 0..counts.len() {
        potential = leaked::<S>(potential, power);
        potential += S::count(counts[i].into()) * threshold.into();
        values[i] = S::narrow(S::halved_to_nearest(potential, power));
    }
}
