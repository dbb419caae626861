//! The event formats: golden bytes, round trips, and decoders of cut, damaged and random bytes.

use std::num::NonZeroU32;

use proptest::prelude::*;
use spikewire::link::{Coding, Session, Transmitter};
use spikewire::out::Batch;
use spikewire::{Event, FromEvents, FromItems, Item, Keyframe, Polarity, Tick};
use spikewire_cameras::format::{
    Edvs, EdvsTime, EventDecoder, EventFormat, EventStream, Evt2, FormatError, Formatted, eieio,
};

fn event(tick: u32, address: u16, is_up: bool) -> Event {
    let tick = Tick::from(tick);
    Event { tick, address, polarity: if is_up { Polarity::Up } else { Polarity::Down } }
}

/// Events in order of time, with gaps below `max_gap`.
fn events(max_gap: u32, max_address: u16) -> impl Strategy<Value = Vec<Event>> {
    let gap = prop_oneof![Just(0), 0..300_u32.min(max_gap), 0..max_gap];
    let one = (gap, 0..=max_address, any::<bool>());
    prop::collection::vec(one, 0..100).prop_map(|gaps| {
        let mut tick = 0_u32;
        let next = |(gap, address, is_up)| {
            tick = tick.wrapping_add(gap);
            event(tick, address, is_up)
        };
        gaps.into_iter().map(next).collect()
    })
}

/// All bytes of the events, in buffers of this size.
fn encode(format: impl EventFormat, events: &[Event], buffer: usize) -> Vec<u8> {
    let mut batch = Formatted::new(format);
    let mut source = FromEvents(events.iter().copied());
    let mut bytes = Vec::new();
    loop {
        let mut buffer = vec![0; buffer];
        match batch.fill(&mut source, &mut buffer) {
            0 => break,
            length => bytes.extend(&buffer[..length]),
        }
    }
    assert_eq!((batch.format().retimed(), batch.unencodable()), (0, 0));
    bytes
}

fn decode(mut decoder: impl EventDecoder, bytes: &[u8], cut: usize) -> Vec<Event> {
    let events = bytes.chunks(cut).flat_map(|bytes| decoder.decode(bytes).collect::<Vec<_>>());
    events.collect()
}

fn one(mut format: impl EventFormat, event: Event) -> Vec<u8> {
    let mut bytes = [0; 64];
    let length = format.encode(event, &mut bytes).unwrap();
    bytes[..length].to_vec()
}

/// A size of more than 32 bits is that of no event, and of none that a shorter one looks like.
#[test]
fn a_size_beyond_32_bits_is_longer_than_any_stream() {
    // 3 and 2³⁵; 3 and 2³²; 0 and 2³³: the low bit says that the size goes on.
    for size in [[7, 1, 1, 1, 1, 2].as_slice(), &[7, 1, 1, 1, 32], &[1, 1, 1, 1, 64]] {
        let event = [9, 6, 1, 0, 1];
        let stream = [EventStream::HEADER.as_slice(), &[5], size, &event.repeat(20)].concat();
        let mut decoder = EventStream::decoder();
        assert_eq!(decoder.decode(&stream).count(), 0, "{size:?}");
        assert_eq!(decoder.skipped(), 100);
    }
}

