//! Short frames: a writer and a reader written from the specification alone give and take the same bytes, with frames
//! lost between; and step codes that heal after any loss that their step numbers tell apart.

#![allow(
    clippy::similar_names,
    clippy::format_push_string,
    clippy::format_collect,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "a specification in plain arithmetic, on numbers that fit"
)]

use std::collections::{HashMap, VecDeque};

use proptest::prelude::*;
use spikewire::link::{
    Coding, FrameView, Framer, LinkError, MAX_FRAME, Reader, Received, Receiver, Session,
    Transmitter,
};
use spikewire::temporal::{SendOnDelta, StepForward};
use spikewire::{
    Code, Event, Fingerprint, FromItems, Item, Keyframe, NeuronSpike, Polarity, Sample, Scheme,
    Taken, Tick,
};

const NUMBERS: u64 = 1 << 48;

/// The checksum of the specification, bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = !0_u32;
    for &byte in bytes {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 };
        }
    }
    !crc
}

/// A string of bits.
#[derive(Default)]
struct Bits(String);

impl Bits {
    fn put(&mut self, value: u64, count: usize) {
        if count > 0 {
            self.0 += &format!("{value:0count$b}");
        }
    }

    fn put_code(&mut self, value: u64, k: u32) {
        let n = (value >> k) + 1;
        let digits = format!("{n:b}");
        self.0 += &"0".repeat(digits.len() - 1);
        self.0 += &digits;
        self.put(value & ((1 << k) - 1), k as usize);
    }

    fn bytes(mut self) -> Vec<u8> {
        while !self.0.len().is_multiple_of(8) {
            self.0.push('0');
        }
        let bytes = self.0.as_bytes().chunks(8);
        bytes.map(|bits| u8::from_str_radix(str::from_utf8(bits).unwrap(), 2).unwrap()).collect()
    }

    fn of_bytes(bytes: &[u8]) -> Self {
        Self(bytes.iter().map(|byte| format!("{byte:08b}")).collect())
    }

    fn take(&mut self, count: usize) -> Option<u64> {
        if count > self.0.len() {
            return None;
        }
        let rest = self.0.split_off(count);
        let bits = std::mem::replace(&mut self.0, rest);
        if count == 0 { Some(0) } else { u64::from_str_radix(&bits, 2).ok() }
    }

    fn take_code(&mut self, k: u32) -> Option<u64> {
        let zeros = self.0.find('1')?;
        self.take(zeros)?;
        let n = self.take(zeros + 1)?;
        Some((n - 1) << k | self.take(k as usize)?)
    }

    fn is_over(&self) -> bool {
        self.0.len() < 8 && !self.0.contains('1')
    }
}

fn zigzag(value: i64) -> u64 {
    if value < 0 { (-2 * value - 1) as u64 } else { 2 * value as u64 }
}

fn unzigzag(code: u64) -> i64 {
    if code % 2 == 1 { -(code as i64 + 1) / 2 } else { (code / 2) as i64 }
}

/// The settings of a sender.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Settings {
    period: u64,
    address_bits: u32,
    jitter_bits: u32,
    step_bits: u32,
    fingerprint: Option<u32>,
}

impl Settings {
    fn grid_bits(&self) -> usize {
        let bits = 64 - self.period.leading_zeros() as i32;
        (21 - bits).clamp(0, 16) as usize
    }

    fn counts(&self) -> i64 {
        1 << self.grid_bits()
    }

    fn step_mask(&self) -> i64 {
        (1 << self.step_bits) - 1
    }

