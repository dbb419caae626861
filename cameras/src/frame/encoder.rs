//! Frame encoder: rows of a camera in, events of pixels out.

use core::fmt;

use super::pass::{Budget, Pass, slots};
use super::{PixelCode, PixelEvent};
use crate::config::{first_address, unwrap};
use spikewire::{ConfigError, Item, Keyframe, Polarity, Put, Tick};

/// The pixels of a camera of `W` columns and `H` rows.
///
/// Takes a row a call, in the interrupt at which the camera's DMA has it, and hands out the events in raster order:
/// by rising column, a pixel's events one after the other, all at the frame's tick.
/// [`encode_interpolated`](Self::encode_interpolated) spreads them over the time since the frame before.
///
/// - **Rows:** by rising number within a frame; one that is not above the row before begins a new frame. A row that the
///   camera lost is left out, and its pixels wait. The first row of each number sets the bases and sends nothing.
/// - **Budget:** the most events a frame, set by [`with_budget`](Self::with_budget). Events beyond it are not sent
///   and [counted](Self::over_budget); as their pixels' bases stay, too, the far end is late but not wrong. Rows at the
///   top come first.
/// - **Memory:** the code's state of `W * H` pixels, `H` bytes and about 32. **Latency:** 0 frames.
///
/// ```
/// use spikewire::{EventQueue, Overflow, Tick};
/// use spikewire_cameras::frame::{FrameEncoder, Intensity};
///
/// static EVENTS: EventQueue<512> = EventQueue::new(Overflow::DropNewest);
///
/// // 35 x 35 pixels behind an inertial sensor's 6 channels, in one queue.
/// let mut camera = FrameEncoder::<_, 35, 35>::new(Intensity::new(10)).with_budget(400).with_first_address(6);
///
/// let line = [0; 35]; // in the interrupt of each line
/// camera.encode_row_into(Tick::from_micros(1_000), 0, &line, &EVENTS);
/// camera.keyframe_row_into(Tick::from_micros(1_000), 0, &EVENTS); // another row each frame
/// assert_eq!((EVENTS.len(), camera.over_budget()), (35, 0));
/// ```
#[derive(Clone)]
pub struct FrameEncoder<C: PixelCode, const W: usize, const H: usize> {
    code: C,
    pixels: [[C::Pixel; W]; H],
    /// Whether each row has its bases.
    has_begun: [bool; H],
    first_address: u16,
    budget: Budget,
    /// The lowest row that goes on with this frame; a row below it begins a new one.
    next: usize,
    tick: Tick,
    outside: u32,
}

impl<C: PixelCode, const W: usize, const H: usize> FrameEncoder<C, W, H> {
    const SHAPE: () = assert!(
        W >= 1 && H >= 1 && W < 1 << 16 && H < 1 << 16,
        "a frame has 1 to 65535 columns and rows"
    );
    /// How many addresses it takes.
    const ADDRESSES: usize = {
        assert!(W * H <= 1 << 16, "addresses have 16 bits: a queue takes up to 65536 pixels");
        W * H
    };

    /// Pixels that wait for their first frame, with this code and no budget.
    pub const fn new(code: C) -> Self {
        const { Self::SHAPE };
        Self {
            code,
            pixels: [[C::START; W]; H],
            has_begun: [false; H],
            first_address: 0,
            budget: Budget::NONE,
            next: 0,
            tick: Tick::from_micros(0),
            outside: 0,
        }
    }

    /// This encoder with at most this many events a frame, for constants: 0 fails the build.
    ///
    /// # Panics
    /// Panics if the budget is 0.
    #[must_use]
    pub const fn with_budget(mut self, events: u32) -> Self {
        self.budget = unwrap(Budget::try_new(events));
        self
    }

    /// This encoder with at most this many events a frame.
    ///
    /// # Errors
    /// Returns an error if the budget is 0.
    pub fn try_with_budget(self, events: u32) -> Result<Self, ConfigError> {
        Ok(Self { budget: Budget::try_new(events)?, ..self })
    }

    /// This encoder with addresses from this one on instead of 0, so that it shares a queue with others.
    ///
    /// # Panics
    /// Panics if the last address is above 65 535; at compile time where it initialises a constant.
    #[must_use]
    pub const fn with_first_address(mut self, address: u16) -> Self {
        unwrap(first_address(address, Self::ADDRESSES));
        self.first_address = address;
        self
    }

    /// This encoder with addresses from this one on instead of 0.
    ///
    /// # Errors
    /// Returns an error if the last address is above 65 535.
    pub fn try_with_first_address(self, address: u16) -> Result<Self, ConfigError> {
        first_address(address, Self::ADDRESSES)?;
        Ok(Self { first_address: address, ..self })
    }

    /// Takes row `y` of the frame of this tick, and hands each event to `emit`.
    #[inline]
    pub fn encode_row(
        &mut self,
        tick: Tick,
        y: usize,
        row: &[u8; W],
        mut emit: impl FnMut(PixelEvent),
    ) {
        if y >= H {
            self.outside = self.outside.saturating_add(1);
            return;
        }
        if y < self.next {
            self.budget.renew();
        }
        self.next = y.wrapping_add(1);
        self.tick = tick;
        self.pass(y, row, Pass::Whole, |x, polarity| {
            emit(PixelEvent { tick, x: x as u16, y: y as u16, polarity });
        });
    }

