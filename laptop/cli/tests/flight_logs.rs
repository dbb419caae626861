//! PX4 logs with faults, built message by message.

mod common;

use std::collections::BTreeMap;

use common::{file, flight_logs, good, ran, refused};
use lab::input::{ChannelOptions, InputOptions};
use yule_log::builder::ULogParserBuilder;
use yule_log::model::inst::{FieldValue, Format};
use yule_log::model::msg::UlogMessage;

/// Bytes of a PX4 log, to which messages are appended.
struct Log(Vec<u8>);

const SCHEME: &str = "encode --scheme sf --threshold 0.5 --topic armed";

impl Log {
    /// Starts a log with two topics. In the format of `armed`, a sample has 9 bytes of data and 7 bytes of padding. The
    /// topic `gps` has a text field.
    fn new() -> Self {
        let mut log = Self([b"ULog\x01\x12\x35\x01".as_slice(), &[0; 8]].concat());
        log.add(b'F', b"armed:uint64_t timestamp;bool on;uint8_t[7] _padding0;");
        log.add(b'F', b"gps:uint64_t timestamp;char[4] device;float lat;");
        log.add(b'A', b"\x00\x01\x00armed");
        log.add(b'A', b"\x00\x02\x00gps");
        log
    }

    fn add(&mut self, kind: u8, content: &[u8]) -> usize {
        let offset = self.0.len();
        self.0.extend((content.len() as u16).to_le_bytes());
        self.0.push(kind);
        self.0.extend(content);
        offset
    }

    fn armed(&mut self, time: u64, on: u8) -> usize {
        self.add(b'D', &[&[1, 0], &time.to_le_bytes()[..], &[on]].concat())
    }

    /// Appends ten samples of `armed`, whose values alternate between 0 and 1. The samples are 5 ms apart. The time of
    /// the first is 5 ms multiplied by `start`.
    fn armed_ten(&mut self, start: u64) {
        for sample in start..start + 10 {
            self.armed(sample * 5000, (sample % 2) as u8);
        }
    }
}

#[test]
fn messages_that_contradict_their_format_are_skipped_and_reported() {
    let mut log = Log::new();
    log.armed_ten(0);
    let offset = log.add(b'D', &[&[1, 0], &50_000_u64.to_le_bytes()[..], &[1; 20]].concat());
    log.armed_ten(10);
    log.add(b'D', &[1, 0, 1]);
    log.armed_ten(20);
    let (_directory, path) = file("long.ulg", &log.0);
    let report = ran!("info {path}").output;
    assert!(report.contains("armed: 30 samples"), "{report}");
    let words = format!(
        "2 messages longer or shorter than their format were skipped, the first at byte {offset}\n"
    );
    assert!(report.contains(&words), "{report}");
    let ran = ran!("{SCHEME} --field on {path}");
    assert!(ran.stderr.contains(&words) && ran.output.contains("# samples=30\n"), "{}", ran.stderr);
}

#[test]
fn padding_at_the_end_may_be_logged_or_not() {
    let mut log = Log::new();
    log.armed_ten(0);
    log.add(b'D', &[&[1, 0], &50_000_u64.to_le_bytes()[..], &[1; 8]].concat());
    let (_directory, path) = file("padded.ulg", &log.0);
    let report = ran!("info {path}").output;
    assert!(report.contains("armed: 11 samples") && !report.contains("skipped"), "{report}");
}

#[test]
fn unregistered_ids_and_formats_that_are_no_text_are_skipped_and_reported() {
    let mut log = Log::new();
    log.armed_ten(0);
    let format = log.add(b'F', b"odd:uint64_t timestamp;float \xff\xfe;");
    log.add(b'A', b"\x00\x03\x00odd");
    let data = log.add(b'D', &[&[3, 0], &[0; 12][..]].concat());
    log.add(b'D', &[&[9, 0], &[0; 12][..]].concat());
    log.armed_ten(10);
    let (_directory, path) = file("odd.ulg", &log.0);
    let report = ran!("info {path}").output;
    assert!(report.contains("armed: 20 samples"), "{report}");
    let ids = format!(
        "2 messages with an id that is not registered were skipped, the first at byte {data}\n"
    );
    let formats =
        format!("2 definitions that cannot be read were skipped, the first at byte {format}\n");
    assert!(report.contains(&ids) && report.contains(&formats), "{report}");
}

#[test]
fn damage_is_distinguished_from_a_cut_and_skipped() {
    let mut log = Log::new();
    log.armed_ten(0);
    let damaged = log.armed(50_000, 1);
    log.armed_ten(11);
    let mut bytes = log.0;
    // A length beyond the end of the file.
    bytes[damaged..damaged + 3].copy_from_slice(&[0xff, 0xff, 0xff]);
    let (_directory, path) = file("damaged.ulg", &bytes);
    let next = damaged + 3 + 11;
    let words = format!(
        "damaged at byte {damaged} of {}; --accept-cut goes on at byte {next}",
        bytes.len()
    );
    refused(&format!("info {path}"), "", &[&words]);
    let ran = ran!("{SCHEME} --field on --accept-cut {path}");
    assert!(ran.output.contains("# samples=20\n"), "{}", ran.output);
    let words = format!("1 damaged stretches were skipped, the first at byte {damaged}\n");
    assert!(ran.stderr.contains(&words), "{}", ran.stderr);
    let (_directory, path) = file("cut.ulg", &bytes[..damaged - 5]);
    refused(
        &format!("info {path}"),
        "",
        &["cut short within the message at byte", "takes what is before"],
    );
    let report = ran!("info --accept-cut {path}").output;
    assert!(report.contains("armed: 9 samples"), "{report}");
}

