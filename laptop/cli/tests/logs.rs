//! Logs of ROS, Betaflight, `ArduPilot` and `MAVLink` are read, even if they are cut short or damaged. ROS logs that
//! `encode` wrote are read too.

mod common;

use common::{file, flight, flight_logs, good, good_bytes, ran, refused, values};
use flight_logs::made::{
    CHUNKED, KINDS, Kind, PAGE, blackbox, dataflash, dataflash_rate, dataflash_sample,
    dataflash_text, fields, frame, gyro, long, record, seconds, time, tlog, wave,
};
use serde_json::Value;
use std::io::Write;

/// Writes `log` to a file called `name`, and returns the output of `info` with `options`.
fn info(name: &str, log: impl AsRef<[u8]>, options: &str) -> String {
    let (_directory, path) = file(name, log);
    ran!("info {options} {path}").output
}

/// Checks that `info` refuses the log with a message that contains each of `words`; returns the output of `info
/// --accept-cut`.
fn damaged(name: &str, log: &[u8], words: &[&str]) -> String {
    let (_directory, path) = file(name, log);
    refused(&format!("info {path}"), "", words);
    ran!("info --accept-cut {path}").output
}

const SCHEME: &str = "encode --scheme sf --threshold 0.1 --topic imu --field rate";

#[test]
fn every_packing_reads_the_same() {
    for kind in KINDS {
        let mut all = kind.packings().iter().map(|how| {
            let (_directory, path) = file(kind.name(), kind.log(how));
            let report = ran!("info {path}").output;
            assert!(report.contains("/imu: 100 samples of t/"), "{report}");
            assert!(report.contains("0.495 s, 200.00 Hz\n  0 gaps above 7.500 ms"), "{report}");
            assert!(report.contains("rate, few[]\n  text: header.frame_id\n"), "{report}");
            let spikes = ran!("{SCHEME} {path}").output;
            assert!(spikes.contains("# time=99,1699999999495000\n# samples=100\n"), "{spikes}");
            let recorded = ran!("{SCHEME} --time recorded {path}").output;
            assert!(recorded.contains("# time=99,1700000000495000\n"), "{recorded}");
            spikes
        });
        let first = all.next().unwrap();
        assert!(all.all(|other| other == first), "{kind:?}");
        // Decoded values are within two steps of the values in the log.
        let decoded = values(&good("decode", &first).output);
        for (sample, value) in (0..).zip(decoded) {
            assert!((value - wave(sample)).abs() < 0.2, "{kind:?}: sample {sample}: {value}");
        }
    }
}

fn packed(how: &str, bytes: &[u8]) -> Vec<u8> {
    let mut packed = Vec::new();
    match how {
        "gz" => {
            let level = flate2::Compression::fast();
            flate2::write::GzEncoder::new(&mut packed, level).write_all(bytes).unwrap();
        }
        "bz2" => {
            let level = bzip2::Compression::fast();
            bzip2::write::BzEncoder::new(&mut packed, level).write_all(bytes).unwrap();
        }
        "zst" => {
            let level = ruzstd::encoding::CompressionLevel::Fastest;
            packed = ruzstd::encoding::compress_to_vec(bytes, level);
        }
        "xz" => {
            let options = lzma_rust2::XzOptions::with_preset(1);
            let mut writer = lzma_rust2::XzWriter::new(&mut packed, options).unwrap();
            writer.write_all(bytes).unwrap();
            writer.finish().unwrap();
        }
        _ => packed.extend(bytes),
    }
    packed
}

/// Every log is read with every compression, from a file and from standard input. The compressed files consist of two
/// streams, as compressors that use several cores write them.
#[test]
fn any_log_is_read_in_any_packing() {
    let logs = [
        (Kind::Bag.log("none"), "/imu: 100 samples"),
        (Kind::Mcap.log("none"), "/imu: 100 samples"),
        (Kind::Db3.log("none"), "/imu: 100 samples"),
        (blackbox(), "main: 200 samples"),
        (dataflash(), "IMU:1: 100 samples"),
        (dataflash_text().into_bytes(), "IMU:1: 100 samples"),
        (tlog(), "RAW_IMU: 100 samples"),
        (std::fs::read(&flight_logs()[0]).unwrap(), "sensor_combined: "),
    ];
    for (log, words) in logs {
        let whole = info("log", &log, "");
        assert!(whole.contains(words), "{whole}");
        for how in ["none", "gz", "bz2", "zst", "xz"] {
            let middle = log.len() / 2;
            let both = [&log[..middle], &log[middle..]].map(|half| packed(how, half)).concat();
            assert_eq!(info("log", &both, ""), whole, "{how}");
            let piped = String::from_utf8(good_bytes("info -", &both).output).unwrap();
            assert_eq!(piped, whole, "{how} on standard input");
        }
        // Damage within ends in words.
        for how in ["gz", "bz2", "zst", "xz"] {
            let mut odd = packed(how, &log);
            let middle = odd.len() / 2;
            odd[middle] ^= 0x55;
            let (_directory, path) = file("log", &odd);
            let told = common::spikewire(&format!("info {path}"), "");
            assert_eq!(told.status, 2, "{how}: {}", told.output);
        }
    }
}

