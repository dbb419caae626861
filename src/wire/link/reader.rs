//! Reader: finds frames in bytes that arrive cut anywhere, damaged, or from the middle of a stream.

use super::frame::{Head, MAGIC, short};
use super::known::Known;
use super::time::Time;
use super::{FrameView, LinkError, MIN_FRAME, session};

/// A gap in the numbers: frames that are missing between two that arrived.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Gap {
    /// Number of missing frames, from 1 on.
    pub lost_frames: u32,
}

/// A frame that arrived, and what is missing before it.
#[derive(Clone, Copy, Debug)]
pub struct Received<'a> {
    /// The gap before this frame, if there is one.
    pub gap: Option<Gap>,
    /// Whether it is the first frame of the sender's session that arrived, also after 2²⁴ lost frames or more; or one of
    /// whose number or time the session's earlier frames say that it is used again.
    pub is_start: bool,
    /// Whether no frame can be read yet of bytes that are not those of an idle line (0 and 0xFF): a frame is damaged, a
    /// short one goes on from one that is missing for too long, or bytes wait behind those. The frame is empty, and has
    /// the number and time of the one before. It comes once until the next frame, as soon as the bytes at hand end, so
    /// that no value is called exact meanwhile.
    pub is_unread: bool,
    /// The frame.
    pub frame: FrameView<'a>,
}

impl Received<'_> {
    /// Whether frames or items are missing before this frame, or the sender or the reader has just started. Temporal
    /// decoders are then exact only if this frame has a keyframe for them.
    pub fn is_after_break(&self) -> bool {
        self.is_start || self.gap.is_some() || self.frame.is_after_loss()
    }
}

/// Finds frames of up to `N` bytes; [`MAX_FRAME`](super::MAX_FRAME) takes all.
///
/// - **Order:** a frame that was already delivered, or that comes up to 65 536 frames late, is left out; a short one that is
///   more than 32 frames or an eighth of all counts (128 to 256 ms) late counts as damaged. Left out, too, is a late
///   frame of the three sessions before, until the present one has delivered 256 frames. Sixteen late frames in a row show
///   that their session goes on or is used again, and the sixteenth counts as a start. So do two full ones after a short
///   one that cannot be read.
/// - **A session that is used again**, as where a sender's supply fails before its start was counted, begins anew where it
///   shows: by another first frame than that delivered, or one that comes more than sixteen frames late, by other bytes of the frame delivered last, by a time that goes
///   back by more than 65.5 ms while numbers rise or the other way round, or by sixteen late frames in a row.
/// - **Memory:** about `N + 210` bytes. **Work:** a checksum a frame; after damage up to one for each byte that looks like
///   the first of a frame.
/// - **Delay:** none; after damage a byte that looks like the first of a frame, as one in eight does, may delay the frames
///   in the 260 bytes after it, which on a quiet link are several keyframes: see
///   [`next_after_silence`](Self::next_after_silence).
///
/// Counters: [`lost_frames`](Self::lost_frames), [`bad_checksums`](Self::bad_checksums),
/// [`repeated`](Self::repeated), [`late`](Self::late), [`skipped`](Self::skipped).
#[derive(Clone, Debug)]
pub struct Reader<const N: usize> {
    buffer: [u8; N],
    /// The part of the buffer in use; the frame returned last, of `handed_out` bytes, comes first.
    start: usize,
    end: usize,
    handed_out: usize,
    /// The sender's last sessions, the present one first.
    sessions: [Run; 4],
    /// The frame delivered last, from which short ones go on.
    known: Option<Known>,
    /// Whether bytes came since then that belong to no frame and are not those of an idle line, whether some began as a
    /// short frame does, and whether the receiver heard of it.
    is_interrupted: bool,
    has_unread_short: bool,
    has_reported: bool,
    other_version: Option<u8>,
    /// How many late frames, or frames of earlier sessions, came in a row.
    strays: u16,
    /// The time and the checksum of the frame that was delivered last.
    time: Time,
    checksum: u32,
    frames: u32,
    lost_frames: u32,
    bad_checksums: u32,
    repeated: u32,
    late: u32,
    skipped: u32,
}

/// A frame counts as late up to this many frames back, and beyond that as a start.
const LATE: i64 = 1 << 16;

