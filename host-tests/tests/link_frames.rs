//! Frames: their bytes, round trips, and readers of damaged and random bytes.

use core::num::NonZeroU32;

use crate::beside::session_from;
use proptest::prelude::*;
use spikewire::link::{
    Coding, FrameView, Framer, LinkError, MAX_FRAME, MIN_FRAME, Reader, Received, Receiver, Session,
};
use spikewire::temporal::StepForward;
use spikewire::{Event, Keyframe, Polarity, Sample, SampleKind, Tick};

/// The checksum of the specification, bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc: u32, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| crc >> 1 ^ (0xEDB8_8320 * (crc & 1)))
    })
}

fn event(tick: u32, address: u16, is_up: bool) -> Event {
    let tick = Tick::from(tick);
    Event { tick, address, polarity: if is_up { Polarity::Up } else { Polarity::Down } }
}

const SESSION: u32 = 0x1234;
/// The number of its first frame: the upper 48 bits of a product of 64.
const FIRST: u64 = 0x1234_u64.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 16;

fn keyframe<S: Sample>(tick: u32, address: u16, value: S) -> Keyframe {
    Keyframe::new(tick.into(), address, value)
}

/// Events at these ticks.
fn events_at(tick: impl Strategy<Value = u32>) -> impl Strategy<Value = Event> {
    let address = prop_oneof![0_u16..6, any::<u16>()];
    (tick, address, any::<bool>()).prop_map(|(tick, address, is_up)| event(tick, address, is_up))
}

fn any_event() -> impl Strategy<Value = Event> {
    events_at(prop_oneof![0_u32..10, 0_u32..100_000, any::<u32>()])
}

/// Events as a sender has them, whose time does not go back far.
fn steady_event() -> impl Strategy<Value = Event> {
    events_at(prop_oneof![0_u32..10, 0_u32..60_000])
}

fn any_coding() -> impl Strategy<Value = Coding> {
    let period = prop_oneof![1_u32..70_000, 1_u32..];
    (period, any::<u8>(), any::<u8>(), any::<u8>()).prop_map(
        |(period, address_bits, jitter_bits, step_bits)| Coding {
            period: NonZeroU32::new(period).unwrap(),
            address_bits,
            jitter_bits,
            step_bits,
        },
    )
}

/// Full frames of at most `room` bytes with these events, and how many events each has.
fn frames(coding: Coding, events: &[Event], room: usize) -> Vec<(Vec<u8>, usize)> {
    let mut sender = Framer::new(coding, Session::counted(SESSION)).with_full_every(0);
    let mut frames = Vec::new();
    let mut rest = events;
    while let Some(first) = rest.first() {
        let mut buffer = vec![0; room];
        let mut frame = sender.start(first.tick, &mut buffer).unwrap();
        let count = rest.iter().take_while(|&&event| frame.event(event).is_ok()).count();
        assert!(count > 0);
        rest = &rest[count..];
        frames.push((frame.finish().to_vec(), count));
    }
    frames
}

#[test]
fn the_bytes_are_those_of_the_specification() {
    let coding = Coding { address_bits: 1, ..Coding::for_channels(6, 1_000) };
    assert_eq!(coding.jitter_bits, 0);
    let mut framer = Framer::new(coding, Session::counted(SESSION)).with_full_every(0);
    let mut buffer = [0xEE; 64];
    let mut frame = framer.start(0x0102_0304.into(), &mut buffer).unwrap();
    frame.keyframe(keyframe(0x0102_0304, 2, -2_i16)).unwrap();
    frame.event(event(0x0102_0304, 0, true)).unwrap(); // 0 10 1
    frame.event(event(0x0102_0304, 4, false)).unwrap(); // 0 0101 0: code(3, 1) = 010 1
    frame.event(event(0x0102_0304 + 1_001, 1, true)).unwrap(); // 1 1 011 11 1: jitter 1 = code(2)
    let bytes = frame.finish();

    // 1 step: code(0) = 1; jitter 1: zigzag 2, code(2, 0) = 011; address 1: code(1, 1) = 1 1.
    let mut expected = vec![0xA5, 0x46];
    expected.extend(&FIRST.to_le_bytes()[..6]);
    expected.extend([4, 3, 2, 1, 0, 0, 0xE8, 3, 0, 0x01, 0, 0, 0, 0, 0, 9]);
    expected.extend([1, 1, 2, 0, 0xFE, 0xFF]); // one, of i16: address, bits
    expected.extend([0b0101_0010, 0b1011_0111, 0b1100_0000]);
    expected.extend(crc32(&expected).to_le_bytes());
    assert_eq!(bytes, expected);

    let (view, _) = FrameView::new(bytes).unwrap();
    assert_eq!((view.number(), view.is_first(), view.is_after_loss()), (FIRST, true, false));
    let kind = SampleKind::Fixed16 { fraction: 0 };
    let tick = Tick::from(0x0102_0304);
    assert!(view.keyframes().eq([Keyframe { tick, address: 2, kind, bits: 0xFFFE }]));
    assert_eq!(view.events().count(), 3);
}

