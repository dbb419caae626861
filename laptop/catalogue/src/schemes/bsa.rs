//! Ben's spiker (BSA), as published and as in the paper's toolbox.

use spikewire::rate::{Bsa, BsaToolbox, Scale, Shape, Taps};

use crate::plain::magnitude;
use crate::prelude::*;

#[cfg(feature = "run")]
use spikewire::rate::Criterion;

/// Ben's spiker.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly them: taps, and what they are made of, in parts of a channel's range.
const TAPS: usize = 24;
const SUM: f64 = 1.0;
const THRESHOLD: f64 = 0.955;
const MULTIPLICATIVE_SUM: f64 = 2.0;
const FACTOR: f32 = 0.92;
const TOOLBOX_TAPS: usize = 9;
const TOOLBOX_PEAK: f64 = 0.2;
const TOOLBOX_FACTOR: f32 = 1.15;

/// Values of the parameter `form`; those of `criterion` follow.
const FORMS: &[&str] = &["aligned", "toolbox"];
const CRITERIA: &[&str] = &["sub", "mul"];

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "bsa",
        type_name: "Bsa",
        title: "BSA",
        words: "Ben's spiker (BSA)",
        good_for: "a rate code of either sign of taps; with the toolbox's indices the paper's tables",
        is_drawn: true,
        colour: [0x8a, 0x5c, 0xb0],
        parameters: &[
            Parameter::filter("triang:9"),
            Parameter::SHIFT,
            Parameter::new(
                "form",
                Kind::Choice(FORMS),
                Unit::None,
                "as published (aligned), or as in the paper's tables (toolbox)",
            )
            .with_default("aligned")
            .with_paper(Paper::Text("toolbox")),
            Parameter::new(
                "criterion",
                Kind::Choice(CRITERIA),
                Unit::None,
                "aligned: e1 <= e2 - threshold (sub, unless given) or e1 <= e2 * threshold (mul)",
            ),
            Parameter::new(
                "threshold",
                Kind::Number,
                Unit::None,
                "sub: 0 or more, in the signal's unit; mul and toolbox: a factor above 0 and below 4",
            )
            .with_paper(Paper::Text("1.15"))
            .with_example("0.955")
            .searched(Search::OfFilter(0.0, 1.0))
            .of_encoder(),
        ],
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[
        InC {
            name: "bsa",
            scheme: "rate::Bsa<S, {0}>",
            shapes: &[&[TAPS]],
            made: &[
                Made {
                    name: "init",
                    words: "`taps`: of the filter; `threshold`: subtractive, 0 or more; `shift`: what is taken off the samples, at most their minimum.",
                    arguments: &[Argument::TAPS, Argument::new("threshold", "S"), Argument::SHIFT],
                    value: "rate::Bsa::try_subtractive(rate::Taps::try_new(taps)?, threshold)?.try_with_shift(shift)",
                    flies: None,
                },
                Made {
                    name: "init_sum",
                    words: "`shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `sum`: of its taps; `threshold`: subtractive, 0 or more; `shift`: what is taken off the samples, at most their minimum.",
                    arguments: &[
                        Argument::HANN,
                        Argument::sample("sum", Flown::Fraction(SUM)),
                        Argument::sample("threshold", Flown::Fraction(THRESHOLD)),
                        Argument::SHIFT,
                    ],
                    value: "rate::Bsa::try_subtractive(rate::Taps::try_shaped(shape, rate::Scale::Sum(sum))?, threshold)?.try_with_shift(shift)",
                    flies: Some("bsa"),
                },
                Made {
                    name: "init_factor",
                    words: "`shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `sum`: of its taps; `factor`: multiplicative, above 0 and below 4; `shift`: what is taken off the samples, at most their minimum.",
                    arguments: &[
                        Argument::HANN,
                        Argument::sample("sum", Flown::Fraction(MULTIPLICATIVE_SUM)),
                        Argument::number("factor", "f32", FACTOR as f64),
                        Argument::SHIFT,
                    ],
                    value: "rate::Bsa::try_multiplicative(rate::Taps::try_shaped(shape, rate::Scale::Sum(sum))?, factor)?.try_with_shift(shift)",
                    flies: Some("bsa-mul"),
                },
            ],
        },
        InC {
            name: "bsa_toolbox",
            scheme: "rate::BsaToolbox<S, {0}>",
            shapes: &[&[TOOLBOX_TAPS]],
            made: &[
                Made {
                    name: "init",
                    words: "`taps`: of the filter; `factor`: above 0 and below 4; `shift`: what is taken off the samples, at most their minimum.",
                    arguments: &[Argument::TAPS, Argument::new("factor", "f32"), Argument::SHIFT],
                    value: "rate::BsaToolbox::try_new(rate::Taps::try_new(taps)?, factor)?.try_with_shift(shift)",
                    flies: None,
                },
                Made {
                    name: "init_peak",
                    words: "`shape`: SW_TRIANGULAR, SW_HANN or SW_GAUSSIAN; `peak`: its largest tap; `factor`: above 0 and below 4; `shift`: what is taken off the samples, at most their minimum.",
                    arguments: &[
                        Argument::TRIANGULAR,
                        Argument::sample("peak", Flown::Fraction(TOOLBOX_PEAK)),
                        Argument::number("factor", "f32", TOOLBOX_FACTOR as f64),
                        Argument::SHIFT,
                    ],
                    value: "rate::BsaToolbox::try_new(rate::Taps::try_shaped(shape, rate::Scale::Peak(peak))?, factor)?.try_with_shift(shift)",
                    flies: Some("bsa-toolbox"),
                },
            ],
        },
    ];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        published(channel, visitor)?;
        let scale = Scale::Peak(channel.fraction(TOOLBOX_PEAK));
        let taps = Taps::<_, TOOLBOX_TAPS>::try_shaped(Shape::Triangular, scale)?;
        let scheme = BsaToolbox::try_new(taps, TOOLBOX_FACTOR)?.try_with_shift(channel.min)?;
        visitor.visit("bsa-toolbox", "Ben's spiker, as in the toolbox", &scheme, BsaToolbox::START)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let range = signal.range;
        // The filter's sum is what a spike at every sample decodes to.
        let whole = V::Sample::from_f64(range);
        aligned("bsa-24", whole, V::Sample::from_f64(0.955 * range), signal, visitor)?;
        // As the paper's signal meets a filter of unit sum: it spikes nearly always.
        aligned("bsa-24-busy", signal.part(1.0), signal.part(0.955), signal, visitor)?;
        toolbox(signal, visitor)
    }
}

