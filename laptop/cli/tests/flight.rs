//! One flight file (`flight.toml`) describes sender and receiver: `listen` needs only this file to decode what the
//! generated module sends, in the units of the channels.

mod common;

use common::{file, flight_logs, good, ran, refused, spikewire};
use spikewire::link::{MAX_FRAME, Session};
use spikewire::{FromItems, Item, Put, Tick};
use std::collections::VecDeque;
use std::fs;

include!("../../flight/tests/flights/grf_slots.rs");

const FILE: &str = "../flight/tests/flights/grf_slots.toml";
const SAMPLES: usize = 400;

struct Items<'a>(&'a mut Vec<Item>);

impl Put for Items<'_> {
    fn put(&mut self, item: Item) {
        self.0.push(item);
    }
}

/// Returns one sample of a channel as a raw sensor reading, in counts. The signal is a sine wave with an amplitude of
/// 1.5 of the channel's units.
fn count(channel: usize, sample: usize) -> i16 {
    let value = 1.5 * (sample as f64 * 0.02 * (channel as f64 + 1.0)).sin();
    (value * flight::COUNTS[channel]).round() as i16
}

/// Runs the sender and the receiver of a flight. Returns the frames sent, and the last value of each channel at the
/// receiver.
fn flown() -> (Vec<u8>, Vec<f64>) {
    let (mut bank, mut transmitter) = (flight::BANK, flight::transmitter(Session::counted(3)));
    let (mut bytes, mut items, mut buffer) = (Vec::new(), Vec::new(), [0; MAX_FRAME]);
    let (mut reader, mut receiver) =
        (spikewire::link::Reader::<MAX_FRAME>::new(), flight::receiver());
    for sample in 0..SAMPLES {
        let tick = Tick::from_micros(sample as u64 * u64::from(flight::PERIOD));
        bank.encode_into(
            tick,
            std::array::from_fn(|channel| count(channel, sample)),
            Items(&mut items),
        );
        if sample % flight::KEYFRAME_EVERY as usize == 0 {
            bank.keyframe_into(tick, Items(&mut items));
        }
        let mut source = FromItems(items.drain(..));
        while let Some(frame) = transmitter.next_frame(&mut source, &mut buffer).unwrap() {
            bytes.extend_from_slice(frame);
        }
    }
    let mut input = &bytes[..];
    while let Some(received) = reader.next_frame(&mut input) {
        receiver.apply(&received, |_, _, _| ());
    }
    receiver.advance(Tick::from_micros(SAMPLES as u64 * u64::from(flight::PERIOD)), |_, _, _| ());
    let value = |channel: u16| {
        f64::from(receiver.exact(channel).unwrap()) / flight::COUNTS[usize::from(channel)]
    };
    (bytes, (0..flight::CHANNELS as u16).map(value).collect())
}

#[test]
fn what_a_flight_sends_is_heard_by_its_file() {
    let (bytes, held) = flown();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("captured.bytes");
    fs::write(&path, bytes).unwrap();
    let heard = ran!("listen {} --flight {FILE}", path.display());
    assert!(!heard.stderr.contains("without a decoder"), "{}", heard.stderr);
    let heard = heard.output;
    let rows: Vec<Vec<&str>> =
        heard.lines().skip(1).map(|line| line.split(',').collect()).collect();
    assert!(rows.len() > (SAMPLES - 2) * flight::CHANNELS, "{} rows", rows.len());
    for (channel, held) in held.iter().enumerate() {
        let address = (channel * 9).to_string(); // neurons of a channel
        let row = rows.iter().rev().find(|row| row.contains(&address.as_str())).unwrap();
        let value = row.iter().filter_map(|word| word.parse::<f64>().ok());
        assert!(value.clone().any(|value| (value - held).abs() < 1e-9), "{held}: {row:?}");
        assert!(held.abs() < 2.0, "{held} is in counts");
    }
    refused(
        &format!("listen {} --flight {FILE} --neurons 9", path.display()),
        "",
        &["--flight says all parameters"],
    );
    refused(
        &format!("listen {} --flight {FILE} --from es", path.display()),
        "",
        &["--flight needs --from link"],
    );
}

/// A generated flight whose channels are filtered before they are encoded.
mod filtered {
    include!("../../flight/tests/flights/sf.rs");
}

