//! Non-linear Gaussian receptive fields, winner takes all.

use spikewire::population::Gaussian;

use crate::plain::{response, spaced_widths};
use crate::prelude::*;

/// Non-linear Gaussian receptive fields, one spike a sample.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly it.
const NEURONS: usize = 20;
const COMPANDED_BY: f32 = 5.0;

/// Parameter for the spacing of the centres.
pub(super) const CENTRES: Parameter = Parameter::new(
    "centres",
    Kind::Text,
    Unit::Signal,
    "`companded`, dense in the middle; `quantiles`, dense where the signal is; or a rising list such as `-1,-0.2,0,0.2,1`",
)
.with_default("companded")
.searched(Search::Words(&["companded", "quantiles"]));

/// Parameter for the widths of the fields.
pub(super) const WIDTHS: Parameter = Parameter::new(
    "widths",
    Kind::Text,
    Unit::Signal,
    "`spacing`, as wide as the distance between a centre's neighbours, one number for all fields, or a list",
)
.with_default("spacing");

/// Parameter for the density of the centres in the middle.
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
        colour: [0xe0, 0x7a, 0x5f],
        parameters: &[
            CENTRES,
            WIDTHS,
            COMPANDING,
            Parameter::neurons("20"),
            Parameter::MIN,
            Parameter::MAX,
        ],
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[InC {
        name: "non_linear_gaussian",
        scheme: "population::Gaussian<S, {0}>",
        shapes: &[&[NEURONS]],
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
                    Argument::number("companding", "f32", COMPANDED_BY as f64),
                ],
                value: "population::Gaussian::try_companded(min..=max, companding)",
                flies: Some("grf-nonlinear"),
            },
        ],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme =
            Gaussian::<_, NEURONS>::try_companded(channel.min..=channel.max, COMPANDED_BY)?;
        let start = Gaussian::<V::Sample, NEURONS>::START;
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

