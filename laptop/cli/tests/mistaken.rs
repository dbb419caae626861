//! `listen` must not mark a decoded value as exact if the receiver's flight file differs from the sender's. The test
//! tries pairs of flight files that differ in one field.

use catalogue::run::Known;
use lab::flight::Flight;
use spikewire::link::{MAX_FRAME, Session, Transmitter};
use spikewire::{Event, FromItems, Item, Keyframe, Tick};
use std::collections::{BTreeMap, BTreeSet};

#[path = "../../flight/examples/mistaken/list.rs"]
mod list;

const SAMPLES: usize = 60;

/// Simulates the sender of a flight. Returns the frames that it sends, which carry a fingerprint of the flight's
/// settings.
fn sent(flight: &Flight) -> Vec<u8> {
    let mut filters = flight.filters().unwrap();
    let mut items: Vec<Vec<Item>> = vec![Vec::new(); SAMPLES];
    let neurons = flight.neurons() as u16;
    let tick = |sample: usize| Tick::from_micros(sample as u64 * u64::from(flight.period.get()));
    for (index, (channel, settings)) in flight.channels.iter().zip(flight.settings()).enumerate() {
        let mut values: Vec<f64> = (0..SAMPLES)
            .map(|at| (at as f64 * 0.03 * (index as f64 + 1.0)).sin() * 1.2 * channel.counts)
            .collect();
        if let Some(filter) = filters.get_mut(index) {
            for value in &mut values {
                *value = filter(*value);
            }
        }
        // Codes of steps start from the first sample.
        let known = Known { calibrated: None, first: &values, can_calibrate: false };
        let asked = flight.asked(channel);
        let started = flight.run_time().resolve(flight.sample, &asked, &known).unwrap();
        let settings = if flight.scheme.has_first_value() { &started } else { settings };
        let mut codec = flight.run_time().codec(settings).unwrap();
        let (mut events, mut decoded) = (Vec::new(), Vec::new());
        codec.encode(&values, &mut events);
        codec.finish(&mut events);
        codec.decode(SAMPLES, &events, &mut decoded).unwrap();
        let first = index as u16 * neurons;
        for event in events {
            let at = event.sample as usize;
            let tick = tick(at) + u32::from(event.slot) * flight.slot_ticks();
            items[at].push(Item::Event(Event {
                tick,
                address: first + event.neuron,
                polarity: event.polarity,
            }));
        }
        for at in (0..SAMPLES).step_by(flight.keyframe_every as usize) {
            if flight.scheme.has_first_value() {
                let bits = bits(flight, decoded[at]);
                let kind = flight.sample.into();
                items[at].push(Item::Keyframe(Keyframe {
                    tick: tick(at),
                    address: first,
                    kind,
                    bits,
                }));
            } else if index == 0 {
                items[at].push(Item::Heartbeat { tick: tick(at), address: 0 });
            }
        }
    }
    let mut transmitter = Transmitter::new(flight.coding(), Session::counted(7))
        .with_fingerprint(flight.fingerprint());
    let (mut bytes, mut buffer) = (Vec::new(), [0; MAX_FRAME]);
    for mut items in items {
        // The transmitter takes events by time and address, then keyframes.
        items.sort_by_key(|item| match item {
            Item::Event(event) => (false, event.tick.micros(), event.address),
            other => (true, other.tick().micros(), 0),
        });
        let mut source = FromItems(items.into_iter());
        while let Some(frame) = transmitter.next_frame(&mut source, &mut buffer).unwrap() {
            bytes.extend_from_slice(frame);
        }
    }
    bytes
}

/// Converts `value` to the flight's sample type, and returns its bits. A keyframe carries these bits, so that a decoder
/// can continue from the value.
fn bits(flight: &Flight, value: f64) -> u32 {
    use catalogue::run::SampleType;
    match flight.sample {
        SampleType::F32 => (value as f32).to_bits(),
        SampleType::Fixed16 { fraction } => {
            u32::from(((value * 2_f64.powi(fraction.into())) as i16).cast_unsigned())
        }
        SampleType::Fixed32 { fraction } => {
            ((value * 2_f64.powi(fraction.into())) as i32).cast_unsigned()
        }
    }
}

/// Decodes `bytes` with the receiver of `flight`; returns the number of values that `listen` would mark as exact.
fn exact(flight: &Flight, bytes: &[u8]) -> usize {
    use lab::events::{LinkReader, Stream, values_writer};
    let mut heard = Vec::new();
    lab::flight::with_receiver(flight, |values| {
        let reader = Box::new(LinkReader::new(Some(values)));
        let mut stream = Stream::new(reader, values_writer(flight.sample), false);
        stream.push(bytes, None, &mut heard)?;
        stream.finish(&mut heard)
    })
    .unwrap();
    String::from_utf8(heard).unwrap().lines().filter(|line| line.ends_with(",exact")).count()
}

/// A simulated sender.
struct Sender {
    /// Text of the sender's flight file.
    text: String,
    /// Names of fields of the flight file. If two senders of the test have one of these names in common, their flight
    /// files differ only in the field of this name.
    kinds: BTreeSet<&'static str>,
    flight: Flight,
    /// The bytes that the sender sends.
    frames: Vec<u8>,
}

fn senders() -> Vec<Sender> {
    let flights = list::flights().into_iter();
    let senders = flights.map(|(text, kinds)| {
        let flight = Flight::parse(&text).unwrap_or_else(|error| panic!("{error}: {text}"));
        let frames = sent(&flight);
        Sender { text, kinds, flight, frames }
    });
    senders.collect()
}

#[test]
fn no_mistaken_pair_has_an_exact_value() {
    let senders = senders();
    let (mut heard_own, mut same) = (0, 0);
    let mut pairs: BTreeMap<&str, usize> = BTreeMap::new();
    for near in &senders {
        heard_own += usize::from(exact(&near.flight, &near.frames) > 20);
        for far in senders.iter().filter(|far| far.text != near.text) {
            let mut common = near.kinds.intersection(&far.kinds).peekable();
            if common.peek().is_none() {
                continue;
            }
            // Receptive fields of one width are the same code as the cells between their centres.
            if near.flight.fingerprint() == far.flight.fingerprint() {
                same += 1;
                continue;
            }
            let exact = exact(&far.flight, &near.frames);
            assert_eq!(exact, 0, "{}\nheard by\n{}", near.text, far.text);
            common.for_each(|kind| *pairs.entry(kind).or_default() += 1);
        }
    }
    println!("{pairs:?}; {heard_own} of {} hear their own", senders.len());
    let kinds: BTreeSet<_> = senders.iter().flat_map(|own| &own.kinds).collect();
    assert!(kinds.into_iter().all(|kind| pairs[kind] >= 30), "{pairs:?}");
    assert_eq!(same, 2, "grf and position");
    // Codes that decode to means are never exact, and some rate codes need more samples.
    assert!(heard_own + 8 > senders.len(), "{heard_own} of {}", senders.len());
}