#[test]
fn a_filtered_flight_is_heard_and_no_other_flight_is_exact() {
    use filtered::flight;
    use fixed::types::I8F8;
    let (mut bank, mut transmitter) = (flight::BANK, flight::transmitter(Session::counted(3)));
    let (mut bytes, mut items, mut buffer) = (Vec::new(), Vec::new(), [0; MAX_FRAME]);
    for sample in 0..SAMPLES {
        let tick = Tick::from_micros(sample as u64 * u64::from(flight::PERIOD));
        let value = I8F8::from_num((sample as f64 * 0.02).sin());
        bank.encode_into(tick, [value; flight::CHANNELS], Items(&mut items));
        if sample % flight::KEYFRAME_EVERY as usize == 0 {
            bank.keyframe_into(tick, Items(&mut items));
        }
        let mut source = FromItems(items.drain(..));
        while let Some(frame) = transmitter.next_frame(&mut source, &mut buffer).unwrap() {
            bytes.extend_from_slice(frame);
        }
    }
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("captured.bytes");
    fs::write(&path, bytes).unwrap();
    let exact = |file: &str| {
        let heard = spikewire(&format!("listen {} --flight {file}", path.display()), "");
        heard.output.lines().filter(|line| line.ends_with(",exact")).count()
    };
    let sender = "../flight/tests/flights/sf.toml";
    assert!(exact(sender) > 100, "{}", exact(sender));
    let text = fs::read_to_string(sender).unwrap();
    for (from, to) in [("80.0", "70.0"), ("0.1 }", "0.2 }"), ("q8.8", "q7.9")] {
        let other = directory.path().join("other.toml");
        fs::write(&other, text.replace(from, to)).unwrap();
        assert_eq!(exact(&other.display().to_string()), 0, "{to}");
    }
    // The reason is told, for whatever differs.
    let of_another =
        "the sender is not made from this flight file: the sender's schemes have the fingerprint";
    for (from, to) in [("80.0", "70.0"), ("0.1 }", "0.2 }"), ("gyro_x", "roll"), ("1000", "1001")] {
        let other = directory.path().join("other.toml");
        fs::write(&other, text.replace(from, to)).unwrap();
        let line = format!("listen {} --flight {}", path.display(), other.display());
        refused(&line, "", &["no value is exact: ", of_another]);
        let ran = spikewire(&line, "");
        assert!(!ran.stderr.contains("--scheme"), "{}", ran.stderr);
        assert!(!ran.output.contains(",keyframe"), "{to}");
    }
}

/// Defines a test that `listen` decodes what the sender of each flight in `tests/flights` sends, bit for bit.
macro_rules! heard_by_the_laptop {
    ($($name:ident)*) => {$(
        mod $name {
            include!(concat!("../../flight/tests/flights/", stringify!($name), ".rs"));

            use super::*;
            use spikewire::{Sample, Scheme, link::Reader};

            #[test]
            fn its_values_are_exact() {
                type S = <flight::Code as Scheme>::Sample;
                let (mut bank, mut transmitter) = (flight::BANK, flight::transmitter(Session::counted(3)));
                let (mut reader, mut receiver) = (Reader::<MAX_FRAME>::new(), flight::receiver());
                let (mut bytes, mut items, mut buffer) = (Vec::new(), Vec::new(), [0; MAX_FRAME]);
                let mut waiting = VecDeque::new();
                let mut end = Tick::from_micros(0);
                for sample in 0..SAMPLES {
                    let tick = Tick::from_micros(sample as u64 * u64::from(flight::PERIOD));
                    let value = |channel: usize| {
                        S::from_f64((sample as f64 * 0.02 + channel as f64).sin() * flight::COUNTS[channel])
                    };
                    bank.encode_into(tick, std::array::from_fn(value), Items(&mut items));
                    if sample % flight::KEYFRAME_EVERY as usize == 0 {
                        bank.keyframe_into(tick, Items(&mut items));
                    }
                    // Items that wait for others stay, as in the queue of a firmware.
                    waiting.extend(items.drain(..));
                    transmitter.observe(tick);
                    let mut source = FromItems(std::iter::from_fn(|| waiting.pop_front()));
                    while let Some(frame) = transmitter.next_frame(&mut source, &mut buffer).unwrap() {
                        bytes.extend_from_slice(frame);
                        let mut input = frame;
                        while let Some(received) = reader.next_frame(&mut input) {
                            if let Some(event) = received.frame.events().last() {
                                end = event.tick + u32::from(flight::PERIOD);
                            }
                            receiver.apply(&received, |_, _, _| ());
                        }
                    }
                }
                // As `listen` does when the recording ends.
                receiver.advance(end, |_, _, _| ());
                let (_directory, path) = file("captured.bytes", &bytes);
                let toml = format!("../flight/tests/flights/{}.toml", stringify!($name));
                let heard = ran!("listen {path} --flight {toml}");
                // A code that starts from a value may have events before its first keyframe.
                let first = heard.output.find(",keyframe").unwrap_or_default();
                assert!(!heard.output[first..].contains(",estimate"), "{}", heard.stderr);
                let rows: Vec<Vec<&str>> = heard.output.lines().skip(1).map(|line| line.split(',').collect()).collect();
                for channel in 0..flight::CHANNELS {
                    let row = rows.iter().rev().find(|row| row[1] == channel.to_string()).unwrap();
                    let value: f64 = row[2].parse().unwrap();
                    let known = receiver.exact(channel as u16).unwrap().to_f64() / flight::COUNTS[channel];
                    assert!((value - known).abs() < 1e-6, "channel {channel}: {value}, {known}");
                }
            }
        }
    )*};
}