/// Makes settings; a list of centres and widths determines all of them.
#[cfg(feature = "run")]
pub(super) fn resolve(asked: &Resolve, info: &Info) -> Result<Settings> {
    let has_quantiles = asked.needed("centres")?.word() == Some("quantiles");
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
                let by = Given::new("centres", "quantiles");
                return Err(Error::of(Given::named(name), ErrorKind::SaysItAll { by }));
            }
            (name, Some(by), ..) if asked.user(name).is_some() => {
                return Err(Error::of(Given::named(name), ErrorKind::ListSaysItAll { by }));
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

/// Returns centres at the signal's quantiles.
#[cfg(feature = "run")]
fn quantiles(asked: &Resolve) -> Result<Vec<f64>> {
    let mut settings = Settings::default();
    asked.settle("neurons", &mut settings)?;
    let neurons = settings.neurons()?;
    let given = Given::new("centres", "quantiles");
    let unknown = || Error::of(given, ErrorKind::NotCalibrated);
    let calibrated = asked.known.calibrated.ok_or_else(unknown)?;
    calibrated.quantiles(neurons).ok_or_else(|| ErrorKind::NoSample.into())
}

/// Returns the need for the signal's range or quantiles, unless a list of centres is given.
#[cfg(feature = "run")]
pub(super) fn needs_signal(asked: &Asked, info: &Info) -> Option<Needs> {
    match asked.word("centres") {
        Some("quantiles") => Some(Needs::AsList("centres")),
        _ => missing(info, asked),
    }
}

/// Returns the range in which a parameter is searched; none where given centres or widths determine it.
#[cfg(feature = "run")]
pub(super) fn search(parameter: &Parameter, asked: &Asked) -> Option<Search> {
    let has =
        |name: &str, preset: &str| asked.get(name).is_none_or(|given| given.word() == Some(preset));
    let is_searched = match parameter.name {
        "companding" | "min" | "max" => has("centres", "companded"),
        "neurons" => has("centres", "companded") || has("centres", "quantiles"),
        "beta" => has("widths", "spacing"),
        _ => true,
    };
    parameter.search.filter(|_| is_searched)
}

/// Returns the number of neurons, which is that of the centres.
#[cfg(feature = "run")]
pub(super) fn neurons(settings: &Settings) -> Result<usize> {
    match settings.preset("centres")? {
        Some("companded") => settings.neurons(),
        _ => Ok(settings.numbers("centres")?.len()),
    }
}

/// Returns the centres, in the sample type.
#[cfg(feature = "run")]
pub(super) fn centres<S: Sample, const M: usize>(settings: &Settings) -> Result<Vec<S>> {
    Ok(match settings.preset("centres")? {
        Some("companded") => {
            let companding = settings.number("companding")? as f32;
            let (neurons, range) = (settings.neurons()?, settings.range()?);
            dynamic::Position::<S, M>::try_companded(neurons, &range, companding)?
                .centres()
                .to_vec()
        }
        _ => settings.signals("centres")?,
    })
}

/// Returns the widths; `None` if they follow from the spacing.
#[cfg(feature = "run")]
pub(super) fn widths(settings: &Settings, neurons: usize) -> Result<Option<Vec<f32>>> {
    if settings.preset("widths")? == Some("spacing") {
        return Ok(None);
    }
    Ok(Some(repeated(settings.reals("widths")?, neurons)))
}

/// Returns a width for each field; a single width is repeated.
#[cfg(feature = "run")]
fn repeated(widths: Vec<f32>, neurons: usize) -> Vec<f32> {
    match widths[..] {
        [one] => vec![one; neurons],
        _ => widths,
    }
}

/// Writes the constructor of companded centres, with its further arguments.
#[cfg(feature = "run")]
pub(super) fn companded(settings: &Settings, rust: Rust, besides: &str) -> Result<String> {
    let companding = settings.number("companding")? as f32;
    Ok(format!("companded({}, {companding:?}{besides})", rust.range(settings)?))
}

/// Writes the constructor of fields with widths of their own.
#[cfg(feature = "run")]
pub(super) fn with_widths(settings: &Settings, rust: Rust, constructor: &str) -> Result<String> {
    if settings.preset("centres")? == Some("companded") {
        return Err(ErrorKind::NoConstantOfWidths.into());
    }
    let widths = settings.numbers("widths")?.iter().map(|width| *width as f32);
    let widths: Vec<f32> = repeated(widths.collect(), neurons(settings)?);
    Ok(format!("{constructor}({}, {widths:?})", rust.signals(settings, "centres")?))
}

#[cfg(feature = "run")]
impl Build for Scheme {
    fn resolve(asked: &Resolve) -> Result<Settings> {
        resolve(asked, &Self::INFO)
    }

    fn needs_signal(asked: &Asked) -> Option<Needs> {
        needs_signal(asked, &Self::INFO)
    }

    fn search(parameter: &Parameter, asked: &Asked) -> Option<Search> {
        search(parameter, asked)
    }

    /// Returns whether a parameter is rounded to the sample type; widths are not.
    fn is_in_samples(parameter: &Parameter, _: &Settings) -> bool {
        parameter.unit == Unit::Signal && parameter.name != WIDTHS.name
    }

    fn shape(settings: &Settings) -> Result<Shape> {
        Ok(Shape { neurons: neurons(settings)?, slots: 1 })
    }

    costs!(Gaussian<S, 20>, "grf-nonlinear-20", |settings| neurons(settings)? as f64 / 20.0);

    fn constant(settings: &Settings, rust: &Rust) -> Result<Constant> {
        let value = match (settings.preset("centres")?, settings.preset("widths")?) {
            (Some("companded"), Some("spacing")) => companded(settings, *rust, "")?,
            (_, Some("spacing")) => format!("spaced({})", rust.signals(settings, "centres")?),
            _ => with_widths(settings, *rust, "with_widths")?,
        };
        rust.constant("population::Gaussian", &neurons(settings)?.to_string(), &value)
    }

    population!(|settings| {
        let centres = centres::<S, M>(settings)?;
        let scheme = match widths(settings, centres.len())? {
            None => dynamic::Position::<S, M>::try_spaced(&centres)?,
            Some(widths) => dynamic::Position::try_with_widths(&centres, &widths)?,
        };
        (scheme.state(), scheme)
    });
}

/// Encodes by the strongest response, with exponentials, in `f32` for every sample type.
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
