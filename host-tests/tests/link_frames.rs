//! Frames: their bytes, round trips, and readers of damaged and random bytes.

use core::num::NonZeroU16;

use proptest::prelude::*;
use spikewire::link::{Coding, FrameView, Framer, Gap, LinkError, MAX_FRAME, MIN_FRAME, Reader};
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

const SESSION: u16 = 0x1234;

fn keyframe<S: Sample>(tick: u32, address: u16, value: S) -> Keyframe {
    Keyframe::new(tick.into(), address, value)
}

fn any_event() -> impl Strategy<Value = Event> {
    let tick = prop_oneof![0_u32..10, 0_u32..100_000, any::<u32>()];
    let address = prop_oneof![0_u16..6, any::<u16>()];
    (tick, address, any::<bool>()).prop_map(|(tick, address, is_up)| event(tick, address, is_up))
}

fn any_coding() -> impl Strategy<Value = Coding> {
    (1_u16.., any::<u8>(), any::<u8>()).prop_map(|(period, address_bits, jitter_bits)| Coding {
        period: NonZeroU16::new(period).unwrap(),
        address_bits,
        jitter_bits,
    })
}

/// Frames of at most `room` bytes with these events, and how many events each has.
fn frames(coding: Coding, events: &[Event], room: usize) -> Vec<(Vec<u8>, usize)> {
    let mut sender = Framer::new(coding, SESSION);
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
    let mut framer = Framer::new(coding, SESSION);
    let mut buffer = [0xEE; 64];
    let mut frame = framer.start(0x0102_0304.into(), &mut buffer).unwrap();
    frame.keyframe(keyframe(0x0102_0304, 2, -2_i16)).unwrap();
    frame.event(event(0x0102_0304, 0, true)).unwrap(); // 0 10 1
    frame.event(event(0x0102_0304, 4, false)).unwrap(); // 0 0101 0: code(3, 1) = 010 1
    frame.event(event(0x0102_0304 + 1_001, 1, true)).unwrap(); // 1 1 011 11 1: jitter 1 = code(2)
    let bytes = frame.finish();

    // 1 step: code(0) = 1; jitter 1: zigzag 2, code(2, 0) = 011; address 1: code(1, 1) = 1 1.
    let mut expected = vec![0xA5, 0x22, 0x34, 0x12, 0, 0, 4, 3, 2, 1, 0xE8, 3, 0x01, 9];
    expected.extend([1, 1, 2, 0, 0xFE, 0xFF]); // one, of i16: address, bits
    expected.extend([0b0101_0010, 0b1011_0111, 0b1100_0000]);
    expected.extend(crc32(&expected).to_le_bytes());
    assert_eq!(bytes, expected);

    let (view, _) = FrameView::new(bytes).unwrap();
    assert_eq!((view.session(), view.sequence(), view.is_after_loss()), (SESSION, 0, false));
    let kind = SampleKind::Fixed16 { fraction: 0 };
    let tick = Tick::from(0x0102_0304);
    assert!(view.keyframes().eq([Keyframe { tick, address: 2, kind, bits: 0xFFFE }]));
    assert_eq!(view.events().count(), 3);
}

#[test]
fn every_error_says_what_is_wrong() {
    let mut framer = Framer::new(Coding::for_channels(1, 1), SESSION);
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
    assert_eq!(error(&|bytes| bytes[1] = 0x11), LinkError::Version { found: 1 });
    assert_eq!(error(&|bytes| bytes[10] = 0), LinkError::Header);
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
        let mut framer = Framer::new(Coding::for_channels(1, 1), SESSION);
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
        events in prop::collection::vec(any_event(), 1..300),
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
        events in prop::collection::vec(any_event(), 60..200),
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
            let number = received.frame.sequence();
            prop_assert!(received.frame.events().eq(
                FrameView::new(&frames[usize::from(number)].0).unwrap().0.events()));
            gaps += received.gap.map_or(0, |gap| gap.lost_frames);
            numbers.push(number);
        }
        let expected: Vec<u16> = (0..frames.len() as u16)
            .filter(|&number| is_whole || usize::from(number) != damaged).collect();
        prop_assert_eq!(numbers, expected);
        prop_assert_eq!(gaps, u16::from(!is_whole && damaged > 0));
        prop_assert_eq!(reader.lost_frames(), u32::from(gaps));
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
        header in prop::collection::vec(any::<u8>(), 11),
    ) {
        let mut bytes = vec![0xA5, 0x20 | flags];
        bytes.extend(&header);
        bytes.push(body.len() as u8);
        bytes.extend(&body);
        bytes.extend(crc32(&bytes).to_le_bytes());
        if let Ok((view, length)) = FrameView::new(&bytes) {
            prop_assert_eq!(length, bytes.len());
            view.events().for_each(drop);
            view.keyframes().for_each(drop);
        }
    }
}

