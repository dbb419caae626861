//! EVT 2.0 with the columns and rows of a camera's pixels.

use super::evt2::{Word, X_MASK};
use super::{EventDecoder, EventFormat, Evt2, Evt2Decoder, Evt2Encoder, FormatError};
use crate::frame::PixelEvent;

/// Prophesee EVT 2.0 with the columns and rows of a [camera](crate::frame).
///
/// - **Words, time and length:** those of [`Evt2`]. **Pixels:** up to 2048 columns and rows.
/// - **Header:** write it before the first word of a file: `% evt 2.0`, `% format EVT2;height=H;width=W`,
///   `% geometry WxH` and `% end`, a line each.
///
/// ```
/// use spikewire::{Polarity, Tick};
/// use spikewire_cameras::frame::PixelEvent;
/// use spikewire_cameras::format::{EventDecoder, EventFormat, Evt2Pixels};
///
/// let event = PixelEvent { tick: Tick::from_micros(0x41), x: 5, y: 239, polarity: Polarity::Up };
/// let mut bytes = [0; 8];
/// assert_eq!(Evt2Pixels::encoder().encode(event, &mut bytes), Ok(8));
/// assert_eq!(bytes, [0x01, 0, 0, 0x80, 0xEF, 0x28, 0x40, 0x10]);
/// assert!(Evt2Pixels::decoder().decode(&bytes).eq([event]));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Evt2Pixels;

impl Evt2Pixels {
    /// An encoder. For a file, write the header first.
    pub const fn encoder() -> Evt2PixelsEncoder {
        Evt2PixelsEncoder(Evt2::encoder())
    }

    /// A decoder of words, from the start of a word on.
    pub const fn decoder() -> Evt2PixelsDecoder {
        Evt2PixelsDecoder(Evt2::decoder())
    }

    /// A decoder of a file. It skips the header, if there is one; see [`Evt2::file_decoder`].
    pub const fn file_decoder() -> Evt2PixelsDecoder {
        Evt2PixelsDecoder(Evt2::file_decoder())
    }
}

/// The encoder of [`Evt2Pixels`].
#[derive(Clone, Copy, Debug)]
pub struct Evt2PixelsEncoder(Evt2Encoder);

impl EventFormat<PixelEvent> for Evt2PixelsEncoder {
    const LONGEST: usize = Evt2Encoder::LONGEST;

    fn encode(&mut self, event: PixelEvent, bytes: &mut [u8]) -> Result<usize, FormatError> {
        let PixelEvent { tick, x, y, polarity } = event;
        if u32::from(x.max(y)) > X_MASK {
            return Err(FormatError::Pixel { x, y });
        }
        self.0.word(Word { tick, polarity, x: x.into(), y: y.into() }, bytes)
    }

    fn retimed(&self) -> u32 {
        self.0.retimed()
    }
}

/// The decoder of [`Evt2Pixels`].
///
/// Triggers and other words are skipped, and so are events before the first time word.
#[derive(Clone, Copy, Debug)]
pub struct Evt2PixelsDecoder(Evt2Decoder);

impl EventDecoder<PixelEvent> for Evt2PixelsDecoder {
    fn push(&mut self, byte: u8) -> Option<PixelEvent> {
        let Word { tick, polarity, x, y } = self.0.push_word(byte)?;
        Some(PixelEvent { tick, x: x as u16, y: y as u16, polarity })
    }

    fn skipped(&self) -> u32 {
        self.0.skipped()
    }

    fn is_partial(&self) -> bool {
        self.0.is_partial()
    }
}
