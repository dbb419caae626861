//! EVT 2.0: the format of Prophesee's cameras and tools.

use super::{Clock, EventDecoder, EventFormat, FormatError};
use crate::bytes::Cursor;
use spikewire::Polarity;
use spikewire::{Event, Tick};

/// Prophesee EVT 2.0: words of 32 bits, little endian.
///
/// - **Event word:** type\[31:28\] 0 (down) or 1 (up), t\[27:22\] the low 6 bits of the time, x\[21:11\], y\[10:0\].
///   **Time word:** type\[31:28\] 8, then the upper 28 bits of the time.
/// - **Address:** `y << 11 | x`; events of rows from 32 on, which have more than 16 bits, are skipped.
/// - **Time:** 34 bits of µs, from the first event's tick on; ticks may wrap.
/// - **Length:** 4 bytes an event, and 4 for a time word before the first event in every 64 µs.
/// - **Resynchronisation:** at each time word; the stream must be read from the start of a word.
///
/// Source: Prophesee, EVT 2.0 format.
///
/// ```
/// use spikewire::{Event, Polarity, Tick};
/// use spikewire_cameras::format::{EventDecoder, EventFormat, Evt2};
///
/// let event = Event { tick: Tick::from_micros(0x41), address: 5, polarity: Polarity::Up };
/// let mut bytes = [0; 8];
/// assert_eq!(Evt2::encoder().encode(event, &mut bytes), Ok(8));
/// assert_eq!(bytes, [0x01, 0, 0, 0x80, 0x00, 0x28, 0x40, 0x10]);
/// assert!(Evt2::decoder().decode(&bytes).eq([event]));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Evt2;

const TIME_BITS: u32 = 34;
pub(super) const LOW_BITS: u32 = 6;
pub(super) const X_BITS: u32 = 11;
pub(super) const X_MASK: u32 = (1 << X_BITS) - 1;
/// Bits of y that no address of 16 bits has.
const FAR_ROWS: u32 = X_MASK & !0x1F;
const DOWN: u32 = 0;
const UP: u32 = 1;
const TIME_HIGH: u32 = 8;

impl Evt2 {
    /// The first lines of a file: 2048 by 32 pixels hold every address.
    pub const HEADER: &[u8] =
        b"% evt 2.0\n% format EVT2;height=32;width=2048\n% geometry 2048x32\n% end\n";

    /// An encoder. For a file, write the [header](Self::HEADER) first.
    pub const fn encoder() -> Evt2Encoder {
        Evt2Encoder { time: None, high: None, retimed: 0 }
    }

    /// A decoder of words, from the start of a word on.
    pub const fn decoder() -> Evt2Decoder {
        Evt2Decoder::starting_at(Header::Over)
    }

    /// A decoder of a file. It skips the header, if there is one: lines that begin with `%`, up to `% end`. A word that
    /// begins with the byte `%` is told from a header by its fourth byte, which is no text.
    pub const fn file_decoder() -> Evt2Decoder {
        Evt2Decoder::starting_at(Header::LineStart)
    }
}

/// The encoder of [`Evt2`].
#[derive(Clone, Copy, Debug)]
pub struct Evt2Encoder {
    /// The time of the last event, 34 bits.
    time: Option<u64>,
    /// The upper 28 bits of the time, as in the last time word.
    high: Option<u32>,
    retimed: u32,
}

/// The content of an event word: a time, a direction, and the bits of x and y.
#[derive(Clone, Copy)]
pub(super) struct Word {
    pub(super) tick: Tick,
    pub(super) polarity: Polarity,
    pub(super) x: u32,
    pub(super) y: u32,
}

impl Evt2Encoder {
    /// Writes the word of an event, after a time word where one is due.
    #[inline]
    pub(super) fn word(
        &mut self,
        Word { tick, polarity, x, y }: Word,
        bytes: &mut [u8],
    ) -> Result<usize, FormatError> {
        let last = self.time.unwrap_or(tick.micros().into());
        let (delta, is_retimed) = Clock::starting_at(Tick::from_micros(last)).since(tick);
        let time = last.wrapping_add(delta.into()) & ((1 << TIME_BITS) - 1);
        let high = (time >> LOW_BITS) as u32;

        let mut out = Cursor::new(bytes);
        let kind = if polarity == Polarity::Up { UP } else { DOWN };
        let word = kind << 28
            | (time as u32 & ((1 << LOW_BITS) - 1)) << 22
            | (x & X_MASK) << X_BITS
            | y & X_MASK;
        if self.high != Some(high) {
            out.put(&(TIME_HIGH << 28 | high).to_le_bytes())
                .ok_or(FormatError::Full { written: 0 })?;
        }
        self.high = Some(high);
        self.retimed = self.retimed.saturating_add(is_retimed.into());
        self.time = Some(time);
        out.put(&word.to_le_bytes()).ok_or(FormatError::Full { written: out.written() })?;
        Ok(out.written())
    }
}

impl EventFormat for Evt2Encoder {
    const LONGEST: usize = 4;

    fn encode(&mut self, event: Event, bytes: &mut [u8]) -> Result<usize, FormatError> {
        let Event { tick, address, polarity } = event;
        let (x, y) = (u32::from(address) & X_MASK, u32::from(address) >> X_BITS);
        self.word(Word { tick, polarity, x, y }, bytes)
    }

