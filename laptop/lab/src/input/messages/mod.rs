//! Flight logs as recordings: fields of a topic as channels, and an overview of a log.
//!
//! The formats themselves are the crate `flight-logs`.

mod channel;
mod overview;

pub use channel::Channel;
pub use overview::{Overview, overview};

use flight_logs::Damage;

/// Returns what is done about damage.
pub fn damage(accept_cut: bool) -> Damage {
    if accept_cut { Damage::Skip } else { Damage::Refuse }
}
