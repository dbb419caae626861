//! `dataset` with many logs: a run that was killed can be continued. The spikes restored from a Parquet file equal
//! those that `encode` writes for the same log.

mod common;

use common::{flight, flight_logs, good, most_memory, ran, refused, spikewire};
use flight_logs::made::{Kind, blackbox, dataflash, dataflash_sample, dataflash_text, frame, tlog};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Kinds of logs, and the channel that the tests read from logs of each kind.
const CHANNELS: [(&str, &str); 8] = [
    ("table", "gyro_x"),
    ("ulog", "sensor_combined.gyro_rad[0]"),
    ("ardupilot", "IMU.GyrX"),
    ("mavlink", "RAW_IMU.xgyro"),
    ("bag", "imu.rate"),
    ("ros2", "imu.rate"),
    ("mcap", "imu.rate"),
    ("blackbox", "main.gyroADC[0]"),
];
const SCHEME: &str = "--scheme sf --threshold 0.05 --skip-non-finite";

/// Returns a CSV table with missing values, a gap, and a time that goes back.
fn table(rows: usize) -> String {
    let mut text = "time_ms,gyro_x,gyro_y\n".to_owned();
    for row in 0..rows {
        let time = match row {
            0..50 => row * 5,
            50..90 => row * 5 + 100,
            _ => row * 5 - 20,
        };
        let (x, y) = ((row as f64 * 0.05).sin(), (row as f64 * 0.031).cos());
        if row % 83 == 7 {
            writeln!(text, "{time},NA,{y}").unwrap();
        } else {
            writeln!(text, "{time},{x},{y}").unwrap();
        }
    }
    text
}

/// Writes logs of all kinds, and one file that is not a log, below `directory`; returns the number of logs.
fn logs(directory: &Path, rows: usize) -> usize {
    let of = |name: &str, content: &[u8]| {
        let path = directory.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, content).unwrap();
    };
    of("README.md", b"Flights of May.\n");
    of("a/1.csv", table(200).as_bytes());
    of("a/2.csv", table(300).as_bytes());
    of("a/log.bin", &dataflash());
    of("a/log.log", dataflash_text().as_bytes());
    of("a/log.tlog", &tlog());
    of("b/log.bag", &Kind::Bag.log("lz4"));
    of("b/log.mcap", &Kind::Mcap.log("none"));
    of("b/log.db3", &Kind::Db3.log("none"));
    of("b/log.bbl", &blackbox());
    of("b/copy.bbl", &blackbox());
    of("b/names.csv", b"gyro_x\none\ntwo\n");
    fs::copy(&flight_logs()[0], directory.join("b/log.ulg")).unwrap();
    // These take long enough to be killed within.
    of("c/long.csv", table(rows).as_bytes());
    of("d/long.csv", table(rows + 1).as_bytes());
    14
}

fn arguments(logs: &Path, output: &Path) -> String {
    let channels = CHANNELS.map(|(kind, names)| format!(" --channels-of {kind}={names}"));
    format!("dataset {SCHEME}{} {} -o {}", channels.concat(), logs.display(), output.display())
}

