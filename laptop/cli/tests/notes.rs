//! The program reports the settings that ran, and warns if they do not suit the signal.

mod common;

use common::{events, file, flight, good, ran, refused, table};

#[test]
fn a_rate_code_that_reaches_the_signal_has_no_note() {
    let (_directory, signal) = file("signal.csv", good("signal --seconds 5", "").output);
    let reached = ran!("score --scheme hsa --paper {signal}").stderr;
    assert!(!reached.contains("too low") && !reached.contains("most that"), "{reached}");
}

#[test]
fn scores_say_what_they_ran_with() {
    let figures = ran!("score --column gyro_x --json {}", flight("hexarotor.csv")).schemes();
    for scheme in &figures {
        assert!(scheme["parameters"].as_object().unwrap().len() >= 2, "{scheme}");
        assert_eq!(scheme["scheme"] == "sf", scheme["slope"].is_object(), "{scheme}");
    }
    let hsa = figures.iter().find(|scheme| scheme["scheme"] == "hsa").unwrap();
    assert_eq!(hsa["parameters"]["taps"].as_array().unwrap().len(), 15);
}

/// A column that `f32` cannot represent is reported. Examples are integers of more than 24 bits, and a small wave on a
/// large offset.
#[test]
fn columns_that_a_sample_type_cannot_hold_are_reported() {
    let latitude: Vec<f64> =
        (0..500).map(|sample| f64::from(473_977_419 + sample * sample % 97)).collect();
    let encode = |sample: &str, values: &[f64]| {
        let (_directory, path) = file("x.csv", table(values));
        let options = format!("--scheme sf --threshold 20 --sample {sample} {path}");
        (ran!("encode {options}"), ran!("score {options}").stderr)
    };
    let ((single, scored), (whole, _)) = (encode("f32", &latitude), encode("i32", &latitude));
    for report in [&single.stderr, &scored] {
        assert!(report.contains("f32 loses the column's own steps: "), "{report}");
        assert!(report.contains("; i32 holds them"), "{report}");
    }
    assert!(!whole.stderr.contains("loses"), "{}", whole.stderr);
    assert_ne!(events(&single.output), events(&whole.output));
    let far: Vec<f64> = (0..2000).map(|sample| 1e9 + (f64::from(sample) * 0.01).sin()).collect();
    let (_directory, path) = file("far.csv", table(&far));
    let words = ["f32 loses", "once 1000000000 is taken from every value", "never leaves"];
    refused(&format!("score --scheme sf {path}"), "", &words);
    refused(&format!("encode --scheme sf --paper {path}"), "", &words);
}