#[test]
fn booleans_keep_their_value() {
    let mut log = Log::new();
    for (sample, on) in [0, 1, 2, 255].into_iter().enumerate() {
        log.armed(sample as u64 * 5000, on);
    }
    let (_directory, path) = file("bool.ulg", &log.0);
    let position =
        format!("encode --scheme position --centres 0,1,2,255 --topic armed --field on {path}");
    let decoded = good("decode", &good(&position, "").output).output;
    assert_eq!(common::values(&decoded), [0.0, 1.0, 2.0, 255.0]);
}

#[test]
fn text_is_named_as_such_and_dropouts_are_reported() {
    let mut log = Log::new();
    log.armed_ten(0);
    log.add(b'D', &[&[2, 0], &[0; 8][..], b"ublx", &1.5_f32.to_le_bytes()].concat());
    log.add(b'O', &20_u16.to_le_bytes());
    log.add(b'O', &300_u16.to_le_bytes());
    let (_directory, path) = file("text.ulg", &log.0);
    let report = ran!("info {path}").output;
    assert!(
        report.contains("2 dropouts of the logger, 320 ms in all, 300 ms the longest\n"),
        "{report}"
    );
    assert!(report.contains("\n  lat\n  text: device\n"), "{report}");
    let scheme = "encode --scheme sf --threshold 0.5 --topic gps";
    for field in ["device", "device[0]"] {
        refused(&format!("{scheme} --field {field} {path}"), "", &["is text, not a signal"]);
    }
    ran!("{scheme} --field lat {path}");
}

#[test]
fn data_appended_after_a_crash_is_read() {
    let header = Log::new().0[..16].to_vec();
    let body = Log::new().0[16..].to_vec();
    let mut log = Log(header);
    let flags = log.add(b'B', &[0; 40]);
    log.0.extend(body);
    log.armed_ten(0);
    let offset = log.0.len();
    // The start of a message that the crash cut.
    log.0.extend([11, 0]);
    let appended = log.0.len();
    log.armed_ten(10);
    log.0[flags + 3 + 8] = 1;
    log.0[flags + 3 + 16..flags + 3 + 24].copy_from_slice(&(appended as u64).to_le_bytes());
    assert_eq!(appended, offset + 2);
    let (_directory, path) = file("crash.ulg", &log.0);
    let report = ran!("info {path}").output;
    assert!(report.contains("armed: 20 samples"), "{report}");
}

#[test]
fn a_compressed_log_is_read() {
    use std::io::Write;
    let mut log = Log::new();
    log.armed_ten(0);
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(&log.0).unwrap();
    let (_directory, path) = file("log.ulg.gz", encoder.finish().unwrap());
    assert!(ran!("info {path}").output.contains("armed: 10 samples"));
    ran!("{SCHEME} --field on {path}");
}

/// A log's values as the crate `yule_log` reads them: topic, field, and one number for each sample.
type Columns = BTreeMap<String, BTreeMap<String, Vec<f64>>>;

#[test]
fn every_number_of_real_logs_as_another_reader_has_it() {
    for log in flight_logs() {
        let (mut others, mut compared) = (Columns::new(), 0);
        let parser = ULogParserBuilder::new(std::fs::File::open(&log).unwrap()).build().unwrap();
        for message in parser {
            if let UlogMessage::LoggedData(logged) = message.unwrap() {
                let topic = match logged.data.multi_id_index.unwrap_or(0) {
                    0 => logged.data.name.to_string(),
                    instance => format!("{}:{instance}", logged.data.name),
                };
                add_numbers(&topic, "", &logged.data, &mut others);
            }
        }
        for (topic, columns) in others {
            let channel = ChannelOptions {
                topic: Some(topic.clone()),
                field: columns.keys().cloned().collect(),
                skip_non_finite: true,
                accept_cut: true,
                ..ChannelOptions::default()
            };
            let options = InputOptions { input: log.clone(), channel };
            let read = options.open().unwrap().rest().unwrap();
            for ((field, other), column) in columns.iter().zip(&read.columns) {
                let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
                assert_eq!(bits(column), bits(other), "{topic} {field}");
                compared += other.len();
            }
        }
        assert!(compared > 50_000, "{compared} numbers in {}", log.display());
    }
}

fn add_numbers(topic: &str, prefix: &str, data: &Format, columns: &mut Columns) {
    for field in &data.fields {
        add_number(topic, format!("{prefix}{}", field.name), &field.value, columns);
    }
}

fn add_number(topic: &str, name: String, value: &FieldValue, columns: &mut Columns) {
    let number = match value {
        FieldValue::ScalarU8(value) => f64::from(*value),
        FieldValue::ScalarU16(value) => f64::from(*value),
        FieldValue::ScalarU32(value) => f64::from(*value),
        FieldValue::ScalarU64(value) => *value as f64,
        FieldValue::ScalarI8(value) => f64::from(*value),
        FieldValue::ScalarI16(value) => f64::from(*value),
        FieldValue::ScalarI32(value) => f64::from(*value),
        FieldValue::ScalarI64(value) => *value as f64,
        FieldValue::ScalarF32(value) => f64::from(*value),
        FieldValue::ScalarF64(value) => *value,
        FieldValue::ScalarBool(value) => f64::from(u8::from(*value)),
        FieldValue::ScalarChar(_) | FieldValue::ArrayChar(_) => return,
        FieldValue::ScalarOther(nested) => {
            return add_numbers(topic, &format!("{name}."), nested, columns);
        }
        array => {
            for (index, value) in array.to_scalars().unwrap().iter().enumerate() {
                add_number(topic, format!("{name}[{index}]"), value, columns);
            }
            return;
        }
    };
    columns.entry(topic.to_owned()).or_default().entry(name).or_default().push(number);
}
