//! `listen` with a different flight file than the sender's marks no value as exact, whatever the difference between the
//! two files.

use catalogue::run::Known;
use lab::flight::Flight;
use spikewire::link::{MAX_FRAME, Session, Transmitter};
use spikewire::{Event, FromItems, Item, Keyframe, Tick};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

const SAMPLES: usize = 60;
const NAMES: [&str; 4] = ["roll", "pitch", "yaw", "thrust"];

/// The fields of a flight file, to be varied one at a time.
struct File<'a> {
    scheme: &'a str,
    parameters: String,
    sample: &'a str,
    period: usize,
    names: [String; 4],
    unit: &'a str,
    counts: f64,
    filter: String,
}

impl Default for File<'_> {
    fn default() -> Self {
        Self {
            scheme: "sf",
            parameters: "threshold = 0.1".into(),
            sample: "f32",
            period: 2000,
            names: NAMES.map(str::to_owned),
            unit: "rad/s",
            counts: 1.0,
            filter: String::new(),
        }
    }
}

impl File<'_> {
    fn text(&self) -> String {
        let Self { scheme, parameters, sample, period, names, unit, counts, filter } = self;
        let mut text = format!(
            "version = 1\nscheme = \"{scheme}\"\nsample = \"{sample}\"\nperiod = {period}\nkeyframe_every = 5\n{filter}\n\
             parameters = {{ {parameters} }}\n"
        );
        for name in names {
            let channel = format!("name = \"{name}\"\nunit = \"{unit}\"\ncounts = {counts:?}");
            writeln!(text, "[[channel]]\n{channel}").unwrap();
        }
        text
    }
}

/// Returns a flight file for each scheme in the catalogue.
fn codes() -> Vec<String> {
    let codes = catalogue::INFO.iter().map(|info| File {
        scheme: info.name,
        parameters: catalogue::run::example(info),
        ..File::default()
    });
    codes.map(|file| file.text()).collect()
}

/// Returns, for each field of a flight file, files that differ in this field only.
fn kinds() -> BTreeMap<&'static str, Vec<String>> {
    let seven =
        |file: &dyn Fn(usize) -> File<'static>| (0..7).map(|step| file(step).text()).collect();
    let file = File::default;
    let swapped = |one: usize, other: usize| {
        let mut names = NAMES.map(str::to_owned);
        names.swap(one, other);
        File { names, ..file() }.text()
    };
    let swaps = (0..4).flat_map(|one| (0..=one).map(move |other| (one, other)));
    let samples = ["f32", "q16.16", "q4.28", "q6.26", "q8.8", "q5.11", "q6.10"];
    let units = ["", "rad/s", "deg/s", "m/s", "m/s²", "g", "V"];
    BTreeMap::from([
        ("code", codes()),
        ("sample type", seven(&|step| File { sample: samples[step], ..file() })),
        (
            "threshold",
            seven(&|step| File { parameters: format!("threshold = 0.1{step}"), ..file() }),
        ),
        ("order of equal channels", swaps.map(|(one, other)| swapped(one, other)).collect()),
        (
            "names",
            seven(&|step| File { names: NAMES.map(|name| format!("{name}{step}")), ..file() }),
        ),
        ("period", seven(&|step| File { period: 2000 + step, ..file() })),
        ("unit", seven(&|step| File { unit: units[step], ..file() })),
        ("counts", seven(&|step| File { counts: 1.0 + step as f64 / 8.0, ..file() })),
        (
            "filter",
            seven(&|step| File {
                filter: format!("filter = {{ kind = \"low-pass\", corner = {} }}", 40 + step),
                ..file()
            }),
        ),
    ])
}

/// Simulates the sender of a flight; returns its frames, which carry the flight's fingerprint.
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

/// Returns the bits by which a keyframe expresses a sample.
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

/// Returns the number of values that `listen` would mark as exact, for these bytes and the receiver of this flight.
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

#[test]
fn no_mistaken_pair_has_an_exact_value() {
    let mut found: BTreeMap<String, BTreeSet<&str>> = BTreeMap::new();
    let kinds = kinds();
    for (kind, texts) in &kinds {
        for text in texts {
            found.entry(text.clone()).or_default().insert(kind);
        }
    }
    let flights: Vec<_> = found
        .iter()
        .map(|(text, kinds)| {
            let flight = Flight::parse(text).unwrap_or_else(|error| panic!("{error}: {text}"));
            let frames = sent(&flight);
            (text, kinds, flight, frames)
        })
        .collect();
    let (mut heard_own, mut same) = (0, 0);
    let mut pairs: BTreeMap<&str, usize> = BTreeMap::new();
    for (near, near_kinds, sender, frames) in &flights {
        for (far, far_kinds, flight, _) in &flights {
            if near_kinds.is_disjoint(far_kinds) {
                continue;
            }
            let exact = exact(flight, frames);
            if near == far {
                heard_own += usize::from(exact > 20);
                continue;
            }
            // Receptive fields of one width are the same code as the cells between their centres.
            if sender.fingerprint() == flight.fingerprint() {
                same += 1;
                continue;
            }
            assert_eq!(exact, 0, "{near}\nheard by\n{far}");
            let common = near_kinds.intersection(far_kinds);
            common.for_each(|kind| *pairs.entry(kind).or_default() += 1);
        }
    }
    println!("{pairs:?}; {heard_own} of {} hear their own", flights.len());
    assert!(kinds.keys().all(|kind| pairs[kind] >= 30), "{pairs:?}");
    assert_eq!(same, 2, "grf and position");
    // Codes that decode to means are never exact, and some rate codes need more samples.
    assert!(heard_own + 8 > flights.len(), "{heard_own} of {}", flights.len());
}