fn rows(dataset: &Path) -> Vec<Value> {
    let text = fs::read_to_string(dataset.join("manifest.jsonl")).unwrap_or_default();
    // A row that is being written has no end yet.
    let whole = &text[..text.rfind('\n').map_or(0, |end| end + 1)];
    whole.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// Returns the names of the files in the directories `events` and `values` of a data set.
fn parts(dataset: &Path) -> Vec<String> {
    let of = |directory: &str| {
        fs::read_dir(dataset.join(directory))
            .into_iter()
            .flatten()
            .map(move |own| format!("{directory}/{}", own.unwrap().file_name().display()))
            .collect::<Vec<_>>()
    };
    ["events", "values"].into_iter().flat_map(of).collect()
}

fn is_unfinished(part: &str) -> bool {
    part.contains("/.spikewire-")
}

/// Starts the program, and kills it in the middle of a log, after it has written `done` rows of the manifest.
fn killed(arguments: &str, dataset: &Path, done: usize) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_spikewire"))
        .args(arguments.split_whitespace())
        .args(["--jobs", "1"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let start = Instant::now();
    while rows(dataset).len() < done || !parts(dataset).iter().any(|own| is_unfinished(own)) {
        assert!(child.try_wait().unwrap().is_none(), "it ended before it was killed");
        assert!(start.elapsed() < Duration::from_secs(120));
        sleep(Duration::from_micros(300));
    }
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
fn a_run_that_is_killed_twice_is_continued_without_a_duplicate_or_a_hole() {
    const ROWS: usize = 60_000;
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    let count = logs(&at("logs"), ROWS);
    let [whole, ended] = ["whole", "ended"].map(|name| arguments(&at("logs"), &at(name)));
    let told = good(&whole, "").output;
    assert!(told.contains(&format!("{} logs with", count - 1)), "{told}");
    assert!(told.contains("1 logs are refused") && told.contains("1 files are neither"), "{told}");

    killed(&ended, &at("ended"), 12);
    assert_eq!(rows(&at("ended")).len(), 12);
    killed(&ended, &at("ended"), 13);
    assert!(parts(&at("ended")).iter().any(|own| is_unfinished(own)));
    let again = good(&ended, "").output;
    assert!(again.contains("13 logs were done before"), "{again}");

    // The rows are the same, byte for byte, and so are the parts.
    let read = |name: &str, file: &str| fs::read(at(name).join(file)).unwrap();
    let of_whole: BTreeSet<String> = parts(&at("whole")).into_iter().collect();
    assert_eq!(of_whole, parts(&at("ended")).into_iter().collect());
    assert_eq!(of_whole.len(), 2 * (count - 1));
    for file in of_whole.iter().map(String::as_str).chain(["manifest.jsonl", "dataset.json"]) {
        assert_eq!(read("whole", file), read("ended", file), "{file}");
    }
    let all = rows(&at("ended"));
    let logs: BTreeSet<&str> = all.iter().map(|row| row["log"].as_str().unwrap()).collect();
    assert_eq!((all.len(), logs.len()), (count, count));

    // Nothing is left to do, and a log that has changed is encoded again.
    let third = good(&format!("{ended} --json"), "").json();
    assert_eq!(third["summary"]["done_before"], count);
    assert_eq!(third["logs"], Value::from(all.clone()));
    fs::write(at("logs/a/1.csv"), table(250)).unwrap();
    let fourth = good(&format!("{ended} --json"), "").json();
    assert_eq!(fourth["summary"]["done_before"], count - 1);
    assert_eq!((&fourth["summary"]["logs"], rows(&at("ended")).len()), (&count.into(), count));
    assert_eq!(rows(&at("ended"))[0]["samples"], 250);

    let other = ended.replace("0.05", "0.06");
    refused(&other, "", &["holds parts of other settings"]);
}

#[test]
fn the_manifest_says_what_became_of_each_log() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    logs(&at("logs"), 100);
    good(&arguments(&at("logs"), &at("out")), "");
    let all = rows(&at("out"));
    let row =
        |name: &str| all.iter().find(|row| row["log"].as_str().unwrap().ends_with(name)).unwrap();
    let names = row("names.csv");
    assert!(names["refused"].as_str().unwrap().contains("line 2, column gyro_x: value `one`"));
    assert_eq!((&names["events"], &names["split"]), (&Value::Null, &Value::Null));
    let first = row("a/1.csv");
    assert_eq!([&first["samples"], &first["not_finite"], &first["gaps"]], [200, 3, 1]);
    assert_eq!([&first["steps_back"], &first["restarts"]], [0, 1]);
    assert_eq!((&first["kind"], &first["rate"]), (&"table".into(), &200.0.into()));
    // Copies are on the same side.
    assert_eq!(row("log.bbl")["split"], row("copy.bbl")["split"]);
    let kinds: BTreeSet<&str> = all.iter().map(|row| row["kind"].as_str().unwrap()).collect();
    assert_eq!(kinds, CHANNELS.map(|(kind, _)| kind).into());

    // A data set is a list of the samples to train on, for `info` and `tune`.
    let out = at("out").display().to_string();
    let told = ran!("info --json {out}").json();
    let train = all.iter().filter(|row| row["split"] == "train");
    let samples = |all: &mut dyn Iterator<Item = &Value>| {
        let mut all: Vec<u64> = all.map(|own| own["samples"].as_u64().unwrap()).collect();
        all.sort_unstable();
        all
    };
    let listed = told["logs"].as_array().unwrap();
    assert_eq!(samples(&mut listed.iter()), samples(&mut train.into_iter()));
    assert!(listed.iter().all(|own| own["kind"] == "table" && own["columns"].is_array()));
    let names = at("logs").join("a");
    let told = ran!("info {} {}/*.bag", names.display(), at("logs/b").display()).output;
    for name in [
        "a/1.csv
",
        "a/2.csv
",
        "a/log.bin
",
        "a/log.tlog
",
        "b/log.bag
/imu: 100",
    ] {
        assert!(told.contains(name), "{told}");
    }
    let odd = format!("info --json {}/b {}/*.xyz", at("logs").display(), at("logs").display());
    refused(&odd, "", &["*.xyz: no file of this name"]);

    good(&format!("{} --by-directory", arguments(&at("logs"), &at("out"))), "");
    let side = |name: &str| {
        let own = rows(&at("out"));
        let own = own
            .iter()
            .filter(|row| row["log"].as_str().unwrap().contains(name) && row["refused"].is_null());
        own.map(|row| row["split"].as_str().unwrap().to_owned()).collect::<BTreeSet<_>>()
    };
    for name in ["/a/", "/b/", "/c/", "/d/"] {
        assert_eq!(side(name).len(), 1, "{name}");
    }
}

/// Runs `dataset` on a directory of logs in SF, and returns its report.
fn encoded(logs: &Path, output: &Path) -> Value {
    let columns = "--scheme sf --threshold 0.05 --columns gyro_x --skip-non-finite";
    ran!("dataset {columns} {} -o {} --json", logs.display(), output.display()).json()
}

/// A log that is added moves no other from training to testing. A log that is deleted loses its row, and the summary
/// counts the rows of the manifest.
#[test]
fn logs_come_and_go_without_moving_others() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    fs::create_dir(at("logs")).unwrap();
    let mut sides: Vec<(String, Value)> = Vec::new();
    for count in 1..=12 {
        fs::write(at("logs").join(format!("{count}.csv")), table(200 + count)).unwrap();
        let report = encoded(&at("logs"), &at("out"));
        let all = rows(&at("out"));
        assert_eq!((&report["summary"]["logs"], all.len()), (&count.into(), count));
        for (log, side) in &sides {
            let row = all.iter().find(|row| row["log"] == **log).unwrap();
            assert_eq!(row["split"], *side, "{log} of {count}");
        }
        let side = |row: &Value| (row["log"].as_str().unwrap().to_owned(), row["split"].clone());
        sides = all.iter().map(side).collect();
    }
    fs::remove_file(at("logs/3.csv")).unwrap();
    let summary = &encoded(&at("logs"), &at("out"))["summary"];
    assert_eq!([&summary["logs"], &summary["gone"], &summary["done_before"]], [11, 1, 11]);
    assert_eq!(rows(&at("out")).len(), 11);
    let counted = [&summary["train"], &summary["test"]].map(|own| own.as_u64().unwrap());
    assert_eq!(counted.iter().sum::<u64>(), 11);
    let whole = encoded(&at("logs"), &at("fresh"));
    assert_eq!(whole["summary"]["test"], summary["test"]);
    let read = |name: &str| fs::read(at(name).join("manifest.jsonl")).unwrap();
    assert_eq!(read("fresh"), read("out"));
}

/// Names that are not UTF-8 stay apart, and a link that leads nowhere is a log that cannot be opened.
#[cfg(target_os = "linux")]
#[test]
fn odd_names_and_links_are_logs_of_their_own() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    fs::create_dir(at("logs")).unwrap();
    for (name, rows) in [(&b"a\xfe.csv"[..], 210), (&b"a\xff.csv"[..], 220)] {
        fs::write(at("logs").join(OsStr::from_bytes(name)), table(rows)).unwrap();
    }
    std::os::unix::fs::symlink("nowhere", at("logs/dangling.csv")).unwrap();
    std::os::unix::fs::symlink("loop.csv", at("logs/loop.csv")).unwrap();
    let report = encoded(&at("logs"), &at("out"));
    assert_eq!([&report["summary"]["logs"], &report["summary"]["refused"]], [4, 2]);
    let all = rows(&at("out"));
    let whole: Vec<&Value> = all.iter().filter(|row| row["refused"].is_null()).collect();
    assert_eq!([&whole[0]["samples"], &whole[1]["samples"]], [210, 220]);
    assert!(whole[0]["log_bytes"].as_str().unwrap().ends_with("61fe2e637376"), "{whole:?}");
    assert_ne!(whole[0]["events"], whole[1]["events"]);
    assert_eq!(parts(&at("out")).len(), 4);
    let refused = all.iter().filter(|row| row["refused_kind"] == "Open");
    assert_eq!(refused.count(), 2, "{all:?}");
    assert_eq!(encoded(&at("logs"), &at("out"))["summary"]["done_before"], 2);

    // The same by a list of bytes.
    let names = fs::read_dir(at("logs")).unwrap().map(|own| own.unwrap().path());
    let lines: Vec<u8> = names
        .filter(|own| own.exists())
        .flat_map(|own| [own.as_os_str().as_bytes(), b"\n"].concat())
        .collect();
    fs::write(at("list"), lines).unwrap();
    let columns = "--scheme sf --threshold 0.05 --columns gyro_x --skip-non-finite";
    ran!("dataset {columns} --list {} -o {}", at("list").display(), at("listed").display());
    assert_eq!(rows(&at("listed")).len(), 2);
}

