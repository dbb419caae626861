//! `--params FILE`: every command that takes a scheme reads it, and its options override it.

mod common;

use common::{file, flight, good, refused};

const HSA: &str = "scheme = \"hsa\"\nsample = \"q8.8\"\nfilter = [0.5, 1.0, 0.5]\nshift = -6\n";

#[test]
fn a_file_is_as_good_as_options() {
    let (_directory, params) = file("hsa.toml", HSA);
    let flight = flight("hexarotor.csv");
    let given = format!(
        "--scheme hsa --sample q8.8 --filter 0.5,1,0.5 --shift -6 --column gyro_x {flight}"
    );
    let read = format!("--params {params} --column gyro_x {flight}");
    for command in ["encode", "score --json"] {
        let (given, read) =
            (good(&format!("{command} {given}"), ""), good(&format!("{command} {read}"), ""));
        let without_filter = |text: &str| -> Vec<String> {
            text.lines().filter(|line| !line.starts_with("# filter=")).map(str::to_owned).collect()
        };
        assert_eq!(without_filter(&given.output), without_filter(&read.output), "{command}");
    }
    let drawn = |what: &str| {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.svg");
        good(&format!("plot {what} -o {}", path.display()), "");
        std::fs::read(path).unwrap()
    };
    assert!(drawn(&given) == drawn(&read));
}

#[test]
fn options_override_it() {
    let (_directory, params) = file("sf.toml", "scheme = \"sf\"\nthreshold = 0.5\n");
    let flight = flight("hexarotor.csv");
    let score = |options: &str| {
        let output = good(&format!("score --json --column gyro_x {options} {flight}"), "").output;
        let figures: serde_json::Value = serde_json::from_str(&output).unwrap();
        figures[0]["parameters"]["threshold"].as_f64().unwrap()
    };
    assert_eq!(score(&format!("--params {params}")), 0.5);
    assert_eq!(score(&format!("--params {params} --threshold 0.25")), 0.25);
}

#[test]
fn what_does_not_fit_is_refused() {
    let (_directory, params) = file("hsa.toml", HSA);
    let flight = flight("hexarotor.csv");
    refused(
        &format!("score --params {params} --scheme sf {flight}"),
        "",
        &["is of hsa", "says sf"],
    );
    refused("score --params nowhere.toml -", "", &["nowhere.toml: cannot be opened"]);
    refused(&format!("listen --params {params} --scheme sf -"), "", &["is of hsa", "says sf"]);
    refused(
        &format!("plot {flight} -o a.svg"),
        "",
        &["--scheme must say which, or --params, or --all"],
    );
    refused(&format!("encode {flight}"), "", &["--scheme must say which, or --params", "t-hsa"]);
    let (_directory, table) = file("table.toml", "scheme = 7");
    refused(&format!("score --params {table} -"), "", &[":1: scheme must be a text"]);
    let (_directory, table) = file("abc.toml", "scheme = \"sf\"\nthreshold = \"abc\"\n");
    let told = ["abc.toml:2: threshold = \"abc\": is not a number"];
    refused(&format!("encode --params {table} -"), "", &told);
}
