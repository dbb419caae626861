//! A smaller run of the paper's benchmark: it agrees with the paper, and it is the run of yesterday.

mod common;

use common::good;
use serde_json::Value;

fn bench() -> Value {
    serde_json::from_str(&good("bench --tests 40 --cases 3 --seed 7 --json", "").output).unwrap()
}

#[test]
fn a_smaller_run_agrees_with_the_paper() {
    let told = bench();
    assert_eq!(told["cells"], 36);
    assert_eq!(told["means_within_sampling_error"], 36, "{told:#}");
    // All but the one that the paper misprints.
    assert_eq!(told["deviations_within_15_percent"], 35, "{told:#}");
}

#[test]
fn the_last_line_says_how_many_means_agree() {
    let told = good("bench --tests 40 --cases 2 --seed 7", "").output;
    assert_eq!(told.lines().last(), Some("24 of 24 means within sampling error"));
}
