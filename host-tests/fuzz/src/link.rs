//! The link: a flight whose frames are lost, doubled, reordered, damaged and mixed with another sender's; and any bytes.

use std::collections::HashMap;
use std::fmt::Debug;

use spikewire::link::{MAX_FRAME, MIN_FRAME, Reader, Receiver, Session, Transmitter};
use spikewire::population::{Position, Slots};
use spikewire::rate::{Hough, Taps};
use spikewire::temporal::{AdaptiveStepForward, MovingWindow, StepForward, TemporalContrast};
use spikewire::{
    Bank, Decoder, Encoder, EventQueue, Output, Overflow, Recovery, Sample, Scheme, Start, Tick,
};

use crate::script::Script;

const CHANNELS: usize = 2;
const PERIOD: u32 = 1_000;

static STEP: StepForward<i16> = StepForward::new(10);
static FLOAT: StepForward<f32> = StepForward::new(0.1);
static CONTRAST: TemporalContrast<i16> = TemporalContrast::new(3);
static WINDOW: MovingWindow<i16, 3> = MovingWindow::new(5);
static ADAPTIVE: AdaptiveStepForward<i16> = AdaptiveStepForward::new(3, 4);
static HOUGH: Hough<i16, 4> = Hough::new(Taps::triangular(40));
static POSITION: Position<i16, 5> = Position::linear(-100..=100);
static SLOTS: Slots<f32, 8, 50> = Slots::new(0.0..=2.0, 1.5);

/// A flight of the scheme that the first byte chooses. A value that a receiver calls exact is the one that the sender's
/// own decoder holds, whatever happens to the frames between; a gap tells how many frames are missing.
pub fn flight(bytes: &[u8]) {
    let mut script = Script::new(bytes);
    match script.below(7) {
        0 => fly(&STEP, &mut script),
        1 => fly(&FLOAT, &mut script),
        2 => fly(&CONTRAST, &mut script),
        3 => fly(&WINDOW, &mut script),
        4 => fly(&ADAPTIVE, &mut script),
        5 => fly(&HOUGH, &mut script),
        _ => fly(&POSITION, &mut script),
    }
}

/// What a frame leaves a decoder with that got all: of which session it is, and the values after it, where it is the
/// last that a queue gave.
type Sent = HashMap<u64, (usize, Option<[u32; CHANNELS]>)>;

