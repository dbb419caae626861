//! Non-linear Gaussian receptive fields, winner takes all.

#![allow(clippy::needless_range_loop)] // index by index, as the definition

use spikewire::population::Gaussian;
use spikewire::{Sample, Start};

use crate::plain::{Plain, response, spaced_widths};
use crate::{
    Argument, Channel, Count, Entry, Flight, InC, Info, Kind, Made, Parameter, Scaled, Search, Unit,
};

#[cfg(feature = "run")]
use {
    crate::run::{
        Asked, Build, BuildPopulation, Constant, Counted, Given, Options, Rust, Settings, Shape,
        Visit, missing, state,
    },
    anyhow::{Context, Result, bail},
    spikewire::dynamic,
};

/// Non-linear Gaussian receptive fields, one spike a sample.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

/// Where the centres are.
pub(super) const CENTRES: Parameter = Parameter::new(
    "centres",
    Kind::Text,
    Unit::Signal,
    "`companded`, dense in the middle; `quantiles`, dense where the signal is; or a rising list such as `-1,-0.2,0,0.2,1`",
)
.with_default("companded")
.searched(Search::Words(&["companded", "quantiles"]));

/// How wide the fields are.
pub(super) const WIDTHS: Parameter = Parameter::new(
    "widths",
    Kind::Text,
    Unit::Signal,
    "`spacing`, as wide as the distance between a centre's neighbours, one number for all fields, or a list",
)
.with_default("spacing");

/// How dense the middle is.
pub(super) const COMPANDING: Parameter = Parameter::new(
    "companding",
    Kind::Number,
    Unit::None,
    "how much denser companded centres are in the middle, above 0",
)
.with_default("255")
.searched(Search::Log(0.1, 1000.0));

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "grf-nonlinear",
        type_name: "NonLinearGaussian",
        title: "GRF, non-linear",
        words: "non-linear Gaussian receptive fields (GRF)",
        good_for: "a value, finer where it is most of the time",
        is_signed: false,
        has_first_value: false,
        climbs_by: None,
        is_drawn: false,
        colour: [0xe0, 0x7a, 0x5f],
        parameters: &[
            CENTRES,
            WIDTHS,
            COMPANDING,
            Parameter::neurons("20"),
            Parameter::MIN,
            Parameter::MAX,
        ],
    };

    const IN_C: &'static [InC] = &[InC {
        name: "non_linear_gaussian",
        scheme: "population::Gaussian<S, {0}>",
        shapes: &[&[20]],
        made: &[
            Made {
                name: "init",
                words: "`centres`: of the neurons, rising; `widths`: of their fields, in the samples' unit, above 0.",
                arguments: &[Argument::CENTRES, Argument::new("widths", "[f32; {0}]")],
                value: "population::Gaussian::try_with_widths(centres, widths)",
                flies: None,
            },
            Made {
                name: "init_companded",
                words: "`min`, `max`: the range, which must rise. `companding`: how much denser the centres are in the middle, above 0.",
                arguments: &[
                    Argument::MIN,
                    Argument::MAX,
                    Argument::number("companding", "f32", 5.0),
                ],
                value: "population::Gaussian::try_companded(min..=max, companding)",
                flies: Some("grf-nonlinear"),
            },
        ],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = Gaussian::<_, 20>::try_companded(channel.min..=channel.max, 5.0)?;
        let start = Gaussian::<V::Sample, 20>::START;
        visitor.visit(Self::INFO.name, Self::INFO.words, &scheme, start)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = Gaussian::<_, 20>::try_companded(signal.min..=signal.max, 20.0)?;
        let means = scheme.centres().map(|centre| centre.to_f64() as f32);
        let sigmas = spaced_widths(&means, 1.5);
        visitor.winner("grf-nonlinear-20", &scheme, &means, &sigmas, |signal, neurons| {
            transcribed(signal, &means, &sigmas, neurons);
        })
    }
}

/// Settings of fields: a list of centres and widths says it all.
#[cfg(feature = "run")]
pub(super) fn resolve(asked: &Asked, info: &Info) -> Result<Settings> {
    let has_quantiles = asked.text("centres").as_deref() == Some("quantiles");
    let centres = if has_quantiles {
        Some(quantiles(asked)?)
    } else {
        asked.list("centres", &["companded", "quantiles"])?
    };
    let widths = asked.list("widths", &["spacing"])?;
    let mut settings = Settings::default();
    for parameter in info.parameters.iter().filter(|parameter| parameter.is_recorded) {
        let replaced = match parameter.name {
            "companding" | "neurons" | "min" | "max" => centres.as_ref().map(|_| "centres"),
            "beta" => widths.as_ref().map(|_| "widths"),
            _ => None,
        };
        match (parameter.name, replaced, &centres, &widths) {
            // How many quantiles.
            ("neurons", ..) if has_quantiles => {}
            (name, Some("centres"), ..) if has_quantiles && asked.user(name).is_some() => {
                bail!("--centres quantiles says it all; --{name} contradicts it")
            }
            (name, Some(by), ..) if asked.user(name).is_some() => {
                bail!("--{by} is a list, which says it all; --{name} contradicts it")
            }
            (_, Some(_), ..) => {}
            ("centres", _, Some(list), _) | ("widths", _, _, Some(list)) => {
                settings.set(parameter.name, list.clone());
            }
            (name, ..) => asked.settle(name, &mut settings)?,
        }
    }
    Ok(settings)
}

