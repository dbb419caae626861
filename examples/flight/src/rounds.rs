//! Signs of life of a task, for a watchdog.

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

use spikewire::Tick;

/// A count that one task raises and another one looks at.
#[derive(Debug, Default)]
pub struct Rounds(AtomicU32);

impl Rounds {
    /// No round so far.
    pub const fn new() -> Self {
        Self(AtomicU32::new(0))
    }

    /// Counts a round. Only one task may call it, as a Cortex-M0 has no atomic addition.
    pub fn count(&self) {
        self.0.store(self.0.load(Relaxed).wrapping_add(1), Relaxed);
    }

    /// Returns the time of the last round, for rounds of `period` µs that began at 0: the tick of the samples that it took.
    pub fn time(&self, period: u32) -> Tick {
        // The count and the ticks wrap alike: both are taken modulo 2³².
        Tick::from(self.0.load(Relaxed).wrapping_mul(period))
    }

    /// Returns whether there were as many rounds since the last call that returned true, with the same `seen`.
    pub fn passed(&self, rounds: u32, seen: &mut u32) -> bool {
        let now = self.0.load(Relaxed);
        let have = now.wrapping_sub(*seen) >= rounds;
        if have {
            *seen = now;
        }
        have
    }

    /// Returns whether there was a round since the last call with the same `seen`.
    pub fn went_on(&self, seen: &mut u32) -> bool {
        let now = self.0.load(Relaxed);
        core::mem::replace(seen, now) != now
    }
}
