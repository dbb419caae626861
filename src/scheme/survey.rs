//! The survey of a channel before arming: whether its sensor works, and the thresholds that suit its signal.

use core::fmt;
use core::ops::RangeInclusive;

use crate::error::{positive, range, tri, unwrap, within};
use crate::num::to_f64;
use crate::temporal::{StepForward, TemporalContrast};
use crate::{Calibration, ConfigError, Histogram, Moments, Sample};

/// The conditions that a channel must meet before it is [`Fit`] to fly.
///
/// ```
/// use spikewire::Conditions;
///
/// /// Two seconds at 1 kHz of a gyroscope in raw counts, lying still.
/// const GYRO: Conditions<i16> =
///     Conditions::new(2_000, i16::MIN..=i16::MAX, 400).with_stillness(120);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Conditions<S> {
    samples: u32,
    limits: [S; 2],
    largest_change: S,
    stillness: Option<S>,
}

impl<S: Sample> Conditions<S> {
    /// The conditions of a channel, for constants, where bad ones fail the build; see [`try_new`](Self::try_new).
    ///
    /// # Panics
    /// Panics if [`try_new`](Self::try_new) returns an error.
    pub const fn new(samples: u32, limits: RangeInclusive<S>, largest_change: S) -> Self {
        unwrap(Self::try_new(samples, limits, largest_change))
    }

    /// The conditions of a channel.
    ///
    /// - `samples`: how many samples it must show, at least 3.
    /// - `limits`: those of the sensor, in the samples' unit. A sound signal stays within them.
    /// - `largest_change`: the largest change from sample to sample that the histogram of changes tells from larger
    ///   ones, above 0, in the samples' unit.
    ///
    /// # Errors
    /// Returns an error if `samples` is below 3, the limits are not finite or do not rise, or the change is not above
    /// 0 or not finite.
    pub const fn try_new(
        samples: u32,
        limits: RangeInclusive<S>,
        largest_change: S,
    ) -> Result<Self, ConfigError> {
        let limits = [*limits.start(), *limits.end()];
        tri!(within("samples", samples as f64, 3.0, u32::MAX as f32));
        tri!(range(to_f64(limits[0]), to_f64(limits[1])));
        tri!(positive("largest change", to_f64(largest_change)));
        Ok(Self { samples, limits, largest_change, stillness: None })
    }

    /// Requires a vehicle at rest: its largest and smallest sample lie at most this distance apart. Without this
    /// condition the vehicle may move. For constants, where a bad distance fails the build.
    ///
    /// # Panics
    /// Panics if the distance is not above 0, or not finite.
    #[must_use]
    pub const fn with_stillness(self, distance: S) -> Self {
        unwrap(self.try_with_stillness(distance))
    }

    /// Requires a vehicle at rest: its largest and smallest sample lie at most this distance apart. Without this
    /// condition the vehicle may move.
    ///
    /// # Errors
    /// Returns an error if the distance is not above 0, or not finite.
    pub const fn try_with_stillness(self, distance: S) -> Result<Self, ConfigError> {
        tri!(positive("stillness", to_f64(distance)));
        Ok(Self { stillness: Some(distance), ..self })
    }
}

/// Watches one channel before arming, one sample at a time, and says whether it is fit to fly.
///
/// A survey keeps minimum, maximum, mean and deviation of the signal, mean and deviation of its changes, and a
/// [`Histogram`] of `B` cells of each. Only a channel that is [`Fit`] gives thresholds.
///
/// - **Memory:** `4 B` bytes, and 184 in `f32`.
/// - **Work:** some arithmetic in double precision a sample, in software where the core has no such unit: run it
///   before arming.
/// - **Rejected samples:** a sample that is not finite is counted, makes the channel unfit, and changes nothing
///   else.
///
/// ```
/// use spikewire::{Conditions, Survey, Unfit};
///
/// const GYRO: Conditions<i16> = Conditions::new(6, i16::MIN..=i16::MAX, 40).with_stillness(12);
///
/// let mut roll = Survey::<i16, 64>::new(GYRO);
/// for counts in [3, 5, 4, 7, 3] {
///     roll.observe(counts);
/// }
/// assert_eq!(roll.verdict().unwrap_err(), Unfit::TooFewSamples { seen: 5, needed: 6 });
/// roll.observe(6);
/// let fit = roll.verdict()?;
/// let scheme = fit.step_forward(0.25)?; // a spike every fourth sample at most
/// assert_eq!(scheme.threshold(), 10);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Survey<S: Sample, const B: usize> {
    conditions: Conditions<S>,
    calibration: Calibration<S>,
    moments: Moments<S>,
    levels: Histogram<S, B>,
    changes: Histogram<S, B>,
    previous: Option<S>,
    at_limits: u32,
}