/// A frame counts as one after a gap if fewer frames than this are missing, and beyond that as a start: 35 minutes of 8000
/// frames a second. Both leave no value exact; only the count of lost frames differs.
const LONGEST_GAP: i64 = 1 << 24;

/// A frame of an earlier session is late up to this many frames after the last that was delivered of it, until the present
/// session has delivered as many.
const OVERLAP: u16 = 256;

/// Number of late frames in a row from which on they are not late: the present session was the late one, or its frames
/// are those of another start.
const RETURN: u16 = 16;

/// How far the times of frames may be out of their order, in µs.
const DISORDER: i64 = 1 << 16;

/// The frames of one session.
#[derive(Clone, Copy, Debug)]
struct Run {
    /// The number of the frame that comes next.
    next: u64,
    /// How many were delivered, up to 256.
    delivered: u16,
    /// The checksum of its first frame, if that was delivered.
    first: Option<u32>,
}

impl Run {
    const NONE: Self = Self { next: 0, delivered: 0, first: None };

    /// How many frames this one comes after the next one; `None` for no run.
    #[inline]
    fn ahead(&self, head: &Head) -> Option<i64> {
        (self.delivered > 0).then(|| session::ahead(head.number, self.next))
    }
}

/// A frame, and its place among those delivered.
struct Found {
    head: Head,
    standing: Standing,
}

/// The place of a frame among those delivered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Standing {
    /// The first of its session.
    First,
    /// A later one, with this many missing before it.
    After(u32),
    /// The frame delivered last.
    Repeated,
    /// An earlier frame of its session.
    Late,
    /// A frame of an earlier session.
    Stray,
    /// No frame can be read.
    Unread,
}

impl<const N: usize> Default for Reader<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> Reader<N> {
    /// A reader before its first byte.
    pub const fn new() -> Self {
        const { assert!(N >= MIN_FRAME, "a reader has room for at least an empty frame") };
        Self {
            buffer: [0; N],
            start: 0,
            end: 0,
            handed_out: 0,
            sessions: [Run::NONE; 4],
            known: None,
            is_interrupted: false,
            has_unread_short: false,
            has_reported: false,
            other_version: None,
            strays: 0,
            time: Time::from_micros(0),
            checksum: 0,
            frames: 0,
            lost_frames: 0,
            bad_checksums: 0,
            repeated: 0,
            late: 0,
            skipped: 0,
        }
    }

