//! Bad input is refused with a message that names the fault, and no unfinished output file is left.

mod common;

use common::{flight_logs, good, ran, refused, spikewire_bytes, table};
use std::fs;

const SF: &str = "encode --scheme sf --threshold 0.5";

#[test]
fn flight_logs_that_are_cut_short() {
    let whole = fs::read(&flight_logs()[0]).unwrap();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("cut.ulg");
    fs::write(&path, &whole[..500_000]).unwrap();
    let cut = path.display();
    refused(&format!("info {cut}"), "", &["cut short", "byte 499971 of 500000"]);
    let channel = format!("{SF} --topic sensor_combined --field gyro_rad[0]");
    refused(&format!("{channel} {cut}"), "", &["cut short"]);
    ran!("{channel} --accept-cut {cut}");
    fs::write(&path, b"ULog").unwrap();
    refused(&format!("info {cut}"), "", &["not a flight log"]);
    fs::write(&path, b"").unwrap();
    refused(&format!("info {cut}"), "", &["empty"]);
}

#[test]
fn nothing_half_written_stays() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("spikes.csv");
    let mut long: Vec<f64> = (0..20_000).map(f64::from).collect();
    let good_table = table(&long);
    long.push(0.0);
    let bad_table = table(&long) + "abc\n";
    refused(&format!("{SF} - -o {}", path.display()), &bad_table, &["line 20003"]);
    assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 0);
    good(&format!("{SF} - -o {}", path.display()), &good_table);
    let before = fs::read(&path).unwrap();
    refused(&format!("{SF} - -o {}", path.display()), &bad_table, &["line 20003"]);
    assert_eq!(fs::read(&path).unwrap(), before);
    assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1);
    let decoded = directory.path().join("decoded.csv");
    let cut = &before[..before.len() - 30];
    refused(
        &format!("decode - -o {}", decoded.display()),
        std::str::from_utf8(cut).unwrap(),
        &["standard input"],
    );
    assert!(!decoded.exists());
}

#[test]
fn bytes_that_are_no_text_are_shown_as_escapes() {
    let table = b"x\n1\n2\n3\n4\n5\n6\n7\n8\n\x01\xff\x1b[31m\xc2\xb5\n";
    let ran = spikewire_bytes("encode --scheme sf --threshold 1 -", table);
    let words = r"line 10, column x: value `\u{1}\xff\u{1b}[31mµ` is not a number";
    assert!(ran.status == 2 && ran.stderr.contains(words), "{}", ran.stderr);
    let long = format!("x\n1\n{}\n", "y".repeat(5000));
    let report = spikewire_bytes("encode --scheme sf --threshold 1 -", long.as_bytes()).stderr;
    assert!(report.len() < 200, "{}", report.len());
}
