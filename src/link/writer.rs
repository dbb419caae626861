//! Writing frames into the caller's buffer.

use core::num::{NonZeroU16, NonZeroU32};

use super::bits::{BitWriter, zigzag};
use super::frame::{
    CHECKSUM, FLAGS_AT, HEADER, LENGTH_AT, MAGIC, MAX_LENGTH, VERSION, checksum, flag,
    keyframe_size,
};
use super::{Keyframe, LinkError, Raw};
use crate::bytes::Cursor;
use crate::{Event, Polarity, tick};

/// How a sender spends the bits of an event. Any choice carries any event; a good one is shorter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Coding {
    /// The time from sample to sample, in µs.
    pub period: NonZeroU16,
    /// About the logarithm of the distance between neighbouring addresses that fire; 0 to 15, above
    /// which it counts as 15.
    pub address_bits: u8,
    /// About the logarithm of the jitter of ticks, in µs, and one for its sign; 0 to 15, as above.
    pub jitter_bits: u8,
}

impl Coding {
    /// For channels of a neuron each, sampled every `period` µs (0 counts as 1) by a timer.
    pub const fn for_channels(channels: u16, period: u16) -> Self {
        let period = match NonZeroU16::new(period) {
            Some(period) => period,
            None => NonZeroU16::MIN,
        };
        // When few fire at a time; more cost a bit or two each.
        let address_bits = (u16::BITS - (channels / 8).leading_zeros()) as u8;
        Self { period, address_bits, jitter_bits: 0 }
    }

    /// The same for ticks that jitter by this many bits of µs.
    #[must_use]
    pub const fn with_jitter_bits(self, jitter_bits: u8) -> Self {
        Self { jitter_bits, ..self }
    }

    const fn byte(self) -> u8 {
        const fn nibble(bits: u8) -> u8 {
            if bits > 15 { 15 } else { bits }
        }
        nibble(self.jitter_bits) << 4 | nibble(self.address_bits)
    }
}

/// Counts a sender's frames.
///
/// ```
/// use spikewire::{Event, Polarity, link::{Coding, FrameView, Framer}};
///
/// let mut framer = Framer::new(Coding::for_channels(6, 1_000));
/// let mut buffer = [0; 64];
/// let mut frame = framer.start(2_000, &mut buffer)?;
/// let event = Event { tick: 2_000, address: 5, polarity: Polarity::Down };
/// frame.event(event)?;
/// let bytes = frame.finish();
///
/// let (view, length) = FrameView::new(bytes)?;
/// assert_eq!(length, bytes.len());
/// assert!(view.events().eq([event]));
/// # Ok::<(), spikewire::link::LinkError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Framer {
    coding: Coding,
    sequence: u16,
    flags: u8,
}

impl Framer {
    /// A sender whose first frame is number 0.
    pub const fn new(coding: Coding) -> Self {
        Self { coding, sequence: 0, flags: flag::RESTART }
    }

    /// Says in the next frame that events were lost before it.
    pub fn mark_loss(&mut self) {
        self.flags |= flag::LOST;
    }

    /// Starts a frame at this tick, best that of its first event. Unless it is
    /// [finished](FrameWriter::finish), nothing has happened.
    ///
    /// # Errors
    /// [`LinkError::Full`]: the buffer is shorter than [`MIN_FRAME`](super::MIN_FRAME).
    pub fn start<'f, 'a>(
        &'f mut self,
        tick: u32,
        buffer: &'a mut [u8],
    ) -> Result<FrameWriter<'f, 'a>, LinkError> {
        let limit = buffer.len().checked_sub(CHECKSUM).ok_or(LinkError::Full)?;
        let [s0, s1] = self.sequence.to_le_bytes();
        let [t0, t1, t2, t3] = tick.to_le_bytes();
        let [p0, p1] = self.coding.period.get().to_le_bytes();
        let header = [MAGIC, 0, s0, s1, t0, t1, t2, t3, p0, p1, self.coding.byte(), 0];

        let mut bytes = Cursor::new(buffer);
        bytes.set_limit(limit.min(HEADER + MAX_LENGTH));
        bytes.put(&header).ok_or(LinkError::Full)?;
        let flags = self.flags;
        let bits = BitWriter::new(bytes);
        Ok(FrameWriter {
            framer: self,
            bits,
            flags,
            keyframes: 0,
            events: 0,
            tick,
            next_address: 0,
        })
    }
}

/// A frame that is being written: keyframes, then events.
#[derive(Debug)]
pub struct FrameWriter<'f, 'a> {
    framer: &'f mut Framer,
    bits: BitWriter<'a>,
    flags: u8,
    keyframes: u8,
    events: u32,
    tick: u32,
    /// As in [`Events`](super::Events).
    next_address: u32,
}

