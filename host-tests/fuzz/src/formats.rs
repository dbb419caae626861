//! Event formats: any bytes are read or skipped, cut anywhere; what was read is written and read again.

use spikewire_cameras::format::{
    Dvs, Edvs, EdvsTime, EventDecoder, EventFormat, EventStream, Evt2, Evt2Pixels, Evt3Pixels,
    Evt21Order, Evt21Pixels, FormatError, eieio,
};

use crate::script::Script;

/// Every format, of which the first byte chooses one.
pub fn all(bytes: &[u8]) {
    let mut script = Script::new(bytes);
    let (kind, cut) = (script.below(15), 1 + script.below(40));
    let bytes = script.rest();
    let edvs = |time| Edvs::new(time);
    match kind {
        0 => check(|| edvs(EdvsTime::None).decoder(), edvs(EdvsTime::None).encoder(), bytes, cut),
        1 => check(|| edvs(EdvsTime::Delta).decoder(), edvs(EdvsTime::Delta).encoder(), bytes, cut),
        2 => {
            check(
                || edvs(EdvsTime::Bits16).decoder(),
                edvs(EdvsTime::Bits16).encoder(),
                bytes,
                cut,
            );
        }
        3 => {
            check(
                || edvs(EdvsTime::Bits24).decoder(),
                edvs(EdvsTime::Bits24).encoder(),
                bytes,
                cut,
            );
        }
        4 => {
            check(
                || edvs(EdvsTime::Bits32).decoder(),
                edvs(EdvsTime::Bits32).encoder(),
                bytes,
                cut,
            );
        }
        5 => check(EventStream::decoder, EventStream::encoder(), bytes, cut),
        6 => {
            let stream = [&EventStream::HEADER[..], bytes].concat();
            check(EventStream::decoder, EventStream::encoder(), &stream, cut);
        }
        7 => check(Evt2::decoder, Evt2::encoder(), bytes, cut),
        8 => check(Evt2::file_decoder, Evt2::encoder(), bytes, cut),
        9 => check(Evt2Pixels::file_decoder, Evt2Pixels::encoder(), bytes, cut),
        10 => {
            let camera = Dvs::new(320, 240);
            let stream = [&camera.header()[..], bytes].concat();
            check(Dvs::decoder, camera.encoder(), &stream, cut);
            check(Dvs::decoder, camera.encoder(), bytes, cut);
        }
        11 => check(Evt3Pixels::decoder, Evt3Pixels::encoder(), bytes, cut),
        // EVT 2.1 is read only: what was read is written as EVT2.
        12 => {
            let decoder = || Evt21Pixels::decoder(Evt21Order::Little);
            check(decoder, Evt2Pixels::encoder(), bytes, cut);
        }
        13 => {
            let decoder = || Evt21Pixels::decoder(Evt21Order::Halves);
            check(decoder, Evt2Pixels::encoder(), bytes, cut);
        }
        _ => datagram(bytes),
    }
}

fn check<E, D, F>(decoder: impl Fn() -> D, mut encoder: F, bytes: &[u8], cut: usize)
where
    E: Copy + std::fmt::Debug + PartialEq,
    D: EventDecoder<E>,
    F: EventFormat<E>,
{
    let mut whole = decoder();
    let events: Vec<E> = whole.decode(bytes).collect();
    let mut pieces = decoder();
    let mut again = Vec::new();
    for piece in bytes.chunks(cut) {
        again.extend(pieces.decode(piece));
    }
    assert_eq!(events, again, "cut into pieces of {cut}");
    assert_eq!(
        (whole.skipped(), whole.is_partial()),
        (pieces.skipped(), pieces.is_partial()),
        "cut into pieces of {cut}"
    );
    assert!(whole.skipped() as usize <= bytes.len(), "more skipped than there was");
    // What is written of them has room in the longest piece, or is refused for its address.
    let mut buffer = vec![0; F::LONGEST];
    for &event in &events {
        let mut pieces = 0;
        loop {
            match encoder.encode(event, &mut buffer) {
                Ok(length) => assert!(length <= F::LONGEST),
                Err(FormatError::Full { written }) => {
                    assert!(written > 0 && written <= F::LONGEST, "nothing goes on");
                    pieces += 1;
                    // Time in pieces: a step of 2^32 us takes very many of Event Stream's.
                    if pieces < 200 {
                        continue;
                    }
                }
                Err(_) => {}
            }
            break;
        }
    }
}

fn datagram(bytes: &[u8]) {
    let Some(datagram) = eieio::decode(bytes) else { return };
    let keys: Vec<u32> = datagram.keys().collect();
    assert!(keys.len() <= 256);
}
