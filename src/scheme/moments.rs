//! Mean and deviation of a signal, one sample at a time.

use crate::num::{Sums, one};
use crate::{ConfigError, Sample};

/// Mean and standard deviation of the samples seen.
///
/// - **Exactness:** fixed point keeps the sums of samples and squares as whole numbers, so that only the answer is
///   rounded, whatever the order of the samples. `f32` uses Welford's running mean in double precision.
/// - **Work:** an addition and a multiplication of 64 bits a sample in fixed point; a division in double precision
///   in `f32`, in software where the core has no such unit: run it before arming.
/// - **Range:** it takes 2³²-1 finite samples, 49 days at 1 kHz. Later ones are counted and change nothing.
/// - **Rejected samples:** a sample that is not finite is counted and changes nothing.
/// - **Memory:** 32 bytes in `f32`, 40 in fixed point on a Cortex-M.
///
/// Source: Welford, *Note on a method for calculating corrected sums of squares and products*, 1962.
///
/// ```
/// use spikewire::Moments;
///
/// let mut rest = Moments::<i16>::new();
/// for counts in [3, 5, 4, 4, 3, 5] {
///     rest.observe(counts);
/// }
/// assert_eq!(rest.mean(), Ok(4.0));
/// assert_eq!(rest.deviation(), Ok((4.0_f64 / 5.0).sqrt())); // with N-1
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Moments<S: Sample> {
    sums: S::Sums,
    seen: u32,
    ignored: u32,
    rejected: u32,
}

impl<S: Sample> Default for Moments<S> {
    fn default() -> Self {
        Self::new()
    }
}

impl<S: Sample> Moments<S> {
    /// Moments before the first sample.
    pub const fn new() -> Self {
        Self { sums: S::Sums::ZERO, seen: 0, ignored: 0, rejected: 0 }
    }

    /// Takes one sample.
    pub fn observe(&mut self, sample: S) {
        if !sample.is_finite() {
            self.rejected = self.rejected.saturating_add(1);
            return;
        }
        let Some(seen) = self.seen.checked_add(1) else {
            self.ignored = self.ignored.saturating_add(1);
            return;
        };
        self.sums.add(seen, sample);
        self.seen = seen;
    }

    /// How many finite samples it has taken, up to 2³²-1.
    pub const fn seen(&self) -> u32 {
        self.seen
    }

    /// How many finite samples came after the first 2³²-1 and are left out; up to 2³²-1.
    pub const fn ignored(&self) -> u32 {
        self.ignored
    }

    /// How many samples were not finite, up to 2³²-1.
    pub const fn rejected(&self) -> u32 {
        self.rejected
    }

    /// The mean, in the samples' unit.
    ///
    /// # Errors
    /// Returns an error if there is no sample.
    pub fn mean(&self) -> Result<f64, ConfigError> {
        self.needs(1)?;
        Ok(self.sums.mean(self.seen) * one::<S>())
    }

    /// The standard deviation with N-1, in the samples' unit.
    ///
    /// # Errors
    /// Returns an error if there are fewer than two samples.
    pub fn deviation(&self) -> Result<f64, ConfigError> {
        self.needs(2)?;
        let degrees = f64::from(self.seen.saturating_sub(1));
        Ok(libm::sqrt(self.sums.squares(self.seen) / degrees) * one::<S>())
    }

    fn needs(&self, needed: u32) -> Result<(), ConfigError> {
        if self.seen < needed {
            return Err(ConfigError::TooFewSamples { seen: self.seen, needed });
        }
        Ok(())
    }
}
