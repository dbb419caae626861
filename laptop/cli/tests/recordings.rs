//! Reads recordings as loggers, viewers and ground stations write them. The files in the directory `recordings` were made
//! for these tests, after layouts and faults of real ones.

mod common;

use common::{file, good, ran, refused, spikewire};
use serde_json::Value;
use std::fmt::Write as _;

/// Returns the path of a file in the directory `recordings`.
fn path(name: &str) -> String {
    format!("{}/tests/recordings/{name}", env!("CARGO_MANIFEST_DIR"))
}

/// Returns what `info --json` says of a log.
fn info(path: &str) -> Value {
    ran!("info --json {path}").log()
}

fn topic<'a>(info: &'a Value, name: &str) -> &'a Value {
    let topics = info["topics"].as_array().unwrap();
    topics.iter().find(|topic| topic["name"] == name).unwrap()
}

fn columns(info: &Value) -> Vec<&str> {
    let columns = info["columns"].as_array().unwrap();
    columns.iter().map(|column| column["name"].as_str().unwrap()).collect()
}

fn is_noted(info: &Value, words: &str) -> bool {
    info["notes"].as_array().unwrap().iter().any(|note| note.as_str().unwrap().contains(words))
}

/// Returns the decoded values of a channel that is encoded without loss.
fn values(options: &str, path: &str) -> Vec<f64> {
    let table = ran!("encode --scheme position --neurons 1024 {options} {path}");
    common::values(&good("decode", &table.output).output)
}

/// Returns 16 000 samples of a sine at 800 Hz that arrive in packets of 8, 10 ms apart.
fn packets() -> String {
    let row = |at: u32| {
        let time = f64::from(at / 8) * 0.01 + f64::from(at % 8) * 0.00005;
        let value = (std::f64::consts::TAU * 1.5 * f64::from(at) / 800.0).sin();
        format!("{time:.6},{value:.6}\n")
    };
    "time,gyro_x\n".to_owned() + &(0..16_000).map(row).collect::<String>()
}

#[test]
fn packets_have_the_rate_of_their_samples() {
    let (_directory, table) = file("b.csv", packets());
    let log = info(&table);
    assert!((log["rate"].as_f64().unwrap() - 800.0).abs() < 1e-6);
    let times = log["times"].as_str().unwrap();
    assert!(times.starts_with("0 gaps above"), "{times}");
    assert!(
        times.contains("800.00 Hz by samples through length, 20000.00 Hz by the median step"),
        "{times}"
    );
    let encoded = ran!("encode --scheme sf --threshold 0.1 {table}").output;
    assert!(encoded.contains("# rate=800\n"), "{}", &encoded[..200]);
    let given = ran!("encode --scheme sf --threshold 0.1 --rate 750 {table}").output;
    assert!(given.contains("# rate=750\n"), "{}", &given[..200]);
    // No period is written, and no advice given, unless the rate is.
    let words = ["800.00 Hz by samples through length", "--rate says how many a second are taken"];
    let advise = "advise --evaluations 3 --max-rmse 0.1";
    refused(&format!("{advise} {table}"), "", &words);
    let report = ran!("{advise} --rate 800 {table}").output;
    assert!(
        report.contains("800 a second, jitter 3.") && report.contains(" ms, 0 gaps"),
        "{report}"
    );
    let tune = "tune --scheme sf --max-rmse 0.1 --evaluations 3 --emit flight";
    refused(&format!("{tune} {table}"), "", &words);
    assert!(ran!("{tune} --rate 800 {table}").output.contains("period = 1250 "));
    let (directory, _) = file("unused", "");
    let set = directory.path().join("set").display().to_string();
    ran!("dataset --scheme sf --threshold 0.1 --test 0 {table} -o {set}");
    let manifest = std::fs::read_to_string(format!("{set}/manifest.jsonl")).unwrap();
    assert!(manifest.contains("\"rate\":null") && manifest.contains("by the median step"));
}