/// A log that another program writes while it is read has no row of spikes, but one that says so.
#[cfg(target_os = "linux")]
#[test]
fn a_log_that_grows_is_refused_until_it_rests() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    fs::create_dir(at("logs")).unwrap();
    let log = at("logs/long.csv");
    fs::write(&log, table(100_000)).unwrap();
    let is_done = std::sync::atomic::AtomicBool::new(false);
    let order = std::sync::atomic::Ordering::Relaxed;
    std::thread::scope(|scope| {
        scope.spawn(|| {
            use std::io::Write;
            while !is_done.load(order) {
                let mut file = fs::OpenOptions::new().append(true).open(&log).unwrap();
                file.write_all(b"600000,1,1\n").unwrap();
                sleep(Duration::from_millis(2));
            }
        });
        let columns = "--scheme sf --threshold 0.05 --columns gyro_x --skip-non-finite";
        let asked =
            format!("dataset {columns} {} -o {}", at("logs").display(), at("out").display());
        let ran = spikewire(&asked, "");
        is_done.store(true, order);
        assert_eq!(ran.status, 2, "{}", ran.stderr);
        assert!(ran.stderr.contains("it changed while it was read"), "{}", ran.stderr);
    });
    let all = rows(&at("out"));
    assert_eq!((&all[0]["refused_kind"], &all[0]["events"]), (&"Changed".into(), &Value::Null));
    assert_eq!(encoded(&at("logs"), &at("out"))["summary"]["refused"], 0);
}

