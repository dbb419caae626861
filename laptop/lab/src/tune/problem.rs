//! The problem that a search solves: a goal, limits, and the score of settings. The score is computed with the same
//! codec that flies on the drone.

use super::RequestKind;
use super::{Costs, Extent, Stretch};
use crate::Result;
use crate::scheme::Scheme;
use catalogue::run::{Asked, Calibrated, Event, Known, SampleType, Settings};

/// The goal of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// The least RMSE among settings that have at least this efficiency, in percent. The efficiency is 100 less the
    /// number of spikes for every 100 samples.
    LeastError(f64),
    /// The highest efficiency among settings that have at most this RMSE.
    MostEfficient(f64),
    /// The Pareto front: all settings that no other settings beat in both spikes and error.
    Front,
}

/// The error that a search reduces if there are several flights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Over {
    /// The mean of the squared errors over all samples.
    #[default]
    Mean,
    /// The largest mean squared error of a single flight.
    Worst,
}

/// Upper limits on what settings may cost.
#[derive(Clone, Debug, Default)]
pub struct Limits {
    /// Maximum size of a channel's encoder, in bytes.
    pub ram: Option<f64>,
    /// Upper limit on the mean number of instructions that encoding a sample takes.
    pub instructions: Option<f64>,
    /// Maximum delay of the code, in samples.
    pub latency: Option<f64>,
    /// Maximum number of events a second.
    pub rate: Option<f64>,
}

/// Counts over the scored samples of several stretches.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    /// Number of samples.
    pub samples: usize,
    /// Number of spikes.
    pub spikes: usize,
    /// Sum of the squared errors.
    pub squares: f64,
    /// The largest mean squared error of a single flight.
    pub worst: f64,
    /// The duration of the samples in seconds, if the rate is known.
    pub seconds: Option<f64>,
}

impl Tally {
    /// Returns the efficiency in percent: 100 less the number of spikes for every 100 samples. For a code with at most
    /// one spike a sample, this is the percentage of samples without a spike.
    pub fn efficiency(&self) -> f64 {
        (1.0 - self.spikes as f64 / self.samples as f64) * 100.0
    }

    /// Returns the root mean square error.
    pub fn rmse(&self) -> f64 {
        (self.squares / self.samples as f64).sqrt()
    }

    /// Returns the number of events a second, if the duration is known.
    pub fn rate(&self) -> Option<f64> {
        self.seconds.map(|seconds| self.spikes as f64 / seconds)
    }
}

/// A quantity that a request may limit. The limit is a maximum, except for [`Efficiency`](Self::Efficiency), whose
/// limit is a minimum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// Size of a channel's encoder in bytes.
    Ram,
    /// Mean number of instructions that encoding a sample takes.
    Instructions,
    /// Delay of the code in samples.
    Latency,
    /// Number of events a second.
    Rate,
    /// Efficiency in percent: 100 less the number of spikes for every 100 samples.
    Efficiency,
    /// Root mean square error, in the signal's unit.
    Rmse,
}

impl Limit {
    /// Returns the name under which a request sets this limit, such as `max_ram`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ram => "max_ram",
            Self::Instructions => "max_instructions",
            Self::Latency => "max_latency",
            Self::Rate => "max_rate",
            Self::Efficiency => "min_efficiency",
            Self::Rmse => "max_rmse",
        }
    }
}

/// A limit that settings break, and by how much they break it.
#[derive(Clone, Debug)]
pub struct Excess {
    /// The limited quantity.
    pub limit: Limit,
    /// Value that the limited quantity has with these settings. Infinite if the value is not known.
    pub value: f64,
    /// The limit itself: the largest or smallest value that is allowed.
    pub allowed: f64,
    /// Amount by which the limit is exceeded, as a share of the limit.
    pub part: f64,
}

/// Value of a cost that is not known: the cost may be any, and breaks every limit.
const UNKNOWN: f64 = f64::INFINITY;

