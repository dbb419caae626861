//! From options, and from the signal where they leave something open, to complete settings.

use crate::codec::Calibrated;
use crate::filter::taps;
use crate::options::{Criterion, Form, SchemeOptions, Step};
use crate::scheme::SchemeName;
use crate::settings::{
    Centres, Contrast, Evenly, Fields, MovingWindow, Probabilistic, Rate, RateRule, Settings,
    Slots, StepForward,
};
use anyhow::{Context, Result, anyhow, bail};

/// What is known of the signal.
#[derive(Clone, Copy)]
pub(crate) struct Known<'a> {
    /// A calibration over the whole of it, where [`missing`] asks for one.
    pub calibrated: Option<&'a Calibrated>,
    /// The first samples, finite; enough for any window.
    pub first: &'a [f64],
    /// Whether the whole of it could be read before, as `--paper` needs.
    pub can_calibrate: bool,
}

/// The options that would make a calibration over the whole signal unnecessary.
pub(crate) fn missing(scheme: SchemeName, options: &SchemeOptions) -> Option<&'static str> {
    let is_open = match scheme {
        _ if options.paper => return Some("parameters in the place of --paper"),
        SchemeName::Tbr => (options.threshold.is_none(), "--threshold"),
        SchemeName::Sf | SchemeName::Mw => (false, ""),
        SchemeName::Hsa | SchemeName::THsa | SchemeName::Bsa => {
            (options.shift.is_none(), "--shift")
        }
        SchemeName::Position if is_listed(options) => (false, ""),
        SchemeName::Position | SchemeName::Grf | SchemeName::GrfSlots | SchemeName::GrfProb => {
            (options.min.is_none() || options.max.is_none(), "--min and --max")
        }
    };
    is_open.0.then_some(is_open.1)
}

/// Complete settings.
///
/// # Errors
/// A parameter is missing, not taken by the scheme, or makes no sense.
pub(crate) fn resolve(
    scheme: SchemeName,
    options: &SchemeOptions,
    known: Known,
) -> Result<Settings> {
    options.check(scheme)?;
    let options = &if options.paper {
        let (min, max) = range(options, known)?;
        if min >= max {
            bail!("--paper: the signal never leaves {min}");
        }
        options.or_paper(scheme, max - min)
    } else {
        options.clone()
    };
    let name = scheme.name();
    let needs = |what: &str| {
        let otherwise = " (or --paper, for the paper's settings scaled to the signal)";
        anyhow!("{name} needs --{what}{}", if known.can_calibrate { otherwise } else { "" })
    };
    let threshold = || finite("threshold", options.threshold.ok_or_else(|| needs("threshold"))?);
    let start = || match options.start {
        Some(start) => finite("start", start),
        None => known.first.first().copied().context("there is no sample"),
    };
    let neurons = || options.neurons.ok_or_else(|| needs("neurons"));
    Ok(match scheme {
        SchemeName::Tbr => {
            let threshold = contrast_threshold(options, known, needs)?;
            let step = match options.step.unwrap_or(Step::Thresholds(1.0)) {
                Step::Value(step) => finite("step", step)?,
                Step::Thresholds(times) => finite("step", times * threshold)?,
            };
            Settings::Contrast(Contrast { threshold, step, start: start()? })
        }
        SchemeName::Sf => {
            Settings::StepForward(StepForward { threshold: threshold()?, start: start()? })
        }
        SchemeName::Mw => {
            let threshold = threshold()?;
            let window = options.window.ok_or_else(|| needs("window"))?;
            let samples = window.saturating_add(1).min(known.first.len().max(1));
            let first = match options.start {
                Some(start) => vec![start; samples],
                None => known.first[..samples.min(known.first.len())].to_vec(),
            };
            Settings::MovingWindow(MovingWindow { threshold, window, start: start()?, first })
        }
        SchemeName::Hsa | SchemeName::THsa | SchemeName::Bsa => {
            let taps = taps(options.filter.as_deref().ok_or_else(|| needs("filter"))?)?;
            let rule = match scheme {
                SchemeName::Hsa => RateRule::Hough,
                SchemeName::THsa => RateRule::ThresholdHough { threshold: threshold()? },
                _ => ben(options, threshold()?)?,
            };
            let shift = match options.shift {
                Some(shift) => finite("shift", shift)?,
                None => range(options, known)?.0,
            };
            Settings::Rate(Rate { taps, shift, rule })
        }
        SchemeName::Position => Settings::Position(centres(options, known, neurons)?),
        SchemeName::Grf => Settings::Gaussian(evenly(options, known, neurons()?)?),
        SchemeName::GrfSlots => {
            let slots = options.slots.ok_or_else(|| needs("slots"))?;
            let fields = fields(options, known, neurons()?)?;
            Settings::Slots(Slots { fields, slots, floor: options.floor.unwrap_or(1) })
        }
        SchemeName::GrfProb => {
            let fields = fields(options, known, neurons()?)?;
            Settings::Probabilistic(Probabilistic { fields, seed: options.seed.unwrap_or(0) })
        }
    })
}