#[test]
fn a_log_that_is_cut_gives_what_is_before_where_that_is_accepted() {
    for kind in CHUNKED {
        for how in kind.packings() {
            let log = kind.log(how);
            // Cuts the log in the middle of the third chunk from the end.
            let chunk = (log.len() - kind.start().len()) / 10;
            let log = &log[..log.len() - 2 * chunk - chunk / 2];
            let words = ["byte", "ends within the record; --accept-cut"];
            let report = damaged(kind.name(), log, &words);
            let count = report.split("/imu: ").nth(1).unwrap().split(' ').next().unwrap();
            let count: u32 = count.parse().unwrap();
            assert!((69..80).contains(&count), "{kind:?} {how}: {report}");
            assert!(report.starts_with("nothing is read from byte"), "{report}");
        }
    }
}

#[test]
fn a_damaged_chunk_is_refused_or_passed_over() {
    for kind in CHUNKED {
        for how in kind.packings().iter().filter(|how| !(kind == Kind::Bag && **how == "none")) {
            let records: Vec<u8> = (0..10).flat_map(|sample| kind.record(sample)).collect();
            let (start, chunk) = (kind.start(), kind.chunk(how, &records));
            let mut odd = chunk.clone();
            let middle = odd.len() - 40;
            odd[middle..middle + 20].fill(0x55);
            let offset = start.len() + chunk.len();
            let log = [&start, &chunk, &odd, &chunk, &kind.end()].map(Vec::as_slice).concat();
            let report = damaged(kind.name(), &log, &[&format!("byte {offset}: ")]);
            let skipped = format!("skipped at byte {offset}: ");
            assert!(report.starts_with(&skipped), "{kind:?} {how}: {report}");
        }
    }
}

#[test]
fn a_database_that_is_cut_or_damaged_gives_the_pages_that_are_whole() {
    let log = Kind::Db3.log("none");
    let offset = log.len() - PAGE;
    let words = format!("byte {offset}: the file ends within its page {}", log.len() / PAGE);
    let report = damaged("log.db3", &log[..log.len() - PAGE / 2], &[&words, "--accept-cut"]);
    assert!(report.contains("/imu: 90 samples of t/msg/Imu"), "{report}");
    let mut other = log.clone();
    other[log.len() - 3 * PAGE] = 10;
    let words = "it is no page of a table; --accept-cut goes on behind it";
    let report = damaged("log.db3", &other, &[words]);
    assert!(
        report.contains("/imu: 90 samples of t/msg/Imu") && report.contains("1 gaps"),
        "{report}"
    );
    let (directory, path) = file("log.db3", &log);
    std::fs::write(directory.path().join("log.db3-wal"), b"more").unwrap();
    let words = "log.db3-wal holds messages that are not in the file yet";
    refused(&format!("info {path}"), "", &[words]);
}

#[test]
fn the_files_of_a_directory_are_read_one_after_the_other() {
    let directory = tempfile::tempdir().unwrap();
    let write = |name: &str, content: &[u8]| {
        std::fs::write(directory.path().join(name), content).unwrap();
    };
    let metadata =
        "rosbag2_bagfile_information:\n  relative_file_paths:\n    - b.db3\n    - a.mcap\n";
    write("metadata.yaml", metadata.as_bytes());
    write("b.db3", &Kind::Db3.log("none"));
    write("a.mcap", &Kind::Mcap.log("none"));
    let path = directory.path().display();
    for path in [path.to_string(), format!("{path}/metadata.yaml")] {
        let report = ran!("info {path}").output;
        assert!(report.contains("/imu: 200 samples of t/msg/Imu"), "{report}");
        let anew = "starts anew 1 times, each a segment of its own: -495.000 ms after sample 99";
        assert!(report.contains(anew), "{report}");
    }
    std::fs::remove_file(directory.path().join("b.db3")).unwrap();
    refused(&format!("info {path}"), "", &["b.db3: cannot be opened"]);
    let empty = tempfile::tempdir().unwrap();
    refused(&format!("info {}", empty.path().display()), "", &["no logs in this directory"]);
}

