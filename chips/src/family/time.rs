//! Time steps, which the driver sends to the chip as leak events.

use core::num::NonZeroU32;

use embedded_hal::spi::SpiDevice;

use super::aer::Carries;
use super::{AerPort, Input, Outcome, Running};
use spikewire::Tick;

/// Maximum number of leak events that one call sends.
const MAX_LEAKS: u32 = 255;

/// Longest time by which a tick can be earlier than the last leak event, in µs (67 s). Because ticks wrap at 32 bits,
/// every tick can be read as earlier or as later than this event. The driver reads a tick as earlier only if the
/// difference is at most this time.
const LATEST: u32 = 1 << 26;

/// Returns the time from `last` to `now` in µs. Returns `None` if `now` is earlier than `last` by at most [`LATEST`];
/// reads any other `now` as later.
fn passed(last: Tick, now: Tick) -> Option<u32> {
    let passed = now.micros().wrapping_sub(last.micros());
    (passed < LATEST.wrapping_neg()).then_some(passed)
}

/// The length of a time step, and the time at which the last leak event (the end of a time step) was due.
#[derive(Clone, Copy, Debug)]
pub(super) struct Time {
    step: NonZeroU32,
    /// Time at which the last leak event was due; `None` before the first tick.
    last: Option<Tick>,
}

impl Time {
    pub(super) const fn new(step: NonZeroU32) -> Self {
        Self { step, last: None }
    }

    /// Returns whether `tick` is earlier than the last leak event, so that its time step has ended.
    pub(super) fn is_over(&self, tick: Tick) -> bool {
        self.last.is_some_and(|last| passed(last, tick).is_none())
    }
}

impl<I: Input, D: SpiDevice, P: AerPort> Running<'_, I, D, P> {
    /// Sends the leak events that are due up to the time `now`. The first call sends none and only stores `now`. Leak
    /// events also become due while the chip is gated, and the next call sends them. Between two calls there must be
    /// less than 70 minutes; see [`with_time_step`](super::OdinChip::with_time_step).
    ///
    /// A call sends at most 255 leak events. If more are due, the call drops the oldest ones and counts them as
    /// [skipped](super::Counters::skipped_steps). Potentials may then be farther from 0 than they should be: 255 leaks
    /// of 1 bring a potential of 300 to 45, although more leaks would bring it to 0.
    ///
    /// # Errors
    /// Returns the errors of [`send`](Self::send). After an error, the next call sends the leak events that this call
    /// did not send.
    pub fn advance(&mut self, now: Tick, mut on_output: impl FnMut(u8)) -> Outcome<(), D, P> {
        self.advance_with(now, &mut on_output)
    }

    pub(super) fn advance_with(
        &mut self,
        now: Tick,
        on_output: &mut impl FnMut(u8),
    ) -> Outcome<(), D, P> {
        let chip = &mut *self.chip;
        let Some(Time { step, last }) = &mut chip.time else { return Ok(()) };
        let last = last.get_or_insert(now);
        let due = passed(*last, now).unwrap_or(0) / *step;
        if due == 0 {
            return Ok(());
        }
        let word = I::LEAK_ALL.word()?;
        let skipped = due.saturating_sub(MAX_LEAKS);
        *last += skipped.wrapping_mul(step.get());
        let count = &mut chip.counters.skipped_steps;
        *count = count.saturating_add(skipped);
        for _ in skipped..due {
            chip.aer.begin(word, Carries::Step, on_output)?;
            *last += step.get();
            chip.aer.finish(on_output)?;
        }
        Ok(())
    }
}
