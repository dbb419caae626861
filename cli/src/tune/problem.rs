//! What is looked for: a goal, limits, and the score of settings by the codec that flies.

use super::{Costs, Extent, Stretch};
use crate::options::SchemeOptions;
use crate::scheme::Scheme;
use anyhow::{Result, anyhow};
use catalogue::run::{Calibrated, Event, Known, Options, SampleType, Settings};

/// What is best.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Goal {
    /// The least RMSE at a spiking efficiency of at least so many percent.
    LeastError(f64),
    /// The greatest spiking efficiency at an RMSE of at most this.
    MostEfficient(f64),
    /// All settings that no other one beats in both.
    Front,
}

/// What settings may cost at most.
#[derive(Clone, Debug, Default)]
pub(crate) struct Limits {
    /// Bytes of a channel's encoder.
    pub ram: Option<f64>,
    /// Instructions a sample to encode, in the mean.
    pub instructions: Option<f64>,
    /// Samples until a code comes out.
    pub latency: Option<f64>,
    /// Events a second.
    pub rate: Option<f64>,
}

/// Counts over stretches.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    pub samples: usize,
    pub spikes: usize,
    pub squares: f64,
    /// How long they are, if that is known.
    pub seconds: Option<f64>,
}

impl Tally {
    /// Percent of samples without a spike.
    pub(crate) fn efficiency(&self) -> f64 {
        (1.0 - self.spikes as f64 / self.samples as f64) * 100.0
    }

    /// Root mean square error.
    pub(crate) fn rmse(&self) -> f64 {
        (self.squares / self.samples as f64).sqrt()
    }

    /// Events a second.
    pub(crate) fn rate(&self) -> Option<f64> {
        self.seconds.map(|seconds| self.spikes as f64 / seconds)
    }
}

/// A limit, what settings come to, and what they may.
#[derive(Clone, Debug)]
pub(crate) struct Excess {
    pub limit: &'static str,
    pub is: f64,
    pub may_be: f64,
    /// By how much it is too much, as a part of what it may be.
    pub part: f64,
}

/// Settings with their score on the stretches to tune on.
#[derive(Clone, Debug)]
pub(crate) struct Scored {
    pub options: Options,
    pub tally: Tally,
    pub costs: Costs,
    /// What they exceed, of limits and goal.
    pub excess: Vec<Excess>,
}

impl Scored {
    /// Whether they keep to all limits, and reach what the goal asks for.
    pub(crate) fn is_allowed(&self) -> bool {
        self.excess.is_empty()
    }
}

/// What is looked for.
pub(crate) struct Problem<'a> {
    pub scheme: Scheme,
    pub sample: SampleType,
    /// What the user has decided.
    pub fixed: Options,
    pub train: &'a [Stretch],
    pub goal: Goal,
    pub limits: &'a Limits,
    pub core: &'a str,
    /// The range of the stretches to tune on.
    pub extent: Extent,
    calibrated: Calibrated,
}

impl<'a> Problem<'a> {
    /// A problem on these stretches, of which there is one at least.
    pub(crate) fn new(
        scheme: Scheme,
        sample: SampleType,
        fixed: &SchemeOptions,
        train: &'a [Stretch],
        (goal, limits, core): (Goal, &'a Limits, &'a str),
    ) -> Self {
        let mut calibrated = Calibrated::new(sample);
        for stretch in train {
            calibrated.observe(&stretch.values);
        }
        let (min, max) = calibrated.range().unwrap_or_default();
        let extent = Extent { min, max };
        Self {
            scheme,
            sample,
            fixed: fixed.0.clone(),
            train,
            goal,
            limits,
            core,
            extent,
            calibrated,
        }
    }

    /// Complete settings on a stretch, as they run.
    ///
    /// # Errors
    /// The options make no sense.
    pub(crate) fn settings(
        &self,
        options: &Options,
        sample: SampleType,
        stretch: &Stretch,
    ) -> Result<Settings> {
        let known = Known {
            calibrated: Some(&self.calibrated),
            first: &stretch.values,
            can_calibrate: true,
        };
        let settings = self.scheme.resolve(options, &known)?;
        Ok(self.scheme.rounded(sample, &settings)?.0)
    }

    /// Encodes and decodes a stretch, and hands on its events, decoded values and latency.
    ///
    /// # Errors
    /// The options make no sense.
    pub(crate) fn run(
        &self,
        options: &Options,
        sample: SampleType,
        stretch: &Stretch,
    ) -> Result<(Vec<Event>, Vec<f64>, usize)> {
        let settings = self.settings(options, sample, stretch)?;
        let mut codec = self.scheme.codec(sample, &settings)?;
        let (mut events, mut decoded) = (Vec::new(), Vec::new());
        codec.encode(&stretch.values, &mut events);
        codec.finish(&mut events);
        codec
            .decode(stretch.values.len(), &events, &mut decoded)
            .map_err(|event| anyhow!("sample {} does not decode", event.sample))?;
        Ok((events, decoded, codec.latency()))
    }