/// The reason why a channel should not fly; of several, the first in this list.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum Unfit {
    /// Samples were not finite.
    NotFinite {
        /// Number of such samples.
        samples: u32,
    },
    /// The survey has not seen enough finite samples yet.
    TooFewSamples {
        /// Number of finite samples seen.
        seen: u32,
        /// Number of samples needed.
        needed: u32,
    },
    /// Samples were at a limit of the sensor or beyond it: the signal was cut off.
    Saturated {
        /// Number of such samples.
        samples: u32,
    },
    /// All samples were alike: a sensor that works has noise.
    Constant,
    /// The vehicle moved, where the conditions require it to rest. Values are shown as `f32`.
    Moving {
        /// The distance between the largest and the smallest sample.
        distance: f32,
        /// The largest distance allowed.
        stillness: f32,
    },
}

impl fmt::Display for Unfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotFinite { samples } => write!(f, "{samples} samples were not finite"),
            Self::TooFewSamples { seen, needed } => {
                write!(f, "{seen} samples were seen, at least {needed} are needed")
            }
            Self::Saturated { samples } => {
                write!(f, "{samples} samples were at the limits of the sensor")
            }
            Self::Constant => write!(f, "all samples were alike; a sensor that works has noise"),
            Self::Moving { distance, stillness } => {
                write!(f, "the samples spread over {distance}, at rest {stillness} at most")
            }
        }
    }
}

impl core::error::Error for Unfit {}

impl<S: Sample, const B: usize> Survey<S, B> {
    /// A survey before its first sample.
    pub const fn new(conditions: Conditions<S>) -> Self {
        const { assert!(B >= 1 && B <= 1024, "a histogram has 1 to 1024 cells") };
        Self {
            conditions,
            calibration: Calibration::new(),
            moments: Moments::new(),
            levels: Histogram::over(conditions.limits, u16::MAX),
            changes: Histogram::over([S::ZERO, conditions.largest_change], u16::MAX),
            previous: None,
            at_limits: 0,
        }
    }

    /// Takes one sample.
    pub fn observe(&mut self, sample: S) {
        self.calibration.observe(sample);
        self.moments.observe(sample);
        self.levels.observe(sample);
        if !sample.is_finite() {
            return;
        }
        let [min, max] = self.conditions.limits;
        if sample <= min || sample >= max {
            self.at_limits = self.at_limits.saturating_add(1);
        }
        if let Some(previous) = self.previous.replace(sample) {
            let change = sample.to_f64() - previous.to_f64();
            self.changes.observe(S::from_f64(change.abs()));
        }
    }

    /// Forgets every sample.
    pub fn reset(&mut self) {
        *self = Self::new(self.conditions);
    }