#[test]
fn parts_give_the_bits_of_a_single_encode() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    logs(&at("logs"), 20_000);
    good(&arguments(&at("logs"), &at("out")), "");
    let all = rows(&at("out"));
    let part = |row: &Value| at("out").join(row["events"].as_str().unwrap());
    for row in all.iter().filter(|row| row["refused"].is_null()) {
        let kind = row["kind"].as_str().unwrap();
        let (_, names) = CHANNELS.iter().find(|(own, _)| *own == kind).unwrap();
        let single = ran!("encode {SCHEME} --columns {names} {}", row["log"].as_str().unwrap());
        let restored = ran!("decode --spikes {}", part(row).display()).output;
        // The samples are a table as well.
        if kind == "table" {
            let values = at("out").join(row["values"].as_str().unwrap());
            let again = ran!("encode {SCHEME} --columns {names} {}", values.display());
            assert_eq!(again.output, single.output, "{row}");
        }
        assert_eq!(restored, single.output, "{row}");
        let decoded = ran!("decode {}", part(row).display()).output;
        assert_eq!(decoded, good("decode", &single.output).output, "{row}");
    }
    // Codes with neurons, slots, look-ahead and calibration, on several channels, with times and without.
    let table = at("logs/d/long.csv");
    let text = fs::read_to_string(&table).unwrap();
    for (place, (code, column)) in [
        ("--scheme grf-slots --neurons 5 --slots 4", "time_ms"),
        ("--scheme hsa --filter triang:15,peak=2", "time_ms"),
        ("--scheme tbr --factor 1 --sample q8.8", "time_ms"),
        ("--scheme grf-prob --neurons 3 --rate 250", "index"),
    ]
    .into_iter()
    .enumerate()
    {
        fs::write(&table, text.replacen("time_ms", column, 1)).unwrap();
        let read = "--skip-non-finite --columns gyro_x,gyro_y";
        let out = at(&format!("out{place}"));
        ran!("dataset {code} {read} {} -o {}", table.display(), out.display());
        let single = ran!("encode {code} {read} {}", table.display()).output;
        let part = out.join(rows(&out)[0]["events"].as_str().unwrap());
        assert_eq!(ran!("decode --spikes {}", part.display()).output, single, "{code}");
    }
}