#[test]
fn edvs_bytes_are_golden() {
    let at = |tick| event(tick, 0x45 << 7 | 0x23, true);
    let bytes = |time, tick| one(Edvs::new(time).encoder(), at(tick));
    assert_eq!(bytes(EdvsTime::None, 99), [0xC5, 0xA3]);
    for (delta, time) in [
        (0, &[0x80][..]),
        (0x7E, &[0xFE]),
        (0x7F, &[0x00, 0xFF]), // the limits are strict
        (0x3FFE, &[0x7F, 0xFE]),
        (0x3FFF, &[0x00, 0x7F, 0xFF]),
        (0x1F_FFFE, &[0x7F, 0x7F, 0xFE]),
        (0x1F_FFFF, &[0x00, 0x7F, 0x7F, 0xFF]),
        (0x0FFF_FFFF, &[0x7F, 0x7F, 0x7F, 0xFF]),
        (0x1000_0000, &[0x7F, 0x7F, 0x7F, 0xFF]), // cut
    ] {
        assert_eq!(bytes(EdvsTime::Delta, delta)[2..], *time, "{delta:#x}");
    }
    assert_eq!(bytes(EdvsTime::Bits16, 0x1234_5678), [0xC5, 0xA3, 0x56, 0x78]);
    assert_eq!(bytes(EdvsTime::Bits24, 0x1234_5678), [0xC5, 0xA3, 0x34, 0x56, 0x78]);
    assert_eq!(bytes(EdvsTime::Bits32, 0x1234_5678), [0xC5, 0xA3, 0x12, 0x34, 0x56, 0x78]);
    let zero = Edvs::new(EdvsTime::None).with_up_as_zero();
    assert_eq!(one(zero.encoder(), at(0)), [0xC5, 0x23]);
    assert_eq!(decode(zero.decoder(), &[0xC5, 0x23], 1), [at(0)]);
}

#[test]
fn edvs_addresses_have_14_bits() {
    let wide = event(0, 1 << 14, true);
    let result = Edvs::new(EdvsTime::None).encoder().encode(wide, &mut [0; 8]);
    assert_eq!(result, Err(FormatError::Address { address: 1 << 14, max: 0x3FFF }));

    let mut batch = Formatted::new(Edvs::new(EdvsTime::None).encoder());
    let length = batch.fill(&mut FromEvents([wide, event(0, 1, true)].into_iter()), &mut [0; 8]);
    assert_eq!((length, batch.unencodable()), (2, 1));
}

#[test]
fn event_stream_bytes_are_golden() {
    assert_eq!(&EventStream::HEADER, b"Event Stream\x02\x00\x00\x00");
    let bytes = |tick| one(EventStream::encoder(), event(tick, 0x0102, false));
    assert_eq!(bytes(253), [253, 6, 2, 1, 0]);
    assert_eq!(bytes(254), [0xFF, 0, 6, 2, 1, 0]);
    assert_eq!(bytes(508 + 7), [0xFF, 0xFF, 7, 6, 2, 1, 0]);
}

#[test]
fn event_stream_skips_what_is_not_its_own() {
    let mut stream = EventStream::HEADER.to_vec();
    stream[13] = 9; // a minor version
    stream.extend([5, 4, 7, 7]); // a payload of two bytes
    stream.extend([5, 0]); // of none
    stream.push(0xFE);
    stream.extend([5, 0x91, 0x02]); // of 200
    stream.extend([0; 200]);
    stream.extend([5, 0x07, 0x01, 0x00, 1, 0, 1]); // of three, in three groups
    let mut decoder = EventStream::decoder();
    assert!(decoder.decode(&stream).eq([event(20, 1, true)]));
    assert_eq!(decoder.skipped(), 2 + 1 + 200);
    assert!(!decoder.is_foreign());

    let mut decoder = EventStream::decoder();
    assert_eq!(decoder.decode(b"Event Stream\x03\0\0\0").count(), 0);
    assert!(decoder.is_foreign());
    let mut decoder = EventStream::decoder();
    assert_eq!(decoder.decode(b"Event Stream\x02\0\0\x01").count(), 0);
    assert!(decoder.is_foreign(), "another type of stream");
}

#[test]
fn evt2_words_are_golden() {
    let mut encoder = Evt2::encoder();
    let mut bytes = [0; 8];
    let first = event(0x40 * 5 + 3, 3 << 11 | 0x7FF, true);
    assert_eq!(encoder.encode(first, &mut bytes), Ok(8));
    let words = [0x8000_0005_u32, 1 << 28 | 3 << 22 | 0x7FF << 11 | 3];
    assert_eq!(bytes[..], words.map(u32::to_le_bytes).concat());
    let second = event(0x40 * 5 + 4, 0, false);
    assert_eq!(encoder.encode(second, &mut bytes), Ok(4));
    assert_eq!(bytes[..4], (4_u32 << 22).to_le_bytes());
}