#[test]
fn a_rate_that_no_sensor_has_asks_for_the_unit() {
    for (name, rate) in [("ts_ms.csv", "250000.00"), ("time_ms.csv", "0.25")] {
        let table = path(name);
        let words = format!("would be {rate} samples a second; --time-unit says their unit");
        refused(&format!("info {table}"), "", &[&words]);
        assert!(ran!("info --time-unit ms {table}").output.contains("0.396 s, 250.00 Hz"));
    }
    // A name with its unit is no guess.
    let rows = (0..20).map(|row| format!("{},1\n", row * 10)).collect::<Vec<_>>().concat();
    assert!(good("info -", &format!("time_s,x\n{rows}")).output.contains("0.10 Hz"));
}

#[test]
fn columns_are_hidden_only_if_they_count_the_rows() {
    assert_eq!(columns(&info(&path("hidden_I.csv"))), ["I", "Q"]);
    let rows =
        (0..20).map(|row| format!("{row},{},{}\n", row * 5, row % 3)).collect::<Vec<_>>().concat();
    let ran = good("info -", &format!("sample,t_ms,i\n{rows}"));
    assert!(ran.output.contains("\n  i\n"), "{}", ran.output);
    assert!(
        ran.output.contains("column `sample` counts the rows and is left out"),
        "{}",
        ran.output
    );
    let rows = rows.replace("3,15,", "2,15,");
    assert!(good("info -", &format!("sample,t_ms,i\n{rows}")).output.contains("\n  sample, i\n"));
}

#[test]
fn a_name_of_two_columns_is_reported() {
    let table = path("dup.csv");
    let ran = ran!("score --scheme sf --threshold 0.5 --column A {table}");
    let words = "2 columns are called `A`; the one that is read is column 2";
    assert!(ran.output.contains(words) || ran.stderr.contains(words), "{}", ran.stderr);
    assert!(is_noted(
        &info(&table),
        "2 columns are called `A`; those that are read are column 2, 3"
    ));
}

