//! The parameters of a scheme as options.

use crate::scheme::SchemeName;
use anyhow::{Error, Result, anyhow, bail};
use clap::{Args, ValueEnum};
use std::str::FromStr;

/// Parameters, by the names of the paper's Table III, and what calibration takes from the signal.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct SchemeOptions {
    /// tbr: the threshold is the differences' mean and this many of their standard deviations, such as `0.5`
    #[arg(long, allow_negative_numbers = true, help_heading = "Parameters")]
    pub factor: Option<f64>,
    /// tbr, with --factor: mean and deviation of the differences' magnitudes
    #[arg(long, help_heading = "Parameters")]
    pub magnitudes: bool,
    /// tbr, sf, mw: how far a sample must move, in the signal's unit, such as `0.1`. t-hsa: the error allowed,
    /// in the signal's unit summed over the filter. bsa: the gain demanded, likewise, or with
    /// `--criterion mul` or `--form toolbox` a ratio, such as `0.955`
    #[arg(long, allow_negative_numbers = true, help_heading = "Parameters")]
    pub threshold: Option<f64>,
    /// tbr: what the decoder adds for a spike, in the signal's unit, `0.2`, or in thresholds, `2x`; `1x`
    /// unless given
    #[arg(long, help_heading = "Parameters")]
    pub step: Option<Step>,
    /// mw: samples of the running mean, less one, as the paper counts: `5` takes 6
    #[arg(long, help_heading = "Parameters")]
    pub window: Option<usize>,
    /// hsa, t-hsa, bsa: `triang:15`, `hann:24`, `gauss:15`, `gauss:15:2.5` (with alpha), or a FILE of taps;
    /// `,peak=2` or `,sum=1` after a shape scales it
    #[arg(long, help_heading = "Parameters")]
    pub filter: Option<String>,
    /// position, grf, grf-slots, grf-prob: how many neurons share the range, such as `20`
    #[arg(long, help_heading = "Parameters")]
    pub neurons: Option<usize>,
    /// grf-slots: sub-timesteps a sample, such as `10`
    #[arg(long, help_heading = "Parameters")]
    pub slots: Option<usize>,
    /// grf-slots, grf-prob: distance of the centres in widths of a field, so the smaller, the wider; 1.5
    /// unless given
    #[arg(long, help_heading = "Parameters")]
    pub beta: Option<f64>,
    /// grf-slots: neurons below this level of `--slots` are silent; 1 unless given
    #[arg(long, help_heading = "Parameters")]
    pub floor: Option<u16>,
    /// bsa: as published (aligned, unless given) or as in the paper's tables (toolbox)
    #[arg(long, help_heading = "Parameters")]
    pub form: Option<Form>,
    /// bsa, aligned: e1 <= e2 - threshold (sub, unless given) or e1 <= e2 * threshold (mul)
    #[arg(long, help_heading = "Parameters")]
    pub criterion: Option<Criterion>,
    /// position: `linear` (unless given), `gaussian`, or a rising list such as `-1,-0.2,0,0.2,1`
    #[arg(long, allow_hyphen_values = true, help_heading = "Parameters")]
    pub centres: Option<String>,
    /// grf-prob: where the generator starts; 0 unless given
    #[arg(long, help_heading = "Parameters")]
    pub seed: Option<u64>,
    /// hsa, t-hsa, bsa: the signal's minimum, in its unit; samples below it cannot be coded
    #[arg(long, allow_negative_numbers = true, help_heading = "Instead of calibration")]
    pub shift: Option<f64>,
    /// position, grf, grf-slots, grf-prob: the signal's minimum, in its unit
    #[arg(long, allow_negative_numbers = true, help_heading = "Instead of calibration")]
    pub min: Option<f64>,
    /// position, grf, grf-slots, grf-prob: the signal's maximum, in its unit
    #[arg(long, allow_negative_numbers = true, help_heading = "Instead of calibration")]
    pub max: Option<f64>,
    /// tbr, sf, mw: the value before the first sample, in the signal's unit; the first sample unless given
    #[arg(long, allow_negative_numbers = true, help_heading = "Instead of calibration")]
    pub start: Option<f64>,
    /// Settings of the paper's benchmark, scaled to the signal's range, for what is not given
    #[arg(long, help_heading = "Parameters")]
    pub paper: bool,
}

