//! `info`, `score`, `tune` and `advise` with many logs: directories, patterns, lists and data sets; and the shape of
//! the reports of `--json`.

mod common;

use common::{flight, good, most_memory, ran, refused, spikewire, table};
use flight_logs::made::Kind;
use serde_json::Value;
use std::fs;
use std::io::{BufWriter, Write};
use std::path::Path;

const SF: &str = "--scheme sf --threshold 0.1";
const CHANNELS: &str = "--channels-of table=x --channels-of mcap=imu.rate";

/// Writes three tables, a log of another kind, and a table that cannot be read.
fn logs(directory: &Path) {
    fs::create_dir(directory).unwrap();
    for log in 1..4 {
        let wave = (0..400).map(|sample| (f64::from(sample * log) * 0.03).sin());
        fs::write(directory.join(format!("{log}.csv")), table(&wave.collect::<Vec<_>>())).unwrap();
    }
    fs::write(directory.join("log.mcap"), Kind::Mcap.of(0..400)).unwrap();
    fs::write(directory.join("names.csv"), "x\none\n").unwrap();
}

/// Returns the names of the logs in a report, without their directories.
fn names(report: &Value) -> Vec<String> {
    let logs = report["logs"].as_array().unwrap().iter();
    logs.map(|own| own["log"].as_str().unwrap().rsplit('/').next().unwrap().to_owned()).collect()
}

#[test]
fn a_score_of_many_logs_has_a_row_each_and_a_sum() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name).display().to_string();
    logs(&directory.path().join("logs"));
    let all = at("logs");
    let scored = spikewire(&format!("score {SF} {CHANNELS} {all} --json"), "");
    assert_eq!(scored.status, 2);
    assert!(scored.stderr.contains("1 of 5 logs cannot be processed"), "{}", scored.stderr);
    let report = scored.json();
    assert_eq!(names(&report), ["1.csv", "2.csv", "3.csv", "log.mcap", "names.csv"]);
    assert!(report["logs"][4]["refused"].as_str().unwrap().contains("value `one`"));
    let (mut spikes, mut squares, mut samples) = (0, 0.0, 0.0);
    for own in &report["logs"].as_array().unwrap()[..4] {
        let channel = own["channel"].as_str().unwrap();
        let log = own["log"].as_str().unwrap();
        let name = if log.ends_with("mcap") { "imu.rate" } else { channel };
        let alone = ran!("score {SF} --columns {name} {log} --json").log();
        assert_eq!(&alone, own);
        let figures = &own["schemes"][0];
        let rmse = figures["rmse"].as_f64().unwrap();
        spikes += figures["spikes"].as_u64().unwrap();
        squares += rmse * rmse * figures["samples"].as_f64().unwrap();
        samples += figures["samples"].as_f64().unwrap();
    }
    let total = &report["summary"]["schemes"][0];
    assert_eq!((&report["summary"]["logs"], &report["summary"]["refused"]), (&5.into(), &1.into()));
    assert_eq!((&total["logs"], &total["spikes"]), (&4.into(), &spikes.into()));
    assert!((total["rmse"].as_f64().unwrap() - (squares / samples).sqrt()).abs() < 1e-12);
    assert!(total["worst_rmse"].as_f64() >= total["rmse"].as_f64());

    // In the table as well, whether the logs are given by a pattern or by a list.
    fs::write(directory.path().join("list"), format!("{all}/1.csv\n\n{all}/[23].csv\n")).unwrap();
    let listed = ran!("score {SF} --list {}", at("list")).output;
    assert_eq!(listed, ran!("score {SF} {all}/?.csv").output);
    let rows: Vec<&str> = listed.lines().collect();
    assert!(rows[0].starts_with("| log ") && rows[4].contains("/3.csv"), "{listed}");
    assert!(rows[5].starts_with("| all 3 logs ") && rows[5].contains("worst RMSE"), "{listed}");
    assert_eq!(rows.len(), 6);
}

#[test]
fn each_command_takes_a_side_of_a_data_set() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name).display().to_string();
    logs(&directory.path().join("logs"));
    ran!("dataset {SF} --rate 200 --test 0.34 {}/?.csv -o {}", at("logs"), at("set"));
    for command in [
        format!("score {SF} --rate 200"),
        "info".to_owned(),
        "tune --scheme sf --min-efficiency 50 --evaluations 20 --anyway --rate 200".to_owned(),
        "advise --max-rmse 0.4 --evaluations 10 --rate 200".to_owned(),
    ] {
        let [train, test, all] = ["train", "test", "all"].map(|split| {
            let asked = if command.starts_with("advise") { "set/manifest.jsonl" } else { "set" };
            let ran = spikewire(&format!("{command} --split {split} {} --json", at(asked)), "");
            names(&ran.json())
        });
        assert_eq!((train.len(), test.len(), all.len()), (2, 1, 3), "{command}");
        assert!(test.iter().all(|own| all.contains(own) && !train.contains(own)), "{command}");
    }
}

