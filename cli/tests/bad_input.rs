//! What is refused, with which words, and that nothing half-written stays behind.

mod common;

use common::{flight, flight_logs, good, refused, spikewire_bytes, table};
use std::fs;

const SF: &str = "encode --scheme sf --threshold 0.5";

#[test]
fn columns_topics_and_fields() {
    let hexarotor = flight("hexarotor.csv");
    refused(&format!("{SF} --column gyro_w {hexarotor}"), "", &["no column `gyro_w`", "gyro_x"]);
    refused(&format!("{SF} --column 8 {hexarotor}"), "", &["no column 8", "1 to 7"]);
    refused(&format!("{SF} {hexarotor}"), "", &["--column must say which", "accel_z"]);
    refused(&format!("{SF} --time clock --column gyro_x {hexarotor}"), "", &["no column `clock`"]);
    refused(
        &format!("{SF} --topic sensor_combined --column gyro_x {hexarotor}"),
        "",
        &["a CSV table takes no --topic"],
    );
    let log = flight_logs()[0].display().to_string();
    refused(&format!("{SF} {log}"), "", &["--topic and --field"]);
    refused(
        &format!("{SF} --topic sensor_combine --field x {log}"),
        "",
        &["no topic `sensor_combine`", "near it are sensor_combined"],
    );
    refused(
        &format!("{SF} --topic sensor_combined --field gyro_rad {log}"),
        "",
        &["field `gyro_rad` is not one number but several", "gyro_rad[0..3]"],
    );
}

#[test]
fn tables() {
    refused(&format!("{SF} nowhere.csv"), "", &["nowhere.csv", "cannot be opened"]);
    refused(&format!("{SF} -"), "", &["standard input: empty"]);
    refused(&format!("{SF} -"), "x\n", &["no samples below the header"]);
    refused(&format!("{SF} -"), "1\n2\n", &["line 1 holds numbers"]);
    refused(
        &format!("{SF} -"),
        "x\n1\n2\nabc\n",
        &["standard input: line 4, column x: `abc` is not a number"],
    );
    refused(
        &format!("{SF} --column x -"),
        "x,y\n1,2\n3\n",
        &["line 3 has 1 columns where the header has 2"],
    );
    refused(
        &format!("{SF} --column x -"),
        "x,time\n1,0\n2,later\n",
        &["line 3, column time: `later`"],
    );
}

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
    good(&format!("{channel} --accept-cut {cut}"), "");
    fs::write(&path, b"ULog").unwrap();
    refused(&format!("info {cut}"), "", &["not a flight log"]);
    fs::write(&path, b"").unwrap();
    refused(&format!("info {cut}"), "", &["empty"]);
}

#[test]
fn parameters() {
    let signal = table(&[0.0, 1.0, 0.5]);
    refused("encode --scheme sf -", &signal, &["sf needs --threshold"]);
    refused("encode --scheme sf --threshold 0 -", &signal, &["threshold 0 must be above 0"]);
    refused(
        "encode --scheme sf --threshold 0.001 --sample q8.8 -",
        &signal,
        &["threshold 0.001 is 0 in q8.8, whose step is 0.00390625"],
    );
    refused(
        "encode --scheme sf --threshold 1 --factor 2 -",
        &signal,
        &["sf takes no --factor; it takes --threshold --start"],
    );
    refused("encode --scheme sf --threshold x -", &signal, &["x"]);
    refused(
        "encode --scheme tbr --factor 1 -",
        &signal,
        &["standard input gives only once", "--threshold"],
    );
    refused("encode --scheme grf --neurons 20 -", &signal, &["--min and --max"]);
    refused(
        "encode --scheme grf --neurons 2 --min 0 --max 1 -",
        &signal,
        &["neurons 2 must be a whole number in 3..=1024"],
    );
    refused("encode --scheme grf --neurons 20 --min 1 --max 1 -", &signal, &["min and max"]);
    refused(
        "encode --scheme mw --threshold 1 --window 16384 -",
        &signal,
        &["window 16384 must be a whole number in 0..=16383"],
    );
    refused(
        "encode --scheme hsa --filter triang:4097 --shift 0 -",
        &signal,
        &["the length `4097` must be 1 to 4096"],
    );
    refused("encode --scheme hsa --filter box:3 --shift 0 -", &signal, &["box:3", "triang:N"]);
    refused(
        "encode --scheme bsa --filter triang:9 --form toolbox --criterion sub --threshold 1 --shift 0 -",
        &signal,
        &["mul only"],
    );
    refused("encode --scheme position --centres 1,0,2 -", &signal, &["rise strictly"]);
    refused(
        "encode --scheme sf --threshold 1 --sample f16 -",
        &signal,
        &["no sample type `f16`", "q"],
    );
    refused("encode --scheme what -", &signal, &["what", "grf-slots"]);
    refused("bench --tests 1", "", &["--tests 1 must lie in 2..=1000000"]);
    let most = usize::MAX;
    refused(&format!("bench --tests {most}"), "", &["2..=1000000"]);
    refused(&format!("signal --seconds {most}"), "", &["1000000 at most"]);
    let window = format!("encode --scheme mw --threshold 1 --window {most} -");
    refused(&window, &signal, &["must be a whole number in 0..=16383"]);
    for number in ["nan", "inf", "0", "-1"] {
        let words = ["must be a number above 0"];
        refused(&format!("{SF} --gap={number} -"), &signal, &words);
        refused(&format!("{SF} --rate={number} -"), &signal, &words);
        refused(&format!("info --gap={number} log.ulg"), "", &words);
    }
}