#[test]
fn a_flight_codes_as_its_sender_does() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    let text = "version = 1
scheme = \"sod\"
sample = \"i16\"
period = 5000
keyframe_every = 100

[[channel]]
name = \"roll\"
source = \"gyro_x\"
unit = \"rad/s\"
counts = 1000
parameters = { threshold = 20, spikes = 4 }
";
    fs::write(at("flight.toml"), text).unwrap();
    let (flight_file, table) = (at("flight.toml"), flight("hexarotor.csv"));
    let ulog = &flight_logs()[0];
    fs::write(at("list"), format!("{table}\n\n{}\n", ulog.display())).unwrap();
    let coded = format!("--flight {}", flight_file.display());
    ran!(
        "dataset {coded} --channels-of table=none --channels-of table=gyro_x --channels-of ulog=sensor_combined.gyro_rad[0] --list {} -o {}",
        at("list").display(),
        at("out").display()
    );
    let all = rows(&at("out"));
    let row = all.iter().find(|row| row["kind"] == "table").unwrap();
    let part = at("out").join(row["events"].as_str().unwrap());
    let single = ran!("encode {coded} {table}").output;
    assert_eq!(ran!("decode --spikes {}", part.display()).output, single);
    // The log is that of the table.
    assert_eq!(all.len(), 2);
    assert_eq!(all[0]["spikes"], all[1]["spikes"]);
}

#[test]
fn what_cannot_be_asked_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let (out, list) = (directory.path().join("out"), directory.path().join("list"));
    fs::write(&list, "").unwrap();
    let table = flight("hexarotor.csv");
    let sf = "dataset --scheme sf --threshold 1";
    for (asked, words) in [
        (format!("{sf} -o {}", out.display()), "were not provided"),
        (format!("{sf} --list {} -o {}", list.display(), out.display()), "no logs: name files"),
        (format!("{sf} missing.csv -o {}", out.display()), "missing.csv: no file of this name"),
        (format!("{sf} --test 2 {table} -o {}", out.display()), "--test 2 must be from 0 to 1"),
        (
            format!("{sf} --channels-of csv=x {table} -o {}", out.display()),
            "csv=x: there are table, ulog, ardupilot",
        ),
        (format!("{sf} --column none {table} -o {}", out.display()), "no log can be encoded: "),
    ] {
        refused(&asked, "", &[words]);
    }
    refused(&format!("decode --spikes {table}"), "", &["--spikes takes a Parquet file"]);
}

/// Returns the processor time, in seconds, of all programs that this process has started and that have ended.
fn spent() -> f64 {
    /// Clock ticks in a second; Linux gives processor times in these ticks.
    const TICKS: f64 = 100.0;
    let text = fs::read_to_string("/proc/self/stat").unwrap();
    let (_, fields) = text.rsplit_once(')').unwrap();
    let fields: Vec<&str> = fields.split_whitespace().collect();
    fields[13..15].iter().map(|own| own.parse::<f64>().unwrap()).sum::<f64>() / TICKS
}

/// Number of logs of the measurement.
const LOGS: usize = 1000;