/// The scheme `sf` with a threshold of 101 encodes an angular rate of the log. Every decoded value differs from the
/// rate by at most 101, because the rate changes by at most 101 from one frame of the log to the next.
#[test]
fn a_blackbox_log_is_read_frame_by_frame() {
    let (_directory, path) = file("log.bbl", blackbox());
    let spikes = ran!("encode --scheme sf --threshold 101 --field gyroADC[0] {path}").output;
    for (sample, value) in (0..).zip(values(&good("decode", &spikes).output)) {
        assert!((value - gyro(sample) as f64).abs() <= 101.0, "sample {sample}: {value}");
    }
}

#[test]
fn a_blackbox_log_that_is_cut_or_damaged_goes_on_where_it_can() {
    let log = blackbox();
    let end = log.len() - b"E\xffEnd of log\0".len();
    let words = "the log ends within a frame; --accept-cut";
    let report = damaged("cut.bbl", &log[..end - 3], &[words]);
    assert!(report.contains("main: 199 samples"), "{report}");
    // A log without the event that marks its end is complete.
    let report = info("unended.bbl", &log[..end], "");
    assert!(report.starts_with("the log has no end") && report.contains("200 samples"), "{report}");
    // A damaged frame and all up to the next I-frame are dropped.
    let before: usize = (0..69).map(|sample| frame(sample).len()).sum();
    let head = end - (0..200).map(|sample| frame(sample).len()).sum::<usize>();
    let mut other = log.clone();
    other[head + before + frame(69).len()] = 0;
    // That is common in good logs, and told rather than refused.
    let told = info("damaged.bbl", &other, "");
    assert!(
        told.contains(&format!("skipped at byte {}: ", head + before + frame(69).len())),
        "{told}"
    );
    assert!(told.contains("main: 174 samples") && told.contains("1 gaps"), "{told}");
    // Two logs in one file.
    let (_directory, path) = file("two.bbl", [blackbox(), blackbox()].concat());
    let report = ran!("info {path}").output;
    assert!(
        report.contains("main: 200 samples") && report.contains("main:1: 200 samples"),
        "{report}"
    );
    let ran = ran!("encode --scheme sf --threshold 101 --topic main:1 --field time {path}");
    assert!(ran.output.contains("# samples=200\n"), "{}", ran.output);
}

/// The binary and the text form of a log decode to the same angular rates. Each of the two sensors has a topic of its
/// own.
#[test]
fn an_ardupilot_log_is_read_sensor_by_sensor() {
    for (name, log) in [("log.bin", dataflash()), ("log.log", dataflash_text().into_bytes())] {
        let (_directory, path) = file(name, log);
        for sensor in 0..2 {
            let topic = ["IMU", "IMU:1"][usize::from(sensor)];
            let encode = format!("encode --scheme sf --threshold 0.21 --topic {topic}");
            let spikes = ran!("{encode} --field GyrX {path}").output;
            let decoded = values(&good("decode", &spikes).output);
            assert_eq!(decoded.len(), 100);
            for (sample, value) in (0..).zip(decoded) {
                let rate = f64::from(dataflash_rate(sample, sensor));
                assert!((value - rate).abs() <= 0.21, "{name}, {topic}: {sample}: {value}, {rate}");
            }
        }
    }
}

#[test]
fn an_ardupilot_log_that_is_cut_or_damaged_goes_on_where_it_can() {
    let log = dataflash();
    let size = dataflash_sample(0).len();
    let report = damaged("cut.bin", &log[..log.len() - 3], &["the log ends within a message"]);
    assert!(
        report.contains("IMU: 100 samples") && report.contains("IMU:1: 99 samples"),
        "{report}"
    );
    // With one byte missing, only the message that lacks it is dropped.
    let mut other = log.clone();
    let offset = log.len() - 10 * size;
    other.remove(offset + 20);
    let words = format!("byte {offset}: {} bytes are no messages; --accept-cut", size / 2 - 1);
    let report = damaged("damaged.bin", &other, &[&words]);
    assert!(
        report.contains("IMU: 99 samples") && report.contains("IMU:1: 100 samples"),
        "{report}"
    );
    // Some loggers write garbage before the first message.
    let report = info("late.bin", [b"garbage", &log[..]].concat(), "--accept-cut");
    assert!(
        report.starts_with("skipped at byte 0: 7 bytes") && report.contains("IMU: 100"),
        "{report}"
    );
    let text = dataflash_text();
    let report =
        damaged("cut.log", &text.as_bytes()[..text.len() - 20], &["a message of 4 columns"]);
    assert!(report.contains("IMU:1: 99 samples"), "{report}");
}