    /// What options come to on stretches, and the latency.
    ///
    /// # Errors
    /// They make no sense.
    pub(crate) fn tally(
        &self,
        options: &Options,
        sample: SampleType,
        stretches: &[Stretch],
    ) -> Result<(Tally, usize)> {
        let mut tally = Tally { seconds: Some(0.0), ..Tally::default() };
        let mut latency = 0;
        for stretch in stretches {
            let (events, decoded, own) = self.run(options, sample, stretch)?;
            latency = own;
            tally.samples += stretch.values.len();
            tally.spikes += events.len();
            let off = stretch.values.iter().zip(&decoded).map(|(value, own)| (value - own).powi(2));
            tally.squares += off.sum::<f64>();
            let seconds = stretch.rate.map(|rate| stretch.values.len() as f64 / rate);
            tally.seconds = tally.seconds.zip(seconds).map(|(all, own)| all + own);
        }
        Ok((tally, latency))
    }

    /// The score of options on the stretches to tune on.
    ///
    /// # Errors
    /// They make no sense.
    pub(crate) fn score(&self, options: &Options) -> Result<Scored> {
        let (tally, latency) = self.tally(options, self.sample, self.train)?;
        let costs = self.costs(options, latency)?;
        Ok(Scored { options: options.clone(), tally, costs, excess: self.excess(&tally, &costs) })
    }

    /// What options cost.
    ///
    /// # Errors
    /// They make no sense.
    pub(crate) fn costs(&self, options: &Options, latency: usize) -> Result<Costs> {
        let Some(stretch) = self.train.first() else { return Err(anyhow!("nothing to tune on")) };
        let settings = self.settings(options, self.sample, stretch)?;
        Ok(Costs::new(self.scheme, self.sample, &settings, latency, self.core))
    }

    fn excess(&self, tally: &Tally, costs: &Costs) -> Vec<Excess> {
        let Limits { ram, instructions, latency, rate } = self.limits;
        // What is not known may be anything.
        let unknown = f64::INFINITY;
        let ram_used = costs.ram.map_or(unknown, |bytes| bytes as f64);
        let mut asked = vec![
            ("--max-ram", ram_used, *ram),
            ("--max-instructions", costs.instructions.unwrap_or(unknown), *instructions),
            ("--max-latency", costs.latency as f64, *latency),
            ("--max-rate", tally.rate().unwrap_or(unknown), *rate),
        ];
        match self.goal {
            Goal::LeastError(efficiency) => {
                // In spikes, as an efficiency may be 0 or less.
                let spikes = 100.0 - tally.efficiency();
                asked.push(("--min-efficiency", spikes, Some(100.0 - efficiency)));
            }
            Goal::MostEfficient(rmse) => asked.push(("--max-rmse", tally.rmse(), Some(rmse))),
            Goal::Front => {}
        }
        // Rounding is no excess.
        let is_above = |is: f64, may_be: f64| is > may_be * (1.0 + 1e-12);
        let excess = asked.into_iter().filter_map(|(limit, is, may_be)| {
            let may_be = may_be.filter(|may_be| is_above(is, *may_be))?;
            Some(Excess { limit, is, may_be, part: ((is - may_be) / may_be.max(1e-9)).min(1e6) })
        });
        excess.collect()
    }

    /// A number that is the smaller, the better a score is: any that is allowed is below any that is not.
    pub(crate) fn value(&self, scored: &Scored) -> f64 {
        const NOT_ALLOWED: f64 = 1e12;
        if !scored.is_allowed() {
            return NOT_ALLOWED * (1.0 + scored.excess.iter().map(|one| one.part).sum::<f64>());
        }
        let Tally { samples, spikes, .. } = scored.tally;
        let range = (self.extent.max - self.extent.min).max(f64::MIN_POSITIVE);
        let (error, spikes) = (scored.tally.rmse() / range, spikes as f64 / samples as f64);
        match self.goal {
            // Of two alike the one with fewer spikes, or with less error.
            Goal::LeastError(_) => error + 1e-9 * spikes,
            Goal::MostEfficient(_) => spikes + 1e-9 * error,
            Goal::Front => error + spikes,
        }
    }
}

/// Those that no other one beats in both spikes and error, by their spikes.
pub(crate) fn front(mut all: Vec<Scored>) -> Vec<Scored> {
    let key = |one: &Scored| one.tally.spikes as f64 / one.tally.samples as f64;
    all.sort_by(|a, b| key(a).total_cmp(&key(b)).then(a.tally.squares.total_cmp(&b.tally.squares)));
    let mut least = f64::INFINITY;
    all.retain(|one| {
        let is_better = one.tally.squares < least;
        least = least.min(one.tally.squares);
        is_better
    });
    all
}