#[cfg(feature = "run")]
impl Build for Scheme {
    fn resolve(asked: &Resolve) -> Result<Settings> {
        let form = asked.needed("form")?;
        let criterion = match (form.word(), asked.user("criterion").and_then(Value::word)) {
            (Some("toolbox"), Some("sub")) => {
                let other = Given::new("criterion", "mul");
                return Err(Error::of(
                    Given::new("form", "toolbox"),
                    ErrorKind::ComparesOnlyBy { other },
                ));
            }
            (Some("toolbox"), _) => "mul".into(),
            (_, Some(_)) => asked.needed("criterion")?,
            (_, None) => "sub".into(),
        };
        let mut settings = Settings::default();
        asked.settle("filter", &mut settings)?;
        asked.settle("shift", &mut settings)?;
        settings.set("form", form);
        settings.set("criterion", criterion);
        asked.settle("threshold", &mut settings)?;
        Ok(settings)
    }

    /// Returns whether the threshold is a sample: a difference is one, a factor is not.
    fn is_in_samples(parameter: &Parameter, settings: &Settings) -> bool {
        let is_difference = settings.get("criterion").and_then(Value::word) == Some("sub");
        parameter.unit == Unit::Signal || parameter.name == "threshold" && is_difference
    }

    /// Returns the range of the threshold, which is different for a factor and for a difference.
    fn search(parameter: &Parameter, asked: &Asked) -> Option<Search> {
        let is_factor =
            asked.word("form") == Some("toolbox") || asked.word("criterion") == Some("mul");
        match parameter.name {
            "threshold" if is_factor => Some(Search::Log(0.3, 3.9)),
            _ => parameter.search,
        }
    }

    fn ram<S: Sample>(settings: &Settings) -> Result<usize> {
        let sizes = match settings.choice("form", FORMS)? {
            "toolbox" => [state::<BsaToolbox<S, 8>>(), state::<BsaToolbox<S, 16>>()],
            _ => [state::<Bsa<S, 8>>(), state::<Bsa<S, 16>>()],
        };
        Ok(lengthened(sizes, settings.length()?))
    }

    fn counted(settings: &Settings) -> Result<Counted> {
        let length = settings.length()? as f64;
        Ok(match settings.choice("form", FORMS)? {
            "toolbox" => Counted::at_most("bsa-toolbox-9", length / 9.0),
            _ => Counted::at_most("bsa-24-busy", length / 24.0),
        })
    }

    fn constant(settings: &Settings, rust: &Rust) -> Result<Constant> {
        let (taps, shift) = (rust.taps(settings)?, rust.signal(settings, "shift")?);
        let ratio = || settings.number("threshold").map(|ratio| format!("{:?}", ratio as f32));
        let (scheme, new) =
            match (settings.choice("form", FORMS)?, settings.choice("criterion", CRITERIA)?) {
                ("toolbox", _) => ("rate::BsaToolbox", format!("new({taps}, {})", ratio()?)),
                (_, "mul") => ("rate::Bsa", format!("multiplicative({taps}, {})", ratio()?)),
                _ => (
                    "rate::Bsa",
                    format!("subtractive({taps}, {})", rust.signal(settings, "threshold")?),
                ),
            };
        let value = format!("{new}.with_shift({shift})");
        rust.constant(scheme, &format!("{}", settings.length()?), &value)
    }