/// Writes a thousand logs of seven formats. The tables repeat a real flight, and the `ULog` files are parts of a real
/// flight. The logs in other formats hold sine waves.
fn a_thousand(logs: &Path) {
    /// Fewest samples of a log, and the largest number above it.
    const SAMPLES: (usize, usize) = (6_000, 20_011);
    fs::create_dir(logs).unwrap();
    let table = fs::read_to_string(flight("hexarotor.csv")).unwrap();
    let (header, flown) = table.split_once('\n').unwrap();
    let flown: Vec<(i64, &str)> = flown
        .lines()
        .map(|line| {
            let (time, values) = line.split_once(',').unwrap();
            (time.parse().unwrap(), values)
        })
        .collect();
    let end = flown.last().unwrap().0 + 5000;
    let ulog = fs::read(&flight_logs()[0]).unwrap();
    let end_of_dataflash =
        dataflash().len() - (0..100).map(|own| dataflash_sample(own).len()).sum::<usize>();
    let end_of_head = blackbox().len()
        - b"E\xffEnd of log\0".len()
        - (0..200).map(|own| frame(own).len()).sum::<usize>();
    for log in 0..LOGS {
        // A different number for each log.
        let samples = (SAMPLES.0 + log * 79_193 % SAMPLES.1) as u32;
        let (ending, content) = match log % 7 {
            0 => {
                let rows = (0..samples as usize * 2).map(|row| {
                    let (time, values) = flown[(row + log) % flown.len()];
                    let turn = ((row + log) / flown.len()) as i64 * end;
                    format!("{},{values}\n", time + turn)
                });
                ("csv", (format!("{header}\n") + &rows.collect::<String>()).into_bytes())
            }
            1 => ("ulg", ulog[..ulog.len() / 2 + log * 400].to_vec()),
            2 => {
                let all = (0..samples).flat_map(dataflash_sample);
                ("bin", [&dataflash()[..end_of_dataflash], &all.collect::<Vec<_>>()].concat())
            }
            3 => {
                let chunks = (0..samples / 500).flat_map(|chunk| {
                    let own =
                        (chunk * 500..(chunk + 1) * 500).flat_map(|own| Kind::Bag.record(own));
                    Kind::Bag.chunk("lz4", &own.collect::<Vec<_>>())
                });
                ("bag", Kind::Bag.start().into_iter().chain(chunks).collect())
            }
            4 => ("mcap", Kind::Mcap.of(0..samples)),
            5 => {
                let frames = (0..samples * 3).flat_map(frame);
                let end = b"E\xffEnd of log\0".iter().copied();
                let head = blackbox()[..end_of_head].to_vec();
                ("bbl", head.into_iter().chain(frames).chain(end).collect())
            }
            _ => {
                let own = tlog();
                ("tlog", own.repeat(samples as usize / 200))
            }
        };
        fs::write(logs.join(format!("{log:04}.{ending}")), content).unwrap();
    }
}

/// One run that encodes a thousand logs, killed twice on the way, takes at most 1.2 times the processor time of a
/// thousand runs with one log each. So do two workers of Dask, of which one is killed twice, with the start of all
/// processes counted, if `FLEET_PYTHON` names a Python with the package; their bytes are the same. The test takes
/// minutes, and runs on Linux only: `cargo verify fleet`.
#[test]
#[ignore = "a measurement"]
fn a_thousand_logs_cost_little_more_than_each_alone() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    a_thousand(&at("logs"));
    let out = at("out");
    let asked = arguments(&at("logs"), &out) + " --accept-cut";
    let start = spent();
    let most =
        [300, 700, usize::MAX].map(|until| most_memory(&asked, || rows(&out).len() >= until));
    let together = spent() - start;
    let all = rows(&out);
    let logs: BTreeSet<&str> = all.iter().map(|row| row["log"].as_str().unwrap()).collect();
    assert_eq!((all.len(), logs.len()), (LOGS, LOGS));
    assert!(all.iter().all(|row| row["refused"].is_null()));
    let start = spent();
    for row in &all {
        let (_, names) = CHANNELS.iter().find(|(kind, _)| row["kind"] == *kind).unwrap();
        let options = if row["kind"] == "table" { "" } else { "--accept-cut" };
        let log = row["log"].as_str().unwrap();
        ran!("encode {SCHEME} --columns {names} {options} {log} -o {}", at("single.csv").display());
    }
    let alone = spent() - start;
    let samples: u64 = all.iter().map(|row| row["samples"].as_u64().unwrap()).sum();
    println!(
        "{samples} samples; together {together:.2} s of processor time, alone {alone:.2} s: {:.2}; {most:.1?} MB",
        together / alone
    );
    assert!(together <= 1.2 * alone);
    assert!(most.iter().all(|most| *most < 200.0));

    let Some(python) = std::env::var_os("FLEET_PYTHON") else { return };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../bindings/python/tests/fleet.py");
    let channels_of = CHANNELS.map(|(kind, names)| format!("{kind}={names}"));
    let (logs, to) = (at("logs").display().to_string(), at("dask").display().to_string());
    let given = [logs, to].into_iter().chain(channels_of).collect::<Vec<_>>();
    let [idle, dask] = [&[][..], &given].map(|arguments| {
        let start = spent();
        let status = Command::new(&python).arg(&script).args(arguments).status();
        assert!(status.unwrap().success());
        spent() - start
    });
    println!("Dask {dask:.2} s, of which {idle:.2} s without logs: {:.2}", dask / alone);
    for file in parts(&out).iter().map(String::as_str).chain(["manifest.jsonl", "dataset.json"]) {
        assert!(
            fs::read(out.join(file)).unwrap() == fs::read(at("dask").join(file)).unwrap(),
            "{file}"
        );
    }
    assert_eq!(parts(&out).len(), parts(&at("dask")).len());
    assert!(dask <= 1.2 * alone);
}
