//! The event formats, and events as they lie in memory.

use core::fmt::{self, Write};

use board::stopwatch::Count;
use spikewire::{Event, Polarity, Tick};
use spikewire_cameras::format::{
    Edvs, EdvsTime, EventDecoder, EventFormat, EventStream, Evt2, FormatError, eieio,
};

use super::{ensure, flight, meter::Cost};

#[inline(never)] // leaves the stack before the next one comes
pub fn measure(out: &mut impl Write) -> fmt::Result {
    format(out, "raw", Raw, Raw, |event| event)?;
    let camera = |out: &mut _, name, time, read: fn(Event) -> Event| {
        let camera = Edvs::new(time);
        format(out, name, camera.encoder(), camera.decoder(), read)
    };
    camera(out, "edvs-e0", EdvsTime::None, |event| Event { tick: Tick::from(0), ..event })?;
    camera(out, "edvs-e1", EdvsTime::Delta, |event| event)?;
    camera(out, "edvs-e2", EdvsTime::Bits16, |event| Event {
        tick: Tick::from(event.tick.micros() & 0xFFFF),
        ..event
    })?;
    camera(out, "edvs-e3", EdvsTime::Bits24, |event| event)?;
    camera(out, "edvs-e4", EdvsTime::Bits32, |event| event)?;
    let mut log = EventStream::decoder();
    log.decode(&EventStream::HEADER).for_each(drop);
    format(out, "event-stream", EventStream::encoder(), log, |event| event)?;
    format(out, "evt2", Evt2::encoder(), Evt2::decoder(), |event| event)?;
    eieio(out)
}

/// Measures a format; `told` is what of an event it tells.
fn format(
    out: &mut impl Write,
    name: &str,
    mut encoder: impl EventFormat,
    mut decoder: impl EventDecoder,
    told: impl Fn(Event) -> Event,
) -> fmt::Result {
    let mut encode = |event: Event, bytes: &mut [u8]| encoder.encode(event, bytes);
    let mut decode = |bytes: &[u8]| decoder.decode(bytes).last();
    let (mut written, mut read) = (Cost::default(), Cost::default());
    let mut bytes = [0; 512];
    let mut agrees = true;
    flight::events(|event| {
        let (mut writing, mut reading, mut length) = (Count::default(), Count::default(), 0);
        let mut decoded = None;
        // Time that passes may take more than there is room for.
        while decoded.is_none() {
            let mut result = Ok(0);
            writing += written.encoding(&mut encode, event, &mut bytes, &mut result);
            let (Ok(more) | Err(FormatError::Full { written: more })) = result else { break };
            reading += read.decoding(&mut decode, &bytes[..more], &mut decoded);
            length += more;
        }
        written.add(1, length, writing);
        read.add(1, length, reading);
        agrees &= decoded.map(&told) == Some(told(event));
    });
    ensure(out, agrees, name)?;
    written.print_event(out, name, "encode")?;
    read.print_event(out, name, "decode")
}

/// Time, address and sign one after the other, as the plainest program would send them.
struct Raw;

impl EventFormat for Raw {
    const LONGEST: usize = 7;

    #[inline]
    fn encode(&mut self, event: Event, bytes: &mut [u8]) -> Result<usize, FormatError> {
        let target: &mut [u8; 7] =
            bytes.first_chunk_mut().ok_or(FormatError::Full { written: 0 })?;
        let [t0, t1, t2, t3] = event.tick.micros().to_le_bytes();
        let [a0, a1] = event.address.to_le_bytes();
        let sign: i8 = if event.polarity == Polarity::Up { 1 } else { -1 };
        *target = [t0, t1, t2, t3, a0, a1, sign as u8];
        Ok(target.len())
    }

    fn retimed(&self) -> u32 {
        0
    }
}

impl EventDecoder for Raw {
    fn push(&mut self, _: u8) -> Option<Event> {
        None
    }

    fn skipped(&self) -> u32 {
        0
    }

    fn is_partial(&self) -> bool {
        false
    }

    fn decode(&mut self, bytes: &[u8]) -> impl Iterator<Item = Event> {
        let event = bytes.first_chunk().map(|&[t0, t1, t2, t3, a0, a1, sign]: &[u8; 7]| Event {
            tick: Tick::from(u32::from_le_bytes([t0, t1, t2, t3])),
            address: u16::from_le_bytes([a0, a1]),
            polarity: if sign == 1 { Polarity::Up } else { Polarity::Down },
        });
        event.into_iter()
    }
}

/// A datagram for the events of each sample.
fn eieio(out: &mut impl Write) -> fmt::Result {
    let key =
        |event: &Event| u32::from(event.address) << 1 | u32::from(event.polarity == Polarity::Up);
    let (mut written, mut read) = (Cost::default(), Cost::default());
    let mut bytes = [0; 64];
    let mut agrees = true;
    flight::batches::<{ flight::CHANNELS }>(1, |events| {
        let [first, ..] = events else { return };
        let mut length = 0;
        let mut encode = |first: Event, bytes: &mut [u8]| {
            eieio::encode(Some(first.tick.micros()), events.iter().map(key), bytes).unwrap_or(0)
        };
        let writing = written.encoding(&mut encode, *first, &mut bytes, &mut length);
        let mut sum = None;
        let mut decode = |bytes: &[u8]| {
            let datagram = eieio::decode(bytes)?;
            Some((datagram.timestamp?, datagram.keys().fold(0, fold)))
        };
        let reading = read.decoding(&mut decode, &bytes[..length], &mut sum);
        written.add(events.len(), length, writing);
        read.add(events.len(), length, reading);
        agrees &= sum == Some((first.tick.micros(), events.iter().map(key).fold(0, fold)));
    });
    ensure(out, agrees, "eieio")?;
    written.print_event(out, "eieio", "encode")?;
    read.print_event(out, "eieio", "decode")
}

/// Keys, of 4 bits each here, as one number.
fn fold(sum: u32, key: u32) -> u32 {
    sum << 4 ^ key
}