heard_by_the_laptop! { sod sod_i32 sf_q2_14 asf_q16_16 healing }

/// Two senders on one line are reported as such: the reader follows one of them, and leaves out the other's frames.
#[test]
fn two_senders_on_one_line_are_told() {
    let frames = |session| {
        let (mut bank, mut transmitter) = (flight::BANK, flight::transmitter(session));
        let (mut frames, mut items, mut buffer) = (Vec::new(), Vec::new(), [0; MAX_FRAME]);
        for sample in 0..SAMPLES {
            let tick = Tick::from_micros(sample as u64 * u64::from(flight::PERIOD));
            let samples = std::array::from_fn(|channel| count(channel, sample));
            bank.encode_into(tick, samples, Items(&mut items));
            if sample % flight::KEYFRAME_EVERY as usize == 0 {
                bank.keyframe_into(tick, Items(&mut items));
            }
            let mut source = FromItems(items.drain(..));
            while let Some(frame) = transmitter.next_frame(&mut source, &mut buffer).unwrap() {
                frames.push(frame.to_vec());
            }
        }
        frames
    };
    let (one, other) = (frames(Session::random(3)), frames(Session::random(90)));
    let both: Vec<u8> =
        one.iter().zip(&other).flat_map(|(one, other)| [one, other]).flatten().copied().collect();
    let (_directory, path) = file("both.bytes", both);
    let heard = spikewire(&format!("listen {path} --flight {FILE}"), "");
    assert!(heard.stderr.contains("are there two senders on the line?"), "{}", heard.stderr);
    assert!(heard.stderr.contains("frames came late"), "{}", heard.stderr);
    let (_directory, path) = file("one.bytes", one.concat());
    let heard = ran!("listen {path} --flight {FILE}");
    assert!(!heard.stderr.contains("two senders"), "{}", heard.stderr);
}

/// A flight file made from a log has the log's topic in its sources, so that other commands find the channels again.
#[test]
fn a_flight_keeps_the_topic_of_its_log() {
    let log = flight_logs()[0].display().to_string();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("flight.toml");
    let fields = "--topic sensor_combined --fields gyro_rad[0],gyro_rad[1]";
    let tune =
        format!("tune {log} {fields} --scheme sf --evaluations 20 --max-rmse 0.6 --emit flight");
    ran!("{tune} -o {}", path.display());
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.contains("source = \"sensor_combined.gyro_rad[1]\"\nunit = \"rad/s\""), "{text}");
    let spikes = ran!("encode --flight {} {log}", path.display()).output;
    assert!(spikes.lines().count() > 20, "{spikes}");
    let scored = ran!("score --flight {} {log} --json", path.display()).json();
    let logs = scored["logs"].as_array().unwrap();
    assert_eq!(logs.len(), 2, "{scored:#}");
    assert!(
        logs.iter().all(|log| log["schemes"][0]["rmse"].as_f64().unwrap() < 0.61),
        "{scored:#}"
    );
    // A file without topics takes that of the command line.
    fs::write(&path, text.replace("sensor_combined.", "")).unwrap();
    let same = ran!("encode --flight {} --topic sensor_combined {log}", path.display()).output;
    assert_eq!(same, spikes);
}