#[test]
fn a_telemetry_log_that_is_cut_or_damaged_goes_on_where_it_can() {
    let log = tlog();
    let report = damaged("cut.tlog", &log[..log.len() - 3], &["the log ends within a packet"]);
    assert!(report.contains("RAW_IMU: 100 samples"), "{report}");
    // A flipped bit in a value, which the checksum reveals.
    let mut other = log.clone();
    other[20] ^= 1;
    let report =
        damaged("damaged.tlog", &other, &["byte 0: 42 bytes are no packets; --accept-cut"]);
    assert!(
        report.contains("RAW_IMU: 100 samples") && report.contains("RAW_IMU:1: 99"),
        "{report}"
    );
}

#[test]
fn logs_without_an_end_or_an_index_are_read() {
    let mut bag = Kind::Bag.log("none");
    let offset = bag.windows(10).position(|window| window == b"index_pos=").unwrap() + 10;
    bag[offset..offset + 8].fill(0);
    let mut mcap = Kind::Mcap.log("none");
    mcap.truncate(mcap.len() - Kind::Mcap.end().len());
    for (kind, log, words) in [(Kind::Bag, bag, "has no index"), (Kind::Mcap, mcap, "has no end")] {
        let report = info(kind.name(), log, "");
        assert!(report.contains(words) && report.contains("/imu: 100 samples"), "{report}");
    }
}

#[test]
fn encodings_that_are_not_known_are_named() {
    let mut log = Kind::Mcap.log("none");
    let offset = log.windows(3).position(|window| window == b"cdr").unwrap();
    log[offset..offset + 3].copy_from_slice(b"foo");
    let (_directory, path) = file("log.mcap", &log);
    let report = ran!("info {path}").output;
    assert!(report.contains("not read: encoding `foo` with a schema of `ros2msg`"), "{report}");
    refused(&format!("{SCHEME} {path}"), "", &["encoding `foo` with a schema of `ros2msg`"]);
    let chunk = record(&[("op", &[5]), ("compression", b"zip"), ("size", &[0; 4])], &[]);
    let (_directory, path) = file("log.bag", [Kind::Bag.start(), chunk].concat());
    refused(&format!("info {path}"), "", &["compression `zip` is not known; there are none, lz4"]);
    let (_directory, path) = file("old.bag", b"#ROSBAG V1.2\nand so on");
    refused(&format!("info {path}"), "", &["of another version than 2.0"]);
}

#[test]
fn gaps_missing_messages_and_rates_that_jump_are_reported() {
    let report = info("log.bag", Kind::Bag.of((0..50).chain(60..100)), "");
    for words in [
        "1 gaps above 7.500 ms where 5.000 ms are usual: 55.000 ms after sample 49",
        "  10 messages are missing, by the numbers of those there\n",
    ] {
        assert!(report.contains(words), "{report}");
    }
    let (_directory, path) = file("log.mcap", Kind::Mcap.of((0..400).step_by(2).chain(400..500)));
    let words = "the rate jumps 1 times: 200.00 Hz from about sample 192\n";
    for ran in [ran!("info {path}"), ran!("{SCHEME} {path}")] {
        assert!((ran.output + &ran.stderr).contains(words));
    }
}

#[test]
fn bags_are_tuned_and_advised_on() {
    for kind in CHUNKED {
        let (_directory, path) = file(kind.name(), kind.of(0..400));
        let channel = format!("--topic /imu --field rate --evaluations 10 {path}");
        let tuned = ran!("tune --scheme sf --min-efficiency 10 --emit toml {channel}");
        assert!(tuned.output.contains("threshold = "), "{kind:?}: {}", tuned.output);
        let advised = ran!("advise --json --max-rmse 0.4 {channel}").log();
        assert_eq!(advised["channels"][0]["look"]["samples"], 400, "{kind:?}: {advised:#}");
        assert_ne!(
            advised["channels"][0]["reaching"],
            Value::Array(Vec::new()),
            "{kind:?}: {advised:#}"
        );
    }
}