#[test]
fn evt2_time_goes_on_over_the_wrap_of_ticks() {
    let mut encoder = Evt2::encoder();
    let mut bytes = [0; 8];
    let mut time_high = |tick| {
        encoder.encode(event(tick, 0, true), &mut bytes).unwrap();
        u32::from_le_bytes(*bytes.first_chunk().unwrap()) & 0x0FFF_FFFF
    };
    assert_eq!(time_high(u32::MAX), 0x03FF_FFFF);
    assert_eq!(time_high(0), 0x0400_0000);
}

#[test]
fn evt2_rows_that_no_address_holds_are_skipped() {
    let word = |row: u32| (1_u32 << 28 | 7 << 11 | row).to_le_bytes();
    let bytes = [(8_u32 << 28).to_le_bytes(), word(32), word(31)].concat();
    let mut decoder = Evt2::decoder();
    assert!(decoder.decode(&bytes).eq([event(0, 31 << 11 | 7, true)]));
    assert_eq!(decoder.skipped(), 4);
}

#[test]
fn a_stream_that_is_cut_within_an_event_says_so() {
    let event = event(300, 0x25, true);
    macro_rules! check {
        ($decoder:expr, $bytes:expr, $whole:expr) => {{
            let mut decoder = $decoder;
            assert!(!decoder.is_partial(), "nothing has begun");
            for (length, &byte) in (1..).zip($bytes) {
                decoder.push(byte);
                assert_eq!(!decoder.is_partial(), $whole.contains(&length), "{length} bytes");
            }
        }};
    }
    let camera = Edvs::new(EdvsTime::Bits16);
    let bytes = [[0x33].as_slice(), &one(camera.encoder(), event)].concat();
    check!(camera.decoder(), &bytes, &[1, 5]);
    let bytes = [&EventStream::HEADER, one(EventStream::encoder(), event).as_slice()].concat();
    check!(EventStream::decoder(), &bytes, &[16, 17, 22]);
    let bytes = [b"% end\n", one(Evt2::encoder(), event).as_slice()].concat();
    check!(Evt2::file_decoder(), &bytes, &[6, 10, 14]);
}

/// A header of lines, short ones too, ends where its last line says, even if a word follows that looks like a line.
#[test]
fn evt2_headers_end_where_they_say() {
    let words = [[0, 0, 0, 0x80], (1_u32 << 28 | 3 << 11).to_le_bytes()].concat();
    // Words of a type that there is not.
    let (like_a_line, like_text) = ([b'%', 0, 0, b'A'], [0, b'A', 0, b'A']);
    for (header, first) in [
        ("", like_text),
        ("% evt 2.0\n% end\n", like_a_line),
        ("%\n% end\n", like_a_line),
        ("%\n", like_text),
    ] {
        let file = [header.as_bytes(), &first, &words].concat();
        let mut decoder = Evt2::file_decoder();
        assert!(decoder.decode(&file).eq([event(0, 3, true)]), "{header:?}");
        assert_eq!(decoder.skipped(), 4, "{header:?}");
    }
}

#[test]
fn evt2_files_begin_with_lines() {
    let events = [event(37, 0x25, true), event(99, 0x25, false)];
    let mut file = Evt2::HEADER.to_vec();
    file.extend(encode(Evt2::encoder(), &events, 64));
    assert_eq!(decode(Evt2::file_decoder(), &file, 7), events);
    let bare = encode(Evt2::encoder(), &events, 64);
    assert_eq!(decode(Evt2::file_decoder(), &bare, 7), events);
    // The first byte is that of a line's: time 0x25 << 6.
    let events = [event(0x25 << 6, 7, true), event(0x2025 << 6, 0x25, false)];
    for event in events {
        let bare = encode(Evt2::encoder(), &[event], 64);
        assert_eq!(bare[0], b'%');
        assert_eq!(decode(Evt2::file_decoder(), &bare, 7), [event]);
        let headed = [b"% evt 2.0\n%\n% x\n", bare.as_slice()].concat();
        assert_eq!(decode(Evt2::file_decoder(), &headed, 7), [event]);
    }
    let mut decoder = Evt2::decoder();
    let early = decoder.decode(&bare[4..8]).count();
    assert_eq!((early, decoder.skipped()), (0, 4), "no event before the first time");
}

