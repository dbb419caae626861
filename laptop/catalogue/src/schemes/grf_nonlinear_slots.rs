//! Non-linear Gaussian receptive fields with sub-timesteps.

use spikewire::population::{NeuronSlots, NonLinearSlots};

use super::grf_nonlinear::{CENTRES, COMPANDING, WIDTHS};
use super::grf_slots::transcribed_decoder;
use crate::plain::{response, spaced_widths};
use crate::prelude::*;

#[cfg(feature = "run")]
use super::grf_nonlinear;

/// Non-linear Gaussian receptive fields with sub-timesteps.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly it.
const NEURONS: usize = 15;
const SLOTS: usize = 10;
const COMPANDED_BY: f32 = 5.0;
const BETA: f32 = 1.5;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "grf-nonlinear-slots",
        type_name: "NonLinearSlots",
        title: "GRF, non-linear, slots",
        words: "non-linear GRF with sub-timesteps",
        good_for: "a value finer than the neurons, by spike time, and finest where it is most of the time",
        colour: [0x9c, 0x66, 0x44],
        parameters: &[
            CENTRES,
            WIDTHS,
            COMPANDING,
            Parameter::neurons("15"),
            Parameter::MIN,
            Parameter::MAX,
            Parameter::SLOTS,
            // Not so in `grf-slots`: docs/tuning.md says why.
            Parameter::BETA.searched(Search::Fields(0.3, 4.0)),
            Parameter::FLOOR,
        ],
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[InC {
        name: "non_linear_slots",
        scheme: "population::NonLinearSlots<S, {0}, {1}>",
        shapes: &[&[NEURONS, SLOTS]],
        made: &[
            Made {
                name: "init",
                words: "`centres`: of the neurons, rising; `widths`: of their fields, in the samples' unit, above 0; `floor`: neurons below this level of the slots are silent, 1 or more.",
                arguments: &[
                    Argument::CENTRES,
                    Argument::new("widths", "[f32; {0}]"),
                    Argument::new("floor", "u16"),
                ],
                value: "population::NonLinearSlots::try_new(centres, widths)?.try_with_floor(floor)",
                flies: None,
            },
            Made {
                name: "init_companded",
                words: "`min`, `max`: the range, which must rise. `companding`: how much denser the centres are in the middle, above 0; `beta`: the fields' width is their distance divided by it; `floor`: neurons below this level of the slots are silent, 1 or more.",
                arguments: &[
                    Argument::MIN,
                    Argument::MAX,
                    Argument::number("companding", "f32", COMPANDED_BY as f64),
                    Argument::number("beta", "f32", BETA as f64),
                    Argument::number("floor", "u16", 1.0),
                ],
                value: "population::NonLinearSlots::try_companded(min..=max, companding, beta)?.try_with_floor(floor)",
                flies: Some("grf-nonlinear-slots"),
            },
        ],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let range = channel.min..=channel.max;
        let scheme = NonLinearSlots::<_, NEURONS, SLOTS>::try_companded(range, COMPANDED_BY, BETA)?;
        let start = NonLinearSlots::<V::Sample, NEURONS, SLOTS>::START;
        visitor.visit(Self::INFO.name, Self::INFO.words, &scheme, start)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let range = signal.min..=signal.max;
        let scheme = NonLinearSlots::<_, 15, 10>::try_companded(range, 20.0, 1.5)?;
        let means = scheme.centres().map(|centre| centre.to_f64() as f32);
        let sigmas = spaced_widths(&means, 1.5);
        visitor.neurons::<_, 15>(
            "grf-nonlinear-slots-15x10",
            &scheme,
            &|| NonLinearSlots::<V::Sample, 15, 10>::START,
            spikes_of,
            |signal, slots| transcribed(signal, &means, &sigmas, 10, slots),
            |slots, before, values| {
                transcribed_decoder(slots, scheme.centres(), 10, before, values);
            },
        )
    }
}

#[cfg(feature = "run")]
impl Build for Scheme {
    fn resolve(asked: &Resolve) -> Result<Settings> {
        grf_nonlinear::resolve(asked, &Self::INFO)
    }

    fn needs_signal(asked: &Asked) -> Option<Needs> {
        grf_nonlinear::needs_signal(asked, &Self::INFO)
    }

    fn search(parameter: &Parameter, asked: &Asked) -> Option<Search> {
        grf_nonlinear::search(parameter, asked)
    }

    /// Returns whether a parameter is rounded to the sample type; widths are not.
    fn is_in_samples(parameter: &Parameter, _: &Settings) -> bool {
        parameter.unit == Unit::Signal && parameter.name != grf_nonlinear::WIDTHS.name
    }

    fn shape(settings: &Settings) -> Result<Shape> {
        let slots = settings.count("slots", 2..=dynamic::LEVELS)?;
        Ok(Shape { neurons: grf_nonlinear::neurons(settings)?, slots })
    }

    costs!(NonLinearSlots<S, 15, 10>, "grf-nonlinear-slots-15x10", |settings| {
        grf_nonlinear::neurons(settings)? as f64 / 15.0
    });

    fn constant(settings: &Settings, rust: &Rust) -> Result<Constant> {
        let Shape { neurons, slots } = Self::shape(settings)?;
        let value = if settings.preset("widths")? == Some("spacing") {
            let beta = format!(", {:?}", settings.number("beta")? as f32);
            match settings.preset("centres")? {
                Some("companded") => grf_nonlinear::companded(settings, *rust, &beta)?,
                _ => format!("spaced({}{beta})", rust.signals(settings, "centres")?),
            }
        } else {
            grf_nonlinear::with_widths(settings, *rust, "new")?
        };
        let value = format!("{value}.with_floor({})", settings.count("floor", 1..=slots)?);
        rust.constant("population::NonLinearSlots", &format!("{neurons}, {slots}"), &value)
    }

    population!(|settings| {
        let slots = settings.count("slots", 2..=dynamic::LEVELS)?;
        let centres = grf_nonlinear::centres::<S, M>(settings)?;
        let scheme = if let Some(widths) = grf_nonlinear::widths(settings, centres.len())? {
            dynamic::NonLinearSlots::<S, M>::try_new(slots, &centres, &widths)?
        } else {
            let beta = settings.number("beta")? as f32;
            dynamic::NonLinearSlots::try_spaced(slots, &centres, beta)?
        };
        let scheme = scheme.try_with_floor(settings.count("floor", 1..=slots)? as u16)?;
        (scheme.state(), scheme)
    });
}

/// Converts a code from the transcription's form: the slot of each neuron, or -1.
fn spikes_of(slots: &[i8]) -> NeuronSlots<15, 10> {
    let fired = (0..).zip(slots).filter(|&(_, &slot)| slot >= 0);
    NeuronSlots::new(fired.map(|(neuron, &slot)| (neuron, slot as u16)))
        .unwrap_or(NeuronSlots::EMPTY)
}

/// Encodes by the responses, with exponentials, in `f32` for every sample type. Writes the slot of each neuron, or -1,
/// one sample after the other.
#[allow(clippy::needless_range_loop)] // index by index, as the definition
#[inline(never)]
pub fn transcribed<S: Plain>(
    input: &[S],
    centres: &[f32],
    sigmas: &[f32],
    levels: usize,
    slots: &mut [i8],
) {
    for i in 0..input.len() {
        let x = input[i].to_f64() as f32;
        for j in 0..centres.len() {
            let level = (levels as f32 * response(x, centres[j], sigmas[j]) + 0.5) as usize;
            slots[i * centres.len() + j] = if level > 0 { (levels - level) as i8 } else { -1 };
        }
    }
}
