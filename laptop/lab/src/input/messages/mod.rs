//! Reads flight logs: fields of a topic as channels, and an overview of a log.
//!
//! The formats themselves are in the crate `flight-logs`.

mod channel;
mod overview;

pub use channel::Channel;
pub use overview::{Overview, overview};

use flight_logs::Damage;

/// Returns how the log reader should treat damage.
pub fn damage(accept_cut: bool) -> Damage {
    if accept_cut { Damage::Skip } else { Damage::Refuse }
}