/// Centres at the signal's quantiles, as a file holds them.
#[cfg(feature = "run")]
fn quantiles(asked: &Asked) -> Result<String> {
    let mut settings = Settings::default();
    asked.settle("neurons", &mut settings)?;
    let neurons = Given::new(&settings, 1.0).neurons()?;
    let calibrated = asked.known.calibrated.context("--centres quantiles: no signal is known")?;
    let centres = calibrated.quantiles(neurons).context("there is no sample")?;
    Ok(centres.iter().map(f64::to_string).collect::<Vec<_>>().join(","))
}

/// The signal's range or its quantiles, unless there is a list of centres.
#[cfg(feature = "run")]
pub(super) fn needs_signal(options: &Options, info: &Info) -> Option<String> {
    match options.get("centres") {
        Some("quantiles") => Some("--centres as a list".to_owned()),
        None | Some("companded") => missing(info, options),
        Some(_) => None,
    }
}

/// As many neurons as there are centres.
#[cfg(feature = "run")]
pub(super) fn neurons(given: &Given) -> Result<usize> {
    match given.word("centres")? {
        "companded" => given.neurons(),
        _ => Ok(given.numbers("centres")?.len()),
    }
}

/// The centres, in the sample type.
#[cfg(feature = "run")]
pub(super) fn centres<S: Sample, const M: usize>(given: &Given) -> Result<Vec<S>> {
    Ok(match given.word("centres")? {
        "companded" => {
            let companding = given.number("companding")? as f32;
            let (neurons, range) = (given.neurons()?, given.range()?);
            dynamic::Position::<S, M>::try_companded(neurons, &range, companding)?
                .centres()
                .to_vec()
        }
        _ => given.signals("centres")?,
    })
}

/// The widths, unless they are those of the spacing.
#[cfg(feature = "run")]
pub(super) fn widths(given: &Given, neurons: usize) -> Result<Option<Vec<f32>>> {
    if given.word("widths")? == "spacing" {
        return Ok(None);
    }
    Ok(Some(repeated(given.reals("widths")?, neurons)))
}

/// One width for all fields, or one each.
#[cfg(feature = "run")]
fn repeated(widths: Vec<f32>, neurons: usize) -> Vec<f32> {
    match widths[..] {
        [one] => vec![one; neurons],
        _ => widths,
    }
}

/// The constructor of companded centres, with what it takes besides.
#[cfg(feature = "run")]
pub(super) fn companded(given: &Given, rust: Rust, besides: &str) -> Result<String> {
    let companding = given.number("companding")? as f32;
    Ok(format!("companded({}, {companding:?}{besides})", rust.range(given)?))
}

/// The constructor of fields with widths of their own.
#[cfg(feature = "run")]
pub(super) fn with_widths(given: &Given, rust: Rust, constructor: &str) -> Result<String> {
    if given.word("centres")? == "companded" {
        bail!("companded centres with widths of their own have no constant; list the centres");
    }
    let widths = given.numbers("widths")?.into_iter().map(|width| width as f32);
    let widths: Vec<f32> = repeated(widths.collect(), neurons(given)?);
    Ok(format!("{constructor}({}, {widths:?})", rust.signals(given, "centres")?))
}

#[cfg(feature = "run")]
impl Build for Scheme {
    fn resolve(asked: &Asked) -> Result<Settings> {
        resolve(asked, &Self::INFO)
    }

    fn needs_signal(options: &Options) -> Option<String> {
        needs_signal(options, &Self::INFO)
    }

    fn shape(given: &Given) -> Result<Shape> {
        Ok(Shape { neurons: neurons(given)?, slots: 1 })
    }

    fn ram<S: Sample>(_: &Given) -> Result<usize> {
        Ok(state::<Gaussian<S, 20>>())
    }

    fn counted(given: &Given) -> Result<Counted> {
        Ok(Counted::at_most("grf-nonlinear-20", neurons(given)? as f64 / 20.0))
    }

    fn constant(given: &Given, rust: &Rust) -> Result<Constant> {
        let value = match (given.word("centres")?, given.word("widths")?) {
            ("companded", "spacing") => companded(given, *rust, "")?,
            (_, "spacing") => format!("spaced({})", rust.signals(given, "centres")?),
            _ => with_widths(given, *rust, "with_widths")?,
        };
        rust.constant("population::Gaussian", &neurons(given)?.to_string(), &value)
    }

    fn build<S: Sample, V: Visit<S>>(given: &Given, visitor: V) -> Result<V::Output> {
        Self::build_population(given, visitor)
    }
}

#[cfg(feature = "run")]
impl BuildPopulation for Scheme {
    fn build_within<S: Sample, V: Visit<S>, const M: usize>(
        given: &Given,
        visitor: V,
    ) -> Result<V::Output> {
        let centres = centres::<S, M>(given)?;
        let scheme = match widths(given, centres.len())? {
            None => dynamic::Position::<S, M>::try_spaced(&centres)?,
            Some(widths) => dynamic::Position::try_with_widths(&centres, &widths)?,
        };
        let start = scheme.state();
        visitor.visit(scheme, start)
    }
}

/// The strongest of the responses, with their exponentials, in `f32` for every sample type.
#[inline(never)]
pub fn transcribed<S: Plain>(input: &[S], centres: &[f32], sigmas: &[f32], neurons: &mut [i8]) {
    for i in 0..input.len() {
        let x = input[i].to_f64() as f32;
        let (mut winner, mut largest) = (0, 0.0);
        for j in 0..centres.len() {
            let response = response(x, centres[j], sigmas[j]);
            if response > largest {
                (winner, largest) = (j, response);
            }
        }
        neurons[i] = winner as i8;
    }
}