#[test]
fn eieio_datagrams_are_golden() {
    let mut bytes = [0; 10];
    let keys = [0x0007_0105, 0x0007_0106];
    assert_eq!(eieio::encode(None, keys, &mut bytes), Ok(10));
    assert_eq!(bytes, [0x02, 0x08, 0x05, 0x01, 0x07, 0x00, 0x06, 0x01, 0x07, 0x00]);
    assert_eq!(eieio::encode(Some(0x1234), [keys[0]], &mut bytes), Ok(10));
    assert_eq!(bytes, [0x01, 0x38, 0x34, 0x12, 0x00, 0x00, 0x05, 0x01, 0x07, 0x00]);
    let datagram = eieio::decode(&bytes).unwrap();
    assert_eq!(datagram.timestamp, Some(0x1234));
    assert!(datagram.keys().eq([keys[0]]));
    assert_eq!(eieio::encode(Some(0), keys, &mut bytes), Err(FormatError::Full { written: 0 }));
    assert_eq!(eieio::decode(&bytes[..9]), None);
    assert_eq!(eieio::decode(&[0, 0x18]), None);
    let mut large = [0; 2_000];
    assert_eq!(eieio::encode(None, 0..255, &mut large), Ok(2 + 4 * 255));
    assert_eq!(eieio::encode(None, 0..256, &mut large), Err(FormatError::Full { written: 0 }));
}

#[test]
fn events_out_of_order_are_retimed_and_counted() {
    let events = [event(500, 1, true), event(400, 2, true), event(600, 3, true)];
    let retimed = [event(500, 1, true), event(500, 2, true), event(600, 3, true)];
    let check = |format: &mut dyn FnMut(Event) -> Vec<u8>| {
        events.into_iter().flat_map(format).collect::<Vec<u8>>()
    };
    macro_rules! check {
        ($encoder:expr, $decoder:expr, $header:expr) => {
            let mut encoder = $encoder;
            let mut bytes = $header.to_vec();
            bytes.extend(check(&mut |event| {
                let mut bytes = [0; 64];
                let length = encoder.encode(event, &mut bytes).unwrap();
                bytes[..length].to_vec()
            }));
            assert_eq!(encoder.retimed(), 1);
            assert_eq!(decode($decoder, &bytes, 3), retimed);
        };
    }
    let edvs = Edvs::new(EdvsTime::Delta);
    check!(edvs.encoder(), edvs.decoder(), []);
    check!(EventStream::encoder(), EventStream::decoder(), EventStream::HEADER);
    check!(Evt2::encoder(), Evt2::decoder(), []);
}