#[test]
fn errors_are_told_in_words() {
    for (error, message) in [
        (LinkError::Truncated { needed: 22, found: 7 }, "the frame has 22 bytes, but 7 are here"),
        (LinkError::NotAFrame { found: 9 }, "a frame does not begin with 0x09"),
        (
            LinkError::Version { found: 3 },
            "the frame is one of version 3 of the link, this end reads version 4",
        ),
        (
            LinkError::Checksum { found: 1, computed: 0xABC },
            "the frame's checksum is 0x00000001, but its bytes give 0x00000abc",
        ),
        (LinkError::Full, "the frame is full"),
    ] {
        assert_eq!(error.to_string(), message);
    }
}

/// The empty first frame of a session by version 3 of the link: magic, version and flags, number, time, period, coding,
/// length, checksum.
const VERSION_3: [u8; 22] = [
    0xA5, 0x34, 0x15, 0x7C, 0x4A, 0x7F, 0xB9, 0x79, 0xE8, 0x03, 0, 0, 0, 0, 0xE8, 0x03, 0x00, 0,
    0x85, 0xC1, 0xF6, 0x8B,
];

#[test]
fn frames_of_version_3_are_refused_by_name() {
    assert_eq!(FrameView::new(&VERSION_3).err(), Some(LinkError::Version { found: 3 }));
    let mut reader = Reader::<MAX_FRAME>::new();
    assert!(reader.next_frame(&mut VERSION_3.repeat(9).as_slice()).is_none());
    assert_eq!(reader.other_version(), Some(3));

    // A sender of this version takes its place.
    let mut framer = Framer::new(Coding::for_channels(1, 1_000), Session::counted(1));
    let mut buffer = [0; 64];
    let mut bytes = framer.start(0.into(), &mut buffer).unwrap().finish();
    while reader.next_after_silence().is_some() {}
    assert!(reader.next_frame(&mut bytes).is_some());
    assert_eq!((reader.other_version(), reader.frames()), (None, 1));
}

#[test]
fn a_frame_says_what_it_holds() {
    let mut framer =
        Framer::new(Coding::for_channels(1, 1_000), Session::counted(SESSION)).with_full_every(0);
    let mut buffer = [0; 64];
    let mut frame = framer.start(0.into(), &mut buffer).unwrap();
    assert!(frame.is_empty());
    frame.keyframe(keyframe(0, 0, 0.5_f32)).unwrap();
    assert!(!frame.is_empty());
    frame.event(event(0, 0, true)).unwrap();
    frame.event(event(0, 1, true)).unwrap();
    assert_eq!((frame.is_empty(), frame.events()), (false, 2));
    let mut frame = framer.start(0.into(), &mut buffer).unwrap();
    frame.event(event(0, 0, true)).unwrap();
    assert!(!frame.is_empty());
}

#[test]
fn keyframes_can_be_read_as_another_type_of_the_same_width() {
    let mut framer =
        Framer::new(Coding::for_channels(1, 1_000), Session::counted(SESSION)).with_full_every(0);
    let mut buffer = [0; 64];
    let mut frame = framer.start(0.into(), &mut buffer).unwrap();
    frame.keyframe(keyframe(0, 0, -2_i16)).unwrap();
    let (view, _) = FrameView::new(frame.finish()).unwrap();
    let kind = SampleKind::Fixed16 { fraction: 8 };
    let tick = Tick::from(0);
    let expected = Keyframe { tick, address: 0, kind, bits: 0xFFFE };
    assert!(view.with_kind(kind).unwrap().keyframes().eq([expected]));
    assert!(view.with_kind(SampleKind::F32).is_none(), "it is wider");
}

/// As few bits for the address as suit events of few channels at a time.
#[test]
fn a_coding_has_bits_for_its_channels() {
    for (channels, address_bits) in [(1, 0), (7, 0), (8, 1), (16, 2), (64, 4), (u16::MAX, 13)] {
        let period = NonZeroU32::new(1_000).unwrap();
        let expected = Coding { period, address_bits, jitter_bits: 0, step_bits: 0 };
        assert_eq!(Coding::for_channels(channels, 1_000), expected);
        assert_eq!(expected.with_jitter_bits(7), Coding { jitter_bits: 7, ..expected });
    }
}

#[test]
fn a_frame_is_full_where_its_buffer_or_its_length_ends() {
    let mut framer =
        Framer::new(Coding::for_channels(1, 1_000), Session::counted(SESSION)).with_full_every(0);
    // The count and type of keyframes, an address, two bytes of a value.
    for (room, fits) in [(5, Err(LinkError::Full)), (6, Ok(()))] {
        let mut buffer = [0; MIN_FRAME + 6];
        let mut frame = framer.start(0.into(), &mut buffer[..MIN_FRAME + room]).unwrap();
        assert_eq!(frame.keyframe(keyframe(0, 0, 3_i16)), fits);
        assert_eq!(frame.is_empty(), fits.is_err());
    }
    let mut buffer = [0; 4 * MAX_FRAME];
    let mut frame = framer.start(0.into(), &mut buffer).unwrap();
    let count = (0..9_999).take_while(|_| frame.event(event(0, 0, true)).is_ok()).count();
    let bytes = frame.finish();
    assert_eq!(bytes.len(), MAX_FRAME);
    assert_eq!(FrameView::new(bytes).unwrap().0.events().count(), count);
}

/// A sender of one channel, whose frames are all full.
fn full_frames() -> Framer {
    Framer::new(Coding::for_channels(1, 1_000), Session::counted(SESSION)).with_full_every(0)
}