/// Spikes decode to the same values from a ROS log as from a CSV file. The tested schemes differ in the form of their
/// spikes: one neuron or several, with or without polarities, with sub-timesteps, or with several spikes in a sample.
/// Each scheme encodes one channel, and then two.
#[test]
fn spikes_as_messages_decode_as_those_of_a_table() {
    let flight = flight("hexarotor.csv");
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name).display().to_string();
    for scheme in [
        "sf --threshold 0.1",
        "bsa --filter triang:15,peak=2 --threshold 1",
        "burst",
        "grf --neurons 5",
        "grf-slots --neurons 4 --slots 5",
    ] {
        for columns in ["gyro_x", "gyro_x,gyro_y"] {
            let encode = format!("encode --scheme {scheme} --columns {columns} {flight}");
            let table = good(&encode, "").output;
            let without_times = |decoded: String| {
                let lines = decoded.lines().map(|line| line.rsplit_once(',').unwrap().0.to_owned());
                lines.collect::<Vec<_>>()
            };
            let expected = without_times(good("decode", &table).output);
            for name in ["spikes.bag", "spikes.mcap"] {
                ran!("{encode} -o {}", path(name));
                let decoded = ran!("decode {}", path(name)).output;
                assert!(without_times(decoded) == expected, "{scheme} of {columns} by {name}");
            }
        }
    }
    let report = ran!("info {}", path("spikes.mcap")).output;
    assert!(report.contains("event_1: 3627 samples of spyke_msgs/msg/SpykeArray"), "{report}");
}

/// A bag written by the toolbox of Dupeyroux et al. (2022) decodes as in the toolbox's own script. The script uses the
/// mean of the thresholds, and ignores the spike of the first message.
#[test]
fn the_toolboxs_own_bag_decodes_as_its_script_does() {
    let numbers =
        "float32 start\nfloat32 min_input\nfloat32 max_input\nfloat32 threshold\nfloat32 input\n";
    let definition =
        format!("# A spyke event\nint8    spike\n{numbers}string  scheme\ntime    timestamp");
    for (scheme, expected) in
        [("step_forward", [1.5, 2.0, 1.5, 1.5]), ("temporal_contrast", [0.0, 1.0, 0.0, 0.0])]
    {
        let data = fields(&[
            ("topic", b"event"),
            ("type", b"spyke_msgs/spyke"),
            ("message_definition", definition.as_bytes()),
        ]);
        let mut bag = b"#ROSBAG V2.0\n".to_vec();
        bag.extend(record(&[("op", &[7]), ("conn", &[0; 4]), ("topic", b"event")], &data));
        for (spike, threshold) in [(1_i8, 0.25_f32), (1, 0.75), (-1, 0.5), (0, 0.5)] {
            let mut message = spike.to_le_bytes().to_vec();
            for number in [1.5, -3.0, 3.0, threshold, 9.0] {
                message.extend(f32::to_le_bytes(number));
            }
            message.extend(long(scheme.as_bytes()));
            message.extend([0; 8]);
            bag.extend(record(&[("op", &[2]), ("conn", &[0; 4]), ("time", &[0; 8])], &message));
        }
        let (_directory, path) = file("encoding.bag", &bag);
        assert_eq!(values(&ran!("decode {path}").output), expected, "{scheme}");
    }
}

#[test]
fn messages_longer_than_their_definition_are_reported() {
    let long = |sample: u32| {
        let stamp = seconds(time(sample)).concat();
        let message = [Kind::Bag.message(sample), vec![0; (sample / 10) as usize]].concat();
        record(&[("op", &[2]), ("conn", &[0; 4]), ("time", &stamp)], &message)
    };
    let chunk = Kind::Bag.chunk("none", &(0..30).flat_map(long).collect::<Vec<u8>>());
    let (_directory, path) = file("x.bag", [Kind::Bag.start(), chunk, Kind::Bag.end()].concat());
    let words = "20 messages are longer than their definition, the first at byte ";
    let info = ran!("info {path}").output;
    assert!(info.contains(words), "{info}");
    let score = format!("score --scheme sf --threshold 0.1 --topic imu --field rate {path}");
    let report = good(&score, "").stderr;
    assert!(report.contains(words), "{report}");
}