#[test]
fn headers_are_found_below_other_lines() {
    let dji = info(&path("dji_sep.csv"));
    assert_eq!((columns(&dji), &dji["rate"]), (vec!["OSD.pitch"], &Value::from(10.0)));
    assert!(is_noted(&dji, "times in s from column `OSD.flyTime [s]`"));
    let explorer = info(&path("bbexplorer.csv"));
    assert_eq!((columns(&explorer), &explorer["samples"]), (vec!["gyroADC[0]"], &Value::from(400)));
    assert_eq!(explorer["rate"], Value::from(250.0));
    assert!(is_noted(&explorer, "the header is line 31; the lines above it are left out"));
    // An error names the line in the file.
    let text = std::fs::read_to_string(path("bbexplorer.csv")).unwrap();
    let odd = text.replace("16,50008000,2\n", "16,50008000,two\n");
    refused("score --scheme sf --threshold 1 --column gyroADC[0] -", &odd, &["line 34"]);

    let rows =
        (0..20).map(|row| format!("{},{},{row}\n", row * 5, row % 3)).collect::<Vec<_>>().concat();
    let header = "Time,gyro,acc\n";
    for above in [
        "Logger 3\nDate,2024-05-01\n\n",
        "Rate,100\nGain,5\nSerial,abc\n",
        "Format Version,1.23,Take Name,x\n\n,,\n",
    ] {
        let table = format!("{above}{header}ms,deg/s,g\n{rows}");
        let ran = good("info -", &table);
        let words = [
            "the header is line",
            "the line below the header holds units",
            "times in ms from column `Time`",
            "0.095 s, 200.00 Hz",
            "  gyro (deg/s), acc (g)\n",
        ];
        assert!(words.iter().all(|words| ran.output.contains(words)), "{above}: {}", ran.output);
        for column in ["gyro", "2"] {
            good(&format!("score --scheme sf --threshold 1 --column {column} -"), &table);
        }
    }
    // Lines that look like a table above the table: only the user knows.
    let table = format!("gain,offset,unit\n1,2,3\n4,5,6\n{header}{rows}");
    refused("info --time-unit ms -", &table, &[]);
    let ran = good("info --header 4 --time-unit ms -", &table);
    assert!(ran.output.contains("20 rows, 0.095 s, 200.00 Hz"), "{}", ran.output);
    let ran = good("info --header 1 -", &format!("# t_ms x y\n{}", rows.replace(',', " ")));
    assert!(ran.output.contains("\n  x, y\n"), "{}", ran.output);
    // A comment that names more columns than there are, or fewer.
    for (names, rest) in [
        ("t_ms,x,y,z", "line 1 has 4 names for 3 columns; the first 3 are taken"),
        (
            "t_ms,x",
            "line 1 has 2 names for 3 columns; the columns behind them are called by their number",
        ),
    ] {
        let table = format!("# {names}\n{rows}");
        let ran = good("info -", &table);
        let words = "the comment in line 1 may hold other names than 3; --header 1 takes them";
        assert!(
            ran.output.contains(words) && ran.output.contains("\n  1, 2, 3\n"),
            "{}",
            ran.output
        );
        let words =
            ["no column `x`; there are 1, 2, 3; --header 1 takes the names of the comment there"];
        refused("score --scheme sf --threshold 1 --column x -", &table, &words);
        let ran = good("info --header 1 -", &table);
        assert!(ran.output.contains(rest) && ran.output.contains("200.00 Hz\n"), "{}", ran.output);
    }
    // One whose names are surely those of the columns, however they are separated.
    for (comment, names) in [
        ("# t_ms x y", "x, y"),
        ("# t (ms) x (m) y (m)", "x (m), y (m)"),
        ("# Columns: t_ms, x, y", "x, y"),
        ("# fields: t_ms x y", "x, y"),
        ("// t_ms, x, y", "x, y"),
    ] {
        for delimiter in [",", " ", ";"] {
            let table = format!("{comment}\n{}", rows.replace(',', delimiter));
            let ran = good("info -", &table);
            let is_named = ran.output.contains(&format!("\n  {names}\n"));
            assert!(is_named && ran.output.contains("200.00 Hz"), "{table:.60}: {}", ran.output);
        }
    }
    // Words of a sentence are no names.
    assert!(good("info -", &format!("# made by me\n{rows}")).output.contains("\n  1, 2, 3\n"));
}

#[test]
fn rows_longer_than_the_header_are_named_with_the_line_to_type() {
    let rows = (0..20).map(|row| format!("{},{}\n", row * 5, row % 3)).collect::<Vec<_>>().concat();
    // All rows: only the user knows which column has no name.
    let long = rows.replace('\n', ",7\n");
    let table = format!("t_ms,x\n{long}");
    let words = "line 2 has 3 columns where the header has 2; --header 1 takes its names for the first columns";
    refused("info -", &table, &[words]);
    let ran = good("info --header 1 -", &table);
    assert!(
        ran.output.contains("\n  x, 3\n") && ran.output.contains("200.00 Hz"),
        "{}",
        ran.output
    );
    // A few rows: they are left out if the user says so.
    let table = format!("t_ms,x\n{}", rows.replace("25,2\n", "25,2,9\n").replace("45,0\n", "45\n"));
    let words =
        "line 7 has 3 columns where the header has 2; --skip-non-finite leaves such lines out";
    refused("info -", &table, &[words]);
    let score = "score --scheme sf --threshold 1";
    refused(&format!("{score} -"), &table, &[words]);
    let ran = good(&format!("{score} --skip-non-finite --json -"), &table).log();
    assert_eq!(ran["schemes"][0]["samples"], Value::from(18));
    assert!(is_noted(
        &ran,
        "2 lines have another number of columns than the header and are left out, the first in line 7"
    ));
}

