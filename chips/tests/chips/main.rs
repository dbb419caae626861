//! The drivers against the chips' models, as one program: what its files share is compiled and linked once.

#![expect(clippy::indexing_slicing, clippy::unwrap_used, reason = "a test may panic")]

mod bus;

mod akd1500;
mod faults;
mod handshake;
mod models;
mod network;
mod reckon;
mod reckon_pairs;
mod reckon_pins;
mod search;
mod steps;
mod words;
mod xylo;

use flight_data::Record;
use proptest::test_runner::{Config, FileFailurePersistence};

/// Settings of a property test: this many cases, times `CASES_TIMES`. They are drawn from the seed that `.cargo/config.toml`
/// fixes, after those that failed before, whose seeds are in `<test>.proptest-regressions`.
fn cases(count: u32) -> Config {
    let times = std::env::var("CASES_TIMES").map_or(1, |times| times.parse().unwrap());
    let failed = FileFailurePersistence::WithSource("proptest-regressions");
    Config {
        cases: count.saturating_mul(times),
        max_global_rejects: 1024_u32.saturating_mul(times),
        failure_persistence: Some(Box::new(failed)),
        ..Config::default()
    }
}

/// A recorded flight of a hexarotor.
fn flight() -> impl Iterator<Item = Record> {
    flight_data::records(flight_data::HEXAROTOR)
}