    fn build<S: Sample, V: Visit<S>>(settings: &Settings, visitor: V) -> Result<V::Output> {
        let (form, criterion) =
            (settings.choice("form", FORMS)?, settings.choice("criterion", CRITERIA)?);
        let (taps, shift) = (settings.taps()?, settings.signal("shift")?);
        let criterion = match (form, criterion) {
            ("toolbox", "mul") => {
                let scheme =
                    dynamic::BsaToolbox::try_new(taps, settings.number("threshold")? as f32)?;
                let scheme = scheme.try_with_shift(shift)?;
                let start = scheme.state();
                return visitor.visit(scheme, start);
            }
            ("aligned", "mul") => Criterion::Multiplicative(settings.number("threshold")? as f32),
            ("aligned", "sub") => Criterion::Subtractive(settings.signal("threshold")?),
            _ => {
                let kind = ErrorKind::NoSuchForm { criterion };
                return Err(Error::of(Given::listed("form", Some(form)), kind));
            }
        };
        let scheme = dynamic::Bsa::try_new(taps, criterion)?.try_with_shift(shift)?;
        let start = scheme.state();
        visitor.visit(scheme, start)
    }
}

#[inline(never)]
fn published<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
    let taps = Taps::<_, TAPS>::try_shaped(Shape::Hann, Scale::Sum(channel.fraction(SUM)))?;
    let scheme = Bsa::try_subtractive(taps, channel.fraction(THRESHOLD))?;
    let scheme = scheme.try_with_shift(channel.min)?;
    visitor.visit("bsa", Scheme::INFO.words, &scheme, Bsa::START)?;

    let taps =
        Taps::<_, TAPS>::try_shaped(Shape::Hann, Scale::Sum(channel.fraction(MULTIPLICATIVE_SUM)))?;
    let scheme = Bsa::try_multiplicative(taps, FACTOR)?.try_with_shift(channel.min)?;
    visitor.visit("bsa-mul", "Ben's spiker, multiplicative", &scheme, Bsa::START)
}

#[inline(never)]
fn aligned<V: Count>(
    name: &'static str,
    sum: V::Sample,
    threshold: V::Sample,
    signal: &Scaled<V::Sample>,
    visitor: &mut V,
) -> Result<(), V::Error> {
    let taps = Taps::<_, 24>::try_shaped(Shape::Hann, Scale::Sum(sum))?;
    let scheme = Bsa::try_subtractive(taps, threshold)?.try_with_shift(signal.min)?;
    let taps = scheme.taps().as_array();
    visitor.rate(name, &scheme, &scheme, taps, signal.min, |signal, spikes| {
        transcribed(signal, taps, threshold, spikes);
    })
}

#[inline(never)]
fn toolbox<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
    let taps = Taps::<_, 9>::try_triangular(signal.part(1.0))?;
    let scheme = BsaToolbox::try_new(taps, 1.15)?.try_with_shift(signal.min)?;
    // The transcription has the ratio in 128ths.
    let agreeing = BsaToolbox::try_new(taps, 147.0 / 128.0)?.try_with_shift(signal.min)?;
    let taps = scheme.taps().as_array();
    visitor.rate("bsa-toolbox-9", &scheme, &agreeing, taps, signal.min, |signal, spikes| {
        transcribed_toolbox(signal, taps, 1.15, spikes);
    })
}

/// Encodes by BSA as published, in its subtractive form, on the shifted input.
#[inline(never)]
pub fn transcribed<S: Plain>(input: &mut [S], filter: &[S], threshold: S, spikes: &mut [i8]) {
    for i in 0..input.len() {
        let (mut e1, mut e2) = (S::Wide::default(), S::Wide::default());
        for j in 0..filter.len() {
            if i + j < input.len() {
                e1 += magnitude(input[i + j].into() - filter[j].into());
                e2 += magnitude(input[i + j].into());
            }
        }
        spikes[i] = 0;
        if e1 <= e2 - threshold.into() {
            spikes[i] = 1;
            for j in 0..filter.len() {
                if i + j < input.len() {
                    input[i + j] = S::narrow(input[i + j].into() - filter[j].into());
                }
            }
        }
    }
}

/// Encodes by the paper's algorithm 5, on the shifted input. For integers the ratio has 14 fractional bits.
#[inline(never)]
pub fn transcribed_toolbox<S: Plain>(
    input: &mut [S],
    filter: &[S],
    threshold: f64,
    spikes: &mut [i8],
) {
    // The ratio in 128ths, so that counts can take part; the paper's 1.15 is then 1.1484.
    let (parts, threshold) = (S::wide(128.0), S::wide(f64::from((threshold * 128.0) as i32)));
    for i in 0..input.len() - filter.len() {
        let (mut e1, mut e2) = (S::Wide::default(), S::Wide::default());
        for j in 0..filter.len() {
            e1 += magnitude(input[i + j + 1].into() - filter[j].into());
            e2 += magnitude(input[i + j].into());
        }
        spikes[i] = 0;
        if e1 * parts <= e2 * threshold {
            spikes[i] = 1;
            for j in 0..filter.len() {
                if i + j + 2 < input.len() {
                    input[i + j + 2] = S::narrow(input[i + j + 2].into() - filter[j].into());
                }
            }
        }
    }
}
