//! What happened to the samples.

/// Counts since the start; each wraps after 2³².
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// Samples that were encoded.
    pub samples: u32,
    /// Samples left out, as the sensor had just been started or counted as dead.
    pub discarded: u32,
    /// Samples that never came: a data-ready edge was later than a period.
    pub missed: u32,
    /// Samples that a read should have brought: the read failed, or what it brought was no sample.
    pub failed: u32,
    /// Samples with as many spikes of a channel as its code allows, or, for a code with one spike a sample, with a spike
    /// right after another: there the signal may have outrun the code.
    pub at_limit: u32,
    /// How often the sensor was found dead.
    pub deaths: u32,
    /// How often the sensor was started, with success.
    pub starts: u32,
}

impl Counters {
    /// Returns the counts since `earlier`.
    #[must_use]
    pub const fn since(&self, earlier: &Self) -> Self {
        Self {
            samples: self.samples.wrapping_sub(earlier.samples),
            discarded: self.discarded.wrapping_sub(earlier.discarded),
            missed: self.missed.wrapping_sub(earlier.missed),
            failed: self.failed.wrapping_sub(earlier.failed),
            at_limit: self.at_limit.wrapping_sub(earlier.at_limit),
            deaths: self.deaths.wrapping_sub(earlier.deaths),
            starts: self.starts.wrapping_sub(earlier.starts),
        }
    }
}
