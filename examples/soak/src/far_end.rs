//! The far end: a reader, a receiver, and what must hold of every frame.

use board::digest::Digest;
use spikewire::link::{FrameView, MAX_FRAME, Reader, Received, Receiver};

use crate::{
    sender::{SCHEMES, Schemes},
    world::CHANNELS,
};

/// Frames that are remembered: those that are on the line at once.
const REMEMBERED: usize = 8;

/// A frame that was sent: by which start of the sender, its number, and a hash of what is in it.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
struct Sent {
    start: u32,
    number: u64,
    content: Digest,
}

pub struct FarEnd {
    reader: Reader<MAX_FRAME>,
    receiver: Receiver<Schemes, CHANNELS>,
    sent: [Sent; REMEMBERED],
    count: usize,
    /// Reader of every frame that goes onto the line.
    watch: Reader<MAX_FRAME>,
    /// The last frame that was delivered.
    delivered: Option<Sent>,
    pub told: Told,
}

/// What the reader has told, over all starts of the far end.
#[derive(Clone, Copy, Default)]
pub struct Told {
    pub lost: u32,
    pub damaged: u32,
    pub repeated: u32,
    pub late: u32,
    pub starts: u32,
}

impl FarEnd {
    pub fn new() -> Self {
        Self {
            reader: Reader::new(),
            receiver: Receiver::per_channel(SCHEMES),
            sent: [Sent::default(); REMEMBERED],
            count: 0,
            watch: Reader::new(),
            delivered: None,
            told: Told::default(),
        }
    }

    /// A brown-out: all is forgotten but what the check needs.
    pub fn restart(&mut self) {
        self.count_told();
        self.reader = Reader::new();
        self.receiver = Receiver::per_channel(SCHEMES);
        self.delivered = None;
    }

    /// Adds up what the reader has counted so far. A fresh reader goes on from zero.
    fn count_told(&mut self) {
        self.told.lost += self.reader.lost_frames();
        self.told.damaged += self.reader.bad_checksums();
        self.told.repeated += self.reader.repeated();
        self.told.late += self.reader.late();
    }

    /// All that was told until now.
    pub fn told(&self) -> Told {
        Told {
            lost: self.told.lost + self.reader.lost_frames(),
            damaged: self.told.damaged + self.reader.bad_checksums(),
            repeated: self.told.repeated + self.reader.repeated(),
            late: self.told.late + self.reader.late(),
            starts: self.told.starts,
        }
    }

    /// Number of frames that were delivered since this far end started.
    pub fn frames(&self) -> u32 {
        self.reader.frames()
    }

    /// Remembers a frame that goes onto the line.
    pub fn remember(&mut self, start: u32, bytes: &[u8]) -> Result<(), &'static str> {
        let last = self.count.checked_sub(1).map(|last| self.sent[last % REMEMBERED].start);
        if last != Some(start) {
            self.watch = Reader::new();
        }
        let mut sent = bytes;
        let received = self.watch.next_frame(&mut sent).ok_or("a frame that was made is none")?;
        let frame = received.frame;
        self.sent[self.count % REMEMBERED] =
            Sent { start, number: frame.number(), content: content(&frame) };
        self.count += 1;
        Ok(())
    }

    /// Bytes as they come.
    pub fn hear(&mut self, mut bytes: &[u8]) -> Result<(), &'static str> {
        while let Some(received) = self.reader.next_frame(&mut bytes) {
            check(&self.sent, &mut self.delivered, &received, &mut self.told.starts)?;
            self.receiver.apply(&received, |_, _, _| ());
        }
        Ok(())
    }

    /// The line is idle: what waits behind a frame without an end comes out.
    pub fn idle(&mut self) -> Result<(), &'static str> {
        while let Some(received) = self.reader.next_after_silence() {
            check(&self.sent, &mut self.delivered, &received, &mut self.told.starts)?;
            self.receiver.apply(&received, |_, _, _| ());
        }
        Ok(())
    }

    /// The values that are exact, once the last frame of this start of the sender has arrived.
    pub fn exact(&self, start: u32) -> Option<[Option<f32>; CHANNELS]> {
        let last = self.sent[self.count.checked_sub(1)? % REMEMBERED];
        let is_all_here = last.start == start && self.delivered == Some(last);
        is_all_here.then(|| core::array::from_fn(|channel| self.receiver.exact(channel as u16)))
    }
}

/// A frame is one that was sent, and those missing before it are told.
fn check(
    sent: &[Sent],
    delivered: &mut Option<Sent>,
    received: &Received<'_>,
    starts: &mut u32,
) -> Result<(), &'static str> {
    if received.is_unread {
        return Ok(());
    }
    let frame = &received.frame;
    let own = sent.iter().find(|sent| sent.number == frame.number());
    let own = own.ok_or("a frame that nobody sent")?;
    if own.content != content(frame) {
        return Err("a frame with other content");
    }
    let gap = received.gap.map_or(0, |gap| u64::from(gap.lost_frames));
    let is_told = match delivered {
        Some(last) if !received.is_start => {
            last.start == own.start && (last.number + 1 + gap) & ((1 << 48) - 1) == own.number
        }
        _ => received.is_start && delivered.is_none_or(|last| last.start != own.start),
    };
    if !is_told {
        return Err("frames are missing, untold");
    }
    *starts += u32::from(received.is_start);
    *delivered = Some(*own);
    Ok(())
}

/// All that a frame says.
fn content(frame: &FrameView<'_>) -> Digest {
    let mut all = Digest::new();
    all.add([frame.tick().micros(), frame.is_after_loss().into()]);
    for keyframe in frame.keyframes() {
        all.add([keyframe.tick.micros(), keyframe.address.into(), keyframe.bits]);
    }
    for event in frame.events() {
        all.add([event.tick.micros(), event.address.into(), event.polarity as u32]);
    }
    all
}
