//! The generated senders and receivers compile, and their events and values are bit for bit those of the laptop.

use catalogue::run::{Event as Fired, Known};
use spikewire::link::{MAX_FRAME, Reader, Session};
use spikewire::{Event, FromItems, Item, Put, Sample, Scheme, Tick};
use spikewire_flight::{Flight, rust};
use std::collections::{BTreeSet, VecDeque};

/// Number of samples of each flight.
const SAMPLES: usize = 1500;

/// A queue to which a bank appends its items. Those that wait for others stay in it, as in the queue of a firmware.
struct Items<'a>(&'a mut VecDeque<Item>);

impl Put for Items<'_> {
    fn put(&mut self, item: Item) {
        self.0.push_back(item);
    }
}

/// Takes the items of a queue one by one.
fn taken(items: &mut VecDeque<Item>) -> FromItems<impl Iterator<Item = Item>> {
    FromItems(std::iter::from_fn(|| items.pop_front()))
}

/// Returns the test signal of a channel, in counts: a slow and a fast sine wave, and a square wave.
fn signal(flight: &Flight, channel: usize) -> Vec<f64> {
    let counts = flight.channels[channel].counts;
    let value = |sample: usize| {
        let (at, pace) = (sample as f64, channel as f64 + 1.0);
        let jump = if sample / 400 % 2 == 1 { 0.8 } else { 0.0 };
        (at * 0.011 * pace).sin() + 0.2 * (at * 0.9).sin() + jump
    };
    (0..SAMPLES).map(|sample| value(sample) * counts).collect()
}

/// Encodes and decodes the test signal of a channel with the laptop's codec; returns its events and decoded values.
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

/// Returns a sample of a triangle wave with a different frequency in each channel, which `bindings/c/tests/ends.c`
/// generates too. The values are the same on every machine.
fn saw(sample: u32, channel: u32, counts: f64) -> f64 {
    let saw = sample * (3 + 2 * channel) % 193;
    let value = (f64::from(if saw < 97 { saw } else { 193 - saw }) - 48.0) / 32.0 * counts;
    if counts > 1.0 { value.trunc() } else { value }
}

/// Continues an FNV-1a hash with these bytes.
fn fnv(hash: u64, bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(hash, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

/// Defines the tests for each flight in `tests/flights`, named after its file.
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
                let (mut items, mut buffer) = (VecDeque::new(), [0; MAX_FRAME]);
                let (mut bytes, mut frames) = (Vec::new(), 0);
                for sample in 0..400 {
                    let tick = Tick::from(sample * u32::from(flight::PERIOD));
                    let value = |channel: usize| S::from_f64(saw(sample, channel as u32, flight::COUNTS[channel]));
                    bank.encode_into(tick, std::array::from_fn(value), Items(&mut items));
                    if sample % flight::KEYFRAME_EVERY == 0 {
                        bank.keyframe_into(tick, Items(&mut items));
                    }
                    transmitter.observe(tick);
                    while let Some(frame) = transmitter.next_frame(taken(&mut items), &mut buffer).unwrap() {
                        bytes.extend_from_slice(frame);
                        frames += 1;
                    }
                }
                let mut hash = fnv(0xcbf2_9ce4_8422_2325, &bytes);
                let (mut reader, mut receiver) = (Reader::<MAX_FRAME>::new(), flight::receiver());
                // Counted after every 64 bytes: shorter frames have fewer of these, and no less is exact.
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
                assert!(known.lines().any(|flown| flown == line), "tests/flights/flown.txt lacks {line}");
            }

            #[test]
            fn both_ends_have_the_laptops_bits() {
                type S = <flight::Code as Scheme>::Sample;
                let parsed = Flight::parse(include_str!(concat!("flights/", stringify!($name), ".toml"))).unwrap();
                let columns: Vec<Vec<f64>> = (0..flight::CHANNELS).map(|channel| signal(&parsed, channel)).collect();
                let laptop: Vec<_> = (0..flight::CHANNELS).map(|channel| on_the_laptop(&parsed, channel)).collect();

                let (mut bank, mut transmitter) = (flight::BANK, flight::transmitter(Session::counted(1)));
                let (mut reader, mut receiver) = (Reader::<MAX_FRAME>::new(), flight::receiver());
                let (mut sent, mut items) = (Vec::<Event>::new(), VecDeque::new());
                let mut arrived = 0;
                let mut buffer = [0; MAX_FRAME];
                let tick = |sample: usize| Tick::from_micros(sample as u64 * u64::from(flight::PERIOD));
                let mut compared = 0;
                for sample in 0..SAMPLES {
                    let samples = std::array::from_fn(|channel| S::from_f64(columns[channel][sample]));
                    let waiting = items.len();
                    bank.encode_into(tick(sample), samples, Items(&mut items));
                    if sample % flight::KEYFRAME_EVERY as usize == 0 {
                        bank.keyframe_into(tick(sample), Items(&mut items));
                    }
                    sent.extend(items.iter().skip(waiting).filter_map(|item| match item {
                        Item::Event(event) => Some(*event),
                        _ => None,
                    }));
                    transmitter.observe(tick(sample));
                    while let Some(frame) = transmitter.next_frame(taken(&mut items), &mut buffer).unwrap() {
                        let mut bytes = frame;
                        while let Some(received) = reader.next_frame(&mut bytes) {
                            arrived += received.frame.events().count();
                            receiver.apply(&received, |_, _, _| ());
                        }
                    }
                    receiver.advance(tick(sample + 1), |_, _, _| ());
                    // Values of a sample whose events wait come later.
                    if arrived < sent.len() {
                        continue;
                    }
                    for (channel, (_, decoded)) in laptop.iter().enumerate() {
                        if let Some(value) = receiver.exact(channel as u16) {
                            let is_same = value.to_f64().to_bits() == S::from_f64(decoded[sample]).to_f64().to_bits();
                            assert!(is_same, "channel {channel}, sample {sample}: {value:?}, {}", decoded[sample]);
                            compared += 1;
                        }
                    }
                }
                // All values are exact from the first or second keyframe on.
                let least = if parsed.gathering == 0 { SAMPLES - 60 } else { SAMPLES / 4 };
                assert!(compared >= least * flight::CHANNELS, "{compared}");

                let (neurons, slot_ticks) = (parsed.neurons() as u16, parsed.slot_ticks());
                let mut expected: Vec<Event> = (0..).zip(&laptop).flat_map(|(channel, (events, _))| {
                    events.iter().map(move |event| Event {
                        tick: tick(event.sample as usize) + u32::from(event.slot) * slot_ticks,
                        address: channel * neurons + event.neuron,
                        polarity: event.polarity,
                    })
                }).collect();
                expected.sort_by_key(|event| (event.tick.micros(), event.address));
                sent.sort_by_key(|event| (event.tick.micros(), event.address));
                assert!(sent.len() > 100 && sent == expected, "{} events, {}", sent.len(), expected.len());
            }
        }
    )*};
}

