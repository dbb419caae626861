//! `bench` with fewer signals agrees with the tables of Dupeyroux et al. (2022), and with figures recorded from earlier
//! versions.

#![expect(clippy::unreadable_literal, reason = "figures as they are printed")]

mod common;

use common::{good, spikewire};
use serde_json::Value;

fn bench() -> Value {
    good("bench --tests 40 --cases 3 --seed 7 --json", "").json()
}

#[test]
fn a_smaller_run_agrees_with_the_paper() {
    let report = bench();
    assert_eq!(report["cells"], 36);
    assert_eq!(report["means_within_sampling_error"], 36, "{report:#}");
    // One deviation is misprinted in the paper.
    assert_eq!(report["deviations_within_15_percent"], 35, "{report:#}");
}

#[test]
fn the_last_line_says_how_many_means_agree() {
    let report = good("bench --tests 40 --cases 2 --seed 7", "").output;
    assert_eq!(report.lines().last(), Some("24 of 24 means within sampling error"));
}

/// Mean efficiencies and RMSEs that an earlier version of `bench` printed. Each item has the name of the table, the
/// length of the signals in seconds, and one mean for each of [`SCHEMES`]. A single
/// spike that moves changes a mean. `bench` compares its means with the paper's only within the error of sampling, which
/// hides such a change.
#[rustfmt::skip]
const BEFORE: [(&str, u64, [f64; 8]); 6] = [
    ("efficiency", 1, [37.900000, 29.975000, 75.100000, 45.800000, 73.675000, 62.275000, 0.000000, -223.700000]),
    ("efficiency", 5, [37.295000, 27.395000, 73.590000, 33.305000, 64.585000, 57.670000, 0.000000, -226.140000]),
    ("efficiency", 15, [36.456667, 27.066667, 73.315000, 30.100000, 62.181667, 55.905000, 0.000000, -226.303333]),
    ("rmse", 1, [0.886593, 0.699708, 0.260421, 0.833547, 0.962812, 0.677383, 0.088757, 0.015994]),
    ("rmse", 5, [1.395748, 0.941815, 0.262261, 0.639244, 0.608439, 0.391191, 0.105719, 0.019024]),
    ("rmse", 15, [2.184575, 1.589317, 0.262425, 0.598191, 0.510962, 0.301882, 0.108452, 0.019358]),
];

const SCHEMES: [&str; 8] = ["TBR", "MW", "SF", "BSA", "HSA", "T-HSA", "GRF", "GRF, slots"];

#[test]
fn every_spike_is_where_it_was() {
    let report = bench();
    for (table, seconds, means) in BEFORE {
        let cases = report[table].as_array().unwrap();
        let case = cases.iter().find(|case| case["seconds"] == seconds).unwrap();
        for (scheme, mean) in SCHEMES.iter().zip(means) {
            let ours = case["schemes"][scheme]["ours"]["mean"].as_f64().unwrap();
            assert!(
                (ours - mean).abs() < 2e-6,
                "{table} at {seconds} s, {scheme}: {ours}, before {mean}"
            );
        }
    }
}

/// `bench` fails if its mean values differ too much from the paper's. With only two signals in each case, some seeds
/// give such means.
#[test]
fn a_benchmark_that_differs_is_an_error() {
    let differing = (1..200).find_map(|seed| {
        let ran = spikewire(&format!("bench --tests 2 --cases 1 --seed {seed}"), "");
        (ran.status != 0).then_some(ran)
    });
    let ran = differing.unwrap();
    assert_eq!(ran.status, 2);
    assert!(ran.stderr.contains("error: not as in the paper: "), "{}", ran.stderr);
    assert!(ran.output.contains(" !"), "{}", ran.output);
    let good = good("bench --tests 40 --cases 1 --seed 7", "").output;
    assert!(good.contains("\nWith 40 signals a case, a mean may be off by "), "{good}");
}