#[test]
fn options_that_the_input_does_not_take() {
    refused(
        &format!("{SF} --accept-cut -"),
        &table(&[1.0]),
        &["a CSV table takes no --accept-cut"],
    );
    let timed = "time_us,x\n0,1\n5000,2\n";
    refused(&format!("{SF} --rate 200 -"), timed, &["--rate 200 contradicts", "column time_us"]);
    let log = flight_logs()[0].display().to_string();
    let channel = "--topic sensor_combined --field gyro_rad[0]";
    refused(&format!("{SF} --rate 200 {channel} {log}"), "", &["a log takes no --rate"]);
}

#[test]
fn paper_is_advised_where_it_is_taken() {
    let timed = "time_us,x\n0,1\n5000,2\n";
    let file = tempfile::NamedTempFile::new().unwrap();
    fs::write(file.path(), timed).unwrap();
    refused(&format!("encode --scheme sf {}", file.path().display()), "", &["or --paper"]);
    for command in ["listen --scheme sf", "encode --scheme sf -"] {
        let told = common::spikewire(command, timed).told;
        assert_eq!(told, "error: sf needs --threshold\n");
    }
}

#[test]
fn filters_from_files() {
    let file = tempfile::NamedTempFile::new().unwrap();
    let path = file.path().display();
    fs::write(file.path(), "0.5, 1\n0.5\n").unwrap();
    let signal = table(&[0.5, 1.0, 0.5, 0.0]);
    let encoded = good(&format!("encode --scheme hsa --filter {path} --shift 0 -"), &signal).output;
    assert!(encoded.contains("# taps=0.5,1,0.5\n"));
    assert_eq!(common::train(&encoded), [1, 0, 0, 0]);
    fs::write(file.path(), "0.5\n1 one\n").unwrap();
    refused(
        &format!("encode --scheme hsa --filter {path} --shift 0 -"),
        &signal,
        &["line 2, number 2: `one`"],
    );
    fs::write(file.path(), "\n").unwrap();
    refused(&format!("encode --scheme hsa --filter {path} --shift 0 -"), &signal, &["empty"]);
}

#[test]
fn files_of_spikes() {
    let whole = good(&format!("{SF} -"), &table(&[0.0, 1.0, 2.0])).output;
    let with = |from: &str, to: &str| whole.replace(from, to);
    refused("decode -", "", &["standard input: empty"]);
    refused("decode -", &table(&[1.0]), &["line 1", "index,address,polarity"]);
    refused("decode -", &with("# scheme=sf\n", ""), &["lacks `# scheme=`"]);
    refused("decode -", &with("# threshold=0.5\n", ""), &["lacks `# threshold=`"]);
    refused("decode -", &with("threshold=0.5", "threshold=half"), &["threshold=half"]);
    refused("decode -", &with("threshold=0.5", "threshold=-1"), &["threshold -1 must be above 0"]);
    refused(
        "decode -",
        &with("# scheme=sf", "# scheme=sf\n# scheme=mw"),
        &["contradicts itself: scheme=sf, then scheme=mw"],
    );
    refused(
        "decode -",
        &with("# scheme=sf", "# scheme=sf\n# window=5"),
        &["window=5, which sf does not take"],
    );
    refused("decode -", &with("1,0,1\n", "1,7,1\n"), &["address 7", "1 neurons"]);
    refused("decode -", &with("1,0,1\n", "1,0,2\n"), &["polarity `2`"]);
    refused("decode -", &with("1,0,1\n", "1,0\n"), &["`1,0` is not an event"]);
    refused(
        "decode -",
        &with("1,0,1\n2,0,1\n", "2,0,1\n1,0,1\n"),
        &["sample 1 comes after sample 2"],
    );
    refused(
        "decode -",
        &with("1,0,1\n", "1,0,1\n1,0,1\n").replace("events=2", "events=3"),
        &["sample 1", "no encoder emits"],
    );
    refused("decode -", &with("# samples=3\n# events=2\n", ""), &["cut short"]);
    refused("decode -", &with("events=2", "events=3"), &["2 events where its end says 3"]);
    refused("decode -", &with("samples=3", "samples=2"), &["sample 2 where its end says 2"]);
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
    let words = r"line 10, column x: `\u{1}\xff\u{1b}[31mµ` is not a number";
    assert!(ran.status == 2 && ran.told.contains(words), "{}", ran.told);
    let long = format!("x\n1\n{}\n", "y".repeat(5000));
    let told = spikewire_bytes("encode --scheme sf --threshold 1 -", long.as_bytes()).told;
    assert!(told.len() < 200, "{}", told.len());
}
