//! Tests of `encode` and `decode` with several channels in one file of spikes.

mod common;

use common::{events, file, flight, flight_logs, good, ran, refused, spikewire};
use flight_logs::made::{Kind, blackbox, dataflash, dataflash_text, tlog};

const COLUMNS: [&str; 6] = ["gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z"];

/// Schemes with their options, and the number of neurons that each scheme has for one column.
const SCHEMES: [(&str, usize); 6] = [
    ("sf --threshold 0.1", 1),
    ("tbr --factor 0.5", 1),
    ("mw --threshold 0.2 --window 5", 1),
    ("hsa --paper", 1),
    ("position --neurons 20", 20),
    ("grf-slots --neurons 15 --slots 10", 15),
];

#[test]
fn each_channel_is_as_if_alone_at_addresses_by_column() {
    let hexarotor = flight("hexarotor.csv");
    for (scheme, neurons) in SCHEMES {
        let all = ran!("encode --scheme {scheme} --columns {} {hexarotor}", COLUMNS.join(","));
        assert!(all.stderr.contains("3627 samples of 6 channels"), "{}", all.stderr);
        let together = events(&all.output);
        let decoded = good("decode", &all.output).output;
        assert!(decoded.starts_with(&format!("index,{},time_us\n", COLUMNS.join(","))));
        let mut count = 0;
        for (channel, column) in COLUMNS.iter().enumerate() {
            let alone = ran!("encode --scheme {scheme} --column {column} {hexarotor}").output;
            let channel_events: Vec<_> = together
                .iter()
                .filter(|event| event.1 / neurons == channel)
                .map(|&(index, address, polarity)| (index, address % neurons, polarity))
                .collect();
            assert_eq!(channel_events, events(&alone), "{scheme} {column}");
            count += channel_events.len();
            let values = good("decode", &alone).output;
            let values = values.lines().skip(1).map(|line| line.split(',').nth(1));
            let column = decoded.lines().skip(1).map(|line| line.split(',').nth(1 + channel));
            assert!(values.eq(column), "{scheme} {channel}");
        }
        assert_eq!(count, together.len(), "{scheme}");
        assert!(together.is_sorted_by_key(|event| event.0), "{scheme}");
    }
}

#[test]
fn columns_may_be_named_one_by_one_and_logs_take_several_fields() {
    let hexarotor = flight("hexarotor.csv");
    let sf = "encode --scheme sf --threshold 0.002";
    let three = ran!("{sf} --columns gyro_x,gyro_y,gyro_z {hexarotor}").output;
    let named = ran!("{sf} --column gyro_x --column 3 --column gyro_z {hexarotor}").output;
    assert_eq!(three, named);
    let fields = "gyro_rad[0],gyro_rad[1],gyro_rad[2]";
    let log = flight_logs()[0].display().to_string();
    let logged = ran!("{sf} --topic sensor_combined --fields {fields} {log}").output;
    assert_eq!(events(&logged), events(&three));
    let stream = good("convert --from csv --to csv", &three).output;
    assert_eq!(stream.lines().count(), 1 + events(&three).len());
}

#[test]
fn a_parameter_may_have_a_value_for_each_channel() {
    let table = "a,b\n0,0\n1,1\n2,2\n0,0\n";
    let encode = |options: &str| good(&format!("encode --scheme sf {options} -"), table).output;
    let both = encode("--threshold 0.5,1.5 --columns a,b");
    assert!(both.contains("# threshold@0=0.5\n") && both.contains("# threshold@1=1.5\n"));
    let alone = |column: &str, threshold: &str| {
        let output = encode(&format!("--threshold {threshold} --column {column}"));
        output.lines().filter(|line| line.starts_with(|first: char| first.is_ascii_digit())).count()
    };
    let spikes = both.lines().filter(|line| line.starts_with(|first: char| first.is_ascii_digit()));
    assert_eq!(spikes.count(), alone("a", "0.5") + alone("b", "1.5"));
    let words = ["--threshold has 2 values, one a channel, for 1 channel"];
    refused("encode --scheme sf --threshold 1,2 --column a -", table, &words);
}

