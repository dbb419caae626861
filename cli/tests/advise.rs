//! `advise`: what a log is like, and which scheme suits it, or why nothing does.

mod common;

use common::{file, flight, good, spikewire, table};
use serde_json::Value;

/// A budget that a test build gets through in a few seconds.
const SHORT: &str = "--seconds 60 --evaluations 60";

#[test]
fn a_scheme_within_the_error_is_advised_with_its_figures() {
    let (_directory, log) = file("signal.csv", good("signal --seconds 6", "").output);
    let arguments = format!("advise {log} --channel signal --max-rmse 0.4 {SHORT}");
    let told: Value =
        serde_json::from_str(&good(&format!("{arguments} --json"), "").output).unwrap();
    let advice = &told[0];
    assert_eq!(advice["look"]["verdict"], "good");
    assert!((advice["look"]["rate"].as_f64().unwrap() - 100.0).abs() < 0.1);
    let reaching = advice["reaching"].as_array().unwrap();
    let bytes: Vec<f64> =
        reaching.iter().map(|one| one["link_bytes_per_second"].as_f64().unwrap()).collect();
    assert!(bytes.is_sorted() && bytes[0] < 400.0, "{bytes:?}");
    for one in reaching {
        assert!(one["tuned_on"]["rmse"].as_f64().unwrap() <= 0.4, "{one:#}");
        assert!(one["held_out"]["rmse"].as_f64().unwrap() <= 0.5, "{one:#}");
    }
    let directory = tempfile::tempdir().unwrap();
    let picture = directory.path().join("signal.svg");
    let page = good(&format!("{arguments} --picture {}", picture.display()), "").output;
    for words in
        ["signal\n", "noise floor", "at rest", "take ", "bytes a second on the link", "latency"]
    {
        assert!(page.contains(words), "{words}: {page}");
    }
    assert!(std::fs::read_to_string(picture).unwrap().starts_with("<svg "));
}

/// A verdict, and no scheme.
#[test]
fn a_log_on_the_ground_or_too_short_has_a_verdict() {
    let rest = spikewire(&format!("advise {} {SHORT}", flight("vtol_at_rest.csv")), "");
    assert_eq!(rest.status, 2);
    assert!(
        rest.told.contains("nothing can be advised") && !rest.output.contains("take "),
        "{}",
        rest.output
    );
    assert_eq!(rest.output.matches("all on the ground").count(), 6, "{}", rest.output);
    for (values, words) in [
        (vec![1.0, 2.0, 4.0, 3.0, 5.0, 4.0, 6.0, 2.0, 1.0, 0.0], "10 samples are too few"),
        (vec![7.0; 500], "never leaves 7"),
    ] {
        let (_directory, path) = file("log.csv", table(&values));
        let ran = spikewire(&format!("advise --rate 100 {path}"), "");
        assert_eq!(ran.status, 2);
        assert!(ran.output.contains(words) && !ran.output.contains("take "), "{}", ran.output);
    }
}