/// A log that is read in pieces has the scores and the picture that it has in memory, with every code, also where its
/// clock starts anew.
#[test]
fn scores_and_pictures_in_pieces_are_those_of_the_whole() {
    let text = fs::read_to_string(flight("hexarotor.csv")).unwrap();
    let (header, rows) = text.split_once('\n').unwrap();
    let rows: Vec<&str> = rows.lines().collect();
    let row = |sample: usize, time: usize| {
        let (_, values) = rows[sample % rows.len()].split_once(',').unwrap();
        let values = if sample % 997 == 5 { "NA,NA,NA,NA,NA,NA" } else { values };
        format!("{time},{values}\n")
    };
    // Flights of 8192 samples, which are read at once, and of 2500, 7 and 12 000. Some samples are missing.
    let flights = [8192, 2500, 7, 12_000].into_iter();
    let flights = flights.flat_map(|samples| (0..samples).map(|own| row(own, own * 5000)));
    // A flight whose rate changes at sample 8192, and whose samples are out of order from sample 9000 on.
    let one = (0..12_000_usize).map(|sample| {
        let place = if sample < 9000 { sample } else { sample + 100 - sample % 100 * 2 };
        row(sample, if sample < 8192 { place * 5000 } else { 8192 * 5000 + (place - 8192) * 1000 })
    });
    for flights in [flights.collect::<String>(), one.collect()] {
        let text = format!("{header}\n{flights}");
        let (directory, path) = common::file("flights.csv", &text);
        for options in ["", "--scheme mw --threshold 0.1 --window 99", "--sample q8.8"] {
            let asked = format!("score {options} --column gyro_x --skip-non-finite --json");
            let read = good(&format!("{asked} {path}"), "");
            for pipe in ["-", "/dev/stdin"] {
                let held = good(&format!("{asked} {pipe}"), &text);
                assert_eq!(read.schemes(), held.schemes(), "{options}");
                assert_eq!(read.log()["notes"], held.log()["notes"], "{options}");
            }
        }
        for options in [
            "--all",
            "--scheme sf --threshold 0.1 --range 8100..8300",
            "--scheme hsa --filter triang:15 --range 8192..11900",
            "--scheme grf-slots --neurons 5 --slots 4 --range 0..40",
        ] {
            let drawn = |input: &str| {
                let picture = directory.path().join("picture.svg");
                let asked = format!("plot {options} --column gyro_x --skip-non-finite {input}");
                let told = good(&format!("{asked} -o {}", picture.display()), &text).stderr;
                (fs::read_to_string(picture).unwrap(), told)
            };
            assert!(drawn(&path) == drawn("-"), "{options}");
        }
    }
}

#[test]
fn what_holds_no_log_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name).display().to_string();
    logs(&directory.path().join("logs"));
    fs::create_dir(directory.path().join("none")).unwrap();
    fs::write(directory.path().join("list"), "\n").unwrap();
    ran!("dataset {SF} --rate 200 --test 0 {}/?.csv -o {}", at("logs"), at("set"));
    let score = format!("score {SF} --rate 200");
    refused(&format!("{score} --list {}", at("list")), "", &["no logs: name files"]);
    refused(&format!("{score} {}", at("none")), "", &["no logs in this directory", ".parquet"]);
    refused(&format!("{score} --split test {}", at("set")), "", &["no flight for testing"]);
    refused(&format!("{score} --split test {}", at("logs")), "", &["--split chooses"]);
    refused(&format!("{score} --list - -"), "", &["both the list and a log"]);

    // Patterns find data sets. A file that is given several times is read once.
    let read = |logs: &str| names(&ran!("{score} {logs} --json").json()).len();
    assert_eq!(read(&at("s*t")), 3);
    assert_eq!(read(&format!("{0}/1.csv {0}/../logs/1.csv {0}/[12].csv", at("logs"))), 2);

    // The manifest of a run that was killed: a log that was encoded again, and half a line.
    let manifest = directory.path().join("set/manifest.jsonl");
    let text = fs::read_to_string(&manifest).unwrap();
    let line = text.lines().next().unwrap();
    fs::write(&manifest, format!("{text}{line}\n{}", &line[..40])).unwrap();
    assert_eq!(read(&at("set")), 3);
    fs::write(&manifest, text.replace("\"split\":\"train\"", "\"split\":null")).unwrap();
    refused(&format!("{score} --split all {}", at("set")), "", &["not complete"]);
}

