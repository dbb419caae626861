//! Frame encoder of a camera whose size is known at run time only.

use alloc::vec::Vec;
use core::fmt;

use super::pass::{Budget, Pass, slots};
use super::{PixelCode, PixelEvent};
use crate::config::within;
use spikewire::{ConfigError, Tick};

/// A [`FrameEncoder`](super::FrameEncoder) of any size, on the heap: for videos, not for firmware.
///
/// Takes whole frames, row-major, and sends the same events.
#[derive(Clone, Debug)]
pub struct DynamicFrameEncoder<C: PixelCode> {
    code: C,
    width: u16,
    height: u16,
    /// Empty before the first frame.
    pixels: Vec<C::Pixel>,
    budget: Budget,
    tick: Tick,
}

/// A frame has another number of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameSize {
    /// How many it has.
    pub pixels: usize,
    /// How many it must have.
    pub expected: usize,
}

impl fmt::Display for FrameSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a frame of {} pixels, where the first has {}", self.pixels, self.expected)
    }
}

impl core::error::Error for FrameSize {}

impl<C: PixelCode> DynamicFrameEncoder<C> {
    /// Pixels that wait for their first frame, with this code and no budget.
    ///
    /// # Errors
    /// Returns an error if width or height are 0.
    pub fn try_new(code: C, width: u16, height: u16) -> Result<Self, ConfigError> {
        within("width", width.into(), 1.0, u16::MAX.into())?;
        within("height", height.into(), 1.0, u16::MAX.into())?;
        let tick = Tick::from_micros(0);
        Ok(Self { code, width, height, pixels: Vec::new(), budget: Budget::NONE, tick })
    }

    /// This encoder with at most this many events a frame.
    ///
    /// # Errors
    /// Returns an error if the budget is 0.
    pub fn try_with_budget(self, events: u32) -> Result<Self, ConfigError> {
        Ok(Self { budget: Budget::try_new(events)?, ..self })
    }

    /// Takes a frame, and hands each event to `emit`, as
    /// [`FrameEncoder::encode_frame`](super::FrameEncoder::encode_frame).
    ///
    /// # Errors
    /// Returns an error if the frame has another size; nothing was done with it.
    pub fn encode_frame(
        &mut self,
        tick: Tick,
        frame: &[u8],
        emit: impl FnMut(PixelEvent),
    ) -> Result<(), FrameSize> {
        self.ensure_size(frame)?;
        if !self.begin(frame) {
            self.pass(tick, frame, Pass::Whole, emit);
        }
        self.tick = tick;
        Ok(())
    }

    /// Takes a frame, and spreads each pixel's events over the time since the frame before, as
    /// [`FrameEncoder::encode_interpolated`](super::FrameEncoder::encode_interpolated).
    ///
    /// # Errors
    /// Returns an error if the frame has another size; nothing was done with it.
    pub fn encode_interpolated(
        &mut self,
        tick: Tick,
        frame: &[u8],
        mut emit: impl FnMut(PixelEvent),
    ) -> Result<(), FrameSize> {
        self.ensure_size(frame)?;
        if !self.begin(frame) {
            for slot in slots(self.code.most(), self.tick, tick) {
                self.pass(slot.tick, frame, slot.pass, &mut emit);
            }
        }
        self.tick = tick;
        Ok(())
    }

    fn ensure_size(&self, frame: &[u8]) -> Result<(), FrameSize> {
        let expected = usize::from(self.width).saturating_mul(self.height.into());
        let pixels = frame.len();
        if pixels == expected { Ok(()) } else { Err(FrameSize { pixels, expected }) }
    }

    /// Whether it was the first frame, whose samples are the bases now.
    fn begin(&mut self, frame: &[u8]) -> bool {
        let is_first = self.pixels.is_empty();
        if is_first {
            self.pixels.extend(frame.iter().map(|&sample| self.code.begin(sample)));
        }
        is_first
    }

    fn pass(&mut self, tick: Tick, frame: &[u8], pass: Pass, mut emit: impl FnMut(PixelEvent)) {
        let Self { code, width, pixels, budget, .. } = self;
        budget.renew();
        let width = usize::from(*width);
        let rows = pixels.chunks_mut(width.max(1)).zip(frame.chunks(width.max(1)));
        for (y, (pixels, row)) in rows.enumerate() {
            budget.encode(code, pixels, row, pass, |x, polarity| {
                emit(PixelEvent { tick, x: x as u16, y: y as u16, polarity });
            });
        }
    }

    /// The picture at the far end: the sample that each pixel's base stands for, row-major; empty before the first frame.
    pub fn picture(&self) -> impl Iterator<Item = u8> {
        self.pixels.iter().map(|&pixel| self.code.value(self.code.base_of(pixel)))
    }

    /// How many events the budget has kept back, over all frames.
    pub const fn over_budget(&self) -> u32 {
        self.budget.kept_back()
    }
}