/// The next frame, with these bytes as its events.
fn with_events(framer: &mut Framer, bytes: &[u8]) -> Vec<u8> {
    let mut buffer = [0; MIN_FRAME];
    let mut frame = framer.start(0.into(), &mut buffer).unwrap().finish().to_vec();
    frame.truncate(MIN_FRAME - 4);
    frame[23] = bytes.len() as u8;
    frame.extend(bytes);
    frame.extend(crc32(&frame).to_le_bytes());
    frame
}

#[test]
fn bits_that_code_no_event_are_told_from_the_end() {
    let read = |bytes: &[u8]| {
        let frame = with_events(&mut full_frames(), bytes);
        let (view, _) = FrameView::new(&frame).unwrap();
        let mut events = view.events();
        (events.by_ref().count(), events.is_complete())
    };
    assert_eq!(read(&[]), (0, true));
    // Three bits are an event: 0, at the frame's tick; 1, of address 0; and the polarity.
    assert_eq!(read(&[0b0110_0000]), (1, true), "up to 7 bits, all 0, fill the last byte up");
    assert_eq!(read(&[0b0110_0000, 0]), (1, false), "13 bits are left");
    assert_eq!(read(&[0]), (0, false), "a whole byte is left");
    assert_eq!(read(&[0b0110_0001]), (1, false), "what is left is not 0");
    assert_eq!(read(&[0; 9]), (0, false), "a code of so many zeros is none");
    // 0, then 16 zeros and 17 bits of a number, and the polarity: addresses 65 535 and 65 536.
    assert_eq!(read(&[0, 0, 0b0100_0000, 0, 0]), (1, true));
    assert_eq!(read(&[0, 0, 0b0100_0000, 0, 0b0100_0000]), (0, false), "there is no such address");
}

/// Their steps are missing: no value is exact after them.
#[test]
fn bits_that_code_no_event_leave_no_value_exact() {
    static SCHEME: StepForward<i16> = StepForward::new(1);
    let (mut framer, mut buffer) = (full_frames(), [0; 64]);
    let mut frame = framer.start(0.into(), &mut buffer).unwrap();
    frame.keyframe(keyframe(0, 0, 3_i16)).unwrap();
    let first = frame.finish().to_vec();
    let bytes = [first, with_events(&mut framer, &[0b0110_0001])].concat();
    let (mut input, mut reader) = (&bytes[..], Reader::<MAX_FRAME>::new());
    let mut receiver = Receiver::<_, 1>::new(&SCHEME);
    let mut heard = Vec::new();
    while let Some(received) = reader.next_frame(&mut input) {
        receiver.apply(&received, |_, _, _| ());
        heard.push((receiver.exact(0), receiver.misfits()));
    }
    assert_eq!(heard, [(Some(3), 0), (None, 1)]);
}

/// A sample earlier costs no more than its few bits, and a frame spans 2²⁹ µs to either side.
#[test]
fn events_may_be_earlier_than_their_frame() {
    const MOST: u32 = 1 << 29;
    let mut framer =
        Framer::new(Coding::for_channels(1, 1_000), Session::counted(SESSION)).with_full_every(0);
    let mut buffer = [0; 64];
    let mut frame = framer.start(5_000.into(), &mut buffer).unwrap();
    frame.event(event(4_001, 0, true)).unwrap();
    // 1; -1 step: zigzag(-2) = 3, code(3, 0) = 00100; jitter 1: code(2, 0) = 011; address 0 and up: 1 1.
    let bytes = frame.finish();
    assert_eq!(bytes[24..bytes.len() - 4], [0b1001_0001, 0b1110_0000]);

    for (tick, is_near) in [
        (MOST, true),
        (MOST + 1, false),
        (MOST.wrapping_neg(), true),
        (MOST.wrapping_neg() - 1, false),
    ] {
        let mut frame = framer.start(0.into(), &mut buffer).unwrap();
        assert_eq!(frame.event(event(tick, 0, true)).is_ok(), is_near, "{tick}");
    }
}