    fn retimed(&self) -> u32 {
        self.retimed
    }
}

/// The decoder of [`Evt2`].
///
/// Triggers and other words are skipped, and so are events before the first time word and in rows
/// from 32 on.
#[derive(Clone, Copy, Debug)]
pub struct Evt2Decoder {
    header: Header,
    /// The bytes of the next word so far, in the highest bits; below them a 1, then zeros.
    partial: u32,
    high: Option<u32>,
    skipped: u32,
}

/// How far the header of a file is read, which may have none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Header {
    /// The header is over, or the file has none: words come.
    Over,
    /// At the start of the file, or of a line of the header.
    LineStart,
    /// After a `%`, which begins a line of the header or a word: `partial` has the bytes from the `%` on.
    Percent,
    /// Within a line of the header, whose first `end` bytes are those of `% end`; `u8::MAX` if they are others.
    Line { end: u8 },
}

/// No byte of a word.
const NO_BYTES: u32 = 1 << 31;

impl Evt2Decoder {
    const fn starting_at(header: Header) -> Self {
        Self { header, partial: NO_BYTES, high: None, skipped: 0 }
    }

    /// Takes a byte of a word, and returns the word that it completes.
    #[inline]
    fn whole(&mut self, byte: u8) -> Option<u32> {
        let word = self.partial >> 8 | u32::from(byte) << 24;
        let is_whole = self.partial & 0x80 != 0;
        self.partial = if is_whole { NO_BYTES } else { word };
        is_whole.then_some(word)
    }

    /// Takes a byte before the header is over.
    #[cold]
    #[inline(never)]
    fn header(&mut self, byte: u8) -> Option<Word> {
        match self.header {
            Header::LineStart if byte != b'%' => {
                self.header = Header::Over;
                let word = self.whole(byte)?;
                return self.word(word);
            }
            Header::LineStart => {
                self.header = Header::Percent;
                self.whole(byte);
            }
            Header::Percent => {
                let word = self.whole(byte)?;
                if !is_text(byte) {
                    self.header = Header::Over;
                    return self.word(word);
                }
                self.header = Header::Line { end: 1 };
                let [_, rest @ ..] = word.to_le_bytes();
                for byte in rest {
                    self.again(byte);
                }
            }
            Header::Line { end } => self.header = within_line(end, byte),
            Header::Over => {}
        }
        None
    }

    /// Takes one of the three bytes after a `%` that began a line: they make no word, and so no event. No call of
    /// [`header`](Self::header), or the stack would have no bound that a compiler sees.
    fn again(&mut self, byte: u8) {
        match self.header {
            Header::Line { end } => {
                self.header = within_line(end, byte);
                return;
            }
            Header::LineStart if byte == b'%' => self.header = Header::Percent,
            Header::LineStart => self.header = Header::Over,
            Header::Percent | Header::Over => {}
        }
        self.whole(byte);
    }

    #[inline]
    fn word(&mut self, word: u32) -> Option<Word> {
        let polarity = match word >> 28 {
            TIME_HIGH => {
                self.high = Some(word & 0x0FFF_FFFF);
                return None;
            }
            DOWN => Polarity::Down,
            UP => Polarity::Up,
            _ => {
                self.skipped = self.skipped.saturating_add(4);
                return None;
            }
        };
        let Some(high) = self.high else {
            self.skip();
            return None;
        };
        let low = word >> 22 & ((1 << LOW_BITS) - 1);
        let (x, y) = (word >> X_BITS & X_MASK, word & X_MASK);
        let tick = Tick::from_micros((high << LOW_BITS | low).into());
        Some(Word { tick, polarity, x, y })
    }

    /// Counts the bytes of a word that gives no event.
    pub(super) fn skip(&mut self) {
        self.skipped = self.skipped.saturating_add(4);
    }

    /// Takes a byte, and returns the content of the event word that it completes.
    #[inline]
    pub(super) fn push_word(&mut self, byte: u8) -> Option<Word> {
        if self.header != Header::Over {
            return self.header(byte);
        }
        let word = self.whole(byte)?;
        self.word(word)
    }
}

/// The state after a byte of a line, which may end the header.
fn within_line(end: u8, byte: u8) -> Header {
    const END: &[u8; 6] = b"% end\n";
    let is_end = END.get(usize::from(end)) == Some(&byte);
    match (byte, is_end) {
        (b'\n', true) => Header::Over,
        (b'\n', false) => Header::LineStart,
        (_, true) => Header::Line { end: end + 1 },
        (_, false) => Header::Line { end: u8::MAX },
    }
}

fn is_text(byte: u8) -> bool {
    matches!(byte, b' '..=b'~' | b'\t' | b'\r' | b'\n')
}

impl EventDecoder for Evt2Decoder {
    #[inline]
    fn push(&mut self, byte: u8) -> Option<Event> {
        let Word { tick, polarity, x, y } = self.push_word(byte)?;
        if y & FAR_ROWS != 0 {
            self.skip();
            return None;
        }
        Some(Event { tick, address: (y << X_BITS | x) as u16, polarity })
    }

    fn skipped(&self) -> u32 {
        self.skipped
    }

    fn is_partial(&self) -> bool {
        matches!(self.header, Header::Line { .. }) || self.partial != NO_BYTES
    }
}
