//! Frames against their reference, and the formats against golden bytes and other programs, as one program.

#![expect(
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test may panic"
)]

mod bytes;
mod frames;
mod peers;
mod pixels;
mod reference;

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