#[test]
fn every_error_says_what_is_wrong() {
    let mut framer =
        Framer::new(Coding::for_channels(1, 1), Session::counted(SESSION)).with_full_every(0);
    assert_eq!(framer.start(0.into(), &mut [0; MIN_FRAME - 1]).err(), Some(LinkError::Full));
    let mut buffer = [0; MIN_FRAME];
    let mut frame = framer.start(0.into(), &mut buffer).unwrap();
    assert_eq!(frame.event(event(0, 0, true)), Err(LinkError::Full));
    assert_eq!(frame.keyframe(keyframe(0, 0, 0_i16)), Err(LinkError::Full));
    let bytes = frame.finish().to_vec();
    assert_eq!(FrameView::new(&bytes).unwrap().1, MIN_FRAME);

    let error = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = bytes.clone();
        change(&mut bytes);
        FrameView::new(&bytes).err().unwrap()
    };
    let truncated = |found| LinkError::Truncated { needed: MIN_FRAME, found };
    assert_eq!(error(&|bytes| bytes.clear()), truncated(0));
    assert_eq!(error(&|bytes| bytes.truncate(7)), truncated(7));
    assert_eq!(error(&|bytes| bytes.truncate(MIN_FRAME - 1)), truncated(MIN_FRAME - 1));
    assert_eq!(error(&|bytes| bytes[0] = 0x5A), LinkError::NotAFrame { found: 0x5A });
    assert_eq!(error(&|bytes| bytes[1] = 0x21), LinkError::Version { found: 2 });
    assert_eq!(error(&|bytes| bytes[14] = 0), LinkError::Header);
    assert!(matches!(error(&|bytes| bytes[6] = 1), LinkError::Checksum { .. }));

    let mut buffer = [0; 64];
    let mut frame = framer.start(0.into(), &mut buffer).unwrap();
    assert_eq!(
        frame.keyframe(keyframe(1, 0, 0.5_f32)),
        Err(LinkError::KeyframeOrder),
        "another tick"
    );
    frame.keyframe(keyframe(0, 0, 0.5_f32)).unwrap();
    assert_eq!(frame.keyframe(keyframe(0, 1, 3_i16)), Err(LinkError::KeyframeOrder));
    let fixed = Keyframe { kind: SampleKind::Fixed32 { fraction: 16 }, ..keyframe(0, 1, 0.5_f32) };
    assert_eq!(frame.keyframe(fixed), Err(LinkError::KeyframeOrder), "f32 is no Q16.16");
    frame.event(event(0, 0, true)).unwrap();
    assert_eq!(frame.keyframe(keyframe(0, 1, 0.5_f32)), Err(LinkError::KeyframeOrder));
    assert_eq!(frame.event(event(1 << 31, 0, true)), Err(LinkError::Full));
    assert_eq!(FrameView::new(frame.finish()).unwrap().0.events().count(), 1);
}

proptest! {
    #![proptest_config(crate::common::cases(256))]

    #[test]
    fn any_events_come_back_in_any_coding(
        events in prop::collection::vec(any_event(), 0..200),
        coding in any_coding(),
        room in 64..600_usize,
    ) {
        let mut read = Vec::new();
        for (bytes, count) in frames(coding, &events, room) {
            prop_assert!(bytes.len() <= room.min(MAX_FRAME));
            let (view, length) = FrameView::new(&bytes).unwrap();
            prop_assert_eq!(length, bytes.len());
            let mut from_view = view.events();
            read.extend(&mut from_view);
            prop_assert!(from_view.is_complete());
            prop_assert_eq!(view.events().count(), count);
        }
        prop_assert_eq!(read, events);
    }

    #[test]
    fn keyframes_come_back_bit_for_bit(values in prop::collection::vec((any::<u16>(), any::<f32>()), 0..42)) {
        let mut framer = Framer::new(Coding::for_channels(1, 1), Session::counted(SESSION)).with_full_every(0);
        let mut buffer = [0; MAX_FRAME];
        let mut frame = framer.start(7.into(), &mut buffer).unwrap();
        for &(address, value) in &values {
            frame.keyframe(keyframe(7, address, value)).unwrap();
        }
        let (view, _) = FrameView::new(frame.finish()).unwrap();
        let expected = values.iter().map(|&(address, value)| keyframe(7, address, value));
        prop_assert!(view.keyframes().eq(expected));
    }

    #[test]
    fn a_stream_cut_anywhere_loses_nothing(
        events in prop::collection::vec(steady_event(), 1..300),
        cuts in prop::collection::vec(1..90_usize, 1..60),
    ) {
        let stream: Vec<u8> = frames(Coding::for_channels(6, 1_000), &events, 100)
            .into_iter().flat_map(|(bytes, _)| bytes).collect();
        let mut reader = Reader::<100>::new();
        let mut read = Vec::new();
        let (mut rest, mut cuts) = (&stream[..], cuts.iter().cycle());
        while !rest.is_empty() {
            let (mut piece, after) = rest.split_at((*cuts.next().unwrap()).min(rest.len()));
            rest = after;
            while let Some(received) = reader.next_frame(&mut piece) {
                prop_assert_eq!(received.gap, None);
                read.extend(received.frame.events());
            }
        }
        prop_assert_eq!(read, events);
        prop_assert_eq!((reader.lost_frames(), reader.skipped(), reader.bad_checksums()), (0, 0, 0));
    }

    #[test]
    fn frames_before_and_after_a_damaged_one_arrive(
        events in prop::collection::vec(steady_event(), 60..200),
        damage in any::<prop::sample::Index>(),
        flips in prop::collection::vec((any::<prop::sample::Index>(), 1_u8..), 1..8),
        junk in prop::collection::vec(any::<u8>(), 0..50),
    ) {
        let frames = frames(Coding::for_channels(6, 1_000), &events, 64);
        // The last frames stay whole, to push out what a damaged length may wait for.
        let damaged = damage.index(frames.len() - 2);
        let mut stream = junk;
        for (number, (bytes, _)) in frames.iter().enumerate() {
            let from = stream.len();
            stream.extend(bytes);
            if number == damaged {
                for (index, flip) in &flips {
                    let at = from + index.index(bytes.len());
                    stream[at] ^= flip;
                }
            }
        }
        stream.extend([0; MAX_FRAME]);

        let original: Vec<u8> = frames.iter().flat_map(|(bytes, _)| bytes.clone()).collect();
        let tail = stream.len() - MAX_FRAME;
        let is_whole = stream[..tail].ends_with(&original); // flips may cancel each other
        let mut reader = Reader::<MAX_FRAME>::new();
        let mut input = &stream[..];
        let mut numbers = Vec::new();
        let mut gaps = 0;
        while let Some(received) = reader.next_frame(&mut input) {
            if received.is_unread {
                continue;
            }
            let number = (received.frame.number() - FIRST) as u16;
            prop_assert!(received.frame.events().eq(
                FrameView::new(&frames[usize::from(number)].0).unwrap().0.events()));
            gaps += received.gap.map_or(0, |gap| gap.lost_frames);
            numbers.push(number);
        }
        let expected: Vec<u16> = (0..frames.len() as u16)
            .filter(|&number| is_whole || usize::from(number) != damaged).collect();
        prop_assert_eq!(numbers, expected);
        prop_assert_eq!(gaps, u32::from(!is_whole && damaged > 0));
        prop_assert_eq!(reader.lost_frames(), gaps);
    }

    #[test]
    fn after_a_silence_no_frame_waits_for_the_end_of_another(
        events in prop::collection::vec(steady_event(), 60..200),
        cut in any::<prop::sample::Index>(),
        at in any::<prop::sample::Index>(),
    ) {
        let frames = frames(Coding::for_channels(6, 1_000), &events, 64);
        let cut = cut.index(frames.len());
        let missing = &frames[cut].0[at.index(frames[cut].0.len())..];
        // Where the next frame begins with what is missing, the one that is cut is whole and the next one is not.
        prop_assume!(!frames.get(cut + 1).is_some_and(|next| next.0.starts_with(missing)));
        let mut reader = Reader::<MAX_FRAME>::new();
        let mut numbers = Vec::new();
        let mut read = |received: Received<'_>| {
            if !received.is_unread {
                numbers.push((received.frame.number() - FIRST) as usize);
            }
        };
        for (number, (bytes, _)) in frames.iter().enumerate() {
            let length = if number == cut { at.index(bytes.len()) } else { bytes.len() };
            let mut arriving = &bytes[..length];
            while let Some(received) = reader.next_frame(&mut arriving) {
                read(received);
            }
        }
        while let Some(received) = reader.next_after_silence() {
            read(received);
        }
        let whole: Vec<usize> = (0..frames.len()).filter(|&number| number != cut).collect();
        prop_assert_eq!(numbers, whole);
        // Nothing is left that would wait.
        prop_assert!(reader.next_after_silence().is_none());
        let mut last = &frames[usize::from(cut == 0)].0[..];
        prop_assert!(reader.next_frame(&mut last).is_none() && last.is_empty());
        prop_assert_eq!(reader.late() + reader.repeated(), 1);
    }

    #[test]
    fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..2_000)) {
        let mut reader = Reader::<64>::new();
        let mut input = &bytes[..];
        while let Some(received) = reader.next_frame(&mut input) {
            received.frame.events().for_each(drop);
            received.frame.keyframes().for_each(drop);
        }
        prop_assert!(input.is_empty());
    }

    #[test]
    fn a_checked_frame_of_random_bytes_never_panics(
        flags in 0_u8..16,
        body in prop::collection::vec(any::<u8>(), 0..=255),
        header in prop::collection::vec(any::<u8>(), 21),
    ) {
        let mut bytes = vec![0xA5, 0x40 | flags];
        bytes.extend(&header);
        bytes[18] %= 5;
        bytes.push(body.len() as u8);
        bytes.extend(&body);
        bytes.extend(crc32(&bytes).to_le_bytes());
        if let Ok((view, length)) = FrameView::new(&bytes) {
            prop_assert_eq!(length, bytes.len());
            view.events().for_each(drop);
            view.keyframes().for_each(drop);
            view.heartbeats().for_each(drop);
        }
    }
}

