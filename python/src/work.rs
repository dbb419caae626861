//! Work without the interpreter's lock, which Ctrl-C ends and whose progress is told.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;

/// What work tells of itself, and is told.
#[derive(Default)]
pub(crate) struct Meter {
    is_stopped: AtomicBool,
    done: AtomicUsize,
}

impl Meter {
    /// Whether the work should end.
    pub(crate) fn is_stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }

    /// Sets what is done.
    pub(crate) fn set(&self, done: usize) {
        self.done.store(done, Ordering::Relaxed);
    }

    /// Adds to what is done.
    pub(crate) fn add(&self, done: usize) {
        self.done.fetch_add(done, Ordering::Relaxed);
    }
}

/// How often Ctrl-C is looked for and progress is told.
const PERIOD: Duration = Duration::from_millis(100);

/// So much is over before anybody could press a key.
const SHORT: usize = 1 << 18;

/// Works until the job is done, or Ctrl-C is pressed. `progress` is called with what is done of the total.
///
/// # Errors
/// Those of Ctrl-C and of `progress`.
pub(crate) fn run<T: Send>(
    py: Python,
    total: usize,
    progress: Option<&Py<PyAny>>,
    job: impl FnOnce(&Meter) -> T + Send,
) -> PyResult<T> {
    let meter = Meter::default();
    if total < SHORT {
        return Ok(py.detach(|| job(&meter)));
    }
    let meter = &meter;
    py.detach(|| {
        let (sender, receiver) = channel();
        thread::scope(|scope| {
            scope.spawn(move || sender.send(job(meter)));
            let mut failed = None;
            loop {
                match receiver.recv_timeout(PERIOD) {
                    Ok(result) => {
                        return match failed {
                            Some(error) => Err(error),
                            None => tell(progress, total, total).map(|()| result),
                        };
                    }
                    Err(RecvTimeoutError::Timeout) if failed.is_none() => {
                        failed = tell(progress, meter.done.load(Ordering::Relaxed), total).err();
                        meter.is_stopped.store(failed.is_some(), Ordering::Relaxed);
                    }
                    Err(RecvTimeoutError::Timeout) => {}
                    // It panicked, and the scope hands that on.
                    Err(RecvTimeoutError::Disconnected) => std::panic::resume_unwind(Box::new(())),
                }
            }
        })
    })
}

fn tell(progress: Option<&Py<PyAny>>, done: usize, total: usize) -> PyResult<()> {
    Python::attach(|py| {
        py.check_signals()?;
        progress.map_or(Ok(()), |call| call.call1(py, (done, total)).map(drop))
    })
}
