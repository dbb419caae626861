//! A line every few seconds while something runs, so that nobody takes it for hung.

use std::{
    sync::{Mutex, MutexGuard, PoisonError},
    thread,
    time::{Duration, Instant},
};

/// No silence is longer than this.
const EVERY: Duration = Duration::from_secs(15);

/// What runs now, each under a number of its own.
static RUNNING: Mutex<Vec<(Instant, String)>> = Mutex::new(Vec::new());

/// Something that runs, until this is dropped.
pub struct Running(Instant);

/// Says from now on that this runs.
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

/// Starts to print what runs, on standard error.
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

/// `  … 45 s: cargo build`, with the time of what has run longest.
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