flights! { sod sod_i32 sf sf_q2_14 asf asf_q16_16 grf_slots notch first_order healing }

/// With step numbers, a channel whose events were lost is the sender's again at its next event, bit for bit, long before
/// the next keyframe. A receiver knows the numbers from the frames, also if its own flight file has none.
#[test]
fn lost_steps_heal_at_the_next_event() {
    use healing::flight;
    type S = <flight::Code as Scheme>::Sample;

    let text = include_str!("flights/healing.toml");
    let without = Flight::parse(&text.replace("step_bits = 4", "")).unwrap();
    assert_eq!(without.fingerprint(), flight::receiver().fingerprint());

    let (mut bank, mut transmitter) = (flight::BANK, flight::transmitter(Session::random(11)));
    let (mut reader, mut receiver) = (Reader::<MAX_FRAME>::new(), flight::receiver());
    let (mut items, mut buffer) = (VecDeque::new(), [0; MAX_FRAME]);
    // A reader that gets every frame says what is in the lost ones.
    let mut witness = Reader::<MAX_FRAME>::new();
    let mut is_off = [false; flight::CHANNELS];
    let (mut frames, mut lost, mut healed) = (0, 0, 0);
    for sample in 0..4_000 {
        let tick = Tick::from(sample * flight::PERIOD);
        let value = |channel: usize| S::from_f64(saw(sample, channel as u32, 1.0));
        bank.encode_into(tick, std::array::from_fn(value), Items(&mut items));
        if sample % flight::KEYFRAME_EVERY == 0 {
            bank.keyframe_into(tick, Items(&mut items));
        }
        transmitter.observe(tick);
        // Channels whose last event so far has arrived.
        let mut current = BTreeSet::new();
        while let Some(frame) = transmitter.next_frame(taken(&mut items), &mut buffer).unwrap() {
            frames += 1;
            let (mut sent, mut arriving) = (frame, frame);
            let seen = witness.next_frame(&mut sent).unwrap();
            let channels = seen.frame.events().map(|event| usize::from(event.address));
            let has_keyframes = seen.frame.keyframes().count() > 0;
            if frames % 7 == 0 && !has_keyframes {
                lost += 1;
                for channel in channels {
                    is_off[channel] = true;
                    current.remove(&channel);
                }
                continue;
            }
            let heard = reader.next_frame(&mut arriving).unwrap();
            receiver.apply(&heard, |_, _, _| ());
            if has_keyframes {
                is_off.fill(false);
            }
            current.extend(channels);
        }
        for channel in current {
            let base = bank.keyframe(channel).unwrap();
            assert_eq!(
                receiver.estimate(channel as u16),
                base,
                "channel {channel}, sample {sample}"
            );
            healed += usize::from(std::mem::take(&mut is_off[channel]));
        }
    }
    assert!(lost > 100 && healed > 200, "{lost} frames lost, {healed} channels healed");
}