/// The longest time between two events of a frame, in µs: 17.9 minutes.
const MAX_SINCE: u32 = 1 << 30;

impl<'a> FrameWriter<'_, 'a> {
    /// Appends what the decoder of an address holds at the frame's tick.
    ///
    /// # Errors
    /// The frame is full, or has events or a keyframe of another width already; it is as it was.
    pub fn keyframe<S: Raw>(&mut self, address: u16, value: S) -> Result<(), LinkError> {
        let wide = if S::IS_WIDE { flag::WIDE } else { 0 };
        let is_first = self.keyframes == 0;
        if self.events > 0 || (!is_first && self.flags & flag::WIDE != wide) {
            return Err(LinkError::KeyframeOrder);
        }
        let size = keyframe_size(wide) + usize::from(is_first);
        if self.keyframes == u8::MAX || size > self.bits.room() {
            return Err(LinkError::Full);
        }
        let Keyframe { address, raw } = Keyframe { address, raw: value.to_raw() };
        if is_first {
            self.bits.put_bytes(&[0]);
        }
        self.bits.put_bytes(&address.to_le_bytes());
        if S::IS_WIDE {
            self.bits.put_bytes(&raw.to_le_bytes());
        } else {
            self.bits.put_bytes(&(raw as u16).to_le_bytes());
        }
        self.keyframes += 1;
        self.flags |= flag::KEYFRAMES | wide;
        Ok(())
    }

    /// Appends an event.
    ///
    /// # Errors
    /// [`LinkError::Full`]: it does not fit, or lies more than 2³⁰ µs from the one before; the frame is
    /// as it was.
    pub fn event(&mut self, event: Event) -> Result<(), LinkError> {
        let mark = self.bits.mark();
        if self.put_event(event).is_none() {
            self.bits.back_to(mark);
            return Err(LinkError::Full);
        }
        self.tick = event.tick;
        self.next_address = u32::from(event.address) + 1;
        self.events = self.events.saturating_add(1);
        Ok(())
    }

    fn put_event(&mut self, event: Event) -> Option<()> {
        let Coding { period, address_bits, jitter_bits } = self.framer.coding;
        let [address_bits, jitter_bits] =
            [address_bits, jitter_bits].map(|bits| u32::from(bits).min(15));
        let address = u32::from(event.address);
        let since = tick::difference(event.tick, self.tick);
        match address.checked_sub(self.next_address) {
            Some(distance) if since == 0 => {
                self.bits.put(0, 1)?;
                self.bits.put_code(distance, address_bits)?;
            }
            _ => {
                if since.unsigned_abs() > MAX_SINCE {
                    return None;
                }
                let (steps, jitter) = nearest_step(since, period.into());
                self.bits.put(1, 1)?;
                self.bits.put_code(zigzag(steps.wrapping_sub(1)), 0)?;
                self.bits.put_code(zigzag(jitter), jitter_bits)?;
                self.bits.put_code(address, address_bits)?;
            }
        }
        self.bits.put((event.polarity == Polarity::Up).into(), 1)?;
        self.bits.is_within_limit().then_some(())
    }

    /// How many events it has.
    pub fn events(&self) -> u32 {
        self.events
    }

    /// Whether it has neither keyframes nor events.
    pub fn is_empty(&self) -> bool {
        self.events == 0 && self.keyframes == 0
    }

    /// Closes the frame and returns its bytes, ready to send. From here on it counts: one that is not
    /// sent is a loss that the reader will see.
    pub fn finish(self) -> &'a [u8] {
        let mut bytes = self.bits.finish();
        let length = bytes.written().saturating_sub(HEADER) as u8;
        bytes.replace(FLAGS_AT, VERSION << 4 | self.flags);
        bytes.replace(LENGTH_AT, length);
        if self.keyframes > 0 {
            bytes.replace(HEADER, self.keyframes);
        }
        bytes.set_limit(usize::MAX);
        let checksum = checksum(bytes.as_slice());
        // There is room: the limit kept it free.
        let _ = bytes.put(&checksum.to_le_bytes());
        self.framer.sequence = self.framer.sequence.wrapping_add(1);
        self.framer.flags = 0;
        bytes.into_slice()
    }
}

/// `since` as steps of the period, and what is left: at most half a period.
fn nearest_step(since: i32, period: NonZeroU32) -> (i32, i32) {
    let magnitude = (since.unsigned_abs() + period.get() / 2) / period;
    let steps = if since < 0 { -(magnitude as i32) } else { magnitude as i32 };
    (steps, since.wrapping_sub(steps.wrapping_mul(period.get() as i32)))
}
