//! On the host two threads stand in for the interrupts.

use crate::source::strike;
use std::{
    sync::{
        Mutex,
        atomic::{AtomicBool, Ordering::SeqCst},
    },
    thread::{self, JoinHandle},
};

/// One may strike within the other's burst, or not.
pub const NESTS: bool = false;

static STORMS: AtomicBool = AtomicBool::new(false);
static THREADS: Mutex<Vec<JoinHandle<()>>> = Mutex::new(Vec::new());

pub fn start(both: bool) {
    STORMS.store(true, SeqCst);
    let sources = if both { 0..2 } else { 0..1 };
    THREADS.lock().unwrap().extend(sources.map(|source| {
        thread::spawn(move || {
            while STORMS.load(SeqCst) {
                strike(source, 3);
                thread::yield_now();
            }
        })
    }));
}

pub fn stop() {
    STORMS.store(false, SeqCst);
    THREADS.lock().unwrap().drain(..).for_each(|thread| thread.join().unwrap());
}
