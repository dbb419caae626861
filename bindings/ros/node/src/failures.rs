//! Failures that DDS tells to the log alone.

use log::{Level, LevelFilter, Log, Metadata, Record};
use std::sync::Mutex;

/// What its threads log before they end. `rustdds` 0.15 does not go on after an interrupted wait, as a debugger causes.
///
/// Version 0.15.1 has no typed sign of it: both threads just return (`rtps/dp_event_loop.rs`, `discovery/discovery.rs`), their
/// handles are private, `DomainParticipantStatusEvent` has no variant for it, and `assert_liveliness` gives `WouldBlock` for
/// an ended thread as for a full channel.
const ENDED: [&str; 2] = ["dp_event_loop poll failed", "Failed in waiting of poll"];

static FAILURES: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Collects the errors that other crates log.
pub(crate) fn collect() {
    static LOGGER: Logger = Logger;
    // Nobody else sets one.
    if log::set_logger(&LOGGER).is_ok() {
        log::set_max_level(LevelFilter::Error);
    }
}

/// Returns the failures since the last call.
pub(crate) fn take() -> Vec<String> {
    FAILURES.lock().map(|mut failures| std::mem::take(&mut *failures)).unwrap_or_default()
}

/// Returns whether DDS has stopped with this failure: nothing more comes or goes.
pub(crate) fn is_end(failure: &str) -> bool {
    ENDED.iter().any(|end| failure.contains(end))
}

struct Logger;

impl Log for Logger {
    fn enabled(&self, metadata: &Metadata) -> bool {
        metadata.level() <= Level::Error
    }

    fn log(&self, record: &Record) {
        if self.enabled(record.metadata())
            && let Ok(mut failures) = FAILURES.lock()
        {
            failures.push(record.args().to_string());
        }
    }

    fn flush(&self) {}
}
