//! Both ends that a flight's file writes: they compile, and each bit of them is the laptop's.

use catalogue::run::{Event as Fired, Known};
use spikewire::link::{MAX_FRAME, Reader, Session};
use spikewire::{Event, FromItems, Item, Put, Sample, Scheme, Tick};
use spikewire_flight::{Flight, rust};

/// Samples of each flight.
const SAMPLES: usize = 1500;

/// A list as the end of a queue.
struct Items<'a>(&'a mut Vec<Item>);

impl Put for Items<'_> {
    fn put(&mut self, item: Item) {
        self.0.push(item);
    }
}

/// A channel's values in counts: slow, fast, and a jump.
fn signal(flight: &Flight, channel: usize) -> Vec<f64> {
    let counts = flight.channels[channel].counts;
    let value = |place: usize| {
        let (at, own) = (place as f64, channel as f64 + 1.0);
        let jump = if place / 400 % 2 == 1 { 0.8 } else { 0.0 };
        (at * 0.011 * own).sin() + 0.2 * (at * 0.9).sin() + jump
    };
    (0..SAMPLES).map(|place| value(place) * counts).collect()
}

/// What the laptop makes of a channel: its events, and its decoded values.
fn on_the_laptop(flight: &Flight, channel: usize) -> (Vec<Fired>, Vec<f64>) {
    let mut values = signal(flight, channel);
    if let Some(filter) = flight.filter {
        let mut filter = filter.start(flight.sample, flight.rate() as f32).unwrap();
        for value in &mut values {
            *value = filter(*value);
        }
    }
    let known = Known { calibrated: None, first: &values, can_calibrate: false };
    let asked = flight.asked(&flight.channels[channel]);
    let settings = flight.run_time().resolve(flight.sample, &asked, &known).unwrap();
    let mut codec = flight.run_time().codec(&settings).unwrap();
    let (mut events, mut decoded) = (Vec::new(), Vec::new());
    codec.encode(&values, &mut events);
    codec.finish(&mut events);
    codec.decode(SAMPLES, &events, &mut decoded).unwrap();
    (events, decoded)
}

/// A saw with a step, whose numbers are the same on any machine, and whole in counts; `bindings/c/tests/ends.c` has it too.
fn saw(place: u32, channel: u32, counts: f64) -> f64 {
    let saw = place * (3 + 2 * channel) % 193;
    let value = (f64::from(if saw < 97 { saw } else { 193 - saw }) - 48.0) / 32.0 * counts;
    if counts > 1.0 { value.trunc() } else { value }
}

/// FNV-1a.
fn fnv(hash: u64, bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(hash, |hash, own| (hash ^ u64::from(*own)).wrapping_mul(0x0000_0100_0000_01b3))
}

