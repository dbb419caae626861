//! Flight logs as recordings: fields of a topic as channels, and an overview of a log.
//!
//! The formats themselves are the crate `flight-logs`.

mod channel;
mod overview;

pub use channel::Channel;
pub use overview::{Overview, overview};

use anyhow::anyhow;
use flight_logs::{Damage, Error, Rest};

/// Returns what is done about damage.
pub fn damage(accept_cut: bool) -> Damage {
    if accept_cut { Damage::Skip } else { Damage::Refuse }
}

/// Adds to a log's error which setting would read more of it.
pub fn advised(error: Error) -> anyhow::Error {
    match error.kind.rest() {
        None => error.into(),
        Some(Rest::Behind) => anyhow!("{error}; `accept_cut` goes on behind it"),
        Some(Rest::From(next)) => anyhow!("{error}; `accept_cut` goes on at byte {next}"),
        Some(Rest::Before) => anyhow!("{error}; `accept_cut` takes what is before"),
    }
}