impl Excess {
    /// Returns the excess of a value over what is allowed, or `None` if there is no limit or the value keeps to it. A
    /// difference within rounding is no excess.
    fn of((limit, value, allowed): (Limit, f64, Option<f64>)) -> Option<Self> {
        let allowed = allowed.filter(|allowed| value > allowed * (1.0 + 1e-12))?;
        Some(Self { limit, value, allowed, part: share_above(value, allowed) })
    }
}

/// Returns the amount by which a value exceeds a limit, as a share of the limit.
fn share_above(value: f64, allowed: f64) -> f64 {
    ((value - allowed) / allowed.max(1e-9)).min(1e6)
}

/// Settings, and their score on the stretches to tune on.
#[derive(Clone, Debug)]
pub struct Scored {
    /// The options from which the settings are completed. Parameters that the options do not give have a default or a
    /// derived value.
    pub options: Asked,
    /// Counts of samples, spikes and errors.
    pub tally: Tally,
    /// Costs of the settings on a flight controller, such as memory and instructions.
    pub costs: Costs,
    /// The limits that the settings break. If the goal demands a maximum RMSE or a minimum efficiency, this is a limit,
    /// too.
    pub excess: Vec<Excess>,
}

impl Scored {
    /// Returns whether the settings break no limit. If the goal demands a maximum RMSE or a minimum efficiency, this is
    /// a limit, too.
    pub fn is_allowed(&self) -> bool {
        self.excess.is_empty()
    }
}

/// The problem that a search solves: a scheme, a recording, a goal and limits.
pub struct Problem<'a> {
    /// The scheme.
    pub scheme: Scheme,
    /// The sample type of the codec that is scored.
    pub sample: SampleType,
    /// Parameters that the user gave, which the search keeps.
    pub fixed: Asked,
    /// The stretches to tune on.
    pub train: &'a [Stretch],
    /// The goal of the search.
    pub goal: Goal,
    /// How the errors of several flights count.
    pub over: Over,
    /// Upper limits on what settings may cost.
    pub limits: &'a Limits,
    /// Name of the processor core, such as `M4F`, whose measured instruction counts apply.
    pub core: &'a str,
    /// Range and mean of the samples in `train`.
    pub extent: Extent,
    calibrated: Calibrated,
}

impl<'a> Problem<'a> {
    /// Makes the problem of tuning on `train`, which must hold at least one stretch.
    pub fn new(
        scheme: Scheme,
        sample: SampleType,
        fixed: &Asked,
        train: &'a [Stretch],
        (goal, limits, core): (Goal, &'a Limits, &'a str),
    ) -> Self {
        let mut calibrated = Calibrated::new(sample);
        let scored = || train.iter().flat_map(Stretch::scored_values);
        scored().for_each(|values| calibrated.observe(values));
        let (min, max) = calibrated.range().unwrap_or_default();
        let mean = scored().flatten().sum::<f64>() / scored().flatten().count().max(1) as f64;
        let extent = Extent { min, max, mean };
        let (fixed, over) = (fixed.clone(), Over::Mean);
        Self { scheme, sample, fixed, train, goal, over, limits, core, extent, calibrated }
    }

    /// Completes `options` to the settings for a stretch. A missing parameter gets its default, or a value that is
    /// derived from the samples used for tuning or from the stretch's samples.
    ///
    /// # Errors
    /// Returns an error if the options are invalid.
    pub fn settings(
        &self,
        options: &Asked,
        sample: SampleType,
        stretch: &Stretch,
    ) -> Result<Settings> {
        let known = Known {
            calibrated: Some(&self.calibrated),
            first: &stretch.values,
            can_calibrate: true,
        };
        Ok(self.scheme.resolve(sample, options, &known)?)
    }