/// For each flight: its module as it is written, and both ends of that module beside the laptop.
macro_rules! flights {
    ($($name:ident)*) => {$(
        mod $name {
            include!(concat!("flights/", stringify!($name), ".rs"));

            use super::*;

            #[test]
            fn the_module_is_what_the_file_writes() {
                let flight = Flight::parse(include_str!(concat!("flights/", stringify!($name), ".toml")));
                let flight = flight.unwrap();
                let written = rust(&flight).unwrap();
                let path = concat!(env!("CARGO_TARGET_TMPDIR"), "/", stringify!($name), ".rs");
                std::fs::write(path, &written).unwrap();
                let known = include_str!(concat!("flights/", stringify!($name), ".rs"));
                assert!(written == known, "tests/flights has another module than {path}");
                assert_eq!(flight.fingerprint(), flight::receiver().fingerprint());
            }

            #[test]
            fn the_ends_in_c_have_these_bits() {
                type S = <flight::Code as Scheme>::Sample;
                let (mut bank, mut transmitter) = (flight::BANK, flight::transmitter(Session::random(7)));
                let (mut items, mut buffer) = (Vec::new(), [0; MAX_FRAME]);
                let (mut bytes, mut frames) = (Vec::new(), 0);
                for place in 0..400 {
                    let tick = Tick::from(place * u32::from(flight::PERIOD));
                    let sample = |own: usize| S::from_f64(saw(place, own as u32, flight::COUNTS[own]));
                    bank.encode_into(tick, std::array::from_fn(sample), Items(&mut items));
                    if place % flight::KEYFRAME_EVERY == 0 {
                        bank.keyframe_into(tick, Items(&mut items));
                    }
                    let mut source = FromItems(items.drain(..));
                    while let Some(frame) = transmitter.next_frame(&mut source, &mut buffer).unwrap() {
                        bytes.extend_from_slice(frame);
                        frames += 1;
                    }
                }
                let mut hash = fnv(0xcbf2_9ce4_8422_2325, &bytes);
                let (mut reader, mut receiver) = (Reader::<MAX_FRAME>::new(), flight::receiver());
                let mut exact = 0;
                for mut part in bytes.chunks(64) {
                    while let Some(received) = reader.next_frame(&mut part) {
                        receiver.apply(&received, |_, _, _| ());
                    }
                    for channel in 0..flight::CHANNELS as u16 {
                        if let Some(value) = receiver.exact(channel) {
                            exact += 1;
                            hash = fnv(fnv(hash, &channel.to_le_bytes()), &value.to_le_bytes());
                        }
                    }
                }
                let (name, length) = (stringify!($name), bytes.len());
                let line = format!("{name} {frames} frames, {length} bytes, {exact} exact values, {hash:016x}");
                let known = include_str!("flights/flown.txt");
                assert!(known.lines().any(|own| own == line), "tests/flights/flown.txt lacks {line}");
            }

            #[test]
            fn both_ends_are_the_laptop_s() {
                type S = <flight::Code as Scheme>::Sample;
                let told = Flight::parse(include_str!(concat!("flights/", stringify!($name), ".toml"))).unwrap();
                let columns: Vec<Vec<f64>> = (0..flight::CHANNELS).map(|own| signal(&told, own)).collect();
                let laptop: Vec<_> = (0..flight::CHANNELS).map(|own| on_the_laptop(&told, own)).collect();

                let (mut bank, mut transmitter) = (flight::BANK, flight::transmitter(Session::counted(1)));
                let (mut reader, mut receiver) = (Reader::<MAX_FRAME>::new(), flight::receiver());
                let (mut sent, mut items): (Vec<Event>, Vec<Item>) = (Vec::new(), Vec::new());
                let mut buffer = [0; MAX_FRAME];
                let tick = |place: usize| Tick::from_micros(place as u64 * u64::from(flight::PERIOD));
                let mut compared = 0;
                for place in 0..SAMPLES {
                    let samples = std::array::from_fn(|own| S::from_f64(columns[own][place]));
                    bank.encode_into(tick(place), samples, Items(&mut items));
                    if place % flight::KEYFRAME_EVERY as usize == 0 {
                        bank.keyframe_into(tick(place), Items(&mut items));
                    }
                    sent.extend(items.iter().filter_map(|item| match item {
                        Item::Event(event) => Some(*event),
                        _ => None,
                    }));
                    let mut source = FromItems(items.drain(..));
                    while let Some(frame) = transmitter.next_frame(&mut source, &mut buffer).unwrap() {
                        let mut bytes = frame;
                        while let Some(received) = reader.next_frame(&mut bytes) {
                            receiver.apply(&received, |_, _, _| ());
                        }
                    }
                    receiver.advance(tick(place + 1), |_, _, _| ());
                    for (own, (_, decoded)) in laptop.iter().enumerate() {
                        if let Some(value) = receiver.exact(own as u16) {
                            let is_same = value.to_f64().to_bits() == S::from_f64(decoded[place]).to_f64().to_bits();
                            assert!(is_same, "channel {own}, sample {place}: {value:?}, {}", decoded[place]);
                            compared += 1;
                        }
                    }
                }
                // From the first keyframe, or the second, all are exact.
                assert!(compared >= (SAMPLES - 60) * flight::CHANNELS, "{compared}");

                let (neurons, slot_ticks) = (told.neurons() as u16, told.slot_ticks());
                let mut expected: Vec<Event> = (0..).zip(&laptop).flat_map(|(channel, (events, _))| {
                    events.iter().map(move |own| Event {
                        tick: tick(own.sample as usize) + u32::from(own.slot) * slot_ticks,
                        address: channel * neurons + own.neuron,
                        polarity: own.polarity,
                    })
                }).collect();
                expected.sort_by_key(|event| (event.tick.micros(), event.address));
                sent.sort_by_key(|event| (event.tick.micros(), event.address));
                assert!(sent.len() > 100 && sent == expected, "{} events, {}", sent.len(), expected.len());
            }
        }
    )*};
}

flights! { sod sf asf grf_slots }