#[test]
fn a_log_may_begin_long_after_boot() {
    const BOOT_TO_LOG: u32 = 40 * 60 * 1_000_000; // more than half the ticks
    let late = event(BOOT_TO_LOG + 300, 0x0102, true);

    let mut from_boot = EventStream::encoder();
    let written = usize::try_from((BOOT_TO_LOG + 300) / 254).unwrap() + 5;
    assert_eq!(from_boot.encode(late, &mut vec![0; written]), Ok(written));
    assert_eq!(from_boot.retimed(), 0);

    let mut from_start = EventStream::encoder_from(BOOT_TO_LOG.into());
    let mut file = [EventStream::HEADER.as_slice(), &[0; 6]].concat();
    assert_eq!(from_start.encode(late, &mut file[16..]), Ok(6));
    assert_eq!(from_start.retimed(), 0);
    assert_eq!(decode(EventStream::decoder_from(BOOT_TO_LOG.into()), &file, 5), [late]);
    assert_eq!(decode(EventStream::decoder(), &file, 5), [Event { tick: Tick::from(300), ..late }]);

    for time in [EdvsTime::Delta, EdvsTime::Bits16, EdvsTime::Bits24] {
        let camera = Edvs::new(time);
        let mut encoder = camera.encoder_from(BOOT_TO_LOG.into());
        let mut bytes = [0; 6];
        let length = encoder.encode(late, &mut bytes).unwrap();
        let mut decoder = camera.decoder();
        decoder.set_tick(BOOT_TO_LOG.into());
        assert!(decoder.decode(&bytes[..length]).eq([late]));
        assert_eq!(encoder.retimed(), 0);
    }
}

/// 2²⁴ µs back is out of order, one more is a silence.
#[test]
fn only_events_a_little_back_are_out_of_order() {
    for (back, retimed) in [(1, 1), (1 << 24, 1), ((1 << 24) + 1, 0)] {
        let mut encoder = Evt2::encoder();
        let mut bytes = [0; 8];
        for tick in [7_u32, 7_u32.wrapping_sub(back)] {
            encoder.encode(event(tick, 5, true), &mut bytes).unwrap();
        }
        assert_eq!(encoder.retimed(), retimed, "{back}");
    }
}

/// An event after a silence of more than half the ticks is later, and those after it are right.
#[test]
fn silence_is_no_way_back() {
    const SILENCES: [u32; 4] = [(1 << 31) - 1, 1 << 31, 2_200_000_000, u32::MAX - (1 << 24)];
    fn read(
        mut encoder: impl EventFormat,
        mut decoder: impl EventDecoder,
        silence: u32,
    ) -> [(u32, bool); 3] {
        let start = 7_u32;
        [start, start.wrapping_add(silence), start.wrapping_add(silence).wrapping_add(1_000)].map(
            |tick| {
                let mut bytes = vec![0; 9_000_000];
                let length = encoder.encode(event(tick, 5, true), &mut bytes).unwrap();
                let read = decoder.decode(&bytes[..length]).last().unwrap();
                (encoder.retimed(), read.tick == Tick::from(tick))
            },
        )
    }
    for silence in SILENCES {
        // A byte for every 254 µs: one silence stands for all.
        if silence == 1 << 31 {
            let mut stream = EventStream::decoder();
            assert_eq!(stream.decode(&EventStream::HEADER).count(), 0);
            assert_eq!(read(EventStream::encoder(), stream, silence), [(0, true); 3]);
        }
        assert_eq!(read(Evt2::encoder(), Evt2::decoder(), silence), [(0, true); 3], "{silence}");
        // E1 has room for 268 s an event: each comes nearer by as much.
        let camera = Edvs::new(EdvsTime::Delta);
        let (mut encoder, mut decoder) = (camera.encoder(), camera.decoder());
        let mut is_right = false;
        for event in [event(0, 5, true)].into_iter().chain([event(silence, 5, true); 17]) {
            let mut bytes = [0; 6];
            let length = encoder.encode(event, &mut bytes).unwrap();
            is_right = decoder.decode(&bytes[..length]).eq([event]);
        }
        assert!(is_right, "{silence}");
    }
}

#[test]
fn edvs_does_not_see_a_lost_byte_where_all_have_bit_7() {
    let events: Vec<_> = (1..100).map(|address| event(0, address, true)).collect();
    for time in [EdvsTime::None, EdvsTime::Delta] {
        let bytes = encode(Edvs::new(time).encoder(), &events, 64);
        let mut decoder = Edvs::new(time).decoder();
        assert_eq!(decoder.decode(&bytes[1..]).filter(|read| events.contains(read)).count(), 0);
        assert_eq!(decoder.skipped(), 0);
    }
}