    /// The channel, if it is fit to fly.
    ///
    /// # Errors
    /// Returns why the channel is unfit. More samples may mend [`Unfit::TooFewSamples`]; the others call for a
    /// [`reset`](Self::reset).
    pub fn verdict(&self) -> Result<Fit<'_, S, B>, Unfit> {
        let Conditions { samples: needed, stillness, .. } = self.conditions;
        let (seen, rejected) = (self.calibration.seen(), self.calibration.rejected());
        if rejected > 0 {
            return Err(Unfit::NotFinite { samples: rejected });
        }
        if seen < needed {
            return Err(Unfit::TooFewSamples { seen, needed });
        }
        if self.at_limits > 0 {
            return Err(Unfit::Saturated { samples: self.at_limits });
        }
        let [min, max] =
            [self.calibration.min(), self.calibration.max()].map(Option::unwrap_or_default);
        if min == max {
            return Err(Unfit::Constant);
        }
        let distance = max.to_f64() - min.to_f64();
        match stillness.map(S::to_f64).filter(|&stillness| distance > stillness) {
            Some(stillness) => {
                Err(Unfit::Moving { distance: distance as f32, stillness: stillness as f32 })
            }
            None => Ok(Fit { survey: self }),
        }
    }
}

/// A channel that is fit to fly: the statistics of its signal, and thresholds that follow from them.
#[derive(Clone, Copy, Debug)]
pub struct Fit<'a, S: Sample, const B: usize> {
    survey: &'a Survey<S, B>,
}

impl<'a, S: Sample, const B: usize> Fit<'a, S, B> {
    /// Minimum and maximum of the signal, mean and deviation of its changes.
    pub const fn calibration(&self) -> &'a Calibration<S> {
        &self.survey.calibration
    }

    /// Mean and deviation of the signal.
    pub const fn moments(&self) -> &'a Moments<S> {
        &self.survey.moments
    }

    /// How often the signal took which values, between the sensor's limits.
    pub const fn levels(&self) -> &'a Histogram<S, B> {
        &self.survey.levels
    }

    /// How often `|x[i] - x[i-1]|` took which values, from 0 to the largest change.
    pub const fn changes(&self) -> &'a Histogram<S, B> {
        &self.survey.changes
    }

    /// Step forward with at most `spikes` spikes a sample, above 0 and up to 1.
    ///
    /// The threshold is `mean |x[i] - x[i-1]| / spikes`. Every spike moves the baseline by a threshold, and the
    /// baseline travels no further than the signal does, so that the samples seen have no more spikes than this,
    /// up to the rounding of the threshold. Fewer spikes cost a larger error.
    ///
    /// # Errors
    /// Returns an error if the number is not within 0 to 1, or the threshold rounds to 0 in the sample type.
    pub fn step_forward(&self, spikes: f32) -> Result<StepForward<S>, ConfigError> {
        check_spikes(spikes)?;
        let mean = self.calibration().magnitudes()?.mean;
        StepForward::try_new(S::from_f64(mean / f64::from(spikes)))
    }

    /// Temporal contrast with at most `spikes` spikes a sample, above 0 and up to 1.
    ///
    /// The threshold is the lowest border between two cells of [`changes`](Self::changes) that at most the part
    /// `spikes` of the changes exceeds: a multiple of `largest_change / B`. Up to 65 534 changes this is exact; of more
    /// the older ones count less.
    ///
    /// # Errors
    /// Returns an error if the number is not within 0 to 1, or a larger part of the changes is in the last cell.
    pub fn temporal_contrast(&self, spikes: f32) -> Result<TemporalContrast<S>, ConfigError> {
        check_spikes(spikes)?;
        let counts = self.changes().counts();
        let total: u32 = counts.iter().copied().map(u32::from).sum();
        let part = |above: u32| above as f32 / total as f32;
        let last = counts.last().copied().unwrap_or_default();
        within("spikes a sample", spikes.into(), part(last.into()), 1.0)?;
        let (mut above, mut border) = (0_u32, B);
        for &count in counts.iter().rev() {
            above = above.saturating_add(count.into());
            if part(above) > spikes || border == 1 {
                break;
            }
            border = border.saturating_sub(1);
        }
        let largest = self.survey.conditions.largest_change.to_f64();
        TemporalContrast::try_new(S::from_f64(largest * border as f64 / B as f64))
    }
}

/// Checks a number of spikes a sample: above 0, at most 1.
fn check_spikes(spikes: f32) -> Result<(), ConfigError> {
    within("spikes a sample", spikes.into(), f32::MIN_POSITIVE, 1.0)
}