/// The frames of a session with an event each.
fn session(session: u16, count: u32) -> Vec<Vec<u8>> {
    frames_of(Session::counted(session.into()), session, count)
}

fn frames_of(session: Session, address: u16, count: u32) -> Vec<Vec<u8>> {
    let mut framer = Framer::new(Coding::for_channels(6, 1_000), session).with_full_every(0);
    let frame = |number: u32| {
        let mut buffer = [0; 64];
        let mut frame = framer.start((number * 1_000).into(), &mut buffer).unwrap();
        frame.event(event(number * 1_000, address, true)).unwrap();
        frame.finish().to_vec()
    };
    (0..count).map(frame).collect()
}

/// What a reader makes of frames: session and place in it, frames lost before it, and whether it is a start.
fn read<'a>(
    frames: impl IntoIterator<Item = &'a Vec<u8>>,
) -> (Vec<(u16, u32, u32, bool)>, Reader<MAX_FRAME>) {
    let mut reader = Reader::<MAX_FRAME>::new();
    let stream: Vec<u8> = frames.into_iter().flatten().copied().collect();
    let mut input = &stream[..];
    let mut read = Vec::new();
    while let Some(received) = reader.next_frame(&mut input) {
        let lost = received.gap.map_or(0, |gap| gap.lost_frames);
        let (frame, is_start) = (received.frame, received.is_start);
        assert_eq!(received.is_after_break(), is_start || lost > 0);
        let session = frame.events().next().unwrap().address;
        read.push((session, frame.tick().micros() / 1_000, lost, is_start));
    }
    (read, reader)
}

