//! One flight file (`flight.toml`) describes sender and receiver: `listen` needs only this file to decode what the
//! generated module sends, in the units of the channels.

mod common;

use common::{file, good, ran, refused, spikewire};
use spikewire::link::{MAX_FRAME, Session};
use spikewire::{FromItems, Item, Put, Tick};
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
    let heard = ran!("listen {} --flight {FILE}", path.display()).output;
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
        format!("{},{}\n", sample * usize::from(flight::PERIOD), values.join(","))
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
    let message = format!("{}:{line}: parameters `spike` is unknown", path.display());
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
