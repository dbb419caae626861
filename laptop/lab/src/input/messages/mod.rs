//! Reads flight logs: fields of a topic as channels, and a summary of each topic.
//!
//! The formats themselves are in the crate `flight-logs`.

mod channel;
mod choice;
mod overview;
mod stamp;

pub use channel::Channel;
pub use overview::{Overview, overview};

use flight_logs::Damage;

/// Returns how a log reader treats damage: it skips the damage if `accept_cut`; otherwise, it refuses the log.
pub fn damage(accept_cut: bool) -> Damage {
    if accept_cut { Damage::Skip } else { Damage::Refuse }
}