    /// The next frame. Takes bytes from the front of `input`; when it returns `None`, it has taken all of them.
    pub fn next_frame(&mut self, input: &mut &[u8]) -> Option<Received<'_>> {
        self.next(input, false)
    }

    /// The next frame among the bytes that were taken, when no more come; `None` once no byte is left. Call it after a
    /// silence longer than any pause within a frame, such as at a serial port's idle interrupt. A frame whose end is
    /// missing is given up, and its bytes are counted as [`skipped`](Self::skipped).
    pub fn next_after_silence(&mut self) -> Option<Received<'_>> {
        self.next(&mut [].as_slice(), true)
    }

    #[inline]
    fn next(&mut self, input: &mut &[u8], is_silent: bool) -> Option<Received<'_>> {
        self.start = self.start.wrapping_add(core::mem::take(&mut self.handed_out));
        if self.start == self.end && input.is_empty() {
            return None;
        }
        self.deliver(input, is_silent)
    }

    #[inline(never)]
    fn deliver(&mut self, input: &mut &[u8], is_silent: bool) -> Option<Received<'_>> {
        let Found { head, standing } = self.find(input, is_silent)?;
        if standing == Standing::Unread {
            let frame = FrameView::with_head(head, &[]);
            return Some(Received { gap: None, is_start: false, is_unread: true, frame });
        }
        self.handed_out = head.length();
        match &mut self.known {
            Some(known) if head.is_short() => {
                known.follow(head.number, head.point, head.register);
            }
            known => *known = Some(head.known()),
        }
        self.frames = self.frames.saturating_add(1);
        (self.is_interrupted, self.has_unread_short, self.has_reported) = (false, false, false);
        self.other_version = None;
        (self.time, self.checksum) = (head.time, head.checksum);
        let is_start = standing == Standing::First;
        if is_start {
            self.start_session(&head);
        }
        let [present, earlier @ ..] = &mut self.sessions;
        present.next = session::next(head.number);
        if present.delivered < OVERLAP {
            present.delivered = present.delivered.wrapping_add(1);
            if present.delivered == OVERLAP {
                *earlier = [Run::NONE; 3];
            }
        }
        if head.is_first() {
            present.first = Some(head.checksum);
        }
        self.strays = 0;

        let lost_frames = if let Standing::After(lost) = standing { lost } else { 0 };
        self.lost_frames = self.lost_frames.saturating_add(lost_frames);
        let gap = (lost_frames > 0).then_some(Gap { lost_frames });
        let frame = FrameView::with_head(head, self.buffer.get(self.start..self.end)?);
        Some(Received { gap, is_start, is_unread: false, frame })
    }

    /// Begins another session, or the present one anew.
    #[cold]
    #[inline(never)]
    fn start_session(&mut self, head: &Head) {
        let [present, earlier @ ..] = &mut self.sessions;
        // Of a session that is used again, the frames before are not those of another one.
        let is_other =
            present.ahead(head).is_none_or(|ahead| !(-LATE..LONGEST_GAP).contains(&ahead));
        if is_other {
            let [second, third, _] = *earlier;
            *earlier = [*present, second, third];
        }
        let first = present.first.filter(|_| !is_other);
        *present = Run { first, ..Run::NONE };
    }

    /// Number of frames that arrived whole.
    pub const fn frames(&self) -> u32 {
        self.frames
    }

    /// Number of frames that are missing, over all gaps.
    pub const fn lost_frames(&self) -> u32 {
        self.lost_frames
    }

    /// How often bytes that looked like a frame had a wrong checksum. One damaged frame may count
    /// more than once, or not at all.
    pub const fn bad_checksums(&self) -> u32 {
        self.bad_checksums
    }

    /// Number of frames with the number of the one before, as on a bus that repeats what was not acknowledged; they
    /// are left out.
    pub const fn repeated(&self) -> u32 {
        self.repeated
    }

    /// Number of frames that came after later ones; they are left out, and were counted as lost.
    pub const fn late(&self) -> u32 {
        self.late
    }

    /// Number of bytes that belonged to no frame.
    pub const fn skipped(&self) -> u32 {
        self.skipped
    }

    /// Whether bytes came since the last frame that belong to none: a frame was damaged, or short frames wait for a full
    /// one, which says what they leave out. Zeros and 0xFF do not count: an idle line may have them between frames.
    pub const fn is_interrupted(&self) -> bool {
        self.is_interrupted
    }

    /// The version of the link that bytes since the last frame seem to be of, if that is another than this one: they began
    /// as its frames do. Both ends need the same version.
    pub const fn other_version(&self) -> Option<u8> {
        self.other_version
    }

    /// Finds the next frame to deliver, which then begins at `start`, and returns its head and standing.
    #[inline]
    fn find(&mut self, input: &mut &[u8], is_silent: bool) -> Option<Found> {
        if self.start == self.end {
            self.take_in(input);
        }
        loop {
            let bytes = self.buffer.get(self.start..self.end).unwrap_or_default();
            let error = match Head::read(bytes, self.known.as_ref()) {
                Ok(head) => {
                    let standing = self.standing(&head);
                    if !matches!(standing, Standing::Repeated | Standing::Late | Standing::Stray) {
                        return Some(Found { head, standing });
                    }
                    self.pass_over(&head, standing);
                    continue;
                }
                Err(error) => error,
            };
            match error {
                LinkError::Truncated { needed, .. }
                    if needed <= N && (!is_silent || bytes.is_empty()) =>
                {
                    if input.is_empty() {
                        return self.report_unread();
                    }
                    self.take_in(input);
                }
                error => self.skip(error),
            }
        }
    }

    /// Reports bytes that belong to no frame, once the bytes at hand end. It waits for that end because a frame behind them,
    /// if it is there already, says by its number whether any is missing.
    #[inline]
    fn report_unread(&mut self) -> Option<Found> {
        if !self.is_interrupted || self.has_reported {
            return None;
        }
        let head = Head::unread(self.known.as_ref()?);
        self.has_reported = true;
        Some(Found { head, standing: Standing::Unread })
    }

    /// Passes over a frame that is not delivered.
    #[cold]
    #[inline(never)]
    fn pass_over(&mut self, head: &Head, standing: Standing) {
        let counter = if standing == Standing::Repeated {
            &mut self.repeated
        } else {
            // Where short frames cannot be read either, their sender is likely another start.
            let weight = if self.has_unread_short && !head.is_short() { RETURN / 2 } else { 1 };
            self.strays = self.strays.saturating_add(weight);
            &mut self.late
        };
        *counter = counter.saturating_add(1);
        self.start = self.start.wrapping_add(head.length());
    }

    /// Skips bytes that begin no frame, up to the next that may.
    #[cold]
    #[inline(never)]
    fn skip(&mut self, error: LinkError) {
        match error {
            LinkError::Checksum { .. } => {
                self.bad_checksums = self.bad_checksums.saturating_add(1);
            }
            LinkError::Version { found } => self.other_version = Some(found),
            _ => {}
        }
        let bytes = self.buffer.get(self.start..self.end).unwrap_or_default();
        self.has_unread_short |= bytes.first().is_some_and(|&first| short::begins_with(first));
        let is_known = self.known.is_some();
        let begins = |&byte: &u8| byte == MAGIC || is_known && short::begins_with(byte);
        let next = bytes.iter().skip(1).position(begins);
        let skipped = next.map_or(bytes.len(), |next| next.wrapping_add(1));
        let is_idle = |&byte: &u8| byte == 0 || byte == u8::MAX;
        self.is_interrupted |= !bytes.iter().take(skipped).all(is_idle);
        self.start = self.start.wrapping_add(skipped);
        self.skipped = self.skipped.saturating_add(skipped as u32);
    }

    #[inline]
    fn standing(&self, head: &Head) -> Standing {
        const BEFORE: i64 = -LATE;
        let checksum = head.checksum;
        let [present, earlier @ ..] = &self.sessions;
        let ahead = present.ahead(head);
        let since = head.time.since(self.time);
        if head.is_first() {
            // The first frame of the present session once more, or late; or of another start with the same session.
            let is_known = match present.first {
                Some(first) => first == checksum,
                None => since <= DISORDER && ahead.is_some_and(|ahead| ahead >= -i64::from(RETURN)),
            };
            match ahead {
                Some(-1) if is_known => return Standing::Repeated,
                Some(BEFORE..0) if is_known => return Standing::Late,
                Some(BEFORE..0) => return Standing::First,
                _ => {}
            }
        } else if let Some(ahead) = ahead {
            match ahead {
                -1 if checksum == self.checksum => return Standing::Repeated,
                -1 => return Standing::First,
                BEFORE..0 => {
                    let is_late = since <= DISORDER && self.strays < RETURN - 1;
                    return if is_late { Standing::Late } else { Standing::First };
                }
                0..LONGEST_GAP => {
                    let is_later = since >= -DISORDER;
                    return if is_later { Standing::After(ahead as u32) } else { Standing::First };
                }
                _ => {}
            }
        }
        // A frame that was on its way when the sender restarted is late.
        let is_stray = |run: &Run| {
            let is_near = run.ahead(head).is_some_and(|ahead| ahead.abs() < i64::from(OVERLAP));
            is_near && (!head.is_first() || run.first.is_none_or(|first| first == checksum))
        };
        if self.strays < RETURN - 1 && earlier.iter().any(is_stray) {
            Standing::Stray
        } else {
            Standing::First
        }
    }

    /// Moves the part in use to the front of the buffer, and appends as much of `input` as there is room for.
    fn take_in(&mut self, input: &mut &[u8]) {
        let used = self.end.wrapping_sub(self.start);
        if self.start > 0 {
            for to in 0..used {
                let byte =
                    self.buffer.get(self.start.wrapping_add(to)).copied().unwrap_or_default();
                if let Some(slot) = self.buffer.get_mut(to) {
                    *slot = byte;
                }
            }
            (self.start, self.end) = (0, used);
        }
        let free = self.buffer.get_mut(used..).unwrap_or_default();
        let count = free.len().min(input.len());
        let (taken, rest) = input.split_at_checked(count).unwrap_or_default();
        for (slot, &byte) in free.iter_mut().zip(taken) {
            *slot = byte;
        }
        self.end = used.wrapping_add(count);
        *input = rest;
    }
}