#[test]
fn a_reader_counts_what_it_passes_over() {
    let frames = session(7, 2);
    let mut damaged = frames[0].clone();
    damaged[6] ^= 1;
    let stream = [&[1, 2, 3][..], &damaged, &frames[1]].concat();
    let mut reader = Reader::<MAX_FRAME>::new();
    let mut rest = &stream[..];
    while reader.next_frame(&mut rest).is_some() {}
    assert_eq!((reader.frames(), reader.bad_checksums()), (1, 1));
    assert_eq!(reader.skipped() as usize, 3 + damaged.len());
}

#[test]
fn a_start_in_the_middle_and_a_new_session_are_starts() {
    let (first, second) = (session(1, 5), session(2, 3));
    let stream: Vec<u8> = first.concat();
    let mut reader = Reader::<MAX_FRAME>::new();
    let mut input = &stream[first[0].len() + 7..];
    let received = reader.next_frame(&mut input).unwrap();
    assert_eq!((received.gap, received.is_start), (None, true));
    assert_eq!((received.frame.tick().micros(), received.frame.is_first()), (2_000, false));

    let (read, reader) = read(first.iter().chain(&second[1..]));
    assert_eq!(read[4..], [(1, 4, 0, false), (2, 1, 0, true), (2, 2, 0, false)]);
    assert_eq!(reader.lost_frames(), 0);
}

/// As many first frames are lost as the session before had sent.
#[test]
fn a_reboot_shows_whatever_is_lost() {
    let (first, second) = (session(1, 3), session(2, 6));
    let (read, _) = read(first.iter().chain(&second[3..]));
    assert_eq!(read[3..], [(2, 3, 0, true), (2, 4, 0, false), (2, 5, 0, false)]);
}

/// The next frame by its number alone, of 16 bits of which 65 536 lost frames leave none.
#[test]
fn an_outage_of_65536_frames_is_a_gap() {
    let mut framer =
        Framer::new(Coding::for_channels(1, 1), Session::counted(SESSION)).with_full_every(0);
    let mut reader = Reader::<MIN_FRAME>::new();
    for number in 0..200_000_u32 {
        let mut buffer = [0; MIN_FRAME];
        let mut bytes = framer.start(number.into(), &mut buffer).unwrap().finish();
        if number < 5 || number == 5 + 65_536 || number > 5 + 2 * 65_536 {
            let received = reader.next_frame(&mut bytes).unwrap();
            let lost = match number {
                65_541 | 131_078 => Some(65_536),
                _ => None,
            };
            assert_eq!(received.gap.map(|gap| gap.lost_frames), lost, "{number}");
        }
    }
}

/// A session whose number comes again, as that of a bit that toggles, is none; those that are counted lie far apart.
#[test]
fn sessions_do_not_meet() {
    let first = |starts| {
        let frame = frames_of(Session::counted(starts), 0, 1).remove(0);
        FrameView::new(&frame).unwrap().0.number()
    };
    let starts: Vec<u64> = (0..65_536).map(first).collect();
    let mut sorted = starts.clone();
    sorted.sort_unstable();
    let around = (1 << 48) - sorted[65_535] + sorted[0];
    let nearest = sorted.windows(2).map(|pair| pair[1] - pair[0]).min().unwrap().min(around);
    assert!(nearest > 1_900_000_000, "{nearest}");
}

/// A session that is not the sender's last one goes on after sixteen frames in a row, from a start.
#[test]
fn an_earlier_session_that_goes_on_is_a_start() {
    let (three, five) = (session(3, 60), session(5, 40));
    let (taken, reader) = read(three[..35].iter().chain(&five[..2]).chain(&three[35..]));
    assert_eq!(taken.len(), 35 + 2 + 10);
    assert_eq!(taken[37], (3, 35 + 15, 0, true));
    assert_eq!(reader.late(), 15);

    let (taken, reader) = read(three[..35].iter().chain(&five[..2]).chain(&three));
    assert_eq!(taken.len(), 35 + 2 + 45);
    assert_eq!(taken[37], (3, 15, 0, true), "a session that is used again, too");
    assert_eq!(reader.late(), 15);

    let between = (0..30).flat_map(|n| [&three[n], &five[n]]);
    let (taken, reader) = read(between);
    assert_eq!((taken.len(), reader.late()), (1 + 30, 29), "never while the present one goes on");
}

#[test]
fn frames_sent_twice_or_late_are_delivered_once() {
    let frames = session(1, 600);
    let order = [0, 0, 1, 3, 2, 2, 3, 4, 4, 1, 300, 200, 45, 44, 43];
    let (read, reader) = read(order.map(|number| &frames[number]));
    let taken: Vec<_> =
        read.iter().map(|&(_, place, lost, is_start)| (place, lost, is_start)).collect();
    let expected = [(0, 0, true), (1, 0, false), (3, 1, false), (4, 0, false), (300, 295, false)];
    assert_eq!(taken, expected, "one of more than 256 back is late, too");
    assert_eq!((reader.repeated(), reader.late()), (2 + 1, 3 + 4));
}

