//! Output files are written completely or not at all, however the program ends, and errors name the file.
#![cfg(unix)]

mod common;

use common::{refused, spikewire};
use std::fs::{self, File};
use std::io::Write;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Number of table rows sent to `encode`: more than `encode` reads before it opens the output.
const ROWS: usize = 20_000;

#[test]
fn ctrl_c_leaves_no_file() {
    let directory = tempfile::tempdir().unwrap();
    let files = || fs::read_dir(directory.path()).unwrap().count();
    let mut child = Command::new(env!("CARGO_BIN_EXE_spikewire"))
        .args(["encode", "--scheme", "sf", "--threshold", "0.5", "-", "-o"])
        .arg(directory.path().join("spikes.csv"))
        .stdin(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut input = child.stdin.take().unwrap();
    input.write_all(("x\n".to_owned() + &"0\n1\n".repeat(ROWS)).as_bytes()).unwrap();
    let end = Instant::now() + Duration::from_secs(20);
    while files() == 0 && Instant::now() < end {
        std::thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(files(), 1, "a file in the making");
    let interrupted = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(interrupted.unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(files(), 0);
}

#[test]
fn a_full_disk_is_reported_with_the_files_name() {
    for command in ["signal -o /dev/full", "signal --seconds 5000 -o /dev/full"] {
        refused(command, "", &["error: /dev/full: cannot be written: No space left"]);
    }
    for command in ["signal", "score --rate 100 -", "info -"] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_spikewire"))
            .args(command.split(' '))
            .stdin(Stdio::piped())
            .stdout(File::options().write(true).open("/dev/full").unwrap())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        child.stdin.take().unwrap().write_all(b"x\n1\n2\n1\n").unwrap();
        let done = child.wait_with_output().unwrap();
        let report = String::from_utf8(done.stderr).unwrap();
        assert_eq!(done.status.code(), Some(2), "{report}");
        assert!(
            report.contains("error: standard output: cannot be written: No space left"),
            "{report}"
        );
    }
}

/// The message for a missing column lists only the first names of a table with 100 000 columns.
#[test]
fn a_message_is_short_though_names_are_many() {
    let names: Vec<String> = (0..100_000).map(|index| format!("c{index}")).collect();
    let row = vec!["0"; names.len()].join(",");
    let table = format!("{}\n{row}\n{row}\n", names.join(","));
    let ran = spikewire("encode --scheme sf --threshold 1 -", &table);
    assert_eq!(ran.status, 2);
    assert!(
        ran.stderr.contains("c18, c19 and 99980 more") && ran.stderr.len() < 500,
        "{}",
        ran.stderr
    );
}

/// A name that ends as another kind of file is refused before the work.
#[test]
fn a_name_with_the_ending_of_another_kind_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name).display().to_string();
    let flight = common::flight("hexarotor.csv");
    let tune = format!("tune {flight} --channel gyro_x --scheme sf --max-rmse 0.1");
    for (command, ending, what) in [
        (format!("advise {flight}"), "svg", "a flight file is written, and no .svg"),
        (format!("{tune} --emit toml"), "csv", "a file of parameters is written, and no .csv"),
        (format!("{tune} --emit flight"), "json", "a flight file is written, and no .json"),
        (format!("{tune} --emit rust"), "toml", "Rust is written, and no .toml"),
        ("emit rust --flight flight.toml".to_owned(), "c", "Rust is written, and no .c"),
        (format!("network x.nir --scheme sf {flight}"), "toml", "Rust is written, and no .toml"),
    ] {
        let output = path(&format!("x.{ending}"));
        refused(&format!("{command} -o {output}"), "", &[what, &output]);
    }
    assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 0);
}
