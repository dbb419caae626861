//! Clocks that wrap or restart: times continue beyond 32 bits, and codes start anew after a reboot.

mod common;

use common::{file, good, ran};
use flight_logs::made::Kind;
use std::fmt::Write;

/// Returns a CSV table with these times, in µs, and a sine wave.
fn table(times: impl Iterator<Item = i64>) -> String {
    let mut table = "time_us,x\n".to_owned();
    for (sample, time) in times.enumerate() {
        let value = (sample as f64 / 30.0).sin();
        writeln!(table, "{time},{value}").unwrap();
    }
    table
}

/// Runs `score` with the scheme `sf` (step forward) on the file at `path`. Returns the text on standard error, and the
/// number of spikes a second.
fn spikes_a_second(path: &str) -> (String, f64) {
    let ran = ran!("score --scheme sf --threshold 0.1 --json {path}");
    let rows: serde_json::Value = ran.json();
    (ran.stderr, rows[0]["spikes_per_second"].as_f64().unwrap())
}

#[test]
fn a_clock_of_32_bits_goes_on_behind_its_end() {
    let start = (1_i64 << 32) - 2_000_000;
    let straight = (0..1000).map(|sample| start + sample * 5000);
    let (_directory, wrapped) = file("x.csv", table(straight.clone().map(|time| time % (1 << 32))));
    let (_other, plain) = file("x.csv", table(straight));
    let (report, rate) = spikes_a_second(&wrapped);
    assert!(report.contains("runs over 1 times, first after sample 399"), "{report}");
    assert!(!report.contains("back in time") && !report.contains("anew"), "{report}");
    assert_eq!(rate, spikes_a_second(&plain).1);
    let encode = |path: &str| ran!("encode --scheme sf --threshold 0.1 --column x {path}").output;
    assert_eq!(encode(&wrapped), encode(&plain));
}

#[test]
fn a_reboot_starts_a_segment_of_its_own() {
    let flight = |samples: i64| (0..samples).map(|sample| 100_000 + sample * 5000);
    let (_directory, path) = file("x.csv", table(flight(1000).chain(flight(600))));
    let (report, rate) = spikes_a_second(&path);
    assert!(report.contains("the clock starts anew 1 times"), "{report}");
    assert!(!report.contains("back in time"), "{report}");
    // The rate refers to the duration of both flights, without the time between them.
    let seconds = 999.0 * 0.005 + 599.0 * 0.005;
    let spikes = (rate * seconds).round();
    assert!((rate * seconds - spikes).abs() < 1e-6 && spikes > 100.0, "{rate}");
}

/// If the clock restarts, the samples after the restart are encoded like a recording of their own.
#[test]
fn no_code_joins_two_segments() {
    let values = |offset: f64| (0..200).map(move |sample| offset + f64::from(sample).sin() * 0.05);
    let mut text = "time_us,x\n".to_owned();
    for (sample, value) in values(0.0).enumerate().chain(values(100.0).enumerate()) {
        writeln!(text, "{},{value}", sample * 5000).unwrap();
    }
    let (directory, path) = file("x.csv", text);
    let ran = ran!("score --scheme sf --threshold 0.1 --json {path}");
    let rows: serde_json::Value = ran.json();
    assert!(rows[0]["rmse"].as_f64().unwrap() < 0.2, "{}", ran.output);
    assert_eq!(rows[0]["slope"]["steps_above_threshold"], 0, "{}", ran.output);

    let picture = directory.path().join("x.svg");
    ran!("plot --scheme sf --threshold 0.1 {path} -o {}", picture.display());
    let svg = std::fs::read_to_string(picture).unwrap();
    let curves = |colour: &str| {
        svg.lines().filter(|line| line.contains("<polyline") && line.contains(colour)).count()
    };
    // Two segments, and the line in the legend.
    assert_eq!((curves("#1F5FA8"), curves("#E87D1E")), (3, 3));
    assert!(svg.contains("time, s, of 2 segments one after the other"));
    assert!(svg.contains("\n1.5\n") && !svg.contains("\n-0.5\n"), "2 s from 0 on");
}

/// A bag whose messages are stored in reverse order has the right duration and rate.
#[test]
fn an_unsorted_bag_has_a_length_and_a_rate() {
    let messages = (0..160).rev().map(|sample| Kind::Bag.record(sample));
    let chunk = Kind::Bag.chunk("none", &messages.collect::<Vec<_>>().concat());
    let bag = [Kind::Bag.start(), chunk, Kind::Bag.end()].concat();
    let (_directory, path) = file("x.bag", bag);
    let ran = ran!("info {path}").output;
    assert!(ran.contains("160 samples") && ran.contains("0.795 s, 200.00 Hz"), "{ran}");
    let score = format!("score --scheme sf --threshold 0.1 --topic /imu --field rate {path}");
    let report = good(&score, "").stderr;
    assert!(report.contains("159 steps back in time"), "{report}");
}