#[test]
fn records_of_a_flysight_2_are_read_by_their_kind() {
    let mut log =
        "$FLYS,1\n$VAR,FIRMWARE_VER,v2023.09.22\n$COL,BARO,time,pressure\n$COL,IMU,time,wx,wy\n\
                   $UNIT,BARO,s,Pa\n$UNIT,IMU,s,deg/s,deg/s\n$DATA\n"
            .to_owned();
    for row in 0..400 {
        let time = f64::from(row) * 0.01;
        writeln!(log, "$IMU,{time:.3},{},{}", row % 7, row % 5).unwrap();
        if row % 10 == 0 {
            writeln!(log, "$BARO,{time:.3},{}", 101_325 - row).unwrap();
        }
    }
    let (_directory, path) = file("SENSOR.CSV", &log);
    let imu = info(&path);
    assert_eq!(columns(&imu), ["wx (deg/s)", "wy (deg/s)"]);
    assert_eq!((&imu["samples"], &imu["rate"]), (&Value::from(400), &Value::from(100.0)));
    assert!(is_noted(
        &imu,
        "a file of a FlySight 2: records IMU of BARO, IMU; --topic chooses others"
    ));
    let wy = values("--column wy --min 0 --max 8", &path);
    assert!((0..400).all(|row| (wy[row] - (row % 5) as f64).abs() < 0.01), "{wy:?}");
    let baro = ran!("encode --scheme sf --threshold 1 --topic BARO --column pressure {path}");
    assert!(baro.output.contains("# rate=10\n"), "{}", baro.stderr);
    refused(
        &format!("encode --scheme sf --threshold 1 --topic GNSS --column lat {path}"),
        "",
        &["no topic `GNSS`; there are BARO, IMU"],
    );
    // An error names the line in the file.
    let odd = log.replace("$IMU,0.030,3,3\n", "$IMU,0.030,3,three\n");
    refused("encode --scheme sf --threshold 1 --column wy -", &odd, &["line 12", "`three`"]);
    refused(
        "encode --scheme sf --threshold 1 --topic IMU --column x -",
        "x\n1\n",
        &["a CSV table takes no --topic"],
    );
}

#[test]
fn tables_as_loggers_write_them() {
    let rows = (0..20).map(|row| format!("{},{}\n", row * 5, row % 3)).collect::<Vec<_>>().concat();
    // The header again, as where files were joined; comments of two kinds; a delimiter at the end of each row.
    let twice = format!("t_ms,x\n{rows}t_ms,x\n{rows}");
    let ran = good("info -", &twice);
    assert!(ran.output.contains("40 rows") && ran.output.contains("1 lines repeat the header"));
    let comments = format!("// made by\nt_ms,x\n// unit: m\n{rows}//end\n# end\n");
    let ran = good("info -", &comments);
    assert!(ran.output.contains("20 rows") && ran.output.contains("3 lines below the header"));
    let long = format!("t_ms,x\n{}", rows.replace('\n', ",\n"));
    assert!(good("info -", &long).output.contains("20 rows"));
    for missing in ["1.#QNAN", "-1.#IND", "-nan(ind)", "?", "--"] {
        let ran = good("info -", &format!("t_ms,x\n{rows}100,{missing}\n"));
        let words = "x: missing or not finite in 1 row";
        assert!(ran.output.contains(words), "{missing}: {}", ran.output);
    }
}

#[test]
fn samples_have_the_times_of_their_columns() {
    let rows = (0..40).map(|row| format!("{},{row},{},{row}\n", row * 5, 1000 + row * 10));
    let table = format!("gyro.time_ms,gyro,time_ms,acc\n{}", rows.collect::<String>());
    let table = table.replace("gyro.time_ms", "t_ms");
    for (column, rate) in [("gyro", "200"), ("acc", "100")] {
        let ran = good(&format!("encode --scheme sf --threshold 0.5 --column {column} -"), &table);
        assert!(ran.output.contains(&format!("# rate={rate}\n")), "{column}: {}", ran.stderr);
        assert!(ran.stderr.contains("columns t_ms, time_ms hold times"), "{}", ran.stderr);
    }
    // The sensor's own stamps come before those of arrival.
    let rows = (0..40).map(|row| format!("{},{},{row}\n", row / 8 * 40_000_000, row * 5_000_000));
    let table = format!("%time,field.header.stamp,field.x\n{}", rows.collect::<String>());
    let ran = good("info -", &table);
    assert!(ran.output.contains("from column `field.header.stamp`"), "{}", ran.output);
    assert!(ran.output.contains("0.195 s, 200.00 Hz"), "{}", ran.output);
}

