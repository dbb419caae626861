//! A rate that contradicts the number of samples through the length of a recording by a fifth or more is never used in
//! silence: each command that reads a recording says so, or refuses.

mod common;

use common::{file, good, ran, refused, spikewire};
use std::fmt::Write as _;

const UNEVEN: &str = "800.00 Hz by samples through length, 20000.00 Hz by the median step";
const GIVEN: &str =
    "the rate that is given, 100.00 Hz, is not that of samples through length, 800.00 Hz";
const ASKED: &str = "--rate says how many a second are taken";

/// Returns a table of 4000 samples at 800 Hz that arrive in packets of 8, 10 ms apart.
fn packets() -> String {
    let mut table = "time,gyro_x\n".to_owned();
    for at in 0..4000_u32 {
        let time = f64::from(at / 8) * 0.01 + f64::from(at % 8) * 0.00005;
        let value = (std::f64::consts::TAU * 1.5 * f64::from(at) / 800.0).sin();
        writeln!(table, "{time:.6},{value:.6}").unwrap();
    }
    table
}

/// Returns what a command that succeeds prints on both outputs.
fn said(arguments: &str, input: &str) -> String {
    let ran = good(arguments, input);
    ran.output + &ran.stderr
}

#[test]
fn each_command_reports_an_uneven_rate() {
    let packets = packets();
    let (directory, table) = file("b.csv", &packets);
    let path = |name: &str| directory.path().join(name).display().to_string();
    let sf = "--scheme sf --threshold 0.1";
    let goal = "--max-rmse 0.1 --evaluations 3";
    let spikes = path("spikes.csv");
    for command in [
        "info {}".to_owned(),
        "info --json {}".to_owned(),
        format!("encode {sf} {{}} -o {spikes}"),
        format!("encode {sf} {{}} -o {}", path("spikes.mcap")),
        format!("score {sf} {{}}"),
        "score {}".to_owned(),
        format!("score {sf} --json {{}}"),
        format!("plot {sf} {{}} -o {}", path("x.svg")),
        format!("plot --all {{}} -o {}", path("all.svg")),
        format!("tune --scheme sf {goal} {{}}"),
        format!("tune --scheme sf {goal} --json {{}}"),
        format!("tune --scheme sf {goal} --below 40Hz {{}}"),
        format!("tune --scheme sf {goal} --max-rate 900 {{}}"),
        format!("tune --scheme sf --evaluations 3 --front {} {{}}", path("front.svg")),
        format!("tune --scheme sf {goal} --emit rust {{}}"),
    ] {
        let words = said(&command.replace("{}", &table), "");
        assert!(words.contains(UNEVEN), "{command}: {words}");
        let is_piped = !command.contains("json") && !command.contains("--all");
        if is_piped && ["info", "score", "plot"].iter().any(|own| command.starts_with(own)) {
            let words = said(&command.replace("{}", "-"), &packets);
            assert!(words.contains(UNEVEN), "{command}, from a pipe: {words}");
        }
    }
    // No advice, and no period in a file.
    for command in [
        format!("advise {goal} {table}"),
        format!("advise {goal} {table} -o {}", path("flight.toml")),
        format!("advise --loop-bandwidth 4 --evaluations 3 {table}"),
        format!("tune --scheme sf {goal} --emit flight {table}"),
    ] {
        refused(&command, "", &[UNEVEN, ASKED]);
    }
    let report = spikewire(&format!("advise {goal} --json {table}"), "");
    assert!(report.status == 2 && report.output.contains(UNEVEN), "{}", report.output);
    let network = path("network.json");
    let layer = r#"{"layers": [{"weights": [[64.0, -64.0]], "keep": 0.9, "threshold": 100.0}]}"#;
    std::fs::write(&network, layer).unwrap();
    let drive = format!("network {network} {sf}");
    let ran = spikewire(&format!("{drive} {table}"), "");
    assert!(ran.status == 2 && ran.stderr.contains(UNEVEN), "{}", ran.stderr);
    // A data set has no rate of such a log, and says why.
    ran!("dataset {sf} --test 0 {table} -o {}", path("set"));
    let manifest = std::fs::read_to_string(directory.path().join("set/manifest.jsonl")).unwrap();
    assert!(manifest.contains(UNEVEN) && manifest.contains("\"rate\":null"), "{manifest}");
}