/// `emit` writes into the module what the sample type changes, and says it.
#[test]
fn a_rounded_parameter_is_told_by_emit() {
    let sf = "../flight/tests/flights/sf.toml";
    let ran = ran!("emit rust --flight {sf}");
    let words = "gyro_x: threshold 0.1 is 0.1015625 in q8.8";
    assert!(ran.stderr.contains(words) && ran.output.contains(words), "{}", ran.stderr);
    let (_directory, path) = file(
        "flight.toml",
        "version = 1\nscheme = \"sf\"\nsample = \"i16\"\nperiod = 2000\n[[channel]]\nname = \"a\"\n\
         parameters = { threshold = 1.4 }\n",
    );
    refused(&format!("emit rust --flight {path}"), "", &["flight.toml:7: ", "would be 1 in i16"]);
}

/// For a table in physical units, `encode --flight` writes the same events as the firmware's encoders, which take a
/// sensor's counts. The flight file has the number of counts in a unit.
#[test]
fn a_recording_is_coded_as_the_vehicle_does() {
    let names = flight::NAMES.join(",");
    let row = |sample: usize| {
        let values = (0..flight::CHANNELS)
            .map(|channel| f64::from(count(channel, sample)) / flight::COUNTS[channel]);
        let values: Vec<String> = values.map(|value| value.to_string()).collect();
        format!("{},{}\n", sample * flight::PERIOD as usize, values.join(","))
    };
    let rows: String = (0..SAMPLES).map(row).collect();
    let (_directory, log) = file("log.csv", format!("time_us,{names}\n{rows}"));
    let spikes = ran!("encode --flight {FILE} {log}").output;
    let (mut bank, mut expected) = (flight::BANK, Vec::new());
    for sample in 0..SAMPLES {
        let tick = Tick::from_micros(sample as u64 * u64::from(flight::PERIOD));
        bank.encode(tick, std::array::from_fn(|channel| count(channel, sample)), |event| {
            expected.push((sample as u64, event.address));
        });
    }
    let rows = spikes.lines().filter(|line| line.starts_with(|first: char| first.is_ascii_digit()));
    let mut coded: Vec<(u64, u16)> = rows
        .map(|line| {
            let mut words = line.split(',');
            (words.next().unwrap().parse().unwrap(), words.next().unwrap().parse().unwrap())
        })
        .collect();
    // The index of a row counts sub-timesteps, of which a sample has 8.
    for (index, _) in &mut coded {
        *index /= 8;
    }
    coded.sort_unstable();
    expected.sort_unstable();
    assert!(coded == expected, "{} events, {} on the vehicle", coded.len(), expected.len());
    refused(
        &format!("encode --flight {FILE} --neurons 9 {log}"),
        "",
        &["--flight says all parameters"],
    );
    refused(&format!("encode --flight {FILE} --scheme sf {log}"), "", &["cannot be used with"]);
}

#[test]
fn tuned_channels_make_a_flight() {
    let (_directory, log) = file("signal.csv", good("signal --seconds 6", "").output);
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("flight.toml");
    let tune = format!("tune {log} --channel signal --max-rmse 0.4 --evaluations 40 --emit flight");
    ran!("{tune} --scheme sod --spikes 8 -o {}", path.display());
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.contains("scheme = \"sod\"") && text.contains("spikes = 8"), "{text}");
    let spikes = ran!("encode --flight {} {log}", path.display()).output;
    assert!(spikes.lines().count() > 40, "{spikes}");
    // An error in the flight file is reported with file and line.
    fs::write(&path, text.replace("spikes = 8", "spike = 8")).unwrap();
    let line = 1 + text.lines().position(|line| line.contains("spikes = 8")).unwrap();
    let message = format!("{}:{line}: channel 0: parameters `spike` is unknown", path.display());
    refused(&format!("encode --flight {} {log}", path.display()), "", &[&message]);
}

#[test]
fn a_crate_for_c_has_both_ends_of_each_flight() {
    let directory = tempfile::tempdir().unwrap();
    let output = directory.path().join("mine");
    let flights = "../flight/tests/flights/sod.toml ../flight/tests/flights/grf_slots.toml";
    ran!("emit c --flight {flights} -o {}", output.display());
    let read = |path: &str| fs::read_to_string(output.join(path)).unwrap();
    let module = fs::read_to_string("../flight/tests/flights/sod.rs").unwrap();
    let ends = read("src/flights/sod.rs");
    assert_eq!(ends.strip_prefix(&module), Some("\nspikewire_c::flight!(sod, flight);\n"));
    let all = read("src/flights/mod.rs");
    assert!(all.contains("= &[sod::description, grf_slots::description];"), "{all}");
    assert!(read("src/lib.rs").contains("\nmod flights;\n"));
    refused(
        &format!("emit c --flight {FILE} {FILE} -o {}-twice", output.display()),
        "",
        &["`grf_slots`"],
    );
}