#[test]
fn tables_of_records_and_of_polars() {
    let records = info(&path("records.json"));
    assert_eq!((columns(&records), &records["samples"]), (vec!["gyro_x"], &Value::from(20)));
    let text = std::fs::read_to_string(path("records.json")).unwrap();
    let pretty = text.replace("[{", "[\n  {\n").replace("},{", "\n  },\n  {\n").replace(',', ",\n");
    assert!(good("info -", &pretty).output.contains("20 rows, 0.190 s, 100.00 Hz"));
    let escaped = r#"[{"a": "x],{\"", "b": 1}, {"a": "\\", "b": 2}]"#;
    assert!(good("info -", escaped).output.contains("standard input: 2 rows"));
    let cut = &text[..text.len() - 9];
    assert!(spikewire("info -", cut).stderr.contains("the JSON array has no end"));

    let odd = info(&path("p_odd.parquet"));
    let decimal = odd["columns"].as_array().unwrap().iter().find(|own| own["name"] == "dec");
    assert_eq!(decimal.unwrap()["missing"], Value::from(0));
    let dec = values("--column dec --min 1 --max 1.5", &path("p_odd.parquet"));
    assert!(dec.len() == 400 && dec.iter().all(|value| (value - 1.25).abs() < 1e-3), "{dec:?}");
    let polars = info(&path("pl_default.parquet"));
    assert_eq!((columns(&polars), &polars["samples"]), (vec!["gyro_x"], &Value::from(400)));
}

#[test]
fn blackbox_logs_with_faults() {
    for (name, is_behind) in [("slow_first.bbl", false), ("newline.bbl", true)] {
        let log = info(&path(name));
        assert_eq!(topic(&log, "main")["samples"], Value::from(200), "{name}");
        let slow = topic(&log, "slow");
        assert!(slow["seconds"].as_f64().unwrap() < 0.199 && slow["gaps"] == 0, "{name}: {slow}");
        let gps = topic(&log, "gps");
        assert!(gps["seconds"].as_f64().unwrap() < 0.199 && gps["gaps"] == 0, "{name}: {gps}");
        let words = "the log begins at byte 1; what is before it is not read";
        assert_eq!(is_noted(&log, words), is_behind, "{name}");
    }
    let lost = info(&path("lost_field.bbl"));
    let words = "the frames have 1 field more than the header names, perhaps behind `gyroADC[0]`";
    assert!(is_noted(&lost, words), "{}", lost["notes"]);
    assert!(topic(&lost, "slow")["seconds"].as_f64().unwrap() < 0.2);
    let log = std::fs::read_to_string(path("slow_first.bbl").as_str());
    assert!(log.is_err(), "the log is no text");
    let bytes = std::fs::read(path("slow_first.bbl")).unwrap();
    let place = bytes.windows(9).position(|own| own == b"6,2,1,1\nH").unwrap();
    let mut unknown = bytes.clone();
    unknown[place] = b'7';
    unknown.splice(place..=place, *b"17");
    let (_directory, log) = file("unknown.bbl", unknown);
    refused(
        &format!("info {log}"),
        "",
        &["predictor 17 of field `loopIteration` in frames P is not known"],
    );
    // Erased flash, and damage, behind good frames.
    let end = bytes.windows(12).position(|own| own == b"E\xffEnd of log").unwrap();
    for rest in [vec![0xff; 600], vec![0; 20], vec![0x81; 40]] {
        let (_directory, log) = file("blank.bbl", [&bytes[..end], &rest].concat());
        let log = info(&log);
        assert_eq!(topic(&log, "main")["samples"], Value::from(200), "{}", log["notes"]);
    }
}

