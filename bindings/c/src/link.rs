//! The two ends of a link: items to frames of bytes, and back.

use core::ffi::c_void;

use spikewire::link::{Coding, MAX_FRAME, Reader, Session, Transmitter};
use spikewire::{Fingerprint, Item, Taken};

use crate::event::CItem;
use crate::kept::Kept;
use crate::queue::{Queue, consumer};
use crate::{Status, pointer};

pub(crate) type CReader = Reader<MAX_FRAME>;

/// Prepares a writer for so many channels, a sample every `period` µs, and a session.
#[unsafe(no_mangle)]
unsafe extern "C" fn sw_writer_init(
    writer: *mut Kept<Transmitter>,
    channels: u16,
    period: u32,
    session: u64,
) -> Status {
    let coding = Coding::for_channels(channels, period);
    // SAFETY: C's promise.
    unsafe { Kept::keep(writer, Transmitter::new(coding, Session::random(session))) }.into()
}

/// Replaces a writer by the one with another setting.
///
/// # Safety
/// C's promise of [`pointer`].
unsafe fn set(
    writer: *mut Kept<Transmitter>,
    with: impl FnOnce(Transmitter) -> Transmitter,
) -> Status {
    let set = || {
        // SAFETY: the caller's promise.
        let writer = unsafe { Kept::exclusive(writer)? };
        *writer = with(*writer);
        Ok(Status::OK)
    };
    set().into()
}

/// Sends the fingerprint of a description.
#[unsafe(no_mangle)]
unsafe extern "C" fn sw_writer_describe(
    writer: *mut Kept<Transmitter>,
    fingerprint: u32,
) -> Status {
    let fingerprint = Fingerprint::from_bits(fingerprint);
    // SAFETY: C's promise.
    unsafe { set(writer, |writer| writer.with_fingerprint(fingerprint)) }
}

/// Sends step numbers, by which step codes heal after lost frames.
#[unsafe(no_mangle)]
unsafe extern "C" fn sw_writer_heal(writer: *mut Kept<Transmitter>, bits: u8) -> Status {
    // SAFETY: C's promise.
    unsafe { set(writer, |writer| writer.with_step_bits(bits)) }
}

/// Lets events wait for others.
#[unsafe(no_mangle)]
unsafe extern "C" fn sw_writer_gather(writer: *mut Kept<Transmitter>, micros: u32) -> Status {
    // SAFETY: C's promise.
    unsafe { set(writer, |writer| writer.with_gathering(micros)) }
}

/// Tells a writer the time.
#[unsafe(no_mangle)]
unsafe extern "C" fn sw_writer_observe(writer: *mut Kept<Transmitter>, now: u32) -> Status {
    let observe = || {
        // SAFETY: C's promise.
        let writer = unsafe { Kept::exclusive(writer)? };
        writer.observe(now.into());
        Ok(Status::OK)
    };
    observe().into()
}

/// Writes a frame of what the queue holds.
#[unsafe(no_mangle)]
unsafe extern "C" fn sw_writer_next_frame(
    writer: *mut Kept<Transmitter>,
    queue: *mut Kept<Queue>,
    bytes: *mut u8,
    capacity: usize,
    length: *mut usize,
) -> Status {
    let write = || {
        // SAFETY: C's promise; any bytes are bytes.
        let (writer, queue) = unsafe { (Kept::exclusive(writer)?, consumer(queue)?) };
        // SAFETY: as above.
        let (bytes, length) =
            unsafe { (pointer::slice_mut(bytes, capacity)?, pointer::place(length)?) };
        length.write(0);
        match writer.next_frame(queue, bytes)? {
            Some(frame) => {
                length.write(frame.len());
                Ok(Status::OK)
            }
            None => Ok(Status::NOTHING),
        }
    };
    write().into()
}

/// Prepares a reader.
#[unsafe(no_mangle)]
unsafe extern "C" fn sw_reader_init(reader: *mut Kept<CReader>) -> Status {
    // SAFETY: C's promise.
    unsafe { Kept::keep(reader, Reader::new()) }.into()
}

/// Reads bytes that are cut anywhere, and hands over each item of each frame that they complete.
#[unsafe(no_mangle)]
unsafe extern "C" fn sw_reader_take(
    reader: *mut Kept<CReader>,
    bytes: *const u8,
    length: usize,
    take: Option<unsafe extern "C" fn(*mut c_void, *const CItem)>,
    context: *mut c_void,
) -> Status {
    let read = || {
        let take = take.ok_or(Status::NULL)?;
        // SAFETY: C's promise; any bytes are bytes.
        let (reader, mut bytes) =
            unsafe { (Kept::exclusive(reader)?, pointer::slice(bytes, length)?) };
        let give = |item: Item| {
            let item = CItem::from(Taken::whole(item));
            // SAFETY: C promises that it can be called with its context and an item.
            unsafe { take(context, &raw const item) };
        };
        while let Some(received) = reader.next_frame(&mut bytes) {
            if received.is_after_break() {
                give(Item::Break(received.frame.tick()));
            }
            let frame = &received.frame;
            frame.keyframes().map(Item::Keyframe).for_each(give);
            let tick = frame.tick();
            frame.heartbeats().map(|address| Item::Heartbeat { tick, address }).for_each(give);
            received.frame.events().map(Item::Event).for_each(give);
        }
        Ok(if reader.other_version().is_some() { Status::OTHER_VERSION } else { Status::OK })
    };
    read().into()
}

/// What a reader has seen.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct ReaderCounts {
    /// Frames.
    pub frames: u32,
    /// Frames that are missing.
    pub lost_frames: u32,
    /// Frames with a wrong checksum.
    pub bad_checksums: u32,
    /// Frames that came again.
    pub repeated: u32,
    /// Frames that came too late.
    pub late: u32,
    /// Bytes that belong to no frame.
    pub skipped: u32,
}

impl ReaderCounts {
    pub(crate) fn of(reader: &CReader) -> Self {
        Self {
            frames: reader.frames(),
            lost_frames: reader.lost_frames(),
            bad_checksums: reader.bad_checksums(),
            repeated: reader.repeated(),
            late: reader.late(),
            skipped: reader.skipped(),
        }
    }
}

/// What a reader has seen.
#[unsafe(no_mangle)]
unsafe extern "C" fn sw_reader_counts_of(
    reader: *const Kept<CReader>,
    counts: *mut ReaderCounts,
) -> Status {
    let count = || {
        // SAFETY: C's promise.
        let (reader, counts) = unsafe { (Kept::shared(reader)?, pointer::place(counts)?) };
        counts.write(ReaderCounts::of(reader));
        Ok(Status::OK)
    };
    count().into()
}
