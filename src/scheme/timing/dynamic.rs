//! Timing codes whose number of slots is chosen at run time; each has room for the largest number.

use core::ops::RangeInclusive;

use crate::dynamic::LEVELS as SLOTS;
use crate::error::within;
use crate::{ConfigError, Sample, timing};

/// [`timing::FirstSpike`] with any number of slots, up to 256.
pub type FirstSpike<S> = timing::FirstSpike<S, SLOTS>;

/// [`timing::LatencyPhase`] with any number of neurons and of slots, up to 256.
pub type LatencyPhase<S> = timing::LatencyPhase<S, SLOTS, SLOTS, SLOTS>;

/// [`timing::WeightedPhase`] with any number of slots, up to 16.
pub type WeightedPhase<S> = timing::WeightedPhase<S, 16>;

/// [`timing::Burst`] with any number of slots, up to 256.
pub type Burst<S> = timing::Burst<S, SLOTS>;

fn check(parameter: &'static str, value: usize, min: usize, max: usize) -> Result<(), ConfigError> {
    within(parameter, value as f64, min as f32, max as f32)
}

impl<S: Sample> FirstSpike<S> {
    /// [`try_linear`](Self::try_linear) with this many slots.
    ///
    /// # Errors
    /// Returns an error if there are not 2 to 256 slots, or as for [`try_linear`](Self::try_linear).
    pub fn try_linear_of(slots: usize, range: &RangeInclusive<S>) -> Result<Self, ConfigError> {
        check("slots", slots, 2, SLOTS)?;
        Self::of_points(range, slots)
    }

    /// [`try_logarithmic`](Self::try_logarithmic) with this many slots.
    ///
    /// # Errors
    /// Returns an error if there are not 2 to 256 slots, or as for [`try_logarithmic`](Self::try_logarithmic).
    pub fn try_logarithmic_of(
        slots: usize,
        range: &RangeInclusive<S>,
        dynamic_range: f32,
    ) -> Result<Self, ConfigError> {
        check("slots", slots, 2, SLOTS)?;
        Self::of_logarithms(range, dynamic_range, slots)
    }

    /// [`try_new`](Self::try_new) with a slot for each edge.
    ///
    /// # Errors
    /// Returns an error if there are not 2 to 256 edges, or as for [`try_new`](Self::try_new).
    pub fn try_new_of(edges: &[S], range: &RangeInclusive<S>) -> Result<Self, ConfigError> {
        check("edges", edges.len(), 2, SLOTS)?;
        Self::of_own(range, edges)
    }
}

impl<S: Sample> LatencyPhase<S> {
    /// [`try_new`](Self::try_new) with this many neurons and latencies, and a period of `period` slots.
    ///
    /// # Errors
    /// Returns an error if there are not 2 to 256 latencies, or more than 256 slots; the period is no power of 2, or
    /// has no slot for each neuron; or as for [`try_new`](Self::try_new).
    pub fn try_of(
        neurons: usize,
        latencies: usize,
        period: usize,
        range: &RangeInclusive<S>,
        spacing: u16,
    ) -> Result<Self, ConfigError> {
        check("latencies", latencies, 2, SLOTS)?;
        check("period", period, 1, SLOTS + 1 - latencies)?;
        // The error names the next lower power of 2 as the period allowed.
        let power = 1 << period.ilog2();
        check("period", period, power, power)?;
        check("neurons", neurons, 1, period)?;
        Self::of(range, neurons, latencies, period, spacing)
    }
}

impl<S: Sample> Burst<S> {
    /// [`try_new`](Self::try_new) with this many slots.
    ///
    /// # Errors
    /// Returns an error if there are not 2 to 256 slots, or as for [`try_new`](Self::try_new).
    pub fn try_of(
        slots: usize,
        range: &RangeInclusive<S>,
        spikes: u8,
        intervals: &RangeInclusive<u8>,
    ) -> Result<Self, ConfigError> {
        check("slots", slots, 2, SLOTS)?;
        Self::of(range, spikes, [*intervals.start(), *intervals.end()], slots)
    }
}
