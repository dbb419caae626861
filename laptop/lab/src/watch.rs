//! Long work as seen from outside: how far it is, and whether it should end.

/// Watches long work and can end it.
pub struct Watch<'a> {
    /// Asked now and then; when it says true, the work ends with the best so far.
    pub is_stopped: &'a (dyn Fn() -> bool + Sync),
    /// Called now and then with how far the work is, from any thread.
    pub tell: &'a (dyn Fn(&Progress) + Sync),
}

impl Watch<'_> {
    /// Nobody watches, and the work runs to its end.
    pub const NONE: Watch<'static> = Watch { is_stopped: &|| false, tell: &|_| () };
}

/// The progress of long work.
#[derive(Clone, Debug, Default)]
pub struct Progress {
    /// Units of work done, such as settings tried.
    pub done: usize,
    /// Units of work in all.
    pub total: usize,
    /// A sentence on what is being done.
    pub words: String,
}
