//! `--params FILE` is accepted by every command that takes a scheme, and options on the command line override it.

mod common;

use common::{file, flight, ran};

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
        let (given, read) = (ran!("{command} {given}"), ran!("{command} {read}"));
        let without_filter = |text: &str| -> Vec<String> {
            text.lines().filter(|line| !line.starts_with("# filter=")).map(str::to_owned).collect()
        };
        assert_eq!(without_filter(&given.output), without_filter(&read.output), "{command}");
    }
    let drawn = |what: &str| {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.svg");
        ran!("plot {what} -o {}", path.display());
        std::fs::read(path).unwrap()
    };
    assert!(drawn(&given) == drawn(&read));
}

#[test]
fn options_override_it() {
    let (_directory, params) = file("sf.toml", "scheme = \"sf\"\nthreshold = 0.5\n");
    let flight = flight("hexarotor.csv");
    let score = |options: &str| {
        let figures = ran!("score --json --column gyro_x {options} {flight}").schemes();
        figures[0]["parameters"]["threshold"].as_f64().unwrap()
    };
    assert_eq!(score(&format!("--params {params}")), 0.5);
    assert_eq!(score(&format!("--params {params} --threshold 0.25")), 0.25);
}