fn contrast_threshold(
    options: &SchemeOptions,
    known: Known,
    needs: impl Fn(&str) -> anyhow::Error,
) -> Result<f64> {
    match (options.threshold, options.factor) {
        (Some(_), Some(_)) => bail!("tbr takes --factor or --threshold, not both"),
        (Some(_), None) if options.magnitudes => bail!("--magnitudes goes with --factor"),
        (Some(threshold), None) => finite("threshold", threshold),
        (None, None) => Err(needs("factor or --threshold")),
        (None, Some(factor)) => {
            let calibrated = known.calibrated.context("tbr: no calibration")?;
            calibrated.threshold(factor, options.magnitudes).with_context(|| {
                let hint = if options.magnitudes {
                    ""
                } else {
                    " (--magnitudes takes that of the differences' magnitudes)"
                };
                format!("tbr: --factor {factor} gives no threshold{hint}")
            })
        }
    }
}

fn ben(options: &SchemeOptions, threshold: f64) -> Result<RateRule> {
    match (options.form.unwrap_or(Form::Aligned), options.criterion) {
        (Form::Toolbox, Some(Criterion::Sub)) => {
            bail!("--form toolbox compares by --criterion mul only")
        }
        (Form::Toolbox, _) => Ok(RateRule::BenToolbox { threshold }),
        (Form::Aligned, Some(Criterion::Mul)) => Ok(RateRule::BenMultiplicative { threshold }),
        (Form::Aligned, _) => Ok(RateRule::BenSubtractive { threshold }),
    }
}

fn is_listed(options: &SchemeOptions) -> bool {
    options.centres.as_deref().is_some_and(|centres| !matches!(centres, "linear" | "gaussian"))
}

fn centres(
    options: &SchemeOptions,
    known: Known,
    neurons: impl Fn() -> Result<usize>,
) -> Result<Centres> {
    match options.centres.as_deref() {
        None | Some("linear") => Ok(Centres::Linear(evenly(options, known, neurons()?)?)),
        Some("gaussian") => Ok(Centres::GaussianSpaced(evenly(options, known, neurons()?)?)),
        Some(list) => {
            if let Some(option) = [
                ("neurons", options.neurons.is_some()),
                ("min", options.min.is_some()),
                ("max", options.max.is_some()),
            ]
            .into_iter()
            .find_map(|(name, is_given)| is_given.then_some(name))
            {
                bail!("--centres {list} says it all; --{option} contradicts it");
            }
            let centres = list.split(',').map(|centre| match centre.trim().parse::<f64>() {
                Ok(centre) if centre.is_finite() => Ok(centre),
                _ => bail!("--centres {list}: `{centre}` is neither a finite number, nor is the whole linear or gaussian"),
            });
            Ok(Centres::Listed(centres.collect::<Result<_>>()?))
        }
    }
}

fn fields(options: &SchemeOptions, known: Known, neurons: usize) -> Result<Fields> {
    let beta = finite("beta", options.beta.unwrap_or(1.5))?;
    Ok(Fields { range: evenly(options, known, neurons)?, beta })
}

fn evenly(options: &SchemeOptions, known: Known, neurons: usize) -> Result<Evenly> {
    let (min, max) = range(options, known)?;
    Ok(Evenly { neurons, min, max })
}

/// The range of the signal, as given or as calibrated.
fn range(options: &SchemeOptions, known: Known) -> Result<(f64, f64)> {
    if let (Some(min), Some(max)) = (options.min, options.max) {
        return Ok((finite("min", min)?, finite("max", max)?));
    }
    let (min, max) = known.calibrated.and_then(Calibrated::range).context("there is no sample")?;
    Ok((options.min.unwrap_or(min), options.max.unwrap_or(max)))
}

fn finite(what: &str, value: f64) -> Result<f64> {
    if value.is_finite() { Ok(value) } else { bail!("--{what} {value} must be finite") }
}
