//! Handles Ctrl-C: a command that runs until it is stopped ends in order and keeps its output; any other is ended at
//! once, and leaves no half-written file.

use crate::inputs::delete_copy;
use anyhow::{Context, Result};
use lab::output::abandon;
use spikewire::Tick;
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

static IS_WANTED: AtomicBool = AtomicBool::new(false);
/// Whether the running command has a [`Stop`], so that it ends by itself after Ctrl-C.
static IS_AWAITED: AtomicBool = AtomicBool::new(false);

/// Installs the handler for Ctrl-C. A command that has a [`Stop`] ends by itself; any other is ended at once, and so is
/// any command at the second Ctrl-C.
///
/// # Errors
/// Returns an error if the system refuses the handler.
pub(crate) fn handle() -> Result<()> {
    /// Exit status that shells give a program that Ctrl-C ended.
    const INTERRUPTED: i32 = 130;
    ctrlc::set_handler(|| {
        if IS_WANTED.swap(true, Ordering::Relaxed) || !IS_AWAITED.load(Ordering::Relaxed) {
            abandon();
            delete_copy();
            process::exit(INTERRUPTED);
        }
    })?;
    Ok(())
}

/// Tells a command that would run for ever when to stop.
pub(crate) struct Stop {
    start: Instant,
    after: Option<Duration>,
}

impl Stop {
    /// Arranges to stop on Ctrl-C, or after `seconds` if they are given. A second Ctrl-C ends the program at once.
    ///
    /// # Errors
    /// Returns an error unless `seconds` is above 0.
    pub(crate) fn new(seconds: Option<f64>) -> Result<Self> {
        let after = seconds.map(duration).transpose()?;
        IS_AWAITED.store(true, Ordering::Relaxed);
        Ok(Self { start: Instant::now(), after })
    }

    /// Returns whether it is time to stop.
    pub(crate) fn is_due(&self) -> bool {
        IS_WANTED.load(Ordering::Relaxed)
            || self.after.is_some_and(|after| self.start.elapsed() >= after)
    }

    /// Returns the time since the start as a tick, in µs.
    pub(crate) fn tick(&self) -> Tick {
        Tick::from_micros(self.start.elapsed().as_micros() as u64)
    }
}

fn duration(seconds: f64) -> Result<Duration> {
    let duration = Duration::try_from_secs_f64(seconds).ok().filter(|after| !after.is_zero());
    duration.with_context(|| format!("--seconds {seconds} must be above 0"))
}
