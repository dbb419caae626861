//! Tests of the chip drivers against models of the chips. They are one program, so that shared code is compiled and
//! linked once.

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
mod reckon_steps;
mod search;
mod steps;
mod words;
mod xylo;

use flight_data::Record;
use proptest::test_runner::{Config, FileFailurePersistence};

/// Configures a property test to try `count` cases, multiplied by the environment variable `CASES_TIMES`. Cases that
/// failed before, whose seeds are in `<test>.proptest-regressions`, come first; the others are drawn from the seed in
/// `.cargo/config.toml`.
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

/// Returns the samples of a recorded flight of a hexarotor.
fn flight() -> impl Iterator<Item = Record> {
    flight_data::records(flight_data::HEXAROTOR)
}