struct Sender<'q, P: Start + 'static> {
    queue: &'q EventQueue<48>,
    bank: Bank<&'static P, CHANNELS>,
    transmitter: Transmitter,
    encoders: [Encoder<'static, P>; CHANNELS],
    decoders: [Decoder<'static, P>; CHANNELS],
    now: u64,
    session: usize,
    /// By tick, what the decoders hold after the sample.
    history: HashMap<u32, [u32; CHANNELS]>,
    /// Reader of every frame that is sent.
    watch: Reader<MAX_FRAME>,
    /// Number of the last frame, if all that was coded is in it or in those before.
    last: Option<u64>,
}

impl<'q, P: Start + 'static> Sender<'q, P>
where
    P::Sample: Debug,
{
    fn new(scheme: &'static P, queue: &'q EventQueue<48>, session: usize, now: u64) -> Self {
        let bank = Bank::new(scheme);
        let transmitter = Transmitter::for_bank(&bank, PERIOD, Session::counted(session as u32));
        Self {
            queue,
            bank,
            transmitter,
            encoders: [(); CHANNELS].map(|()| scheme.encoder()),
            decoders: [(); CHANNELS].map(|()| scheme.decoder()),
            now,
            session,
            history: HashMap::new(),
            watch: Reader::new(),
            last: None,
        }
    }

    fn tick(&self) -> Tick {
        Tick::from_micros(self.now)
    }

    fn sample(&mut self, samples: [P::Sample; CHANNELS]) {
        self.last = None;
        self.now += u64::from(PERIOD);
        self.bank.encode_into(self.tick(), samples, self.queue);
        let mut values = [0; CHANNELS];
        for channel in 0..CHANNELS {
            if let Some(code) = self.encoders[channel].encode(samples[channel]).code() {
                values[channel] = self.decoders[channel].decode(code).to_bits32();
            }
        }
        self.history.insert(self.tick().micros(), values);
    }

    fn keyframe(&mut self) {
        self.bank.keyframe_into(self.tick(), self.queue);
        for channel in 0..CHANNELS {
            if let Some(value) = self.bank.keyframe(channel) {
                self.decoders[channel].resync(value);
                // The last sample's value is known better now.
                if let Some(values) = self.history.get_mut(&Tick::from_micros(self.now).micros()) {
                    values[channel] = value.to_bits32();
                }
            }
        }
    }

    fn reset(&mut self) {
        self.bank.reset_into(self.tick(), self.queue);
        self.encoders.iter_mut().for_each(Encoder::reset);
    }

    /// All that waits, as frames.
    fn frames(&mut self, sent: &mut Sent) -> Vec<Vec<u8>> {
        let mut consumer = self.queue.consumer().expect("the only one");
        let mut buffer = [0; MAX_FRAME];
        let mut frames: Vec<Vec<u8>> = Vec::new();
        let mut last = None;
        while let Some(frame) = self.transmitter.next_frame(&mut consumer, &mut buffer).unwrap() {
            let mut bytes = frame;
            let read = self.watch.next_frame(&mut bytes).expect("a sender's frame is whole");
            let number = read.frame.number();
            sent.insert(number, (self.session, None));
            last = Some(number);
            frames.push(frame.to_vec());
        }
        if let Some(number) = last {
            let held = self.decoders.each_ref().map(|own| own.held().map_or(0, Sample::to_bits32));
            sent.insert(number, (self.session, Some(held)));
            self.last = last;
        }
        frames
    }
}

#[allow(clippy::too_many_lines, reason = "one list of all that can happen")]
fn fly<P: Start + 'static>(scheme: &'static P, script: &mut Script)
where
    P::Sample: Debug,
{
    let is_timed = !matches!(scheme.recovery(), Recovery::Keyframe);
    let overflow = [Overflow::DropOldest, Overflow::DropNewest, Overflow::Refuse][script.below(3)];
    let queues = [EventQueue::new(overflow), EventQueue::new(overflow)];
    let mut sent = Sent::new();
    let mut histories: Vec<HashMap<u32, [u32; CHANNELS]>> = vec![HashMap::new(); 2];
    let mut senders =
        [0, 1].map(|one| Sender::new(scheme, &queues[one], one, u64::from(script.word())));
    let mut reader = Reader::<MAX_FRAME>::new();
    let mut receiver = Receiver::<_, CHANNELS, 16>::new(scheme);
    let mut delayed: Vec<Vec<u8>> = Vec::new();
    let mut delivered: Option<u64> = None;
    let mut turns = 0;
    while !script.is_over() && turns < 400 {
        turns += 1;
        let one = usize::from(script.below(8) == 0);
        let sender = &mut senders[one];
        let mut stream: Vec<u8> = Vec::new();
        match script.below(16) {
            0..=6 => {
                for _ in 0..=script.below(6) {
                    let samples = [(); CHANNELS].map(|()| {
                        if is_timed {
                            P::Sample::from_f64(f64::from(script.byte()) - 128.0)
                        } else {
                            script.sample()
                        }
                    });
                    sender.sample(samples);
                }
            }
            7 | 8 => sender.keyframe(),
            9 if !is_timed => sender.reset(),
            10 if !is_timed => {
                sender.now += u64::from(script.word() >> 3);
                sender.transmitter.observe(sender.tick());
            }
            11 => {
                // A brown-out of the sender: another session, perhaps with a clock that starts again.
                let session = histories.len();
                histories.push(HashMap::new());
                let now = if script.below(2) == 0 { 0 } else { sender.now };
                let queue = sender.queue;
                let mut consumer = queue.consumer().expect("the only one");
                while spikewire::Source::take(&mut consumer).is_some() {}
                drop(consumer);
                let old = std::mem::replace(sender, Sender::new(scheme, queue, session, now));
                histories[old.session] = old.history;
            }
            12 if !delayed.is_empty() => {
                stream = delayed.swap_remove(script.below(delayed.len().min(256)));
            }
            // Only once all that was sent has arrived, as `advance` asks.
            13 => {
                let is_heard = |own: &&Sender<_>| own.last.is_some() && own.last == delivered;
                if let Some(own) = senders.iter().find(is_heard) {
                    receiver.advance(own.tick(), |_, _, _| ());
                }
            }
            14 => {
                // A brown-out of the receiver.
                reader = Reader::new();
                receiver = Receiver::new(scheme);
                delivered = None;
            }
            _ => {
                for mut frame in sender.frames(&mut sent) {
                    match script.below(16) {
                        0..=6 => {}
                        7 | 8 => continue,
                        9 => {
                            delayed.push(frame);
                            continue;
                        }
                        10 => frame.extend(frame.clone()),
                        // Up to three bits, of which CRC-32 misses none in a frame of this length.
                        11 | 12 => {
                            for _ in 0..=script.below(3) {
                                let at = (script.byte() as usize) % frame.len();
                                frame[at] ^= 1 << script.below(8);
                            }
                        }
                        13 => frame.truncate(script.below(frame.len())),
                        14 => drop(frame.drain(..script.below(frame.len()))),
                        _ => {
                            let noise: Vec<u8> =
                                (0..script.below(20)).map(|_| script.byte()).collect();
                            frame.splice(0..0, noise).for_each(drop);
                        }
                    }
                    stream.extend(frame);
                }
            }
        }
        let mut input = &stream[..];
        while let Some(received) = reader.next_frame(&mut input) {
            let number = received.frame.number();
            if received.is_unread {
                receiver.apply(&received, |_, _, _| ());
                continue;
            }
            let (session, held) = *sent.get(&number).expect("no frame is invented");
            let gap = received.gap.map_or(0, |gap| u64::from(gap.lost_frames));
            if !received.is_start {
                let next = delivered.map(|last| last + 1 + gap);
                assert_eq!(next.map(|next| next & ((1 << 48) - 1)), Some(number), "frames missing");
            }
            delivered = Some(number);
            let mut told: [Option<(Tick, u32)>; CHANNELS] = [None; CHANNELS];
            receiver.apply(&received, |channel, tick, value| {
                told[usize::from(channel)] = Some((tick, value.to_bits32()));
            });
            for channel in 0..CHANNELS {
                let Some(exact) = receiver.exact(channel as u16) else { continue };
                if is_timed {
                    let Some((tick, value)) = told[channel] else { continue };
                    assert_eq!(exact.to_bits32(), value, "what was told last is what is exact");
                    let flown = senders.iter().find(|own| own.session == session);
                    let history = flown.map_or(&histories[session], |own| &own.history);
                    let near = history
                        .keys()
                        .find(|own| tick.since(Tick::from(**own)).unsigned_abs() <= PERIOD / 2);
                    let near = near.expect("a value is of a sample");
                    assert_eq!(value, history[near][channel], "called exact, at {near}");
                } else if let Some(held) = held {
                    assert_eq!(exact.to_bits32(), held[channel], "called exact");
                }
            }
        }
    }
}

/// Any bytes: cut anywhere they give the same frames and counts. If the first is odd, they are
/// made frames with a magic and a checksum that fit, to get behind these.
pub fn bytes(bytes: &[u8]) {
    let mut script = Script::new(bytes);
    let (kind, cut) = (script.byte(), 1 + script.below(40));
    let input = if kind % 2 == 1 { dressed(&mut script) } else { script.rest().to_vec() };
    let whole = read::<MAX_FRAME>(&input, input.len().max(1));
    assert_eq!(whole, read::<MAX_FRAME>(&input, cut), "cut into pieces of {cut}");
    read::<MIN_FRAME>(&input, cut);
    receive(&STEP, &input, 0);
    receive(&FLOAT, &input, 0);
    receive(&ADAPTIVE, &input, 0);
    receive(&HOUGH, &input, 0);
    receive(&POSITION, &input, 0);
    receive(&SLOTS, &input, u32::from(cut as u16));
}

/// Frames of what follows: a length, then the bytes behind the magic, whose version is the present one.
fn dressed(script: &mut Script) -> Vec<u8> {
    let mut stream = Vec::new();
    while !script.is_over() {
        let mut frame = vec![0xA5, 0x40 | script.byte() & 0x0F];
        frame.extend((0..16).map(|_| script.byte()));
        frame.push(script.byte() % 5); // bits of step numbers
        frame.extend((0..4).map(|_| script.byte()));
        let length = script.below(64);
        frame.push(length as u8);
        frame.extend((0..length).map(|_| script.byte()));
        frame.extend(crc32(&frame).to_le_bytes());
        stream.extend(frame);
    }
    stream
}

fn crc32(bytes: &[u8]) -> u32 {
    let step = |sum: u32, _| if sum & 1 == 1 { sum >> 1 ^ 0xEDB8_8320 } else { sum >> 1 };
    !bytes.iter().fold(!0, |sum, &byte| (0..8).fold(sum ^ u32::from(byte), step))
}

/// The frames in the input, and the reader's counts.
fn read<const N: usize>(input: &[u8], cut: usize) -> (Vec<Vec<u8>>, [u32; 6]) {
    let mut reader = Reader::<N>::new();
    let mut frames = Vec::new();
    for mut piece in input.chunks(cut) {
        while let Some(received) = reader.next_frame(&mut piece) {
            if received.is_unread {
                continue;
            }
            let frame = &received.frame;
            let told = (
                frame.number(),
                frame.micros(),
                frame.keyframes().count(),
                frame.heartbeats().count(),
                frame.events().collect::<Vec<_>>(),
                received.gap,
            );
            frames.push(format!("{told:?}").into_bytes());
        }
    }
    let counts = [
        reader.frames(),
        reader.lost_frames(),
        reader.bad_checksums(),
        reader.repeated(),
        reader.late(),
        reader.skipped(),
    ];
    assert_eq!(counts[0] as usize, frames.len());
    (frames, counts)
}

fn receive<P: Scheme + 'static>(scheme: &'static P, mut input: &[u8], slot_ticks: u32) {
    let mut reader = Reader::<MAX_FRAME>::new();
    let mut receiver = Receiver::<_, CHANNELS, 4>::new(scheme).with_slot_ticks(slot_ticks);
    while let Some(received) = reader.next_frame(&mut input) {
        receiver.apply(&received, |channel, _, _| assert!(usize::from(channel) < CHANNELS));
        receiver.advance(received.frame.tick() + 70_000, |_, _, _| ());
        for channel in 0..=CHANNELS as u16 {
            let is_exact = receiver.exact(channel).is_some();
            let exists = usize::from(channel) < CHANNELS;
            assert_eq!(is_exact, exists && receiver.withheld(channel).is_none());
        }
    }
}