/// A report lists a log that is refused also if it is the only one.
#[test]
fn a_report_does_not_depend_on_the_number_of_logs() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name).display().to_string();
    logs(&directory.path().join("logs"));
    fs::create_dir(directory.path().join("one")).unwrap();
    fs::copy(at("logs/log.mcap"), at("one/log.mcap")).unwrap();
    for asked in [
        format!("score {SF} --column x {}", at("logs/names.csv")),
        format!("info {}", at("missing.csv")),
        format!("advise --max-rmse 1e-9 --evaluations 5 --rate 200 {}", at("logs/1.csv")),
    ] {
        let ran = spikewire(&format!("{asked} --json"), "");
        assert_eq!(ran.status, 2, "{asked}");
        assert!(ran.log()["refused"].is_string(), "{asked}");
        assert_eq!(ran.json()["summary"]["refused"], 1, "{asked}");
    }
    // An option that does not apply to a log is left out if a directory is given.
    ran!("score {SF} --delimiter , {CHANNELS} {}", at("one"));
    refused(&format!("score {SF} --delimiter , {}", at("one/log.mcap")), "", &["--delimiter"]);

    // Every log has an error of 0.
    for name in ["0.csv", "00.csv"] {
        fs::write(directory.path().join(name), table(&[0.0; 99])).unwrap();
    }
    let report = ran!("score {SF} {} {} --json", at("0.csv"), at("00.csv")).json();
    assert_eq!(report["summary"]["schemes"][0]["worst_log"], at("0.csv"));
}

#[test]
fn logs_of_several_kinds_are_tuned_together() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join("logs").join(name).display().to_string();
    logs(&directory.path().join("logs"));
    let tune = "tune --scheme sf --min-efficiency 50 --evaluations 20 --anyway --rate 200";
    let report = ran!("{tune} {CHANNELS} {} {} --json", at("1.csv"), at("log.mcap")).json();
    let channels: Vec<_> =
        report["logs"].as_array().unwrap().iter().map(|own| &own["channels"][0]).collect();
    assert_eq!(channels, ["x", "rate"]);
    assert!(report["summary"]["channels"]["x"].is_array());
    fs::write(at("y.csv"), "y\n1\n2\n").unwrap();
    let words = ["other channels: x in ", "1.csv, y in "];
    refused(&format!("{tune} {} {}", at("1.csv"), at("y.csv")), "", &words);
}

/// `score` and `plot` take as little memory for a long log as for a short one. Runs on Linux only: `cargo test --release
/// -p spikewire-cli --test lists -- --ignored --nocapture`. `SAMPLES` sets the length of the log.
#[test]
#[ignore = "a measurement"]
fn a_long_log_is_scored_and_drawn_in_constant_memory() {
    let samples: u64 =
        std::env::var("SAMPLES").map_or(20_000_000, |samples| samples.parse().unwrap());
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("long.npy");
    let mut file = BufWriter::new(fs::File::create(&path).unwrap());
    let about = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({samples},), }}");
    // The array begins at a multiple of 64 bytes.
    file.write_all(b"\x93NUMPY\x01\x00\x76\x00").unwrap();
    writeln!(file, "{about:117}").unwrap();
    for sample in 0..samples {
        let value = (sample as f64 * 0.01).sin() as f32;
        file.write_all(&value.to_le_bytes()).unwrap();
    }
    file.flush().unwrap();
    let picture = directory.path().join("long.png");
    for command in ["score".to_owned(), format!("plot -o {}", picture.display())] {
        let asked = format!("{command} {SF} --rate 1000 {}", path.display());
        let most = most_memory(&asked, || false);
        println!("{samples} samples, {most:.1} MB: {command}");
        assert!((1.0..100.0).contains(&most));
    }
}

/// Each report has the command, an entry for each log, and a summary.
#[test]
fn all_reports_have_one_shape() {
    let directory = tempfile::tempdir().unwrap();
    let out = directory.path().join("out").display().to_string();
    let log = flight("hexarotor.csv");
    let copy = directory.path().join("copy-of-hexarotor.csv");
    fs::copy(&log, &copy).unwrap();
    let network = "tests/peers/on_chip.json";
    for (command, logs) in [
        (format!("info {log} {}", copy.display()), 2),
        (format!("score {SF} --column gyro_x {log}"), 1),
        (format!("tune --scheme sf --channel gyro_x --evaluations 20 {log}"), 1),
        (format!("advise --channel gyro_x --evaluations 10 {log}"), 1),
        (format!("dataset {SF} --columns gyro_x {log} -o {out}"), 1),
        ("bench --tests 40 --cases 1".to_owned(), 0),
        (
            format!(
                "network {network} --scheme sf --threshold 0.05 --columns gyro_x,gyro_y,gyro_z {log} -o {out}.rs"
            ),
            1,
        ),
    ] {
        let report = spikewire(&format!("{command} --json"), "").json();
        let keys: Vec<&String> = report.as_object().unwrap().keys().collect();
        assert_eq!(keys, ["command", "logs", "summary"], "{command}");
        assert_eq!(report["command"], command.split(' ').next().unwrap());
        let summary = report["summary"].as_object().unwrap();
        let entries = report["logs"].as_array().unwrap();
        assert_eq!(entries.len(), logs, "{command}");
        if !command.starts_with("bench") {
            assert_eq!((&summary["logs"], &summary["refused"]), (&logs.into(), &0.into()));
        }
        for entry in entries {
            assert!(entry["log"].as_str().unwrap().ends_with("hexarotor.csv"), "{command}");
            assert!(entry["refused"].is_null() && entry["notes"].is_array(), "{command}");
        }
    }
}