const SF: &str = "--scheme sf --threshold 0.05";

/// Returns the line of a file of spikes that begins with `# KEY=`.
fn origin(spikes: &str, key: &str) -> String {
    let start = format!("# {key}=");
    spikes.lines().find_map(|line| line.strip_prefix(&start)).unwrap_or_default().to_owned()
}

#[test]
fn the_sensor_that_flew_is_found_in_every_format() {
    let [log, _] = flight_logs().map(|log| log.display().to_string());
    let six = "gyro_rad[0],gyro_rad[1],gyro_rad[2],accelerometer_m_s2[0],accelerometer_m_s2[1],accelerometer_m_s2[2]";
    let ran = ran!("encode {SF} {log}");
    assert_eq!(origin(&ran.output, "topic"), "sensor_combined");
    assert_eq!(origin(&ran.output, "field"), six);
    let reads = format!(
        "{log}: reads gyro_rad[0..3] (rad/s), accelerometer_m_s2[0..3] (m/s²) of sensor_combined, 199 Hz"
    );
    let line = ran.stderr.lines().find(|line| line.contains(": reads ")).unwrap();
    assert!(line.starts_with(&reads) && line.ends_with("; --channels chooses others"), "{line}");
    let named = ran!("encode {SF} --topic sensor_combined --fields {six} {log}");
    assert_eq!(named.output, ran.output);
    assert!(!named.stderr.contains(": reads "), "{}", named.stderr);

    let gyros = "gyroADC[0],gyroADC[1],gyroADC[2]";
    for (name, bytes, topic, fields, words) in [
        ("a.bbl", blackbox(), "main", gyros, "gyroADC[0..3] (deg/s) of main, 4000 Hz"),
        ("a.bin", dataflash(), "IMU", "GyrX,GyrY", "GyrX, GyrY (rad/s) of IMU, 200 Hz; other"),
        ("a.log", dataflash_text().into_bytes(), "IMU", "GyrX,GyrY", "of IMU, 200 Hz; other"),
        (
            "a.tlog",
            tlog(),
            "RAW_IMU",
            "xgyro,ygyro,zgyro,xacc,yacc,zacc",
            "zacc (unit unknown) of RAW_IMU, 200 Hz; other sensors: RAW_IMU:1; ",
        ),
    ] {
        let (_directory, path) = file(name, bytes);
        let ran = ran!("encode {SF} --skip-non-finite {path}");
        assert_eq!(origin(&ran.output, "topic"), topic, "{name}");
        assert_eq!(origin(&ran.output, "field"), fields, "{name}");
        assert!(ran.stderr.contains(&format!("{path}: reads ")), "{name}: {}", ran.stderr);
        assert!(ran.stderr.contains(words), "{name}: {}", ran.stderr);
    }

    let table = "time_us,battery,gyro_x_dps,gyro_y_dps,gyro_z_dps\n0,7,1,2,3\n2000,7,2,3,4\n";
    let ran = good(&format!("encode {SF} -"), table);
    assert_eq!(origin(&ran.output, "column"), "gyro_x_dps,gyro_y_dps,gyro_z_dps");
    let words = "reads gyro_x_dps, gyro_y_dps, gyro_z_dps (deg/s), 500 Hz in the first rows; ";
    assert!(ran.stderr.contains(words), "{}", ran.stderr);
}

/// `advise` without an option reads the sensor that flew; of a table in which no name tells one, all columns.
#[test]
fn advice_on_a_log_needs_no_channels() {
    let [log, _] = flight_logs().map(|log| log.display().to_string());
    let ran = ran!("advise {log} --evaluations 2 --json");
    let report = ran.log();
    let names: Vec<&str> = report["channels"]
        .as_array()
        .unwrap()
        .iter()
        .map(|own| own["look"]["name"].as_str().unwrap())
        .collect();
    assert_eq!(names[..2], ["gyro_rad[0]", "gyro_rad[1]"]);
    assert_eq!(names.len(), 6);
    assert!(report["notes"].to_string().contains("of sensor_combined"), "{}", report["notes"]);
    let rows: Vec<String> = (0..200).map(|row| format!("{row},{}", row * row % 17)).collect();
    let table = format!("x,y\n{}\n", rows.join("\n"));
    let ran = good("advise - --evaluations 2 --json --rate 100", &table);
    assert_eq!(ran.log()["channels"].as_array().unwrap().len(), 2);
}

