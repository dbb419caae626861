//! EVT 2.1: the format of Prophesee's `GenX320` and IMX636 cameras, with up to 32 pixels a word.

use super::EventDecoder;
use super::evt2::{LOW_BITS, X_BITS, X_MASK};
use crate::frame::PixelEvent;
use spikewire::{Polarity, Tick};

/// Prophesee EVT 2.1: words of 64 bits, each with up to 32 pixels of a row. Read only.
///
/// - **Event word:** type\[63:60\] 0 (down) or 1 (up), t\[59:54\] the low 6 bits of the time, x\[53:43\], y\[42:32\], and
///   valid\[31:0\]: bit `n` is an event of column `x + n`. **Time word:** type\[63:60\] 8, then the upper 28 bits of the
///   time, \[59:32\].
/// - **Byte order:** [`Little`](Evt21Order::Little) for the `GenX320`, whose files say `endianness=little`, or
///   [`Halves`](Evt21Order::Halves) for the IMX636, whose files say `endianness=legacy`.
/// - **Resynchronisation:** at each time word; the stream must be read from the start of a word, after a file's header.
///
/// Source: Prophesee, EVT 2.1 format.
///
/// ```
/// use spikewire::{Polarity, Tick};
/// use spikewire_cameras::format::{EventDecoder, Evt21Order, Evt21Pixels};
///
/// let words = [0x8000_0001_0000_0000, 0x10C2_000A_0000_0005_u64];
/// let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
/// let mut decoder = Evt21Pixels::decoder(Evt21Order::Little);
/// let events: Vec<_> = decoder.decode(&bytes).map(|event| (event.tick, event.x, event.y)).collect();
/// assert_eq!(events, [(Tick::from_micros(67), 64, 10), (Tick::from_micros(67), 66, 10)]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Evt21Pixels;

/// The order in which the bytes of an EVT 2.1 word are sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Evt21Order {
    /// The lowest byte of the 64 bits first.
    Little,
    /// The upper 32 bits first, then the lower 32 bits, each with its lowest byte first.
    Halves,
}

const BYTES: u8 = 8;

impl Evt21Pixels {
    /// A decoder of words, from the start of a word on.
    pub const fn decoder(order: Evt21Order) -> Evt21PixelsDecoder {
        Evt21PixelsDecoder {
            order,
            word: 0,
            count: 0,
            high: None,
            next: PixelEvent { tick: Tick::from_micros(0), x: 0, y: 0, polarity: Polarity::Up },
            valid: 0,
            skipped: 0,
        }
    }
}

/// The decoder of [`Evt21Pixels`].
///
/// Triggers and other words are skipped, and so are events before the first time word.
#[derive(Clone, Copy, Debug)]
pub struct Evt21PixelsDecoder {
    order: Evt21Order,
    /// The bytes of the next word so far, in the order of their arrival: the first of 8 is the lowest.
    word: u64,
    /// Number of bytes in `word`.
    count: u8,
    /// The upper 28 bits of the time.
    high: Option<u32>,
    /// The event of the lowest bit of `valid`.
    next: PixelEvent,
    /// The pixels of the last word that have not been returned yet.
    valid: u32,
    skipped: u32,
}

impl Evt21PixelsDecoder {
    fn whole(&mut self, arrived: u64) {
        let word = match self.order {
            Evt21Order::Little => arrived,
            Evt21Order::Halves => arrived.rotate_left(32),
        };
        let (upper, valid) = ((word >> 32) as u32, word as u32);
        let polarity = match upper >> 28 {
            8 => {
                self.high = Some(upper & 0x0FFF_FFFF);
                return;
            }
            0 => Polarity::Down,
            1 => Polarity::Up,
            _ => return self.skip(),
        };
        let Some(high) = self.high else { return self.skip() };
        let low = upper >> 22 & ((1 << LOW_BITS) - 1);
        let tick = Tick::from_micros((high << LOW_BITS | low).into());
        let (x, y) = ((upper >> X_BITS & X_MASK) as u16, (upper & X_MASK) as u16);
        self.next = PixelEvent { tick, x, y, polarity };
        self.valid = valid;
    }

    fn skip(&mut self) {
        self.skipped = self.skipped.saturating_add(BYTES.into());
    }
}

impl EventDecoder<PixelEvent> for Evt21PixelsDecoder {
    fn push(&mut self, byte: u8) -> Option<PixelEvent> {
        self.word = self.word >> 8 | u64::from(byte) << 56;
        self.count = self.count.wrapping_add(1);
        if self.count == BYTES {
            self.count = 0;
            self.whole(self.word);
        }
        self.pending()
    }

    fn pending(&mut self) -> Option<PixelEvent> {
        take_valid(&mut self.valid, self.next)
    }

    fn skipped(&self) -> u32 {
        self.skipped
    }

    fn is_partial(&self) -> bool {
        self.count > 0
    }
}

/// Removes the lowest bit of `valid`, and returns its event. `first` is the event of bit 0.
pub(super) fn take_valid(valid: &mut u32, first: PixelEvent) -> Option<PixelEvent> {
    if *valid == 0 {
        return None;
    }
    let column = valid.trailing_zeros() as u16;
    *valid &= valid.wrapping_sub(1);
    Some(PixelEvent { x: first.x.wrapping_add(column), ..first })
}