/// The frames of a session with an event each.
fn session(session: u16, count: u32) -> Vec<Vec<u8>> {
    let mut framer = Framer::new(Coding::for_channels(6, 1_000), session);
    let frame = |number: u32| {
        let mut buffer = [0; 64];
        let mut frame = framer.start((number * 1_000).into(), &mut buffer).unwrap();
        frame.event(event(number * 1_000, session, true)).unwrap();
        frame.finish().to_vec()
    };
    (0..count).map(frame).collect()
}

/// What a reader makes of frames: session, sequence, frames lost before it, and whether it is a start.
fn read<'a>(
    frames: impl IntoIterator<Item = &'a Vec<u8>>,
) -> (Vec<(u16, u16, u16, bool)>, Reader<MAX_FRAME>) {
    let mut reader = Reader::<MAX_FRAME>::new();
    let stream: Vec<u8> = frames.into_iter().flatten().copied().collect();
    let mut input = &stream[..];
    let mut read = Vec::new();
    while let Some(received) = reader.next_frame(&mut input) {
        let lost = received.gap.map_or(0, |gap| gap.lost_frames);
        let (frame, is_start) = (received.frame, received.is_start);
        assert_eq!(received.is_after_break(), is_start || lost > 0);
        read.push((frame.session(), frame.sequence(), lost, is_start));
    }
    (read, reader)
}

#[test]
fn a_start_in_the_middle_and_a_new_session_are_starts() {
    let (first, second) = (session(1, 5), session(2, 3));
    let stream: Vec<u8> = first.concat();
    let mut reader = Reader::<MAX_FRAME>::new();
    let mut input = &stream[35..];
    let received = reader.next_frame(&mut input).unwrap();
    assert_eq!((received.gap, received.is_start, received.frame.sequence()), (None, true, 2));

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

#[test]
fn frames_sent_twice_or_late_are_delivered_once() {
    let frames = session(1, 600);
    let order = [0, 0, 1, 3, 2, 2, 3, 4, 4, 1, 300, 200, 45, 44];
    let (read, reader) = read(order.map(|number| &frames[number]));
    let expected = [(0, 0), (1, 0), (3, 1), (4, 0), (300, 295), (44, 65_279)];
    let told: Vec<_> = read.iter().map(|&(_, sequence, lost, _)| (sequence, lost)).collect();
    assert_eq!(told, expected, "one of more than 256 back counts as a long gap");
    assert_eq!((reader.repeated(), reader.late()), (2 + 1, 4 + 1));
}

#[test]
fn what_was_on_its_way_before_a_reboot_is_late() {
    let sessions: Vec<_> = (1..6).map(|number| session(number, 300)).collect();
    let frame = |session: usize, number: usize| &sessions[session][number];
    let (told, reader) = read([
        frame(0, 0),
        frame(1, 0),
        frame(0, 1),
        frame(2, 0),
        frame(1, 1),
        frame(0, 2),
        frame(2, 1),
    ]);
    assert_eq!(told, [(1, 0, 0, true), (2, 0, 0, true), (3, 0, 0, true), (3, 1, 0, false)]);
    assert_eq!(reader.late(), 3);
    // A number that comes again much later is a session of its own.
    let (told, reader) =
        read(sessions[0][..1].iter().chain(&sessions[1][..256]).chain(&sessions[0][1..3]));
    assert_eq!(told[256..], [(2, 255, 0, false), (1, 1, 0, true), (1, 2, 0, false)]);
    assert_eq!(reader.late(), 0);
}

#[test]
fn the_sequence_wraps() {
    let mut framer = Framer::new(Coding::for_channels(1, 1), SESSION);
    let mut reader = Reader::<MIN_FRAME>::new();
    for number in 0..=70_000_u32 {
        let mut buffer = [0; MIN_FRAME];
        let mut bytes = framer.start(0.into(), &mut buffer).unwrap().finish();
        let is_lost = (65_530..65_540).contains(&number);
        if !is_lost {
            let received = reader.next_frame(&mut bytes).unwrap();
            let gap = (number == 65_540).then_some(Gap { lost_frames: 10 });
            assert_eq!(received.gap, gap, "{number}");
        }
    }
    assert_eq!(reader.lost_frames(), 10);
}