#[test]
fn ardupilot_logs_with_faults() {
    let log = info(&path("d_ff.bin"));
    assert_eq!(topic(&log, "AAA")["samples"], Value::from(30));
    assert!(is_noted(&log, "the last 512 bytes, from byte 628 on, are blank, as erased flash is"));
    let log = info(&path("d_nofmt.bin"));
    assert_eq!(topic(&log, "DCM")["samples"], Value::from(50));
    // Before damage a whole message counts; one of which bytes are missing does not.
    let bytes = std::fs::read(path("d_ff.bin")).unwrap();
    let end = 628;
    let damaged = [&bytes[..end], b"damaged", &bytes[end - 45..end]].concat();
    let (_directory, log) = file("damaged.bin", damaged);
    refused(&format!("info {log}"), "", &["byte 628: 7 bytes are no messages"]);
    let ran = ran!("info --json --accept-cut {log}").log();
    assert_eq!(topic(&ran, "AAA")["samples"], Value::from(33));
    let short = [&bytes[..end - 3], &bytes[end - 45..end]].concat();
    let (_directory, log) = file("short.bin", short);
    let ran = ran!("info --json --accept-cut {log}").log();
    assert_eq!(topic(&ran, "AAA")["samples"], Value::from(32));
    // A log of sdlog2 has its times in messages of their own.
    let format = |kind: u8, length: u8, name: &[u8; 4], letters: &str, columns: &str| {
        let mut message = vec![0xa3, 0x95, 0x80, kind, length];
        message.extend(name);
        message.extend(format!("{letters:\0<16}{columns:\0<64}").bytes());
        message
    };
    let mut log = format(129, 11, b"TIME", "Q", "StartTime");
    log.extend(format(2, 7, b"IMU\0", "f", "GyroX"));
    for sample in 0..50_u16 {
        log.extend([0xa3, 0x95, 129]);
        log.extend((2_000_000 + u64::from(sample) * 5000).to_le_bytes());
        log.extend([0xa3, 0x95, 2]);
        log.extend(f32::from(sample).to_le_bytes());
    }
    let (_directory, log) = file("sdlog2.bin", log);
    let imu = &info(&log);
    assert_eq!(topic(imu, "IMU")["rate"], Value::from(200.0));
}

#[test]
fn telemetry_without_times_of_arrival() {
    let path = path("t_zerotime.tlog");
    let log = info(&path);
    let attitude = topic(&log, "ATTITUDE");
    assert_eq!((&attitude["samples"], &attitude["rate"]), (&Value::from(50), &Value::from(100.0)));
    assert_eq!(attitude["stamp"], "time_boot_ms");
    assert!(is_noted(&log, "50 packets have the time of arrival 0"));
    let encode = "encode --scheme sf --threshold 0.001 --topic ATTITUDE --field roll";
    let ran = ran!("{encode} {path}");
    assert!(ran.output.contains("# rate=100\n"), "{}", ran.stderr);
    assert!(ran.stderr.contains("times are the sensor's own, `time_boot_ms`"), "{}", ran.stderr);
    let recorded = ran!("{encode} --time recorded {path}");
    assert!(!recorded.output.contains("# rate="), "{}", recorded.output);
    // Bytes before the first packet are damage, and a message without a layout is named.
    let bytes = std::fs::read(&path).unwrap();
    let unknown = [&[0; 8][..], &[0xfe, 2, 0, 1, 1, 42, 7, 0, 0, 0]].concat();
    let (_directory, log) = file("behind.tlog", [b"abc", &bytes[..], &unknown, &bytes].concat());
    let log = ran!("info --json --accept-cut {log}").log();
    assert_eq!(topic(&log, "ATTITUDE")["samples"], Value::from(100));
    assert!(is_noted(&log, "passed over: 1 MISSION_CURRENT"), "{}", log["notes"]);
}

