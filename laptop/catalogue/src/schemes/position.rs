//! Position coding.

use spikewire::population::{Neuron, Position};

use crate::plain::magnitude;
use crate::prelude::*;

/// Position coding.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly it.
const NEURONS: usize = 20;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "position",
        type_name: "Position",
        title: "Position",
        words: "position",
        good_for: "a value, dense where it matters",
        colour: [0xc0, 0x50, 0x4d],
        parameters: &[
            Parameter::new(
                "centres",
                Kind::Text,
                Unit::Signal,
                "`linear`, `gaussian`, or a rising list such as `-1,-0.2,0,0.2,1`",
            )
            .with_default("linear")
            .searched(Search::Words(&["linear", "gaussian"])),
            Parameter::neurons("20"),
            Parameter::MIN,
            Parameter::MAX,
        ],
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[InC {
        name: "position",
        scheme: "population::Position<S, {0}>",
        shapes: &[&[NEURONS]],
        made: &[
            Made {
                name: "init",
                words: "`centres`: of the neurons, rising.",
                arguments: &[Argument::CENTRES],
                value: "population::Position::try_new(centres)",
                flies: None,
            },
            Made {
                name: "init_linear",
                words: "`min`, `max`: the range, which must rise. The centres are evenly spaced.",
                arguments: &[Argument::MIN, Argument::MAX],
                value: "population::Position::try_linear(min..=max)",
                flies: Some("position"),
            },
            Made {
                name: "init_gaussian",
                words: "`min`, `max`: the range, which must rise. The centres are dense in the middle.",
                arguments: &[Argument::MIN, Argument::MAX],
                value: "population::Position::try_gaussian_spaced(min..=max)",
                flies: Some("position-gauss"),
            },
        ],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        linear(channel, visitor)?;
        let scheme = Position::<_, NEURONS>::try_gaussian_spaced(channel.min..=channel.max)?;
        visitor.visit(
            "position-gauss",
            "position, dense in the middle",
            &scheme,
            Position::<V::Sample, NEURONS>::START,
        )
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = Position::<_, 20>::try_gaussian_spaced(signal.min..=signal.max)?;
        let centres = scheme.centres();
        visitor.coded(
            "position-20",
            &scheme,
            index_of,
            neuron_of,
            |signal, neurons| transcribed(signal, centres, neurons),
            |neurons, values| plain::position_decode(neurons, centres, values),
        )
    }
}

#[cfg(feature = "run")]
impl Build for Scheme {
    /// Makes settings; a list of centres determines all of them.
    fn resolve(asked: &Resolve) -> Result<Settings> {
        asked.own_centres(&["linear", "gaussian"])?.map_or_else(|| asked.all(), Ok)
    }

    fn shape(settings: &Settings) -> Result<Shape> {
        let neurons = match settings.preset("centres")? {
            None => settings.numbers("centres")?.len(),
            Some(_) => settings.neurons()?,
        };
        Ok(Shape { neurons, slots: 1 })
    }

    // Neurons are found by bisection.
    costs!(Position<S, 20>, "position-20", |settings| Self::shape(settings)?.neurons as f64 / 20.0);

    fn constant(settings: &Settings, rust: &Rust) -> Result<Constant> {
        let (name, neurons) = ("population::Position", Self::shape(settings)?.neurons.to_string());
        let spaced = match settings.preset("centres")? {
            None => {
                let value = format!("new({})", rust.signals(settings, "centres")?);
                return rust.constant(name, &neurons, &value);
            }
            Some("gaussian") => "gaussian_spaced",
            Some(_) => "linear",
        };
        rust.constant(name, &neurons, &format!("{spaced}({})", rust.range(settings)?))
    }

    population!(|settings| {
        let scheme = match settings.preset("centres")? {
            Some("linear") => {
                dynamic::Position::<S, M>::try_linear(settings.neurons()?, &settings.range()?)?
            }
            Some("gaussian") => dynamic::Position::<S, M>::try_gaussian_spaced(
                settings.neurons()?,
                &settings.range()?,
            )?,
            _ => dynamic::Position::<S, M>::try_new(&settings.signals("centres")?)?,
        };
        (scheme.state(), scheme)
    });
}

#[inline(never)]
fn linear<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
    let scheme = Position::<_, NEURONS>::try_linear(channel.min..=channel.max)?;
    visitor.visit("position", Scheme::INFO.words, &scheme, Position::<V::Sample, NEURONS>::START)
}

/// Converts a neuron to the transcription's form.
pub fn index_of<const M: usize>(neuron: Option<Neuron<M>>) -> i8 {
    neuron.map_or(-1, |neuron| neuron.index() as i8)
}

/// Converts a neuron from the transcription's form.
pub fn neuron_of<const M: usize>(index: i8) -> Option<Neuron<M>> {
    Neuron::new(index as u16)
}

/// Encodes by the paper's algorithm 1.
#[inline(never)]
pub fn transcribed<S: Plain>(input: &[S], centres: &[S], neurons: &mut [i8]) {
    for i in 0..input.len() {
        let (mut winner, mut least) = (0, magnitude(input[i].into() - centres[0].into()));
        for j in 1..centres.len() {
            let distance = magnitude(input[i].into() - centres[j].into());
            if distance < least {
                (winner, least) = (j, distance);
            }
        }
        neurons[i] = winner as i8;
    }
}