    /// Encodes and decodes a stretch (a part of a recording). Returns the events, the decoded values, and the code's
    /// latency in samples.
    ///
    /// # Errors
    /// Returns an error if the options are invalid.
    pub fn run(
        &self,
        options: &Asked,
        sample: SampleType,
        stretch: &Stretch,
    ) -> Result<(Vec<Event>, Vec<f64>, usize)> {
        self.coded(&self.settings(options, sample, stretch)?, stretch)
    }

    fn coded(
        &self,
        settings: &Settings,
        stretch: &Stretch,
    ) -> Result<(Vec<Event>, Vec<f64>, usize)> {
        let mut codec = self.scheme.codec(settings)?;
        let (mut events, mut decoded) = (Vec::new(), Vec::with_capacity(stretch.values.len()));
        codec.encode(&stretch.values, &mut events);
        codec.finish(&mut events);
        codec.decode(stretch.values.len(), &events, &mut decoded).map_err(|event| {
            let (scheme, sample) = (self.scheme.name(), event.sample);
            RequestKind::NotDecoded { scheme, sample }
        })?;
        Ok((events, decoded, codec.latency()))
    }

    /// Scores settings on stretches (parts of recordings). Returns the counts of samples, spikes and errors, and the
    /// code's latency in samples.
    ///
    /// # Errors
    /// Returns an error if the settings are invalid.
    pub fn tally(
        &self,
        options: &Asked,
        sample: SampleType,
        stretches: &[Stretch],
    ) -> Result<(Tally, usize)> {
        let (tally, latency, _) = self.tallied(options, sample, stretches)?;
        Ok((tally, latency))
    }

    /// Scores settings on stretches, like [`tally`](Self::tally). Returns the counts, the code's latency in samples,
    /// and the complete settings for the last stretch.
    fn tallied(
        &self,
        options: &Asked,
        sample: SampleType,
        stretches: &[Stretch],
    ) -> Result<(Tally, usize, Settings)> {
        let first = stretches.first().ok_or(RequestKind::NoSamples)?;
        let mut tally = Tally { seconds: Some(0.0), ..Tally::default() };
        let mut latency = 0;
        let mut settings = self.settings(options, sample, first)?;
        // Stretches can differ only in the first value.
        let is_shared = !self.scheme.info().has_first_value();
        for flight in stretches.chunk_by(|a, b| a.flight == b.flight) {
            let (mut samples, mut squares) = (0, 0.0);
            for stretch in flight {
                if tally.samples + samples > 0 && !is_shared {
                    settings = self.settings(options, sample, stretch)?;
                }
                let (events, decoded, own) = self.coded(&settings, stretch)?;
                latency = own;
                samples += stretch.samples();
                tally.spikes += stretch.scored_events(&events).map(<[_]>::len).sum::<usize>();
                for scored in &stretch.scored {
                    let pairs = stretch.values[scored.clone()].iter().zip(&decoded[scored.clone()]);
                    squares += pairs.map(|(value, own)| (value - own).powi(2)).sum::<f64>();
                }
                tally.seconds = tally.seconds.zip(stretch.seconds()).map(|(all, own)| all + own);
            }
            tally.samples += samples;
            tally.squares += squares;
            tally.worst = tally.worst.max(squares / samples as f64);
        }
        Ok((tally, latency, settings))
    }

    /// Scores options on the stretches to tune on.
    ///
    /// # Errors
    /// Returns an error if the options are invalid.
    pub fn score(&self, options: &Asked) -> Result<Scored> {
        let (tally, latency, settings) = self.tallied(options, self.sample, self.train)?;
        let costs = Costs::new(self.scheme, &settings, latency, self.core);
        Ok(Scored { options: options.clone(), tally, costs, excess: self.excess(&tally, &costs) })
    }

