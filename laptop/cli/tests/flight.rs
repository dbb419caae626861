//! One flight's file describes both ends: what its module sends is decoded in the channels' units, by that file alone.

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

/// Returns a sensor's count: a wave of amplitude 1.5 units.
fn count(channel: usize, place: usize) -> i16 {
    let value = 1.5 * (place as f64 * 0.02 * (channel as f64 + 1.0)).sin();
    (value * flight::COUNTS[channel]).round() as i16
}

/// Returns the frames of a vehicle, and the values that its receiver holds after the last of them.
fn flown() -> (Vec<u8>, Vec<f64>) {
    let (mut bank, mut transmitter) = (flight::BANK, flight::transmitter(Session::counted(3)));
    let (mut bytes, mut items, mut buffer) = (Vec::new(), Vec::new(), [0; MAX_FRAME]);
    let (mut reader, mut receiver) =
        (spikewire::link::Reader::<MAX_FRAME>::new(), flight::receiver());
    for place in 0..SAMPLES {
        let tick = Tick::from_micros(place as u64 * u64::from(flight::PERIOD));
        bank.encode_into(tick, std::array::from_fn(|own| count(own, place)), Items(&mut items));
        if place % flight::KEYFRAME_EVERY as usize == 0 {
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
    let value =
        |own: u16| f64::from(receiver.exact(own).unwrap()) / flight::COUNTS[usize::from(own)];
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
        let own = rows.iter().rev().find(|row| row.contains(&address.as_str())).unwrap();
        let value = own.iter().filter_map(|word| word.parse::<f64>().ok());
        assert!(value.clone().any(|own| (own - held).abs() < 1e-9), "{held}: {own:?}");
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

/// A flight with a filter, which both ends must have in common.
mod shaken {
    include!("../../flight/tests/flights/sf.rs");
}

#[test]
fn a_filtered_flight_is_heard_and_no_other_flight_is_exact() {
    use fixed::types::I8F8;
    use shaken::flight;
    let (mut bank, mut transmitter) = (flight::BANK, flight::transmitter(Session::counted(3)));
    let (mut bytes, mut items, mut buffer) = (Vec::new(), Vec::new(), [0; MAX_FRAME]);
    for place in 0..SAMPLES {
        let tick = Tick::from_micros(place as u64 * u64::from(flight::PERIOD));
        let sample = I8F8::from_num((place as f64 * 0.02).sin());
        bank.encode_into(tick, [sample; flight::CHANNELS], Items(&mut items));
        if place % flight::KEYFRAME_EVERY as usize == 0 {
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
    let own = "../flight/tests/flights/sf.toml";
    assert!(exact(own) > 100, "{}", exact(own));
    let text = fs::read_to_string(own).unwrap();
    for (from, to) in [("80.0", "70.0"), ("0.1 }", "0.2 }"), ("q8.8", "q7.9")] {
        let other = directory.path().join("other.toml");
        fs::write(&other, text.replace(from, to)).unwrap();
        assert_eq!(exact(&other.display().to_string()), 0, "{to}");
    }
}

/// A table in the channels' units is encoded in counts, as on the vehicle.
#[test]
fn a_recording_is_coded_as_the_vehicle_does() {
    let names = flight::NAMES.join(",");
    let row = |place: usize| {
        let values =
            (0..flight::CHANNELS).map(|own| f64::from(count(own, place)) / flight::COUNTS[own]);
        let values: Vec<String> = values.map(|value| value.to_string()).collect();
        format!("{},{}\n", place * usize::from(flight::PERIOD), values.join(","))
    };
    let rows: String = (0..SAMPLES).map(row).collect();
    let (_directory, log) = file("log.csv", format!("time_us,{names}\n{rows}"));
    let spikes = ran!("encode --flight {FILE} {log}").output;
    let (mut bank, mut expected) = (flight::BANK, Vec::new());
    for place in 0..SAMPLES {
        let tick = Tick::from_micros(place as u64 * u64::from(flight::PERIOD));
        bank.encode(tick, std::array::from_fn(|own| count(own, place)), |event| {
            expected.push((place as u64, event.address));
        });
    }
    let rows = spikes.lines().filter(|line| line.starts_with(|own: char| own.is_ascii_digit()));
    let mut coded: Vec<(u64, u16)> = rows
        .map(|line| {
            let mut words = line.split(',');
            (words.next().unwrap().parse().unwrap(), words.next().unwrap().parse().unwrap())
        })
        .collect();
    // A row's index counts sub-timesteps.
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
    // What is wrong is told with file and line.
    fs::write(&path, text.replace("spikes = 8", "spike = 8")).unwrap();
    let line = 1 + text.lines().position(|line| line.contains("spikes = 8")).unwrap();
    let place = format!("{}:{line}: parameters `spike` is unknown", path.display());
    refused(&format!("encode --flight {} {log}", path.display()), "", &[&place]);
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
