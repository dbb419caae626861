//! Prints a line every few seconds while something runs, so that it does not seem to hang.

use std::{
    sync::{Mutex, MutexGuard, PoisonError},
    thread,
    time::{Duration, Instant},
};

/// Longest time without output.
const EVERY: Duration = Duration::from_secs(15);

/// The tasks that run now, each with its start.
static RUNNING: Mutex<Vec<(Instant, String)>> = Mutex::new(Vec::new());

/// A task that runs until this is dropped.
pub struct Running(Instant);

/// Registers a task as running.
pub fn running(what: String) -> Running {
    let mut all = all();
    // Two that begin in the same instant would end as one.
    let mut start = Instant::now();
    while all.iter().any(|(other, _)| *other == start) {
        start += Duration::from_nanos(1);
    }
    all.push((start, what));
    Running(start)
}

impl Drop for Running {
    fn drop(&mut self) {
        all().retain(|(start, _)| *start != self.0);
    }
}

/// Starts to print running tasks on standard error.
pub fn watch() {
    thread::spawn(|| {
        loop {
            thread::sleep(EVERY);
            let line = line(&all());
            if let Some(line) = line {
                eprintln!("{line}");
            }
        }
    });
}

/// Formats `  … 45 s: cargo build`, with the time of the task that has run longest.
fn line(all: &[(Instant, String)]) -> Option<String> {
    let longest = all.iter().map(|(start, _)| start.elapsed()).max()?;
    let names: Vec<&str> = all.iter().map(|(_, what)| what.as_str()).collect();
    Some(format!("  … {} s: {}", longest.as_secs(), names.join(", ")))
}

fn all() -> MutexGuard<'static, Vec<(Instant, String)>> {
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_ended_is_not_shown() {
        let one = running("one".into());
        let two = running("two".into());
        assert_eq!(line(&all()).unwrap(), "  … 0 s: one, two");
        drop(one);
        assert_eq!(line(&all()).unwrap(), "  … 0 s: two");
        drop(two);
        assert_eq!(line(&all()), None);
    }
}