    /// Completes options without scoring them. Returns the settings, and by how much they exceed the limits of RAM,
    /// instructions and latency, as a sum of shares. Returns `None` if no codec can be built.
    pub(super) fn unscored(&self, options: &Asked) -> Option<(Settings, f64)> {
        let settings = self.settings(options, self.sample, self.train.first()?).ok()?;
        let latency = self.scheme.codec(&settings).ok()?.latency();
        let costs = Costs::new(self.scheme, &settings, latency, self.core);
        let excess = self.costly(&costs).iter().map(|own| own.part).sum();
        Some((settings, excess))
    }

    /// Returns the limits of RAM, instructions and latency that costs break.
    fn costly(&self, costs: &Costs) -> Vec<Excess> {
        let Limits { ram, instructions, latency, rate: _ } = self.limits;
        let costs = [
            (Limit::Ram, costs.ram.map_or(UNKNOWN, |bytes| bytes as f64), *ram),
            (Limit::Instructions, costs.instructions.unwrap_or(UNKNOWN), *instructions),
            (Limit::Latency, costs.latency as f64, *latency),
        ];
        costs.into_iter().filter_map(Excess::of).collect()
    }

    fn excess(&self, tally: &Tally, costs: &Costs) -> Vec<Excess> {
        let mut excess = self.costly(costs);
        let rate = (Limit::Rate, tally.rate().unwrap_or(UNKNOWN), self.limits.rate);
        excess.extend(Excess::of(rate));
        if let Goal::MostEfficient(rmse) = self.goal {
            let own = self.mean_square(tally).sqrt();
            excess.extend(Excess::of((Limit::Rmse, own, Some(rmse))));
        }
        if let Goal::LeastError(efficiency) = self.goal {
            // Compared in whole spikes, because percentages are rounded.
            let most = most_spikes(efficiency, tally.samples);
            if tally.spikes > most {
                let part = share_above(tally.spikes as f64, most.max(1) as f64);
                let value = tally.efficiency();
                excess.push(Excess { limit: Limit::Efficiency, value, allowed: efficiency, part });
            }
        }
        excess
    }

    /// Returns the mean square error that the search reduces: over all samples, or on the worst flight.
    pub(super) fn mean_square(&self, tally: &Tally) -> f64 {
        match self.over {
            Over::Mean => tally.squares / tally.samples as f64,
            Over::Worst => tally.worst,
        }
    }

    /// Rates scored settings by how well they reach a goal, and returns the rating. A smaller rating is better.
    /// Settings that break a limit have larger ratings than all settings that break none.
    pub fn value(&self, goal: Goal, scored: &Scored) -> f64 {
        let Tally { samples, spikes, .. } = scored.tally;
        let limits = scored
            .excess
            .iter()
            .filter(|own| !matches!(own.limit, Limit::Efficiency | Limit::Rmse));
        let part: f64 = limits.map(|own| own.part).sum();
        let rmse = self.mean_square(&scored.tally).sqrt();
        let value = self.value_of(goal, spikes, rmse, samples);
        if part > 0.0 { NOT_ALLOWED * (1.0 + part) + value } else { value }
    }

    /// Rates a result by how well it reaches a goal, and returns the rating. A smaller rating is better. The result
    /// consists of a number of spikes in `samples` samples and an RMSE. Ignores all limits that are not part of the goal.
    fn value_of(&self, goal: Goal, spikes: usize, rmse: f64, samples: usize) -> f64 {
        let range = (self.extent.max - self.extent.min).max(f64::MIN_POSITIVE);
        let (error, part) = (rmse / range, spikes as f64 / samples as f64);
        match goal {
            Goal::LeastError(efficiency) => {
                let most = most_spikes(efficiency, samples);
                if spikes > most {
                    let above = (spikes - most) as f64 / most.max(1) as f64;
                    return NOT_ALLOWED * (1.0 + above);
                }
                // Of two settings with the same error, the one with fewer spikes is better.
                error + 1e-9 * part
            }
            Goal::MostEfficient(most) if rmse > most * (1.0 + 1e-12) => {
                NOT_ALLOWED * (rmse / most).min(1e6)
            }
            Goal::MostEfficient(_) => part + 1e-9 * error,
            Goal::Front => error + part,
        }
    }