/// The decoder's step of temporal contrast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Step {
    /// In the signal's unit.
    Value(f64),
    /// This many thresholds.
    Thresholds(f64),
}

/// The two forms of BSA.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Form {
    /// As published.
    Aligned,
    /// With the toolbox's indices.
    Toolbox,
}

/// What BSA compares its errors by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Criterion {
    /// `e1 <= e2 - threshold`.
    Sub,
    /// `e1 <= e2 * threshold`.
    Mul,
}

impl FromStr for Step {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let number = |text: &str| text.parse().map_err(|_| anyhow!("`{text}` is not a number"));
        Ok(match text.strip_suffix('x') {
            Some(times) => Self::Thresholds(number(times)?),
            None => Self::Value(number(text)?),
        })
    }
}

impl SchemeOptions {
    /// Refuses what the scheme does not take.
    ///
    /// # Errors
    /// Such an option is given.
    pub(crate) fn check(&self, scheme: SchemeName) -> Result<()> {
        let taken = scheme.options();
        if let Some(option) = self.given().into_iter().find(|option| !taken.contains(option)) {
            let taken: Vec<String> = taken.iter().map(|option| format!("--{option}")).collect();
            bail!("{} takes no --{option}; it takes {}", scheme.name(), taken.join(" "));
        }
        Ok(())
    }

    /// Whether any parameter is given.
    pub(crate) fn is_empty(&self) -> bool {
        self.given().is_empty()
    }

    fn given(&self) -> Vec<&'static str> {
        let given = [
            ("factor", self.factor.is_some()),
            ("magnitudes", self.magnitudes),
            ("threshold", self.threshold.is_some()),
            ("step", self.step.is_some()),
            ("window", self.window.is_some()),
            ("filter", self.filter.is_some()),
            ("neurons", self.neurons.is_some()),
            ("slots", self.slots.is_some()),
            ("beta", self.beta.is_some()),
            ("floor", self.floor.is_some()),
            ("form", self.form.is_some()),
            ("criterion", self.criterion.is_some()),
            ("centres", self.centres.is_some()),
            ("seed", self.seed.is_some()),
            ("shift", self.shift.is_some()),
            ("min", self.min.is_some()),
            ("max", self.max.is_some()),
            ("start", self.start.is_some()),
        ];
        given.into_iter().filter(|(_, is_given)| *is_given).map(|(name, _)| name).collect()
    }

    /// The paper's benchmark settings where nothing is given, for a signal with this range.
    #[must_use]
    pub(crate) fn or_paper(&self, scheme: SchemeName, range: f64) -> Self {
        /// What the paper calls the amplitude of its signal.
        const PAPER_RANGE: f64 = 5.8;
        let scale = range / PAPER_RANGE;
        let filter =
            |length: usize| self.filter.clone().or(Some(format!("triang:{length},peak={scale}")));
        let threshold = |value: f64| self.threshold.or(Some(value));
        let mut options = self.clone();
        match scheme {
            SchemeName::Tbr => {
                options.factor = self.factor.or(self.threshold.is_none().then_some(0.5));
                options.step = self.step.or(Some(Step::Thresholds(2.0)));
            }
            SchemeName::Sf => options.threshold = threshold(0.5 * scale),
            SchemeName::Mw => {
                options.threshold = threshold(0.25 * scale);
                options.window = self.window.or(Some(5));
            }
            SchemeName::Hsa => options.filter = filter(15),
            SchemeName::THsa => {
                options.filter = filter(15);
                options.threshold = threshold(0.85 * scale);
            }
            SchemeName::Bsa => {
                options.filter = filter(9);
                options.form = self.form.or(Some(Form::Toolbox));
                options.threshold = threshold(1.15);
            }
            SchemeName::Position
                if self.centres.as_deref().is_some_and(|centres| centres.contains(',')) => {}
            SchemeName::Position | SchemeName::Grf => options.neurons = self.neurons.or(Some(20)),
            SchemeName::GrfSlots => {
                options.neurons = self.neurons.or(Some(15));
                options.slots = self.slots.or(Some(10));
            }
            SchemeName::GrfProb => options.neurons = self.neurons.or(Some(15)),
        }
        options
    }
}
