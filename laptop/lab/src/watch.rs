//! Progress reports of long work, and requests to end the work.

/// Callbacks through which a caller follows long work, and can end it.
pub struct Watch<'a> {
    /// Function that is called from time to time. If it returns true, the work ends with the best result so far.
    pub is_stopped: &'a (dyn Fn() -> bool + Sync),
    /// Function that receives the progress from time to time. It may be called from any thread.
    pub tell: &'a (dyn Fn(&Progress) + Sync),
}

impl Watch<'_> {
    /// A watch that ignores the progress and never stops the work.
    pub const NONE: Watch<'static> = Watch { is_stopped: &|| false, tell: &|_| () };
}

/// A report on how much of a long task is done.
#[derive(Clone, Debug, Default)]
pub struct Progress {
    /// Number of units of work done, such as settings tried.
    pub done: usize,
    /// Number of units of work in all.
    pub total: usize,
    /// Description of the present work, in a sentence.
    pub words: String,
}