#[test]
fn each_command_reports_a_given_rate_that_the_times_contradict() {
    let (directory, table) = file("b.csv", packets());
    let path = |name: &str| directory.path().join(name).display().to_string();
    let (sf, goal) = ("--scheme sf --threshold 0.1", "--max-rmse 0.1 --evaluations 3");
    for command in [
        format!("encode {sf} {table}"),
        format!("score {sf} {table}"),
        format!("plot {sf} {table} -o {}", path("x.svg")),
        format!("tune --scheme sf {goal} {table}"),
        format!("tune --scheme sf {goal} --emit flight {table}"),
        format!("advise {goal} {table} -o {}", path("flight.toml")),
    ] {
        let words = said(&format!("{command} --rate 100"), "");
        assert!(words.contains(GIVEN), "{command}: {words}");
        let words = said(&format!("{command} --rate 750"), "");
        assert!(!words.contains("Hz, is not that of samples"), "{command}: {words}");
    }
    ran!("dataset {sf} --test 0 --rate 100 {table} -o {}", path("set"));
    let manifest = std::fs::read_to_string(directory.path().join("set/manifest.jsonl")).unwrap();
    assert!(manifest.contains(GIVEN), "{manifest}");
    // The flight has the rate that was last given, 750 Hz, and another recording a fourth of it.
    let mut slow = "time,gyro_x\n".to_owned();
    for row in 0..400 {
        writeln!(slow, "{:.3},{}", f64::from(row) * 0.005, row % 7).unwrap();
    }
    let (_directory, slow) = file("slow.csv", slow);
    let flight = path("flight.toml");
    let words = "the recording has 200.00 samples a second, and the flight 750.19";
    for command in ["encode", "score"] {
        let said = said(&format!("{command} --flight {flight} {slow}"), "");
        assert!(said.contains(words), "{command}: {said}");
        assert!(
            !self::said(&format!("{command} --flight {flight} --rate 800 {table}"), "")
                .contains("and the flight")
        );
    }
    ran!("dataset --flight {flight} --test 0 {slow} -o {}", path("flown"));
    let manifest = std::fs::read_to_string(directory.path().join("flown/manifest.jsonl")).unwrap();
    assert!(manifest.contains(words), "{manifest}");
}

/// In a list of tables and logs, one that is uneven is settled by `--rate`, in each command that reads lists.
#[test]
fn a_rate_settles_an_uneven_log_in_a_mixed_list() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name);
    let row = |at: u32| format!("{},{}\n", at * 1250, (f64::from(at) * 0.0118).sin());
    let even = "time_us,gyro_x\n".to_owned() + &(0..4000).map(row).collect::<String>();
    std::fs::write(path("even.csv"), even).unwrap();
    std::fs::write(path("uneven.log"), ardupilot()).unwrap();
    let list = format!(
        "{} {} --channels-of table=gyro_x --channels-of ardupilot=IMU.GyrX",
        path("even.csv").display(),
        path("uneven.log").display()
    );
    let goal = "--max-rmse 0.1 --evaluations 3";
    let output = spikewire(&format!("advise {goal} {list}"), "");
    assert!(output.status == 2 && output.stderr.contains(ASKED), "{}", output.stderr);
    let advised = ran!("advise {goal} --json --rate 800 {list}").json();
    assert_eq!(advised["summary"]["refused"], 0, "{advised:#}");
    let set = path("set").display().to_string();
    ran!("dataset --scheme sf --threshold 0.1 --test 0 --rate 800 {list} -o {set}");
    let manifest = std::fs::read_to_string(path("set/manifest.jsonl")).unwrap();
    assert_eq!(manifest.matches("\"rate\":800").count(), 2, "{manifest}");
    assert!(!manifest.contains("by the median step"), "{manifest}");
}

/// Returns an `ArduPilot` log as text, with the same packets.
fn ardupilot() -> String {
    let mut log = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n\
                   FMT, 129, 15, IMU, Qf, TimeUS,GyrX\n"
        .to_owned();
    for line in packets().lines().skip(1) {
        let (time, value) = line.split_once(',').unwrap();
        let time: f64 = time.parse().unwrap();
        writeln!(log, "IMU, {}, {value}", (time * 1e6).round()).unwrap();
    }
    log
}
