//! Formats with columns and rows: golden bytes, round trips, and what they refuse.

use crate::cases;
use proptest::collection::vec;
use proptest::prelude::*;
use spikewire::{Polarity, Tick};
use spikewire_cameras::format::{
    Dvs, EventDecoder, EventFormat, Evt2Pixels, Evt3Pixels, Evt21Order, Evt21Pixels, FormatError,
};
use spikewire_cameras::frame::PixelEvent;

const CAMERA: Dvs = Dvs::new(320, 240);

fn event(micros: u32, x: u16, y: u16, polarity: Polarity) -> PixelEvent {
    PixelEvent { tick: Tick::from(micros), x, y, polarity }
}

/// Writes with as much room as there is after each event, down to none.
fn write(encoder: &mut impl EventFormat<PixelEvent>, events: &[PixelEvent]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (index, &event) in events.iter().enumerate() {
        let mut buffer = vec![0; 5 + index % 9];
        loop {
            match encoder.encode(event, &mut buffer) {
                Ok(length) => {
                    bytes.extend(&buffer[..length]);
                    break;
                }
                Err(FormatError::Full { written }) => bytes.extend(&buffer[..written]),
                Err(error) => panic!("{error}"),
            }
        }
    }
    bytes
}

/// As `event_stream` 1.6.3 writes them.
#[test]
fn golden_bytes_of_an_event_stream() {
    let (up, down) = (Polarity::Up, Polarity::Down);
    let events = [
        event(130, 5, 0, up),
        event(131, 6, 239, down),
        event(257, 1, 1, up),
        event(384, 2, 1, down),
    ];
    let mut bytes = CAMERA.header().to_vec();
    bytes.extend(write(&mut CAMERA.encoder(), &events));
    let golden =
        "4576656e742053747265616d02000001 4001f000 ff0705000000 020600ef00 fd01000100 ff0002000100";
    let hex = bytes.iter().fold(String::new(), |hex, byte| format!("{hex}{byte:02x}"));
    assert_eq!(hex, golden.replace(' ', ""));
    let mut decoder = Dvs::decoder();
    assert!(decoder.decode(&bytes).eq(events));
    assert_eq!(
        (decoder.skipped(), decoder.is_partial(), decoder.size()),
        (0, false, Some((320, 240)))
    );
    assert!(!decoder.is_foreign());
    // A reset is no event, and takes no time.
    assert!(decoder.decode(&[0xFE, 0xFE, 0x03, 9, 0, 8, 0]).eq([event(385, 9, 8, up)]));
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn round_trips(raw in vec((0_u32..3000, 0_u16..320, 0_u16..240, any::<bool>()), 0..200), start in any::<u32>()) {
        let mut tick = start;
        let events: Vec<_> = raw
            .into_iter()
            .map(|(delta, x, y, up)| {
                tick = tick.wrapping_add(delta);
                event(tick, x, y, if up { Polarity::Up } else { Polarity::Down })
            })
            .collect();
        let mut encoder = CAMERA.encoder_from(Tick::from(start));
        let mut bytes = CAMERA.header().to_vec();
        bytes.extend(write(&mut encoder, &events));
        let mut decoder = Dvs::decoder_from(Tick::from(start));
        prop_assert!(decoder.decode(&bytes).eq(events.iter().copied()));
        prop_assert_eq!((decoder.skipped(), encoder.retimed()), (0, 0));

        let mut encoder = Evt2Pixels::encoder();
        let mut bytes = b"% evt 2.0\n% format EVT2;height=240;width=320\n% end\n".to_vec();
        bytes.extend(write(&mut encoder, &events));
        let mut decoder = Evt2Pixels::file_decoder();
        prop_assert!(decoder.decode(&bytes).eq(events.iter().copied()));
        prop_assert_eq!((decoder.skipped(), encoder.retimed()), (0, 0));

        let mut encoder = Evt3Pixels::encoder();
        let bytes = write(&mut encoder, &events);
        let mut decoder = Evt3Pixels::decoder();
        prop_assert!(decoder.decode(&bytes).eq(events));
        prop_assert_eq!((decoder.skipped(), encoder.retimed(), decoder.is_partial()), (0, 0, false));
    }

    #[test]
    fn vectors_of_evt3_and_evt21_are_the_pixels_of_their_bits(
        rows in vec((0_u64..40, 0_u16..2000, 0_u16..2048, any::<bool>(), any::<u32>()), 0..40),
    ) {
        let (mut time, mut expected) = (0, vec![]);
        let (mut evt21, mut evt3): (Vec<u64>, Vec<u16>) = (vec![], vec![]);
        for (delta, x, y, up, valid) in rows {
            time += delta;
            let polarity = if up { Polarity::Up } else { Polarity::Down };
            let of_bit = |bit: u16| event(time as u32, x + bit, y, polarity);
            expected.extend((0..32).filter(|bit| valid >> bit & 1 == 1).map(of_bit));
            let word = u64::from(up) << 60 | (time & 63) << 54 | u64::from(x) << 43 | u64::from(y) << 32;
            evt21.extend([8 << 60 | time >> 6 << 32, word | u64::from(valid)]);
            let base = 3 << 12 | u16::from(up) << 11 | x;
            evt3.extend([8 << 12 | (time >> 12) as u16, 6 << 12 | (time & 0xFFF) as u16, y, base]);
            let part = |from: u32, mask: u32| (valid >> from & mask) as u16;
            evt3.extend([4 << 12 | part(0, 0xFFF), 4 << 12 | part(12, 0xFFF), 5 << 12 | part(24, 0xFF)]);
        }
        let bytes: Vec<u8> = evt21.iter().flat_map(|word| word.to_le_bytes()).collect();
        let mut decoder = Evt21Pixels::decoder(Evt21Order::Little);
        prop_assert!(decoder.decode(&bytes).eq(expected.iter().copied()));
        let bytes: Vec<u8> = evt21.iter().flat_map(|word| word.rotate_left(32).to_le_bytes()).collect();
        let mut decoder = Evt21Pixels::decoder(Evt21Order::Halves);
        prop_assert!(decoder.decode(&bytes).eq(expected.iter().copied()));
        let bytes: Vec<u8> = evt3.iter().flat_map(|word| word.to_le_bytes()).collect();
        prop_assert!(Evt3Pixels::decoder().decode(&bytes).eq(expected));
    }

    #[test]
    fn any_bytes_are_read(bytes in vec(any::<u8>(), 0..400)) {
        let mut stream = Dvs::decoder();
        stream.decode(&CAMERA.header()).for_each(drop);
        for event in stream.decode(&bytes) {
            prop_assert!(event.x < 320 && event.y < 240);
        }
        Evt2Pixels::decoder().decode(&bytes).for_each(drop);
        for decoder in [Evt21Order::Little, Evt21Order::Halves].map(Evt21Pixels::decoder) {
            let mut decoder = decoder;
            let read = decoder.decode(&bytes).count();
            prop_assert!(read <= 4 * bytes.len() && decoder.skipped() as usize <= bytes.len());
        }
        let mut decoder = Evt3Pixels::decoder();
        let read = decoder.decode(&bytes).count();
        prop_assert!(read <= 6 * bytes.len() && decoder.skipped() as usize <= bytes.len());
        Dvs::decoder().decode(&bytes).for_each(drop);
    }
}

