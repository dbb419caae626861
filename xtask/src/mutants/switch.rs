//! Part of the copy of the crate: tells which change is switched on.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};
use std::io::Write;

/// No change is switched on, and those that are reached are recorded.
const RECORD: u32 = u32::MAX - 1;

/// The environment has not been read yet.
const UNKNOWN: u32 = u32::MAX;

static CHOSEN: AtomicU32 = AtomicU32::new(UNKNOWN);

static REACHED: [AtomicBool; CHANGES] = [const { AtomicBool::new(false) }; CHANGES];

/// Returns whether this change is switched on. Constants are never changed.
#[inline]
pub(crate) const fn is(change: u32) -> bool {
    core::intrinsics::const_eval_select((change,), in_constants, while_running)
}

const fn in_constants(_: u32) -> bool {
    false
}

#[inline]
fn while_running(change: u32) -> bool {
    let chosen = CHOSEN.load(Relaxed);
    if chosen < RECORD { chosen == change } else { look(change) }
}

#[cold]
#[inline(never)]
fn look(change: u32) -> bool {
    if CHOSEN.load(Relaxed) == UNKNOWN {
        let chosen = std::env::var("MUTANTS_CHANGE").map_or(RECORD, |change| change.parse().unwrap());
        CHOSEN.store(chosen, Relaxed);
        return is(change);
    }
    let reached = &REACHED[change as usize];
    if !reached.load(Relaxed) && !reached.swap(true, Relaxed) {
        if let Ok(file) = std::env::var("MUTANTS_REACHED") {
            let mut file = std::fs::OpenOptions::new().append(true).open(file).unwrap();
            file.write_all(std::format!("{change}\n").as_bytes()).unwrap();
        }
    }
    false
}
