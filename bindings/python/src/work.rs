//! Work without the interpreter's lock, which Ctrl-C ends and whose progress is told.

use std::mem;
use std::process;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

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
const SHORT: usize = 1 << 19;

/// The threads of a process.
struct Pool {
    process: u32,
    threads: Arc<ThreadPool>,
}

/// Returns the threads of this process. A fork copies a pool without its threads, on which the child would wait for
/// ever; so a child makes its own at its first call.
///
/// # Errors
/// The system has no more threads.
fn pool(_: Python) -> PyResult<Arc<ThreadPool>> {
    /// Locked by who holds the interpreter's lock, and so by nobody while Python forks.
    static POOL: Mutex<Option<Pool>> = Mutex::new(None);
    let mut known = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let own = process::id();
    if let Some(pool) = known.as_ref().filter(|pool| pool.process == own) {
        return Ok(Arc::clone(&pool.threads));
    }
    let threads = ThreadPoolBuilder::new().thread_name(|number| format!("spikewire {number}"));
    let threads = threads.build().map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
    let threads = Arc::new(threads);
    // The parent's threads are not here to be ended.
    mem::forget(known.replace(Pool { process: own, threads: Arc::clone(&threads) }));
    Ok(threads)
}

/// Returns the number of threads that share work on so many channels of so many numbers in all. One works without the
/// pool, whose single thread would be on another core than the caller, with nothing in its cache.
///
/// # Errors
/// The system has no more threads.
pub(crate) fn threads(py: Python, channels: usize, numbers: usize) -> PyResult<usize> {
    /// About what one thread does while another wakes up.
    const FEW: usize = 1 << 13;
    if channels > 1 && numbers > FEW { Ok(pool(py)?.current_num_threads()) } else { Ok(1) }
}

/// Works without the interpreter's lock: on all threads of the process if `is_wide`, where alone rayon may be used.
///
/// # Errors
/// The system has no more threads.
pub(crate) fn detached<T: Send>(
    py: Python,
    is_wide: bool,
    job: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    if !is_wide {
        return Ok(py.detach(job));
    }
    let pool = pool(py)?;
    Ok(py.detach(|| pool.install(job)))
}

/// Works until the job is done, or Ctrl-C is pressed. `progress` is called with what is done of the total. The job runs
/// as that of [`detached`] does.
///
/// # Errors
/// Those of Ctrl-C and of `progress`.
pub(crate) fn run<T: Send>(
    py: Python,
    is_wide: bool,
    total: usize,
    progress: Option<&Py<PyAny>>,
    job: impl FnOnce(&Meter) -> T + Send,
) -> PyResult<T> {
    let meter = Meter::default();
    if total < SHORT {
        return detached(py, is_wide, || job(&meter));
    }
    let meter = &meter;
    let pool = if is_wide { Some(pool(py)?) } else { None };
    let job = || match &pool {
        Some(pool) => pool.install(|| job(meter)),
        None => job(meter),
    };
    py.detach(|| {
        let (sender, receiver) = channel();
        thread::scope(|scope| {
            scope.spawn(move || sender.send(job()));
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