    /// Takes row `y` of the frame of this tick, and puts the events into a queue, at the address `y * W + x`. Never
    /// blocks; what does not fit is counted by the queue as lost, under any policy.
    #[inline]
    pub fn encode_row_into(&mut self, tick: Tick, y: usize, row: &[u8; W], mut queue: impl Put) {
        const { assert!(Self::ADDRESSES > 0) };
        let first = self.first_address;
        self.encode_row(tick, y, row, |event| put(event, W, first, &mut queue));
    }

    /// Takes a whole frame, and hands each event to `emit`.
    pub fn encode_frame(
        &mut self,
        tick: Tick,
        frame: &[[u8; W]; H],
        mut emit: impl FnMut(PixelEvent),
    ) {
        self.budget.renew();
        self.next = 0;
        for (y, row) in frame.iter().enumerate() {
            self.encode_row(tick, y, row, &mut emit);
        }
    }

    /// Takes a whole frame, and puts the events into a queue.
    pub fn encode_frame_into(&mut self, tick: Tick, frame: &[[u8; W]; H], mut queue: impl Put) {
        const { assert!(Self::ADDRESSES > 0) };
        let first = self.first_address;
        self.encode_frame(tick, frame, |event| put(event, W, first, &mut queue));
    }

    /// Takes a whole frame, and spreads each pixel's events over the time since the frame before, in `K` slots, where `K`
    /// is the code's [`most`](PixelCode::most): event `j` of `n` in the slot `⌈(j+1)K/n⌉-1`, at the tick
    /// `t_before + ⌊(slot+1)Δt/K⌋`. Events come by rising tick, and in raster order within a tick.
    ///
    /// Passes over the frame `K` times. A frame that is not later than the one before has all its events at its own tick.
    pub fn encode_interpolated(
        &mut self,
        tick: Tick,
        frame: &[[u8; W]; H],
        mut emit: impl FnMut(PixelEvent),
    ) {
        for slot in slots(self.code.most(), self.tick, tick) {
            self.budget.renew();
            let tick = slot.tick;
            for (y, row) in frame.iter().enumerate() {
                self.pass(y, row, slot.pass, |x, polarity| {
                    emit(PixelEvent { tick, x: x as u16, y: y as u16, polarity });
                });
            }
        }
        self.next = H;
        self.tick = tick;
    }

    /// Goes over a row once.
    #[inline]
    fn pass(&mut self, y: usize, row: &[u8; W], pass: Pass, emit: impl FnMut(usize, Polarity)) {
        let Self { code, pixels, has_begun, budget, .. } = self;
        let (Some(pixels), Some(has_begun)) = (pixels.get_mut(y), has_begun.get_mut(y)) else {
            return;
        };
        if !*has_begun {
            *has_begun = true;
            for (pixel, &sample) in pixels.iter_mut().zip(row) {
                *pixel = code.begin(sample);
            }
            return;
        }
        budget.encode(code, pixels, row, pass, emit);
    }

    /// Puts a keyframe of every pixel of a row into a queue, behind the events so far: the bases, as `i16`. Nothing
    /// for a row that has none yet. `tick` is that of the last frame.
    pub fn keyframe_row_into(&self, tick: Tick, y: usize, mut queue: impl Put) {
        const { assert!(Self::ADDRESSES > 0) };
        let (Some(pixels), Some(true)) = (self.pixels.get(y), self.has_begun.get(y)) else {
            return;
        };
        let mut address = self.first_address.wrapping_add(y.wrapping_mul(W) as u16);
        for &pixel in pixels {
            let base: u16 = self.code.base_of(pixel).into();
            queue.put(Item::Keyframe(Keyframe::new(tick, address, base as i16)));
            address = address.wrapping_add(1);
        }
    }

    /// Forgets the bases: the next frame is a first one. The far end does not see this.
    pub fn reset(&mut self) {
        self.has_begun = [false; H];
        self.next = 0;
        self.budget.renew();
    }

    /// The base of a pixel; `None` before its row's first sample, and if there is no such pixel.
    pub fn base(&self, x: usize, y: usize) -> Option<C::Base> {
        let pixel = self.pixels.get(y)?.get(x)?;
        self.has_begun.get(y).is_some_and(|&begun| begun).then(|| self.code.base_of(*pixel))
    }

    /// How many events the budget has kept back, over all frames; one that is still due in the next frame counts again.
    pub const fn over_budget(&self) -> u32 {
        self.budget.kept_back()
    }

    /// How many rows had a number of `H` or above; nothing was done with them.
    pub const fn outside(&self) -> u32 {
        self.outside
    }

    /// The code of its pixels.
    pub const fn code(&self) -> &C {
        &self.code
    }
}

#[inline]
fn put(event: PixelEvent, width: usize, first_address: u16, queue: &mut impl Put) {
    let PixelEvent { tick, x, y, polarity } = event;
    let place = y.wrapping_mul(width as u16).wrapping_add(x);
    let address = first_address.wrapping_add(place);
    queue.put(Item::Event(spikewire::Event { tick, address, polarity }));
}

impl<C: PixelCode + fmt::Debug, const W: usize, const H: usize> fmt::Debug
    for FrameEncoder<C, W, H>
{
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut encoder = f.debug_struct("FrameEncoder");
        encoder.field("code", &self.code).field("tick", &self.tick);
        encoder.field("budget", &self.budget).finish_non_exhaustive()
    }
}