#[test]
fn pixels_outside_and_time_that_goes_back() {
    let mut encoder = CAMERA.encoder();
    let mut bytes = [0; 8];
    for (x, y) in [(320, 0), (0, 240), (u16::MAX, u16::MAX)] {
        let refused = encoder.encode(event(0, x, y, Polarity::Up), &mut bytes);
        assert_eq!(refused, Err(FormatError::Pixel { x, y }));
    }
    assert_eq!(
        FormatError::Pixel { x: 320, y: 0 }.to_string(),
        "pixel 320, 0 lies outside the picture that the header tells"
    );
    let mut words = Evt2Pixels::encoder();
    let refused = words.encode(event(0, 0, 2048, Polarity::Up), &mut bytes);
    assert_eq!(refused, Err(FormatError::Pixel { x: 0, y: 2048 }));
    assert_eq!(words.encode(event(0, 2047, 2047, Polarity::Up), &mut bytes), Ok(8));

    assert_eq!(encoder.encode(event(100, 1, 1, Polarity::Up), &mut bytes), Ok(5));
    assert_eq!(encoder.encode(event(90, 1, 1, Polarity::Up), &mut bytes), Ok(5));
    assert_eq!(encoder.retimed(), 1);
    words.encode(event(100, 1, 1, Polarity::Up), &mut bytes).unwrap();
    words.encode(event(90, 1, 1, Polarity::Up), &mut bytes).unwrap();
    assert_eq!(words.retimed(), 1);
}

