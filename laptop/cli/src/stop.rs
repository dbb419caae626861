//! Handles Ctrl-C. A command that runs until it is stopped finishes normally and keeps its output; any other command is
//! ended at once, and its unfinished output file is removed.

use crate::inputs::delete_copy;
use anyhow::{Context, Result};
use lab::output::abandon;
use spikewire::Tick;
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

static IS_WANTED: AtomicBool = AtomicBool::new(false);
/// Whether the running command has a [`Stop`], and therefore ends by itself after Ctrl-C.
static IS_AWAITED: AtomicBool = AtomicBool::new(false);

/// Installs the handler for Ctrl-C. A command that has a [`Stop`] ends by itself; any other command is ended at once,
/// and so is every command at the second Ctrl-C.
///
/// # Errors
/// Returns an error if the operating system refuses the handler.
pub(crate) fn handle() -> Result<()> {
    /// Exit status that a shell reports for a program ended by Ctrl-C: 128 + SIGINT.
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

/// Condition that ends a command early: Ctrl-C or a time limit.
pub(crate) struct Stop {
    start: Instant,
    after: Option<Duration>,
}

impl Stop {
    /// Creates a condition for the end of a command. The command is due to end after Ctrl-C. If `seconds` is given, the
    /// command is also due to end after that time. A second Ctrl-C ends the program at once.
    ///
    /// # Errors
    /// Returns an error if `seconds` is not above 0.
    pub(crate) fn new(seconds: Option<f64>) -> Result<Self> {
        let after = seconds.map(duration).transpose()?;
        IS_AWAITED.store(true, Ordering::Relaxed);
        Ok(Self { start: Instant::now(), after })
    }

    /// Returns whether the command should end now.
    pub(crate) fn is_due(&self) -> bool {
        IS_WANTED.load(Ordering::Relaxed)
            || self.after.is_some_and(|after| self.start.elapsed() >= after)
    }

    /// Returns the time since this value was created, as a tick in µs.
    pub(crate) fn tick(&self) -> Tick {
        Tick::from_micros(self.start.elapsed().as_micros() as u64)
    }
}

fn duration(seconds: f64) -> Result<Duration> {
    let duration = Duration::try_from_secs_f64(seconds).ok().filter(|after| !after.is_zero());
    duration.with_context(|| format!("--seconds {seconds} must be above 0"))
}