#[test]
fn what_was_on_its_way_before_a_reboot_is_late() {
    let sessions: Vec<_> = (1..6).map(|number| session(number, 300)).collect();
    let frame = |session: usize, number: usize| &sessions[session][number];
    let (taken, reader) = read([
        frame(0, 0),
        frame(1, 0),
        frame(0, 1),
        frame(2, 0),
        frame(1, 1),
        frame(0, 2),
        frame(2, 1),
    ]);
    assert_eq!(taken, [(1, 0, 0, true), (2, 0, 0, true), (3, 0, 0, true), (3, 1, 0, false)]);
    assert_eq!(reader.late(), 3);
    // Up to 255 frames after what was delivered of it, a session was on its way; farther on it has gone on.
    for (number, is_start) in [(256, false), (257, true)] {
        let (taken, reader) = read([frame(0, 0), frame(1, 0), frame(0, number)]);
        let expected = if is_start { (3, 0) } else { (2, 1) };
        assert_eq!((taken.len(), reader.late()), expected, "{number}");
        assert_eq!(reader.frames() as usize, taken.len());
    }
    // A number that comes again much later is a session of its own.
    let (taken, reader) =
        read(sessions[0][..1].iter().chain(&sessions[1][..256]).chain(&sessions[0][1..3]));
    assert_eq!(taken[256..], [(2, 255, 0, false), (1, 1, 0, true), (1, 2, 0, false)]);
    assert_eq!(reader.late(), 0);
}

/// The time goes on where ticks wrap, told by items or by the clock alone; a step that is not known is a loss.
#[test]
fn the_time_of_a_sender_goes_on() {
    const MOST: u64 = 1 << 30;
    let mut framer = Framer::new(Coding::for_channels(1, 1), Session::random(9)).with_full_every(0);
    let mut send = |observed: &[u64], at: u64| {
        for &now in observed {
            framer.observe(Tick::from_micros(now));
        }
        let mut buffer = [0; MIN_FRAME];
        let bytes = framer.start(Tick::from_micros(at), &mut buffer).unwrap().finish().to_vec();
        let frame = FrameView::new(&bytes).unwrap().0;
        (frame.micros(), frame.is_after_loss(), framer.leaps())
    };
    let start = 4_294_000_000;
    assert_eq!(send(&[], start), (start, false, 0));
    assert_eq!(send(&[], start + MOST), (start + MOST, false, 0));
    let mut now = start + MOST;
    let observed: Vec<u64> = (1..=50).map(|step| now + step * MOST).collect();
    now = observed[49] - 300; // an item may be older than the time
    assert_eq!(send(&observed, now), (now, false, 0));
    assert_eq!(send(&[], now - 1_000), (now - 1_000, false, 0), "and out of order");
    assert_eq!(send(&[], now + MOST), (now + MOST, true, 1));
    assert_eq!(send(&[], now), (now, false, 1));
}

/// The time goes on from a frame's last event, however long the frame lasted.
#[test]
fn a_frame_that_lasts_minutes_is_no_silence() {
    const LONGEST: u32 = 1 << 29;
    const MOST: u32 = 1 << 30;
    let mut framer =
        Framer::new(Coding::for_channels(1, 1_000), Session::random(9)).with_full_every(0);
    let mut buffer = [0; 64];
    let mut frame = framer.start(0.into(), &mut buffer).unwrap();
    frame.event(event(LONGEST, 0, true)).unwrap();
    frame.finish();
    for (tick, is_after_loss) in [(LONGEST + MOST, false), (LONGEST + 2 * MOST + 1, true)] {
        let bytes = framer.start(tick.into(), &mut buffer).unwrap().finish();
        assert_eq!(FrameView::new(bytes).unwrap().0.is_after_loss(), is_after_loss, "{tick}");
    }
}

/// A first frame is a start, wherever its number lies: ahead of what came, behind it, or the same.
#[test]
fn a_first_frame_is_a_start_unless_it_is_the_one_that_came() {
    let at = |first, address| frames_of(session_from(first), address, 40);
    let goes_on = |&(_, _, lost, is_start): &(u16, u32, u32, bool)| lost == 0 && !is_start;
    let old = at(1_000, 1);
    for first in [1_000, 1_001, 1_019, 1_020, 1_021, 1_300, 900, 999, 1_000 + (1 << 24)] {
        let new = at(first, 2);
        let (taken, reader) = read(old[..20].iter().chain(&new));
        assert_eq!(taken[20..].len(), 40, "{first}");
        assert_eq!((taken[20], reader.late()), ((2, 0, 0, true), 0), "{first}");
        assert!(taken[21..].iter().all(goes_on), "{first}");
    }
    // The frame that came, once more or late, is none.
    let (taken, reader) = read(old[..20].iter().chain(&old[..1]).chain(&old[20..]));
    assert_eq!((taken.len(), reader.late()), (40, 1));
    let (taken, reader) = read(old[..1].iter().chain(&old[..1]));
    assert_eq!((taken.len(), reader.repeated()), (1, 1));
    // Without its first frame, a session that comes again shows by other bytes of the frame that came last.
    let again = at(1_000, 3);
    let (taken, _) = read(old[..20].iter().chain(&again[15..]));
    assert_eq!(taken[20], (3, 19, 0, true));
    assert!(taken[21..].iter().all(goes_on));
    // The first frame that came stays known.
    let (taken, reader) = read(old[..20].iter().chain(&again[15..]).chain(&old[..1]));
    assert_eq!((taken.len(), reader.late()), (20 + 21, 4 + 1));
    // So does one of an earlier session, of which another first frame is a start.
    let (between, again) = (at(90_000_000, 2), at(1_000, 3));
    let (taken, reader) = read(old[..20].iter().chain(&between[..3]).chain(&again));
    assert_eq!((taken[23], taken.len(), reader.late()), ((3, 0, 0, true), 63, 0));
    assert!(taken[24..].iter().all(goes_on));
    // It is none of the next session's, whose own first frame may be late.
    let (taken, reader) =
        read(old[..20].iter().chain(&between[1..4]).chain(&between[..1]).chain(&between[4..]));
    assert_eq!((taken.len(), reader.late()), (20 + 39, 1));
}