    /// Returns the Pareto front, sorted by spikes: the settings that no other settings beat in both spikes and error.
    pub(super) fn front(&self, mut all: Vec<Scored>) -> Vec<Scored> {
        let key = |one: &Scored| one.tally.spikes as f64 / one.tally.samples as f64;
        let error = |one: &Scored| self.mean_square(&one.tally);
        all.sort_by(|a, b| key(a).total_cmp(&key(b)).then(error(a).total_cmp(&error(b))));
        let mut least = f64::INFINITY;
        all.retain(|one| {
            let is_better = error(one) < least;
            least = least.min(error(one));
            is_better
        });
        all
    }
}

/// Smallest result of [`Problem::value`] for settings that break a limit. Settings that break no limit have smaller
/// results.
pub(super) const NOT_ALLOWED: f64 = 1e12;

/// Returns the largest number of spikes in `samples` samples at which the efficiency is at least `efficiency` percent.
/// Corrects rounding: the efficiency of a whole number of spikes gives exactly this number again.
pub fn most_spikes(efficiency: f64, samples: usize) -> usize {
    let spikes = (100.0 - efficiency) / 100.0 * samples as f64;
    let nearest = spikes.round();
    let is_count = (spikes - nearest).abs() < 1e-6;
    (if is_count { nearest } else { spikes.floor() }).max(0.0) as usize
}

#[cfg(test)]
mod tests {
    use super::{Goal, Limits, Over, Problem, Tally, most_spikes};
    use crate::scheme::Scheme;
    use crate::trial::Recording;
    use crate::tune::Stretch;
    use catalogue::run::{Asked, SampleType};

    /// Of a calm and a lively flight, the larger error counts as the worst.
    #[test]
    fn the_worst_is_the_larger_of_two_flights() {
        let flight = |flight: usize, size: f64, samples: i32| {
            let values = (0..samples).map(|place| size * (f64::from(place) * 0.3).sin()).collect();
            let recording = Recording::of("x".to_owned(), values, Some(100.0));
            let mut stretches = Stretch::whole(&recording);
            for own in &mut stretches {
                own.flight = flight;
            }
            stretches.remove(0)
        };
        let train = [flight(0, 0.2, 900), flight(1, 2.0, 300)];
        let limits = Limits::default();
        let known = (Goal::LeastError(80.0), &limits, "M4F");
        let scheme = Scheme::named("sf").unwrap();
        let mut problem = Problem::new(scheme, SampleType::F32, &Asked::default(), &train, known);
        let mut options = Asked::default();
        options.set("threshold", 0.1);
        let score =
            |stretches: &[Stretch]| problem.tally(&options, SampleType::F32, stretches).unwrap().0;
        let [calm, lively] = [score(&train[..1]).rmse(), score(&train[1..]).rmse()];
        let both = score(&train);
        assert!(lively > 2.0 * calm, "{calm} {lively}");
        assert!((both.worst.sqrt() - lively).abs() < 1e-12, "{} {lively}", both.worst.sqrt());
        assert!(both.rmse() < 0.9 * lively, "{} {lively}", both.rmse());
        problem.over = Over::Worst;
        assert_eq!(problem.mean_square(&both), both.worst);
    }

    #[test]
    fn an_efficiency_allows_the_count_it_was_computed_from() {
        for samples in (1..4000).step_by(7) {
            for spikes in 0..samples.min(500) {
                let efficiency = Tally { samples, spikes, ..Tally::default() }.efficiency();
                assert_eq!(most_spikes(efficiency, samples), spikes, "{samples}");
            }
        }
        assert_eq!(
            [most_spikes(90.0, 1009), most_spikes(100.0, 9), most_spikes(-50.0, 9)],
            [100, 0, 13]
        );
    }
}