#[test]
fn other_files_are_foreign() {
    let mut generic = Dvs::decoder();
    assert_eq!(generic.decode(b"Event Stream\x02\0\0\0\x01\x06abc").count(), 0);
    assert!(generic.is_foreign() && generic.size().is_none());
    assert_eq!(generic.skipped(), 5);
}

/// The bytes of an event that is cut off wait for the rest; a word of another type is skipped.
#[test]
fn an_event_that_has_not_ended_is_partial() {
    let mut decoder = Dvs::decoder();
    for (length, &byte) in CAMERA.header().iter().enumerate() {
        assert_eq!(decoder.is_partial(), length > 0);
        decoder.push(byte);
    }
    let told = [0xFF, 0x03, 9, 0, 8, 0].map(|byte| {
        decoder.push(byte);
        decoder.is_partial()
    });
    assert_eq!(told, [false, true, true, true, true, false]);

    let mut bytes = [0; 8];
    Evt2Pixels::encoder().encode(event(5, 3, 4, Polarity::Up), &mut bytes).unwrap();
    let mut decoder = Evt2Pixels::decoder();
    let told = bytes.map(|byte| {
        decoder.decode(&[byte]).for_each(drop);
        decoder.is_partial()
    });
    assert_eq!(told, [true, true, true, false, true, true, true, false]);
    decoder.decode(&[0, 0, 0, 0xF0]).for_each(drop);
    assert_eq!(decoder.skipped(), 4);
}

#[test]
fn times_of_evt3_go_on_over_silences_and_wraps() {
    let up = Polarity::Up;
    let ticks = [5, 5 + (1 << 24), 3 << 24, (3 << 24) + 1, 0xFFFF_FFFF, 4, 4, 0x7000_0000];
    let events: Vec<_> = ticks.map(|tick| event(tick, 1, 2, up)).to_vec();
    let mut encoder = Evt3Pixels::encoder();
    let bytes = write(&mut encoder, &events);
    assert!(Evt3Pixels::decoder().decode(&bytes).eq(events));
    assert_eq!(encoder.retimed(), 0);

    // Back by less than a wrap: words out of order, at their own time.
    let words =
        [8 << 12 | 2, 6 << 12 | 9, 3, 2 << 12, 8 << 12 | 1, 2 << 12, 8 << 12 | 0xFFF, 2 << 12];
    let more = [8 << 12, 2 << 12, 0xA << 12, 0xE << 12];
    let bytes: Vec<u8> =
        words.iter().chain(&more).flat_map(|word: &u16| word.to_le_bytes()).collect();
    let mut decoder = Evt3Pixels::decoder();
    let read: Vec<u32> = decoder.decode(&bytes).map(|event| event.tick.micros()).collect();
    assert_eq!(read, [0x2009, 0x1000, 0xFF_F000, 0x100_0000]);
    assert_eq!(decoder.skipped(), 4);
    // An event before the first times, or before the first row, has no place.
    let mut decoder = Evt3Pixels::decoder();
    assert_eq!(decoder.decode(&[0, 0x20, 0, 0x80, 0, 0x20, 7, 0]).count(), 0);
    assert_eq!((decoder.skipped(), decoder.is_partial()), (4, false));
    assert!(decoder.decode(&[1, 0x28, 0]).eq([event(0, 1, 7, up)]));
    assert!(decoder.is_partial());
}