/// A reader that joined late knows no first frame: one that comes is late by up to sixteen frames and 65 536 µs, and beyond
/// that of another start.
#[test]
fn a_first_frame_that_nobody_knows_is_told_by_number_and_time() {
    let old = frames_of(session_from(1_000), 1, 40);
    for (last, tick, is_late) in [
        (1, 0, true),
        (15, 0, true),
        (16, 0, false),
        (30, 0, false),
        (3, 3_000 + 65_536, true),
        (3, 3_000 + 65_537, false),
        (3, 9_000_000, false),
    ] {
        let mut framer = Framer::new(Coding::for_channels(6, 1_000), session_from(1_000));
        let mut buffer = [0; 64];
        let mut first = framer.start(Tick::from(tick), &mut buffer).unwrap();
        first.event(event(tick, 2, true)).unwrap();
        let first = first.finish().to_vec();
        let (taken, reader) = read(old[1..=last].iter().chain([&first]));
        assert_eq!(reader.late(), u32::from(is_late), "{last} {tick}");
        let start = (2, tick / 1_000, 0, true);
        assert_eq!(taken.get(last), (!is_late).then_some(&start), "{last} {tick}");
    }
}

/// Sixteen late frames in a row are those of another start; fewer are late, whatever comes then.
#[test]
fn sixteen_late_frames_show_a_session_that_is_used_again() {
    let at = |address| frames_of(session_from(1_000), address, 60);
    let (old, new) = (at(1), at(2));
    for late in [1, 14, 15, 16, 30] {
        let (taken, reader) = read(old[..40].iter().chain(&new[1..=late]).chain(&old[40..]));
        let is_again = late >= 16;
        assert_eq!(reader.late() as usize, late.min(15), "{late}");
        let start = taken.iter().position(|frame| frame.3 && frame.0 == 2);
        assert_eq!(start, is_again.then_some(40), "{late}");
        if !is_again {
            assert_eq!(taken[40], (1, 40, 0, false), "{late}");
        }
    }
    // Bytes that seem to be a short frame are long forgotten when the next frame was delivered.
    let stray = vec![0x60; 3];
    let before = old[..40].iter().chain([&stray]).chain(&old[40..41]);
    let (taken, reader) = read(before.chain(&old[10..14]).chain(&old[41..]));
    assert_eq!((taken.len(), reader.late()), (60, 4));
    // One that is delivered between them ends the row.
    let mixed = new[1..=14].iter().chain(&old[40..41]).chain(&new[1..=14]).chain(&old[41..]);
    let (taken, reader) = read(old[..40].iter().chain(mixed));
    assert_eq!((taken.len(), reader.late()), (60, 28));
}

/// What a gap and what a start is, by numbers and by times.
#[test]
fn gaps_end_where_no_outage_lasts() {
    let coding = Coding::for_channels(6, 1_000);
    let frame = |number: u64, tick: u32| {
        let mut framer = Framer::new(coding, Session::counted(1)).with_full_every(0);
        let mut buffer = [0; MIN_FRAME];
        let mut bytes = framer.start(tick.into(), &mut buffer).unwrap().finish().to_vec();
        bytes.truncate(MIN_FRAME - 4);
        bytes[1] = 0x40;
        bytes[2..8].copy_from_slice(&number.to_le_bytes()[..6]);
        bytes.extend(crc32(&bytes).to_le_bytes());
        bytes
    };
    let heard = |number: u64, tick: u32| {
        let mut reader = Reader::<MIN_FRAME>::new();
        let stream = [frame(1 << 30, 1_000_000), frame(number, tick)].concat();
        let mut input = &stream[..];
        assert!(reader.next_frame(&mut input).is_some_and(|received| received.is_start));
        reader
            .next_frame(&mut input)
            .map(|received| (received.gap.map(|gap| gap.lost_frames), received.is_start))
    };
    let next = (1 << 30) + 1;
    for (number, tick, expected) in [
        (next, 1_000_000, Some((None, false))),
        (next + 65_536, 2_000_000, Some((Some(65_536), false))),
        (next + (1 << 24) - 1, 2_000_000, Some((Some((1 << 24) - 1), false))),
        (next + (1 << 24), 2_000_000, Some((None, true))),
        (next, 1_000_000 - 65_536, Some((None, false))),
        (next, 1_000_000 - 65_537, Some((None, true))),
        (next - 300, 500_000, None),
        (next - 65_536, 500_000, None),
        (next - 65_537, 500_000, Some((None, true))),
        (next - 300, 1_000_000 + 65_536, None),
        (next - 300, 1_000_000 + 65_537, Some((None, true))),
    ] {
        assert_eq!(heard(number, tick), expected, "{number} at {tick}");
    }
}