#[test]
fn a_ulog_with_an_unknown_incompatible_flag_is_refused() {
    let path = path("u_incompat.ulg");
    for options in ["", "--accept-cut"] {
        refused(&format!("info {options} {path}"), "", &["an incompatible flag that is not known"]);
    }
    // Without the flag, it is read, also with zeros behind its end.
    let mut bytes = std::fs::read(&path).unwrap();
    bytes[19 + 8] = 0;
    bytes.extend([0; 300]);
    let (_directory, log) = file("zeros.ulg", bytes);
    let log = info(&log);
    assert_eq!(topic(&log, "a")["samples"], Value::from(20));
    assert!(is_noted(&log, "the last 300 bytes"), "{}", log["notes"]);
}

#[test]
fn a_bag_with_zeros_before_its_index_is_read() {
    use flight_logs::made::{Kind, record};
    let index: [(&str, &[u8]); 4] =
        [("op", &[4]), ("ver", &[1, 0, 0, 0]), ("conn", &[0; 4]), ("count", &[1, 0, 0, 0])];
    let index = record(&index, &[0; 12]);
    let zeros = [Kind::Bag.log("none"), vec![0; 4096], index].concat();
    let (_directory, log) = file("zeros.bag", zeros);
    let log = info(&log);
    assert_eq!(topic(&log, "/imu")["samples"], Value::from(100));
    assert!(is_noted(&log, "4096 zeros where a record should begin"), "{}", log["notes"]);
}

/// The codes that spread a range over neurons, times or chances clamp what is outside of it, or are silent there.
#[test]
fn samples_outside_the_range_are_reported_once_with_their_share() {
    let is_ranged = |info: &&catalogue::Info| {
        let has = |name| info.parameters.iter().any(|own| own.name == name);
        has("min") && has("max")
    };
    let ranged: Vec<_> = catalogue::INFO.iter().filter(is_ranged).collect();
    assert_eq!(ranged.len(), 14);
    let rows = |values: [i32; 4]| {
        "x\n".to_owned() + &values.map(|value| format!("{value}\n")).concat().repeat(25)
    };
    let (directory, outside) = file("outside.csv", rows([150, 0, 50, 100]));
    let (_inside, inside) = file("inside.csv", rows([-100, 0, 50, 100]));
    let picture = directory.path().join("x.svg").display().to_string();
    let words = "25 of 100 samples, 25 %, lie outside the code's range, min -100 to max 100";
    for info in ranged {
        let options = format!("--scheme {} --paper --min -100 --max 100", info.name);
        for (command, output) in [("encode", "-"), ("score", ""), ("plot", &*picture)] {
            let output = if output.is_empty() { String::new() } else { format!("-o {output}") };
            let ran = ran!("{command} {options} {outside} {output}");
            let count = ran.stderr.matches("lie outside").count();
            assert!(
                ran.stderr.contains(words) && count == 1,
                "{command} {options}: {}",
                ran.stderr
            );
            let ran = ran!("{command} {options} {inside} {output}");
            assert!(!ran.stderr.contains("lie outside"), "{command} {options}: {}", ran.stderr);
        }
        let set = directory.path().join(info.name).display().to_string();
        ran!("dataset {options} --test 0 {outside} -o {set}");
        let manifest = std::fs::read_to_string(format!("{set}/manifest.jsonl")).unwrap();
        assert!(manifest.contains(words), "{manifest}");
    }
}

/// Networks as snnTorch exports them: with weights of half precision, and with neurons that keep all of their potential.
#[test]
fn networks_of_half_precision_are_read_and_beta_1_is_explained() {
    let (_directory, steps) = file("steps.txt", "0\n1 2\n\n3\n0 1\n2 3\n".repeat(20));
    let network = |name: &str| {
        let of = path(name);
        format!("network {of} {steps} --as snntorch --reset to-value --on controller")
    };
    let ran = ran!("{}", network("half.nir"));
    assert!(ran.output.contains("-0.178"), "{}", ran.output);
    let words = ["`tau` holds inf, as snnTorch exports beta=1", "export it as IF"];
    refused(&network("beta_1.nir"), "", &words);
}