#[test]
fn channels_are_named_in_one_way_for_tables_and_logs() {
    let [log, _] = flight_logs().map(|log| log.display().to_string());
    let hexarotor = flight("hexarotor.csv");
    let three = ran!("encode {SF} --columns gyro_x,gyro_y,gyro_z {hexarotor}").output;
    for names in
        ["--channels gyro_*", "--channels gyro_?", "--channel 2,gyro_y,gyro_z", "--column gyro_*"]
    {
        assert_eq!(ran!("encode {SF} {names} {hexarotor}").output, three, "{names}");
    }
    let fields = "gyro_rad[0],gyro_rad[1],gyro_rad[2]";
    let three = ran!("encode {SF} --topic sensor_combined --fields {fields} {log}").output;
    for names in [
        "--channels gyro_rad[*]",
        "--channels gyro_rad[0..3]",
        "--channels sensor_combined.gyro_rad[0..3]",
        "--channels sensor_c*.gyro_rad[?]",
        "--topic sensor_combined --field gyro_rad[0..3]",
        "--topic sensor_combined --channels gyro_rad[*]",
    ] {
        assert_eq!(ran!("encode {SF} {names} {log}").output, three, "{names}");
    }
    // Commands that take one channel do not take the first of several.
    for command in ["score", "plot -o a.svg"] {
        refused(
            &format!("{command} {SF} --channels gyro_* {hexarotor}"),
            "",
            &["takes one column or field, not 3"],
        );
    }
    let words = ["several topics, ", "such as 'actuator_motors.*timestamp*'"];
    refused(&format!("encode {SF} --channels *timestamp* {log}"), "", &words);
    refused(
        &format!("encode {SF} --channels altimeter[*] {log}"),
        "",
        &["no channel `altimeter[*]`; near it are "],
    );
    let (_directory, bag) = file("a.bag", Kind::Bag.log("none"));
    let rate = ran!("encode {SF} --topic imu --field rate {bag}").output;
    for channels in ["rate", "imu.rate", "/imu.rate", "*imu.rate"] {
        let encoded = ran!("encode {SF} --channels {channels} {bag}").output;
        assert_eq!(events(&encoded), events(&rate), "{channels}");
    }
}

/// A refusal ends with a command that succeeds, and each name that a message suggests is taken.
#[test]
fn suggestions_are_taken() {
    let [log, other] = flight_logs().map(|log| log.display().to_string());
    let (_directory, bag) = file("a.bag", Kind::Bag.log("none"));
    for log in [&log, &other, &bag] {
        let ran = spikewire(&format!("score {SF} --skip-non-finite {log}"), "");
        assert_eq!(ran.status, 2, "{}", ran.stderr);
        assert!(
            ran.stderr.contains("a log needs --channels, such as --channels '"),
            "{}",
            ran.stderr
        );
        let line = ran.stderr.lines().last().unwrap().trim().replace('\'', "");
        ran!("{}", line.strip_prefix("spikewire ").unwrap());
    }
    let asked = format!("encode {SF} --topic sensor_combined --field gyro_rads {log}");
    let ran = spikewire(&asked, "");
    let (_, near) =
        ran.stderr.split_once("near it are ").unwrap_or_else(|| panic!("{}", ran.stderr));
    let near = near.split(';').next().unwrap();
    assert!(near.contains("gyro_rad[0..3]"), "{near}");
    for name in near.split(", ") {
        ran!("encode {SF} --topic sensor_combined --field {name} {log}");
    }
    let table = "time_us,temperature\n0,1\n1,2\n";
    refused(
        "encode --scheme sf --threshold 1 -",
        "a,b\n1,2\n",
        &["--channels must say which; there are a, b"],
    );
    good("encode --scheme sf --threshold 1 -", table);
}
