//! Reads the brightness of YUV4MPEG2 videos, from 0 for black to 255 for white.
//!
//! In a grey video, and in a colour video whose header says `XCOLORRANGE=FULL`, the stored values already have this
//! range. In other colour videos, the stored values range from 16 for black to 235 for white, and are expanded.

use super::FramesKind;
use super::video::{Rate, Video};
use crate::{Place, Result, Spot};
use std::cell::Cell;
use std::io::{self, Chain, Cursor, Read};
use std::rc::Rc;
use y4m::{Decoder, Error};

/// The first bytes of a YUV4MPEG2 file.
pub(super) const MAGIC: &[u8] = b"YUV4MPEG2 ";

/// Maximum length of the header in bytes. The decoder, the crate `y4m`, has the same limit.
const LONGEST_HEADER: usize = 1024;

/// A reader that counts the bytes read through it.
struct Counting<R> {
    reader: R,
    bytes: Rc<Cell<u64>>,
}

impl<R: Read> Read for Counting<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.reader.read(buffer)?;
        self.bytes.set(self.bytes.get() + count as u64);
        Ok(count)
    }
}

/// A reader that first yields the bytes of the header, which are in memory, and then the bytes of the frames.
type Whole<R> = Chain<Cursor<Vec<u8>>, Counting<R>>;

/// Reads the header, and checks width and height, because the decoder multiplies them without a check for overflow.
/// Returns a reader of the whole video, which yields the header once more before the frames.
fn header<R: Read>(mut reader: Counting<R>, name: &str) -> Result<Whole<R>> {
    let mut header = Vec::new();
    while !header.ends_with(b"\n") && header.len() < LONGEST_HEADER {
        let mut byte = [0];
        if reader.read(&mut byte)? == 0 {
            break;
        }
        header.extend(byte);
    }
    for word in header.trim_ascii_end().split(|byte| *byte == b' ').skip(1) {
        let [field @ (b'W' | b'H'), digits @ ..] = word else { continue };
        let digits = String::from_utf8_lossy(digits);
        if !matches!(digits.parse::<u16>(), Ok(1..)) {
            let field = if *field == b'W' { "columns" } else { "rows" };
            let digits = digits.into_owned();
            return Err(FramesKind::Length { digits, field }.at(name));
        }
    }
    Ok(Cursor::new(header).chain(reader))
}

/// A YUV4MPEG2 video of 8 bits a pixel.
pub(super) struct Y4m<R: Read> {
    decoder: Decoder<Whole<R>>,
    is_limited: bool,
    name: String,
    size: (u16, u16),
    /// Number of bytes read so far.
    bytes: Rc<Cell<u64>>,
    /// Offset in the video, in bytes, at which the latest frame ends. Before the first frame, the end of the header.
    end: u64,
    index: u64,
    frames: Option<u64>,
}

impl<R: Read> Y4m<R> {
    /// Reads the header. `length` is the file's length in bytes, if known; the number of frames is computed from it.
    ///
    /// # Errors
    /// Returns an error if the file is not YUV4MPEG2, or if its pixels have more than 8 bits.
    pub(super) fn open(reader: R, name: String, length: Option<u64>) -> Result<Self> {
        let bytes = Rc::new(Cell::new(0));
        let counting = Counting { reader, bytes: Rc::clone(&bytes) };
        let decoder = Decoder::new(header(counting, &name)?).map_err(|error| match error {
            Error::UnknownColorspace => {
                FramesKind::PixelFormat.at(Place::spot(&name, Spot::Byte(bytes.get())))
            }
            Error::EOF => FramesKind::CutHeader { byte: bytes.get() }.at(&name),
            error => FramesKind::NoHeader { error }.at(Place::spot(&name, Spot::Byte(bytes.get()))),
        })?;
        if decoder.get_bytes_per_sample() != 1 {
            return Err(FramesKind::DeepVideo { bits: decoder.get_bit_depth() }.at(name));
        }
        let size = (decoder.get_width() as u16, decoder.get_height() as u16);
        let end = bytes.get();
        let frames = length.map(|length| {
            let (pixels, colours) = colours(&decoder);
            (length - end) / (b"FRAME\n".len() as u64 + pixels + colours)
        });
        let mut words = decoder.get_raw_params().split(|byte| *byte == b' ');
        let is_limited = !matches!(decoder.get_colorspace(), y4m::Colorspace::Cmono)
            && !words.any(|word| word == b"XCOLORRANGE=FULL");
        Ok(Self { decoder, is_limited, name, size, bytes, end, index: 0, frames })
    }
}

/// Expands brightness from the limited range, 16 to 235, to the full range. Values outside the limited range become
/// black or white.
fn full_range(limited: u8) -> u8 {
    const BLACK: u16 = 16;
    const STEPS: u16 = 219;
    let above = u16::from(limited).saturating_sub(BLACK).min(STEPS);
    ((above * 255 + STEPS / 2) / STEPS) as u8
}

/// Returns the number of bytes that the brightness of a frame takes, and the number of bytes that the frame's colours
/// take.
fn colours<R: Read>(decoder: &Decoder<R>) -> (u64, u64) {
    use y4m::Colorspace;
    let (width, height) = (decoder.get_width() as u64, decoder.get_height() as u64);
    let colours = match decoder.get_colorspace() {
        Colorspace::Cmono => 0,
        Colorspace::C422 => 2 * width.div_ceil(2) * height,
        Colorspace::C444 => 2 * width * height,
        _ => 2 * width.div_ceil(2) * height.div_ceil(2),
    };
    (width * height, colours)
}

impl<R: Read> Video for Y4m<R> {
    fn size(&self) -> (u16, u16) {
        self.size
    }

    fn rate(&self) -> Option<Rate> {
        let rate = self.decoder.get_framerate();
        Rate::new(rate.num as u64, rate.den as u64)
    }

    fn frames(&self) -> Option<u64> {
        self.frames
    }

    fn next(&mut self, frame: &mut Vec<u8>) -> Result<bool> {
        let Self { decoder, is_limited, name, bytes, end, index, .. } = self;
        match decoder.read_frame() {
            Ok(read) => {
                let plane = read.get_y_plane();
                frame.clear();
                if *is_limited {
                    frame.extend(plane.iter().map(|own| full_range(*own)));
                } else {
                    frame.extend_from_slice(plane);
                }
            }
            Err(Error::EOF) if bytes.get() == *end => return Ok(false),
            Err(Error::EOF) => {
                let place = Place::spot(&*name, Spot::Frame(*index));
                return Err(FramesKind::Cut { byte: bytes.get() }.at(place));
            }
            Err(error) => {
                let place = Place::spot(&*name, Spot::Frame(*index));
                return Err(FramesKind::NoFrame { byte: *end, error }.at(place));
            }
        }
        *end = bytes.get();
        *index += 1;
        Ok(true)
    }
}