/// Sends all items in the shortest batches.
fn goes_on<B: Batch>(mut batch: B, items: &[Item]) {
    let mut source = FromItems(items.iter().copied());
    let mut bytes = vec![0; B::SHORTEST];
    while source.0.len() > 0 {
        assert!(batch.fill(&mut source, &mut bytes) > 0);
    }
}

proptest! {
    #![proptest_config(crate::cases(256))]

    #[test]
    fn the_shortest_batch_always_holds_something(
        near in events(100_000, u16::MAX),
        far in events(u32::MAX, 0x3FFF),
        (period, address_bits, jitter_bits) in any::<(NonZeroU32, u8, u8)>(),
        keyframes in prop::collection::vec(any::<(f32, prop::sample::Index)>(), 0..20),
    ) {
        let [near, mut far] = [near, far].map(|events| events.into_iter().map(Item::Event).collect::<Vec<_>>());
        for time in [EdvsTime::None, EdvsTime::Delta, EdvsTime::Bits16, EdvsTime::Bits24, EdvsTime::Bits32] {
            goes_on(Formatted::new(Edvs::new(time).encoder()), &far);
        }
        goes_on(Formatted::new(EventStream::encoder()), &near);
        goes_on(Formatted::new(Evt2::encoder()), &far);
        for (address, (value, at)) in (0..).zip(keyframes) {
            let at = at.index(far.len() + 1);
            far.insert(at, Item::Keyframe(Keyframe::new(Tick::default(), address, value)));
        }
        goes_on(Transmitter::new(Coding { period, address_bits, jitter_bits, step_bits: 0 }, Session::counted(0)), &far);
    }

    #[test]
    fn edvs_round_trips(
        (time, events) in prop_oneof![
            (Just(EdvsTime::Delta), events((1 << 28) - 1, 0x3FFF)),
            (Just(EdvsTime::Bits16), events((1 << 16) - 1, 0x3FFF)),
            (Just(EdvsTime::Bits24), events((1 << 24) - 1, 0x3FFF)),
            (Just(EdvsTime::Bits32), events(u32::MAX, 0x3FFF)),
        ],
        is_zero in any::<bool>(),
        buffer in 6..100_usize,
        cut in 1..20_usize,
    ) {
        let format = Edvs::new(time);
        let format = if is_zero { format.with_up_as_zero() } else { format };
        let bytes = encode(format.encoder(), &events, buffer);
        prop_assert_eq!(decode(format.decoder(), &bytes, cut), events);
    }

    #[test]
    fn every_event_read_at_another_time_is_counted(ticks in prop::collection::vec(any::<u32>(), 0..20)) {
        let events: Vec<_> = ticks.iter().map(|&tick| event(tick, 0, true)).collect();
        for time in [EdvsTime::Delta, EdvsTime::Bits16, EdvsTime::Bits24, EdvsTime::Bits32] {
            let mut encoder = Edvs::new(time).encoder();
            let mut decoder = Edvs::new(time).decoder();
            let mut retimed = 0;
            for &event in &events {
                let mut bytes = [0; 6];
                let length = encoder.encode(event, &mut bytes).unwrap();
                retimed += decoder.decode(&bytes[..length]).filter(|&read| read != event).count();
                prop_assert_eq!(encoder.retimed() as usize, retimed);
            }
        }
    }

    #[test]
    fn edvs_without_time_takes_that_of_arrival(events in events(1, 0x3FFF), now: u32) {
        let format = Edvs::new(EdvsTime::None);
        let bytes = encode(format.encoder(), &events, 2);
        let mut decoder = format.decoder();
        decoder.set_tick(now.into());
        let expected = events.into_iter().map(|event| Event { tick: now.into(), ..event });
        prop_assert_eq!(decoder.decode(&bytes).collect::<Vec<_>>(), expected.collect::<Vec<_>>());
    }

    #[test]
    fn event_stream_round_trips(events in events(100_000, u16::MAX), buffer in 5..100_usize, cut in 1..20_usize) {
        let mut bytes = EventStream::HEADER.to_vec();
        bytes.extend(encode(EventStream::encoder(), &events, buffer));
        prop_assert_eq!(decode(EventStream::decoder(), &bytes, cut), events);
    }

    #[test]
    fn evt2_round_trips(events in events(1 << 30, u16::MAX), buffer in 4..100_usize, cut in 1..20_usize) {
        let bytes = encode(Evt2::encoder(), &events, buffer);
        prop_assert_eq!(decode(Evt2::decoder(), &bytes, cut), events);
    }

    #[test]
    fn eieio_round_trips(stamp: Option<u32>, keys in prop::collection::vec(any::<u32>(), 0..=255)) {
        let mut bytes = [0; 6 + 4 * 255];
        let length = eieio::encode(stamp, keys.iter().copied(), &mut bytes).unwrap();
        let datagram = eieio::decode(&bytes[..length]).unwrap();
        prop_assert_eq!(datagram.timestamp, stamp);
        prop_assert!(datagram.keys().eq(keys));
    }

    #[test]
    fn random_and_damaged_bytes_never_panic(
        events in events(1 << 16, 0x3FFF),
        flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..20),
        random in prop::collection::vec(any::<u8>(), 0..300),
        is_file in any::<bool>(),
    ) {
        let damage = |mut bytes: Vec<u8>| {
            for (index, flip) in &flips {
                if !bytes.is_empty() {
                    let at = index.index(bytes.len());
                    bytes[at] ^= flip;
                }
            }
            bytes.extend(&random);
            bytes
        };
        for time in [EdvsTime::None, EdvsTime::Delta, EdvsTime::Bits16, EdvsTime::Bits24] {
            let format = Edvs::new(time);
            decode(format.decoder(), &damage(encode(format.encoder(), &events, 64)), 50);
        }
        let header: &[u8] = if is_file { &EventStream::HEADER } else { &[] };
        let es = [header, &encode(EventStream::encoder(), &events, 64)].concat();
        decode(EventStream::decoder(), &damage(es), 50);
        let header: &[u8] = if is_file { Evt2::HEADER } else { &[] };
        let evt2 = [header, &encode(Evt2::encoder(), &events, 64)].concat();
        decode(Evt2::file_decoder(), &damage(evt2.clone()), 50);
        decode(Evt2::decoder(), &damage(evt2), 50);
        if let Some(datagram) = eieio::decode(&random) {
            datagram.keys().for_each(drop);
        }
    }

    #[test]
    fn edvs_with_up_as_zero_finds_back_among_events_that_all_go_up(
        mut events in events(1 << 21, 0x3FFF),
        lost in any::<prop::sample::Index>(),
    ) {
        for event in &mut events {
            event.polarity = Polarity::Up;
        }
        for time in [EdvsTime::None, EdvsTime::Delta] {
            let format = Edvs::new(time).with_up_as_zero();
            let mut bytes = encode(format.encoder(), &events, 64);
            if bytes.is_empty() {
                break;
            }
            let at = lost.index(bytes.len());
            bytes.remove(at);
            let whole = format.decoder().decode(&bytes[..at]).count();
            let read: Vec<_> = format.decoder().decode(&bytes).map(|event| event.address).collect();
            let sent: Vec<_> = events.iter().map(|event| event.address).collect();
            let right = sent.get(whole + 3..).unwrap_or_default();
            prop_assert!(read.ends_with(right), "{time:?}");
        }
    }

    #[test]
    fn edvs_resynchronises_on_bit_7(
        events in events(1_000, 0x3FFF),
        junk in prop::collection::vec(0_u8..0x80, 0..20),
    ) {
        let format = Edvs::new(EdvsTime::Delta);
        let bytes = [junk.clone(), encode(format.encoder(), &events, 64)].concat();
        let mut decoder = format.decoder();
        prop_assert!(decoder.decode(&bytes).eq(events));
        prop_assert_eq!(decoder.skipped(), junk.len() as u32);
    }
}
