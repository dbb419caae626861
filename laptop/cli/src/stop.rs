//! Ctrl-C: a command without an end of its own stops and keeps what it has so far; any other leaves no half-written file.

use anyhow::{Context, Result};
use lab::output::abandon;
use spikewire::Tick;
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

static IS_WANTED: AtomicBool = AtomicBool::new(false);
/// Whether the command ends by itself once Ctrl-C was pressed.
static IS_AWAITED: AtomicBool = AtomicBool::new(false);

/// Handles Ctrl-C: a command that has a [`Stop`] ends by itself; any other, and any at the second Ctrl-C, is ended at once.
///
/// # Errors
/// The system refuses.
pub(crate) fn handle() -> Result<()> {
    /// The exit status that shells give a program that Ctrl-C ended.
    const INTERRUPTED: i32 = 130;
    ctrlc::set_handler(|| {
        if IS_WANTED.swap(true, Ordering::Relaxed) || !IS_AWAITED.load(Ordering::Relaxed) {
            abandon();
            process::exit(INTERRUPTED);
        }
    })?;
    Ok(())
}

/// Tells a command that goes on for ever when to stop.
pub(crate) struct Stop {
    start: Instant,
    after: Option<Duration>,
}

impl Stop {
    /// Stops on Ctrl-C, or after this many seconds if they are given; a second Ctrl-C ends the program at once.
    ///
    /// # Errors
    /// The number is not above 0.
    pub(crate) fn new(seconds: Option<f64>) -> Result<Self> {
        let after = seconds.map(duration).transpose()?;
        IS_AWAITED.store(true, Ordering::Relaxed);
        Ok(Self { start: Instant::now(), after })
    }

    /// Whether it is time to stop.
    pub(crate) fn is_due(&self) -> bool {
        IS_WANTED.load(Ordering::Relaxed)
            || self.after.is_some_and(|after| self.start.elapsed() >= after)
    }

    /// The time since the start, in µs as ticks have it.
    pub(crate) fn tick(&self) -> Tick {
        Tick::from_micros(self.start.elapsed().as_micros() as u64)
    }
}

fn duration(seconds: f64) -> Result<Duration> {
    let duration = Duration::try_from_secs_f64(seconds).ok().filter(|after| !after.is_zero());
    duration.with_context(|| format!("--seconds {seconds} must be above 0"))
}
