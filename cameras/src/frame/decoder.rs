//! Frame decoder: events of pixels in, frames out.

use core::fmt;

use super::{PixelCode, PixelEvent};
use crate::config::{first_address, unwrap};
use spikewire::{ConfigError, Event, Keyframe, Polarity};

/// The picture at the far end: the base of every pixel, which each event moves as it moved the encoder's.
///
/// It starts at 0 everywhere: give it the [first frame](Self::start), or [keyframes](Self::keyframe). After a lost
/// event a pixel is wrong by a threshold until its next keyframe.
///
/// - **Memory:** the code's base of `W * H` pixels, 1 or 2 bytes each. **Work:** constant for each event.
/// - **Error:** that of the code: within a threshold of the samples while they change by `K` thresholds a frame at most.
#[derive(Clone)]
pub struct FrameDecoder<C: PixelCode, const W: usize, const H: usize> {
    code: C,
    bases: [[C::Base; W]; H],
    first_address: u16,
    outside: u32,
}

impl<C: PixelCode, const W: usize, const H: usize> FrameDecoder<C, W, H> {
    const SHAPE: () = assert!(
        W >= 1 && H >= 1 && W < 1 << 16 && H < 1 << 16,
        "a frame has 1 to 65535 columns and rows"
    );
    /// How many addresses it takes.
    const ADDRESSES: usize = {
        assert!(W * H <= 1 << 16, "addresses have 16 bits: a queue takes up to 65536 pixels");
        W * H
    };

    /// A black picture of the encoder's code.
    pub fn new(code: C) -> Self {
        const { Self::SHAPE };
        let black = code.base(0);
        Self { code, bases: [[black; W]; H], first_address: 0, outside: 0 }
    }

    /// This decoder with the encoder's first address.
    ///
    /// # Panics
    /// Panics if the last address is above 65 535.
    #[must_use]
    pub const fn with_first_address(mut self, address: u16) -> Self {
        unwrap(first_address(address, Self::ADDRESSES));
        self.first_address = address;
        self
    }

    /// This decoder with the encoder's first address.
    ///
    /// # Errors
    /// Returns an error if the last address is above 65 535.
    pub fn try_with_first_address(self, address: u16) -> Result<Self, ConfigError> {
        first_address(address, Self::ADDRESSES)?;
        Ok(Self { first_address: address, ..self })
    }

    /// Starts from the encoder's first frame.
    pub fn start(&mut self, frame: &[[u8; W]; H]) {
        for (bases, row) in self.bases.iter_mut().zip(frame) {
            for (base, &sample) in bases.iter_mut().zip(row) {
                *base = self.code.base(sample);
            }
        }
    }

    /// Takes an event.
    #[inline]
    pub fn decode(&mut self, event: PixelEvent) {
        let code = self.code;
        let step = if event.polarity == Polarity::Up { 1 } else { -1 };
        match self.base_mut(event.x.into(), event.y.into()) {
            Some(base) => *base = code.moved(*base, step),
            None => self.outside = self.outside.saturating_add(1),
        }
    }

    /// Takes an event from a queue or a link.
    #[inline]
    pub fn event(&mut self, event: Event) {
        const { assert!(Self::ADDRESSES > 0) };
        match PixelEvent::from_event(event, W as u16, self.first_address) {
            Some(event) => self.decode(event),
            None => self.outside = self.outside.saturating_add(1),
        }
    }

    /// Takes a keyframe from a queue or a link: from here on its pixel is exact, until an event of it is lost.
    pub fn keyframe(&mut self, keyframe: Keyframe) {
        const { assert!(Self::ADDRESSES > 0) };
        let place = keyframe.address.checked_sub(self.first_address).map(usize::from);
        let base = keyframe.value::<i16>().and_then(|base| u16::try_from(base).ok());
        let base = base.and_then(|base| C::Base::try_from(base).ok());
        let pixel = place.and_then(|place| self.bases.as_flattened_mut().get_mut(place));
        match (pixel, base) {
            (Some(pixel), Some(base)) => *pixel = base,
            _ => self.outside = self.outside.saturating_add(1),
        }
    }

    fn base_mut(&mut self, x: usize, y: usize) -> Option<&mut C::Base> {
        self.bases.get_mut(y)?.get_mut(x)
    }

    /// The base of a pixel; `None` if there is no such pixel.
    pub fn base(&self, x: usize, y: usize) -> Option<C::Base> {
        self.bases.get(y)?.get(x).copied()
    }

    /// A row of the picture; `None` if there is no such row.
    pub fn row(&self, y: usize) -> Option<[u8; W]> {
        Some(self.bases.get(y)?.map(|base| self.code.value(base)))
    }

    /// The picture, row by row.
    pub fn rows(&self) -> impl Iterator<Item = [u8; W]> {
        self.bases.iter().map(|row| row.map(|base| self.code.value(base)))
    }

    /// How many events and keyframes had the address of no pixel, or a value that is no base.
    pub const fn outside(&self) -> u32 {
        self.outside
    }
}

impl<C: PixelCode + fmt::Debug, const W: usize, const H: usize> fmt::Debug
    for FrameDecoder<C, W, H>
{
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut decoder = f.debug_struct("FrameDecoder");
        decoder.field("code", &self.code).field("outside", &self.outside).finish_non_exhaustive()
    }
}