    /// What a short frame leaves out.
    fn left_out(&self, number: u64, epoch: u64) -> Vec<u8> {
        let mut bytes = self.period.to_le_bytes()[..3].to_vec();
        bytes.push((self.jitter_bits << 4 | self.address_bits) as u8);
        bytes.push(self.step_bits as u8);
        bytes.push(self.fingerprint.is_some().into());
        bytes.extend(self.fingerprint.unwrap_or(0).to_le_bytes());
        bytes.extend(&(number / 256).to_le_bytes()[..5]);
        bytes.extend(&epoch.to_le_bytes()[..6]);
        bytes
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Spiked {
    time: u64,
    address: u16,
    is_up: bool,
}

/// A frame as it is meant: keyframes of `i16`, and events.
#[derive(Clone, Debug, Default, PartialEq)]
struct Meant {
    time: u64,
    is_lost: bool,
    keyframes: Vec<(u16, i16)>,
    events: Vec<Spiked>,
}

/// The writer of the specification.
struct Writer {
    settings: Settings,
    number: u64,
    sent: u32,
    /// Time and number of the last frame's point on the grid.
    point: (u64, i64),
    last_full: u64,
    steps: HashMap<u16, i64>,
}

impl Writer {
    fn write(&mut self, frame: &Meant) -> Vec<u8> {
        let Settings { period, .. } = self.settings;
        let is_first = self.sent == 0;
        if is_first {
            self.point = (frame.time, 0);
        }
        let since = frame.time as i64 - self.point.0 as i64;
        let steps = (since as f64 / period as f64).round() as i64;
        let jitter = since - steps * period as i64;
        let counts = self.settings.counts();
        let point = ((self.point.0 as i64 + steps * period as i64) as u64, self.point.1 + steps);
        let count = point.1.rem_euclid(counts) as u64;
        let every = if frame.keyframes.is_empty() { 1 << 19 } else { 1 << 18 };
        let mut bits = Bits::default();
        bits.put(count, self.settings.grid_bits());
        bits.put_code(zigzag(jitter), self.settings.jitter_bits);
        let is_full = self.sent < 4
            || frame.is_lost
            || frame.time as i64 - self.last_full as i64 >= every
            || steps > counts / 2
            || steps < -(counts / 8)
            || bits.0.len() >= 32;
        if is_full {
            bits = Bits::default();
        }

        let mut payload = Vec::new();
        if let Some(fingerprint) = self.settings.fingerprint.filter(|_| is_full) {
            payload.extend(fingerprint.to_le_bytes());
        }
        if !frame.keyframes.is_empty() {
            payload.extend([frame.keyframes.len() as u8, 1]);
        }
        for &(address, value) in &frame.keyframes {
            payload.extend(address.to_le_bytes());
            payload.extend(value.to_le_bytes());
            if self.settings.step_bits > 0 {
                let step = if address < 16 { self.steps.get(&address).unwrap_or(&0) } else { &0 };
                payload.push((step & self.settings.step_mask()) as u8);
            }
        }
        self.events(frame, &mut bits);
        payload.extend(bits.bytes());

        let number = self.number;
        self.number = (number + 1) % NUMBERS;
        self.sent += 1;
        let has_keyframes = !frame.keyframes.is_empty();
        let mut bytes = Vec::new();
        let mut before = Vec::new();
        if is_full {
            let kept = i16::try_from(jitter).is_ok();
            self.point = if kept { point } else { (frame.time, point.1) };
            self.last_full = frame.time;
            let lost = u8::from(frame.is_lost);
            let described = u8::from(self.settings.fingerprint.is_some());
            let flags =
                lost | u8::from(has_keyframes) << 1 | u8::from(is_first) << 2 | described << 3;
            bytes.extend([0xA5, 4 << 4 | flags]);
            bytes.extend(&number.to_le_bytes()[..6]);
            bytes.extend(&frame.time.to_le_bytes()[..6]);
            bytes.extend(&period.to_le_bytes()[..3]);
            bytes.push((self.settings.jitter_bits << 4 | self.settings.address_bits) as u8);
            bytes.push(self.settings.step_bits as u8);
            bytes.extend((count as u16).to_le_bytes());
            bytes.extend(i16::try_from(jitter).unwrap_or(0).to_le_bytes());
            bytes.push(payload.len() as u8);
        } else {
            self.point = point;
            let epoch = point.0 - count * period;
            before = self.settings.left_out(number, epoch);
            let first = 0x60 | u8::from(has_keyframes) << 4;
            if payload.len() <= 15 {
                bytes.push(first | (payload.len() - 1) as u8);
            } else {
                bytes.extend([first | 15, payload.len() as u8]);
            }
            bytes.push(number as u8);
        }
        bytes.extend(payload);
        let checksum = crc32(&[&before[..], &bytes].concat());
        bytes.extend(checksum.to_le_bytes());
        bytes
    }

    fn events(&mut self, frame: &Meant, bits: &mut Bits) {
        let Settings { period, address_bits, jitter_bits, step_bits, .. } = self.settings;
        let (mut time, mut next, mut seen) = (frame.time, 0, Vec::new());
        for event in &frame.events {
            let address = u64::from(event.address);
            if event.time == time && address >= next {
                bits.put(0, 1);
                bits.put_code(2 * (address - next) + u64::from(event.is_up), address_bits + 1);
            } else {
                let since = event.time as i64 - time as i64;
                let steps = (since as f64 / period as f64).round() as i64;
                bits.put(1, 1);
                bits.put_code(zigzag(steps - 1), 0);
                bits.put_code(zigzag(since - steps * period as i64), jitter_bits);
                bits.put_code(2 * address + u64::from(event.is_up), address_bits + 1);
            }
            let step = self.steps.entry(event.address).or_default();
            *step += if event.is_up { 1 } else { -1 };
            if event.address < 16 && !seen.contains(&event.address) {
                bits.put((*step & self.settings.step_mask()) as u64, step_bits as usize);
            }
            seen.push(event.address);
            (time, next) = (event.time, address + 1);
        }
    }
}

/// The reader of the specification, for bytes of one frame.
#[derive(Default)]
struct Known {
    last: Option<Last>,
}

struct Last {
    settings: Settings,
    number: u64,
    point: u64,
    count: i64,
}

impl Known {
    /// The number of a frame and what it says, if it can be read.
    fn read(&mut self, bytes: &[u8]) -> Option<(u64, Meant)> {
        let (body, checksum) = bytes.split_at(bytes.len() - 4);
        let is_checked = |before: &[u8]| crc32(&[before, body].concat()).to_le_bytes() == checksum;
        let whole = |bytes: &[u8]| {
            bytes.iter().rev().fold(0_u64, |number, &byte| number << 8 | u64::from(byte))
        };
        if bytes[0] == 0xA5 {
            assert_eq!(bytes[1] >> 4, 4);
            assert!(is_checked(&[]));
            let (flags, code) = (bytes[1], u32::from(bytes[17]));
            let has_fingerprint = flags & 8 != 0;
            let settings = Settings {
                period: whole(&body[14..17]),
                address_bits: code & 15,
                jitter_bits: code >> 4,
                step_bits: bytes[18].into(),
                fingerprint: has_fingerprint.then(|| whole(&body[24..28]) as u32),
            };
            let (number, time) = (whole(&body[2..8]), whole(&body[8..14]));
            let jitter = i16::from_le_bytes([body[21], body[22]]);
            let point = (time as i64 - i64::from(jitter)) as u64;
            let count = whole(&body[19..21]) as i64;
            self.last = Some(Last { settings, number, point, count });
            let from = if has_fingerprint { 28 } else { 24 };
            let (keyframes, at) = entries(settings, flags & 2 != 0, &body[from..]);
            let mut bits = Bits::of_bytes(&body[from + at..]);
            let events = events(settings, time, &mut bits)?;
            return Some((number, Meant { time, is_lost: flags & 1 != 0, keyframes, events }));
        }
        let last = self.last.as_ref()?;
        let settings = last.settings;
        let header = if bytes[0] & 15 == 15 { 3 } else { 2 };
        let (low, payload) = (u64::from(bytes[header - 1]), &body[header..]);
        let (keyframes, at) = entries(settings, bytes[0] & 16 != 0, payload);
        let mut bits = Bits::of_bytes(&payload[at..]);
        let count = bits.take(settings.grid_bits())? as i64;
        let jitter = unzigzag(bits.take_code(settings.jitter_bits)?);
        let near = |number: &u64| number % 256 == low;
        let next = last.number + 1;
        let around = NUMBERS + next - 32..NUMBERS + next + 224;
        let number = around.map(|number| number % NUMBERS).find(near).unwrap();
        let counts = settings.counts();
        let steps = (-(counts / 8)..counts - counts / 8)
            .find(|steps| (last.count + steps).rem_euclid(counts) == count)?;
        let point = (last.point as i64 + steps * settings.period as i64) as u64;
        let epoch = point.wrapping_sub(count as u64 * settings.period) % NUMBERS;
        if !is_checked(&settings.left_out(number, epoch)) {
            return None;
        }
        let time = (point as i64 + jitter) as u64;
        self.last = Some(Last { settings, number, point, count });
        let events = events(settings, time, &mut bits)?;
        Some((number, Meant { time, is_lost: false, keyframes, events }))
    }
}

fn entries(settings: Settings, is_there: bool, payload: &[u8]) -> (Vec<(u16, i16)>, usize) {
    if !is_there {
        return (Vec::new(), 0);
    }
    assert_eq!(payload[1], 1, "whole numbers of 16 bits");
    let size = if settings.step_bits > 0 { 5 } else { 4 };
    let end = 2 + usize::from(payload[0]) * size;
    let entry = |bytes: &[u8]| {
        (u16::from_le_bytes([bytes[0], bytes[1]]), i16::from_le_bytes([bytes[2], bytes[3]]))
    };
    (payload[2..end].chunks(size).map(entry).collect(), end)
}

fn events(settings: Settings, start: u64, bits: &mut Bits) -> Option<Vec<Spiked>> {
    let (mut time, mut next, mut events) = (start, 0, Vec::<Spiked>::new());
    while !bits.is_over() {
        if bits.take(1)? == 1 {
            let steps = unzigzag(bits.take_code(0)?) + 1;
            let jitter = unzigzag(bits.take_code(settings.jitter_bits)?);
            time = (time as i64 + steps * settings.period as i64 + jitter) as u64;
            next = 0;
        }
        let code = bits.take_code(settings.address_bits + 1)?;
        let address = (next + code / 2) as u16;
        if address < 16 && events.iter().all(|event| event.address != address) {
            bits.take(settings.step_bits as usize)?;
        }
        events.push(Spiked { time, address, is_up: code % 2 == 1 });
        next = u64::from(address) + 1;
    }
    Some(events)
}

fn items(frame: &Meant) -> Vec<Item> {
    let tick = Tick::from_micros(frame.time);
    let mut items = Vec::new();
    if frame.is_lost {
        items.push(Item::Break(tick));
    }
    for &(address, value) in &frame.keyframes {
        items.push(Keyframe::new(tick, address, value).into());
    }
    for &Spiked { time, address, is_up } in &frame.events {
        let polarity = if is_up { Polarity::Up } else { Polarity::Down };
        items.push(Event { tick: Tick::from_micros(time), address, polarity }.into());
    }
    items
}

fn settings() -> impl Strategy<Value = Settings> {
    let period = prop_oneof![Just(1_u64), Just(125), Just(1_001), Just(2_001), 50_000..300_000_u64]
        .prop_map(|period| period | 1); // no time lies in the middle of two points
    let bits = (0_u32..6, 0_u32..12, 0_u32..=4);
    (period, bits, any::<Option<u32>>()).prop_map(|(period, bits, fingerprint)| Settings {
        period,
        address_bits: bits.0,
        jitter_bits: bits.1,
        step_bits: bits.2,
        fingerprint,
    })
}

/// A frame some periods after the one before, with events some periods apart.
#[derive(Clone, Debug)]
struct Drawn {
    periods: u64,
    early: f64,
    is_lost: bool,
    keyframes: Vec<(u16, i16)>,
    events: Vec<(u64, u16, bool)>,
    /// Whether the line loses it.
    is_missing: bool,
}

fn drawn() -> impl Strategy<Value = Drawn> {
    let periods = prop_oneof![8 => 0_u64..20, 2 => 0_u64..400, 1 => 0_u64..3_000];
    let early = prop_oneof![Just(0.0), -0.4..0.4];
    let address = prop_oneof![0_u16..6, 0_u16..40];
    let keyframes = prop::collection::vec((0_u16..20, any::<i16>()), 0..4);
    let keyframes = prop_oneof![4 => Just(Vec::new()), 1 => keyframes];
    let event = (prop_oneof![Just(0_u64), 0_u64..4], address, any::<bool>());
    let events = prop::collection::vec(event, 0..30);
    (periods, early, 0_u8..20, keyframes, events, 0_u8..4).prop_map(
        |(periods, early, lost, keyframes, events, missing)| Drawn {
            periods,
            early,
            is_lost: lost == 0,
            keyframes,
            events,
            is_missing: missing == 0,
        },
    )
}

proptest! {
    #![proptest_config(crate::common::cases(200))]

    /// The crate's transmitter and the writer of the specification give the same bytes, and its reader takes from them,
    /// with frames lost between, what the specification's takes.
    #[test]
    fn frames_are_those_of_the_specification(
        settings in settings(),
        start in 1_u64 << 20..1 << 31,
        session in any::<u64>(),
        frames in prop::collection::vec(drawn(), 1..60),
    ) {
        let coding = Coding {
            address_bits: settings.address_bits as u8,
            jitter_bits: settings.jitter_bits as u8,
            step_bits: settings.step_bits as u8,
            ..Coding::for_channels(1, settings.period as u32)
        };
        let mut link = Transmitter::new(coding, Session::random(session));
        if let Some(fingerprint) = settings.fingerprint {
            link = link.with_fingerprint(Fingerprint::from_bits(fingerprint));
        }
        let mut writer = Writer {
            settings,
            number: session.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 16,
            sent: 0,
            point: (0, 0),
            last_full: 0,
            steps: HashMap::new(),
        };
        let (mut known, mut reader) = (Known::default(), Reader::<MAX_FRAME>::new());
        let mut at = start;
        for Drawn { periods, early, is_lost, keyframes, events, is_missing } in frames {
            at += periods * settings.period;
            let time = at.wrapping_add_signed((early * settings.period as f64) as i64);
            let mut meant = Meant { time, is_lost, keyframes, events: Vec::new() };
            let mut now = time;
            for (periods, address, is_up) in events {
                now += periods * settings.period;
                meant.events.push(Spiked { time: now, address, is_up });
            }
            let Some(first) = items(&meant).first().map(Item::tick) else { continue };
            // A frame has the time of its first item.
            meant.time = first.widen(meant.time);
            let mut buffer = [0; MAX_FRAME];
            let mut source = FromItems(items(&meant).into_iter());
            let bytes = link.next_frame(&mut source, &mut buffer).unwrap().unwrap();
            prop_assert_eq!(bytes, writer.write(&meant));
            let mut more = [0; MAX_FRAME];
            prop_assert!(link.next_frame(&mut source, &mut more).unwrap().is_none());
            if is_missing {
                continue;
            }
            let expected = known.read(bytes);
            if let Some((_, expected)) = &expected {
                prop_assert_eq!(expected, &meant);
            }
            let (mut bytes, mut read) = (bytes, Vec::new());
            while let Some(received) = reader.next_frame(&mut bytes) {
                read.extend(heard(&received));
            }
            // What cannot be read may look like the beginning of a longer frame.
            while let Some(received) = reader.next_after_silence() {
                read.extend(heard(&received));
            }
            let expected = expected.map(|(number, meant)| Heard {
                number,
                time: meant.time,
                is_lost: meant.is_lost,
                items: items(&meant).into_iter().filter(|item| !matches!(item, Item::Break(_))).collect(),
            });
            prop_assert_eq!(read, Vec::from_iter(expected));
        }
    }
}

/// A frame as the crate reads it.
#[derive(Debug, PartialEq)]
struct Heard {
    number: u64,
    time: u64,
    is_lost: bool,
    items: Vec<Item>,
}

fn heard(received: &Received<'_>) -> Option<Heard> {
    let frame = received.frame;
    let keyframes = frame.keyframes().map(Item::Keyframe);
    (!received.is_unread).then(|| Heard {
        number: frame.number(),
        time: frame.micros(),
        is_lost: frame.is_after_loss(),
        items: keyframes.chain(frame.events().map(Item::Event)).collect(),
    })
}

/// The code of the ends at which a frame is damaged.
static STEP: StepForward<i16> = StepForward::new(10);

/// A line with one sender, whose frames are lost on demand.
struct Line {
    link: Transmitter,
    reader: Reader<MAX_FRAME>,
    now: u64,
}

impl Line {
    fn new(step_bits: u8) -> Self {
        let coding = Coding::for_channels(2, 1_000).with_step_bits(step_bits);
        let link = Transmitter::new(coding, Session::counted(3)).with_full_every(1 << 29);
        Self { link, reader: Reader::new(), now: 5_000 }
    }

    /// A frame of one sample's items.
    fn frame(&mut self, items: &[Item]) -> Vec<u8> {
        self.now += 1_000;
        let mut buffer = [0; MAX_FRAME];
        let source = FromItems(items.iter().copied());
        self.link.next_frame(source, &mut buffer).unwrap().unwrap().to_vec()
    }

    fn step(&self, polarity: Polarity) -> Item {
        Event { tick: Tick::from_micros(self.now), address: 1, polarity }.into()
    }
}

/// Every run of up to seven steps that is lost, from every step number, with each step after it: if it comes to fewer
/// than half of the steps that the numbers tell apart, the value is the sender's again, and an estimate until its keyframe.
#[test]
fn a_step_code_heals_after_every_loss_that_its_numbers_tell_apart() {
    static WHOLE: StepForward<i16> = StepForward::new(10);
    static FLOAT: StepForward<f32> = StepForward::new(0.25);
    static DELTA: SendOnDelta<i16, 4> = SendOnDelta::new(7);
    for bits in 1..=4_u8 {
        for before in 0..1_i32 << bits {
            for length in 0..=7 {
                for lost in 0..1_u32 << length {
                    for last in [Polarity::Up, Polarity::Down] {
                        let case = Loss { bits, before, length, lost, last };
                        heals(&WHOLE, case);
                        if bits == 4 {
                            heals(&FLOAT, case);
                            heals(&DELTA, case);
                        }
                    }
                }
            }
        }
    }
}

/// Steps before a loss, those that are lost, and the one after it.
#[derive(Clone, Copy, Debug)]
struct Loss {
    bits: u8,
    before: i32,
    length: u32,
    lost: u32,
    last: Polarity,
}

fn heals<P: Scheme>(scheme: &'static P, loss: Loss)
where
    P::Sample: Sample + PartialEq,
{
    let ups = loss.lost.count_ones().cast_signed();
    let (net, half) = (2 * ups - loss.length.cast_signed(), 1_u32 << (loss.bits - 1));
    let mut line = Line::new(loss.bits);
    let mut receiver = Receiver::<_, 2, 0>::new(scheme);
    let mut truth = scheme.decoder();
    let mut spike = |polarity| {
        let firing = NeuronSpike { neuron: 0, slot: 0, polarity };
        truth.decode(P::Code::assemble(std::iter::once(firing)))
    };
    let mut hear = |reader: &mut Reader<MAX_FRAME>, bytes: &[u8]| {
        let mut bytes = bytes;
        while let Some(received) = reader.next_frame(&mut bytes) {
            receiver.apply(&received, |_, _, _| ());
        }
        (receiver.exact(1), receiver.estimate(1))
    };
    let tick = Tick::from_micros(line.now);
    let first = line.frame(&[Keyframe::new(tick, 1, P::Sample::default()).into()]);
    hear(&mut line.reader, &first);
    for _ in 0..loss.before {
        let frame = line.frame(&[line.step(Polarity::Up)]);
        let value = spike(Polarity::Up);
        assert_eq!(hear(&mut line.reader, &frame), (Some(value), value));
    }
    for at in 0..loss.length {
        let polarity = if loss.lost >> at & 1 == 1 { Polarity::Up } else { Polarity::Down };
        line.frame(&[line.step(polarity)]);
        spike(polarity);
    }
    let frame = line.frame(&[line.step(loss.last)]);
    let value = spike(loss.last);
    let (exact, estimate) = hear(&mut line.reader, &frame);
    assert_eq!(exact.is_some(), loss.length == 0, "{loss:?}");
    if net.unsigned_abs() != half {
        assert_eq!(estimate == value, net.unsigned_abs() < half, "{loss:?}");
    }
    let keyframe = Keyframe::new(Tick::from_micros(line.now), 1, value);
    let frame = line.frame(&[keyframe.into()]);
    assert_eq!(hear(&mut line.reader, &frame), (Some(value), value), "{loss:?}");
    let frame = line.frame(&[line.step(loss.last)]);
    assert_eq!(hear(&mut line.reader, &frame).0, Some(spike(loss.last)), "{loss:?}");
}

/// Numbers that do not fit the events are the sender's mistake, and no value is exact after them.
#[test]
fn a_step_number_that_contradicts_is_a_misfit() {
    let mut near = Line::new(4);
    let mut receiver = Receiver::<_, 2, 0>::new(&STEP);
    let mut hear = |bytes: &[u8], reader: &mut Reader<MAX_FRAME>| {
        let mut bytes = bytes;
        let received = reader.next_frame(&mut bytes).unwrap();
        receiver.apply(&received, |_, _, _| ());
        (receiver.exact(1), receiver.misfits())
    };
    let keyframe = Keyframe::new(Tick::from_micros(near.now), 1, 0_i16);
    let first = near.frame(&[keyframe.into()]);
    assert_eq!(hear(&first, &mut near.reader), (Some(0), 0));
    // The second frame of the same session, by a sender that has counted a step more.
    let mut other = Line::new(4);
    other.frame(&[other.step(Polarity::Up)]);
    let second = other.frame(&[other.step(Polarity::Up)]);
    assert_eq!(hear(&second, &mut near.reader), (None, 1));
}

#[test]
fn a_short_frame_is_read_behind_the_one_before_alone() {
    let mut line = Line::new(0);
    let frames: Vec<_> = (0..700).map(|_| line.frame(&[line.step(Polarity::Up)])).collect();
    assert_eq!(frames[3].len(), 28 + 1, "the fourth frame is full");
    // The magic, the number; eleven bits of count, one of jitter and five of the event in three bytes; the checksum.
    assert!(frames[4..].iter().all(|frame| frame.len() == 9));
    assert_eq!(FrameView::new(&frames[4]).err(), Some(LinkError::NotAFrame { found: 0x62 }));
    for (missing, is_read) in [(0, true), (223, true), (224, false)] {
        let mut reader = Reader::<MAX_FRAME>::new();
        let mut first = &frames[3][..];
        assert!(reader.next_frame(&mut first).is_some());
        let mut next = &frames[4 + missing][..];
        let received = reader.next_frame(&mut next).filter(|received| !received.is_unread);
        let lost = received.map(|received| received.gap.map_or(0, |gap| gap.lost_frames));
        assert_eq!(lost, is_read.then_some(missing as u32));
        assert_eq!(reader.is_interrupted(), !is_read);
    }
    // Late ones, of which sixteen in a row would begin anew; up to 32 back.
    let mut reader = Reader::<MAX_FRAME>::new();
    let stream: Vec<u8> = frames[..100].iter().chain(&frames[86..100]).flatten().copied().collect();
    let mut input = &stream[..];
    while reader.next_frame(&mut input).is_some() {}
    assert_eq!((reader.frames(), reader.late(), reader.repeated()), (100, 13, 1));
    assert_eq!(reader.skipped(), 0);
    // They are those of a sender that goes on, whatever was damaged before them.
    let mut reader = Reader::<MAX_FRAME>::new();
    let mut damaged = frames[100].clone();
    damaged[2] ^= 1;
    let late = frames[..100].iter().chain([&damaged]).chain(&frames[86..92]).chain(&frames[101..]);
    let stream: Vec<u8> = late.flatten().copied().collect();
    let mut input = &stream[..];
    let mut starts = 0;
    while let Some(received) = reader.next_frame(&mut input) {
        starts += u32::from(received.is_start && !received.is_unread);
    }
    assert_eq!((starts, reader.late(), reader.lost_frames()), (1, 6, 1));
    let mut input = &frames[67][..];
    assert!(reader.next_frame(&mut input).is_some_and(|received| received.is_unread));
}

/// A flip of any bit of a frame, full or short: nothing comes but what stands for it, whether the bytes come at once or
/// one by one. It comes with the frame's last byte, or after a silence where the flip makes the frame seem longer.
#[test]
fn a_damaged_frame_is_reported_at_once() {
    let mut line = Line::new(4);
    let keyframe = Keyframe::new(Tick::from_micros(line.now), 1, 0_i16);
    let first = line.frame(&[keyframe.into()]);
    let frames: Vec<_> = (0..8).map(|_| line.frame(&[line.step(Polarity::Up)])).collect();
    let (full, short) = (&frames[2], &frames[3]);
    assert!(FrameView::new(full).is_ok() && FrameView::new(short).is_err());
    for (before, frame, most_longer) in [(2, full, 8), (3, short, 8)] {
        let mut longer = 0;
        for bit in 0..8 * frame.len() {
            let mut damaged = frame.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            for piece in [1, damaged.len()] {
                let mut reader = Reader::<MAX_FRAME>::new();
                let mut receiver = Receiver::<_, 2, 0>::new(&STEP);
                for mut bytes in [&first].into_iter().chain(&frames[..before]).map(Vec::as_slice) {
                    receiver.apply(&reader.next_frame(&mut bytes).unwrap(), |_, _, _| ());
                }
                assert!(receiver.exact(1).is_some());
                let mut unread = 0;
                for mut bytes in damaged.chunks(piece) {
                    while let Some(received) = reader.next_frame(&mut bytes) {
                        assert!(received.is_unread);
                        unread += 1;
                        receiver.apply(&received, |_, _, _| ());
                    }
                }
                let seems_longer = unread == 0;
                longer += u32::from(seems_longer);
                while let Some(received) =
                    seems_longer.then(|| reader.next_after_silence()).flatten()
                {
                    unread += u32::from(received.is_unread);
                    receiver.apply(&received, |_, _, _| ());
                }
                assert_eq!((receiver.exact(1), unread), (None, 1), "bit {bit} of {damaged:02x?}");
            }
        }
        assert!(longer <= 2 * most_longer, "{longer}");
    }
}

/// Each time that frames are damaged it is reported, once until the next frame.
#[test]
fn every_damage_is_reported_once() {
    let mut line = Line::new(0);
    let frames: Vec<_> = (0..12).map(|_| line.frame(&[line.step(Polarity::Up)])).collect();
    let mut heard = Vec::new();
    for (number, frame) in frames.iter().enumerate() {
        let mut frame = frame.clone();
        if [5, 6, 8].contains(&number) {
            frame[2] ^= 1;
        }
        let mut bytes = &frame[..];
        let mut unread = 0;
        while let Some(received) = line.reader.next_frame(&mut bytes) {
            unread += u32::from(received.is_unread);
        }
        heard.push(unread);
    }
    assert_eq!(heard, [0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0]);
}

/// The writer sends a short frame up to half of all counts after the one before; the reader takes one that is up to an
/// eighth of them late.
#[test]
fn short_frames_reach_half_of_all_counts_ahead_and_an_eighth_back() {
    // Counts of eleven bits at a period of 1000.
    for (silence, is_short) in [(1_024, true), (1_025, false)] {
        let mut line = Line::new(0);
        let mut frames: Vec<_> = (0..5).map(|_| line.frame(&[line.step(Polarity::Up)])).collect();
        line.now += (silence - 1) * 1_000;
        frames.push(line.frame(&[line.step(Polarity::Up)]));
        assert_eq!(FrameView::new(&frames[5]).is_err(), is_short, "{silence}");
        assert!(FrameView::new(&frames[4]).is_err());
    }
    for (silence, late) in [(256, 1), (257, 0)] {
        let mut line = Line::new(0);
        let mut frames: Vec<_> = (0..5).map(|_| line.frame(&[line.step(Polarity::Up)])).collect();
        line.now += (silence - 1) * 1_000;
        frames.push(line.frame(&[line.step(Polarity::Up)]));
        let stream = [frames.concat(), frames[4].clone()].concat();
        let mut input = &stream[..];
        while line.reader.next_frame(&mut input).is_some() {}
        assert_eq!((line.reader.frames(), line.reader.late()), (6, late), "{silence}");
    }
}

/// A master that clocks its bus between frames reads what an idle line has: nothing is missing.
#[test]
fn bytes_of_an_idle_line_leave_values_exact() {
    for idle in [0x00, 0xFF] {
        let mut line = Line::new(4);
        let mut receiver = Receiver::<_, 2, 0>::new(&STEP);
        let keyframe = Keyframe::new(Tick::from_micros(line.now), 1, 0_i16);
        let mut frames = vec![line.frame(&[keyframe.into()])];
        frames.extend((0..20).map(|_| line.frame(&[line.step(Polarity::Up)])));
        for frame in frames {
            for bytes in [&frame[..], &[idle; 300]] {
                let mut input = bytes;
                while let Some(received) = line.reader.next_frame(&mut input) {
                    receiver.apply(&received, |_, _, _| ());
                }
                while let Some(received) = line.reader.next_after_silence() {
                    receiver.apply(&received, |_, _, _| ());
                }
                assert!(receiver.exact(1).is_some(), "{idle:#x}");
            }
        }
        assert!(!line.reader.is_interrupted() && line.reader.skipped() == 21 * 300);
    }
}

/// Frames of another session, time, coding or fingerprint fail their check.
#[test]
fn a_short_frame_of_another_sender_is_none() {
    let coding = Coding::for_channels(2, 1_000);
    let sender = |session, start: u32, coding, fingerprint: Option<u32>| {
        let mut framer = Framer::new(coding, Session::counted(session));
        if let Some(bits) = fingerprint {
            framer = framer.with_fingerprint(Fingerprint::from_bits(bits));
        }
        let mut frames = Vec::new();
        for number in 0..30_u32 {
            let mut buffer = [0; MAX_FRAME];
            let tick = Tick::from(start + number * 1_000);
            let mut frame = framer.start(tick, &mut buffer).unwrap();
            frame.event(Event { tick, address: 1, polarity: Polarity::Up }).unwrap();
            frames.push(frame.finish().to_vec());
        }
        frames
    };
    let near = sender(1, 0, coding, Some(7));
    for (what, other) in [
        ("session", sender(2, 0, coding, Some(7))),
        ("time", sender(1, 1_000, coding, Some(7))),
        ("phase", sender(1, 1, coding, Some(7))),
        ("fingerprint", sender(1, 0, coding, Some(8))),
        ("no fingerprint", sender(1, 0, coding, None)),
        ("jitter bits", sender(1, 0, coding.with_jitter_bits(1), Some(7))),
        ("step bits", sender(1, 0, coding.with_step_bits(1), Some(7))),
        ("period", sender(1, 0, Coding::for_channels(2, 1_001), Some(7))),
    ] {
        let mut reader = Reader::<MAX_FRAME>::new();
        let others = [near[..10].concat(), other[10..].concat()].concat();
        let (mut read, mut unread) = (0, 0);
        for bytes in [others, near[29].clone(), vec![0; 300]] {
            let mut input = &bytes[..];
            while let Some(received) = reader.next_frame(&mut input) {
                if received.is_unread {
                    assert!(received.is_after_break());
                    unread += 1;
                    continue;
                }
                read += 1;
                let lost = received.gap.map_or(0, |gap| gap.lost_frames);
                assert_eq!(lost, if read == 11 { 19 } else { 0 }, "{what}");
            }
        }
        assert_eq!((read, unread), (11, 1), "another {what}");
    }
}

/// Samples of 10 Hz and slower, and periods beyond the field.
#[test]
fn slow_senders_have_a_period() {
    for (period, expected) in
        [(100_000_u32, 100_000), (16_777_215, 16_777_215), (1 << 24, 16_777_215)]
    {
        let mut framer = Framer::new(Coding::for_channels(1, period), Session::counted(1));
        let mut reader = Reader::<MAX_FRAME>::new();
        for number in 0..20_u32 {
            let mut buffer = [0; MAX_FRAME];
            let tick = Tick::from(number.wrapping_mul(expected));
            let mut bytes = framer.start(tick, &mut buffer).unwrap().finish();
            let received = reader.next_frame(&mut bytes).unwrap();
            assert_eq!(received.frame.period().get(), expected);
            assert_eq!(received.frame.tick(), tick);
        }
    }
}

/// Events wait for others as long as they may, in their queue; keyframes and losses take them along at once.
#[test]
fn events_gather_in_a_frame() {
    let send = |gathering: u32| {
        let coding = Coding::for_channels(2, 1_000);
        let mut link = Transmitter::new(coding, Session::counted(1)).with_gathering(gathering);
        let (mut reader, mut items) = (Reader::<MAX_FRAME>::new(), VecDeque::new());
        let (mut frames, mut bytes, mut latest, mut events) = (0, 0, 0, 0);
        for number in 0..1_000_u32 {
            let now = Tick::from(number * 1_000);
            items.push_back(Item::from(Event { tick: now, address: 1, polarity: Polarity::Up }));
            let mut buffer = [0; MAX_FRAME];
            loop {
                link.observe(now);
                let source = FromItems(std::iter::from_fn(|| items.pop_front()));
                let Some(mut frame) = link.next_frame(source, &mut buffer).unwrap() else { break };
                frames += 1;
                bytes += frame.len();
                let received = reader.next_frame(&mut frame).unwrap();
                latest = latest.max(now.since(received.frame.tick()));
                events += received.frame.events().count();
            }
        }
        (frames, bytes, latest, events)
    };
    assert_eq!(send(0), (1_000, 9_100, 0, 1_000));
    assert_eq!(send(20_000), (47, 1_369, 20_000, 987));
}

#[test]
fn what_must_not_wait_does_not() {
    let coding = Coding::for_channels(2, 1_000);
    let tick = Tick::from(5_000);
    let event = Item::from(Event { tick, address: 1, polarity: Polarity::Up });
    let after_loss = Taken { lost: 1, item: event };
    for (first, waits) in [
        (Taken::whole(event), true),
        (after_loss, false),
        (Keyframe::new(tick, 1, 0_i16).into(), false),
        (Item::Break(tick).into(), false),
    ] {
        let mut link = Transmitter::new(coding, Session::counted(1)).with_gathering(10_000);
        link.observe(tick);
        let mut buffer = [0; MAX_FRAME];
        let mut next = |items: Option<Taken>, now: u32| {
            link.observe(Tick::from(now));
            link.next_frame(FromItems(items.into_iter()), &mut buffer).unwrap().is_some()
        };
        assert_eq!(next(Some(first), 14_999), !waits);
        assert_eq!(next(None, 15_000), waits);
    }
    // As after a clock that stepped back by the time that an event may wait.
    for (now, waits) in [(0, true), (4_294_962_297, true), (4_294_962_296, false)] {
        let mut link = Transmitter::new(coding, Session::counted(1)).with_gathering(10_000);
        link.observe(Tick::from(now));
        let items = FromItems([event].into_iter());
        let mut buffer = [0; MAX_FRAME];
        assert_eq!(link.next_frame(items, &mut buffer).unwrap().is_none(), waits, "{now}");
    }
}

/// A frame begins where its buffer does, as a sink that knows its length alone takes for granted.
#[test]
fn a_frame_begins_with_its_buffer() {
    let coding = Coding::for_channels(40, 1_000);
    let mut link = Transmitter::new(coding, Session::counted(1));
    for number in 0..60_u32 {
        let tick = Tick::from(number * 1_000);
        let events = (0..number as u16).map(|address| {
            let event = Event { tick, address: address % 40, polarity: Polarity::Up };
            Item::from(event)
        });
        let beat = [Item::Heartbeat { tick, address: 0 }];
        let items = beat.into_iter().chain(events);
        let mut buffer = [0; MAX_FRAME];
        let frame = link.next_frame(FromItems(items), &mut buffer).unwrap().unwrap().to_vec();
        assert_eq!(frame, buffer[..frame.len()], "{number}");
    }
}
