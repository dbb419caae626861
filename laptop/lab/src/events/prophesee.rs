//! Reads the files and streams of Prophesee's cameras: EVT2, EVT 2.1 and EVT3.

use super::{EventReader, EventsKind, Item, Size, Tally};
use crate::Result;
use spikewire::Event;
use spikewire_cameras::format::{
    EventDecoder, Evt2Pixels, Evt2PixelsDecoder, Evt3Pixels, Evt3PixelsDecoder, Evt21Order,
    Evt21Pixels, Evt21PixelsDecoder,
};
use spikewire_cameras::frame::PixelEvent;

/// Number of columns of a file whose pixels stand for addresses. Such a file has [`ADDRESS_ROWS`] rows.
const ADDRESS_COLUMNS: u16 = 2048;
/// Number of rows in which a pixel stands for an address of 16 bits.
const ADDRESS_ROWS: u16 = 32;
/// Longest line of a header.
const LONGEST_LINE: usize = 4096;

/// Returns the pixel that stands for an address in EVT2 and EVT3.
pub(super) fn pixel_of(event: Event) -> PixelEvent {
    let Event { tick, address, polarity } = event;
    PixelEvent { tick, x: address % ADDRESS_COLUMNS, y: address / ADDRESS_COLUMNS, polarity }
}

/// Returns the lines with which a file begins. Without a size, its pixels stand for addresses.
pub(super) fn header(version: Version, size: Option<Size>) -> Vec<u8> {
    let size = match size {
        None => Size { width: ADDRESS_COLUMNS, height: ADDRESS_ROWS },
        // A file of pixels must not look like one of addresses.
        Some(Size { width: ADDRESS_COLUMNS, height: ADDRESS_ROWS }) => {
            Size { width: ADDRESS_COLUMNS, height: ADDRESS_ROWS + 1 }
        }
        Some(size) => size,
    };
    let Size { width, height } = size;
    let (number, name) = (version.number(), version.name());
    format!(
        "% evt {number}\n% format {name};height={height};width={width}\n% geometry {width}x{height}\n% end\n"
    )
    .into_bytes()
}

/// A version of the format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Version {
    Evt2,
    Evt21,
    Evt3,
}

impl Version {
    const ALL: [Self; 3] = [Self::Evt2, Self::Evt21, Self::Evt3];

    /// Returns the number in the header's line `% evt`.
    fn number(self) -> &'static str {
        match self {
            Self::Evt2 => "2.0",
            Self::Evt21 => "2.1",
            Self::Evt3 => "3.0",
        }
    }

    /// Returns the name in the header's line `% format`.
    fn name(self) -> &'static str {
        match self {
            Self::Evt2 => "EVT2",
            Self::Evt21 => "EVT21",
            Self::Evt3 => "EVT3",
        }
    }
}

/// A reader of one version. A file whose header names another version is refused.
pub(super) struct Reader {
    version: Version,
    header: Header,
    decoder: Decoder,
    /// Whether events have columns and rows; if not, they have addresses.
    has_pixels: bool,
    /// Number of events in rows that no address has.
    far_rows: u64,
    /// The order of the bytes in a word that the user gave.
    order: Option<Evt21Order>,
    /// The words by which the order of their bytes is found, until it is.
    undecided: Option<Vec<u8>>,
    /// The order that the words showed.
    found_order: Option<Evt21Order>,
}

enum Decoder {
    Evt2(Evt2PixelsDecoder),
    Evt21(Evt21PixelsDecoder),
    Evt3(Evt3PixelsDecoder),
}

impl Decoder {
    fn decode(&mut self, bytes: &[u8], pixels: &mut Vec<PixelEvent>) {
        match self {
            Self::Evt2(decoder) => pixels.extend(decoder.decode(bytes)),
            Self::Evt21(decoder) => pixels.extend(decoder.decode(bytes)),
            Self::Evt3(decoder) => pixels.extend(decoder.decode(bytes)),
        }
    }

    fn skipped(&self) -> u32 {
        match self {
            Self::Evt2(decoder) => decoder.skipped(),
            Self::Evt21(decoder) => decoder.skipped(),
            Self::Evt3(decoder) => decoder.skipped(),
        }
    }

    fn is_partial(&self) -> bool {
        match self {
            Self::Evt2(decoder) => decoder.is_partial(),
            Self::Evt21(decoder) => decoder.is_partial(),
            Self::Evt3(decoder) => decoder.is_partial(),
        }
    }
}

impl Reader {
    /// Makes a reader. If `has_pixels` is false, the header of a file of addresses gives events with addresses, and so does
    /// an EVT2 stream without a header.
    pub(super) fn new(version: Version, has_pixels: bool) -> Self {
        let decoder = match version {
            Version::Evt2 => Decoder::Evt2(Evt2Pixels::decoder()),
            Version::Evt21 => Decoder::Evt21(Evt21Pixels::decoder(Evt21Order::Little)),
            Version::Evt3 => Decoder::Evt3(Evt3Pixels::decoder()),
        };
        Self {
            version,
            header: Header::default(),
            decoder,
            has_pixels,
            far_rows: 0,
            order: None,
            undecided: None,
            found_order: None,
        }
    }

    /// Makes a reader of EVT 2.1. Without an `order` of the bytes in a word, the header says it, or the words show it.
    pub(super) fn of_evt21(order: Option<Evt21Order>) -> Self {
        Self { order, ..Self::new(Version::Evt21, true) }
    }

    /// Applies the header, which is over.
    fn begin(&mut self) -> Result<()> {
        let Header { version, size, order, is_there, .. } = &self.header;
        if let Some(version) = version.filter(|version| *version != self.version) {
            let name = version.name().to_lowercase();
            return Err(EventsKind::OtherVersion { version: version.number(), name }.into());
        }
        if let Decoder::Evt21(decoder) = &mut self.decoder {
            let order = match (self.order, order.as_deref()) {
                (Some(order), _) => Some(order),
                (None, None) => None,
                (None, Some("little")) => Some(Evt21Order::Little),
                (None, Some("legacy")) => Some(Evt21Order::Halves),
                (None, Some(other)) => {
                    return Err(EventsKind::ByteOrder { order: other.to_owned() }.into());
                }
            };
            match order {
                Some(order) => *decoder = Evt21Pixels::decoder(order),
                None => self.undecided = Some(Vec::new()),
            }
        }
        let addresses = Size { width: ADDRESS_COLUMNS, height: ADDRESS_ROWS };
        let has_addresses =
            if *is_there { *size == Some(addresses) } else { self.version == Version::Evt2 };
        self.has_pixels |= !has_addresses;
        Ok(())
    }

    /// Takes the next words. As long as the order of their bytes is unknown, they wait.
    fn take(&mut self, bytes: &[u8], items: &mut Vec<Item>) -> Result<()> {
        /// Number of bytes that show the order surely, and number after which they never will.
        const FEWEST: usize = 64 * WORD;
        const MOST: usize = 1 << 16;
        let Some(mut waiting) = self.undecided.take() else {
            self.words(bytes, items);
            return Ok(());
        };
        waiting.extend_from_slice(bytes);
        let is_early = waiting.len() < FEWEST
            || waiting.len() < MOST && order_of(&waiting, self.header.size).is_none();
        if is_early {
            self.undecided = Some(waiting);
            return Ok(());
        }
        self.decide(&waiting, items)
    }

    /// Decides the order of the bytes by the words that have waited, and reads these.
    fn decide(&mut self, waiting: &[u8], items: &mut Vec<Item>) -> Result<()> {
        self.found_order = order_of(waiting, self.header.size);
        let orders = [Evt21Order::Little, Evt21Order::Halves];
        // Without a time word, no order gives events: the bytes are of another format, and are skipped.
        if self.found_order.is_none() && orders.iter().any(|order| has_time(waiting, *order)) {
            return Err(EventsKind::WhichByteOrder.into());
        }
        let order = self.found_order.unwrap_or(Evt21Order::Little);
        self.decoder = Decoder::Evt21(Evt21Pixels::decoder(order));
        self.words(waiting, items);
        Ok(())
    }

    fn words(&mut self, bytes: &[u8], items: &mut Vec<Item>) {
        let mut pixels = vec![];
        self.decoder.decode(bytes, &mut pixels);
        for pixel in pixels {
            let PixelEvent { tick, x, y, polarity } = pixel;
            if self.has_pixels {
                items.push(Item::Pixel(pixel));
            } else if y < ADDRESS_ROWS {
                let address = y * ADDRESS_COLUMNS + x;
                items.push(Item::Event(Event { tick, address, polarity }));
            } else {
                self.far_rows += 1;
            }
        }
    }
}

impl EventReader for Reader {
    fn read(&mut self, bytes: &[u8], items: &mut Vec<Item>) -> Result<()> {
        let mut rest = bytes;
        while !self.header.is_over {
            let Some((byte, after)) = rest.split_first() else { return Ok(()) };
            rest = after;
            self.header.push(*byte);
            if self.header.is_over {
                self.begin()?;
                let first = std::mem::take(&mut self.header.line);
                self.take(&first, items)?;
            }
        }
        self.take(rest, items)
    }

    fn finish(&mut self, items: &mut Vec<Item>) -> Result<()> {
        // The stream may be shorter than a word.
        if !self.header.is_over && !self.header.is_there {
            let first = std::mem::take(&mut self.header.line);
            self.words(&first, items);
        }
        match self.undecided.take() {
            Some(waiting) => self.decide(&waiting, items),
            None => Ok(()),
        }
    }

    fn tally(&self) -> Tally {
        Tally {
            skipped: self.decoder.skipped().into(),
            is_cut: self.decoder.is_partial() || !self.header.line.is_empty(),
            far_rows: self.far_rows,
            found_order: self.found_order,
            ..Tally::default()
        }
    }

    fn size(&self) -> Option<Size> {
        self.header.size.filter(|_| self.has_pixels)
    }
}

/// Number of bytes in a word of EVT 2.1.
const WORD: usize = 8;

/// Returns the words of EVT 2.1 in these bytes.
fn words_of(bytes: &[u8], order: Evt21Order) -> impl Iterator<Item = u64> {
    let (words, _) = bytes.as_chunks::<WORD>();
    words.iter().map(move |bytes| match order {
        Evt21Order::Little => u64::from_le_bytes(*bytes),
        Evt21Order::Halves => u64::from_le_bytes(*bytes).rotate_left(32),
    })
}

fn is_time(word: u64) -> bool {
    word >> 60 == 8
}

fn has_time(bytes: &[u8], order: Evt21Order) -> bool {
    words_of(bytes, order).any(is_time)
}

/// Finds the order of the bytes in words of EVT 2.1: the only one in which they can be words of a camera. If both can,
/// as in a short stream, it is the only one in which the first word has the time, without which no event can be read.
fn order_of(bytes: &[u8], size: Option<Size>) -> Option<Evt21Order> {
    let can_be = |order: &Evt21Order| are_words(words_of(bytes, *order), size);
    let begins = |order: &Evt21Order| words_of(bytes, *order).next().is_some_and(is_time);
    let orders: Vec<Evt21Order> =
        [Evt21Order::Little, Evt21Order::Halves].into_iter().filter(can_be).collect();
    let mut first = orders.iter().copied().filter(begins);
    match (&orders[..], first.next(), first.next()) {
        (&[order], ..) | (_, Some(order), None) => Some(order),
        _ => None,
    }
}

/// Returns whether a camera can send these words: all are of known types, the times do not go back, and each event has a
/// column that is a multiple of 32, a pixel at least, and a place within the picture.
fn are_words(words: impl Iterator<Item = u64>, size: Option<Size>) -> bool {
    let size = size.unwrap_or(Size { width: 1 << 11, height: 1 << 11 });
    let mut latest = None;
    for word in words {
        let upper = word >> 32;
        match upper >> 28 {
            8 if latest.is_none_or(|latest| latest <= upper) => latest = Some(upper),
            0 | 1 => {
                let (x, y) = (upper >> 11 & 0x7FF, upper & 0x7FF);
                let is_inside = x < u64::from(size.width) && y < u64::from(size.height);
                if !is_inside || x % 32 > 0 || word as u32 == 0 {
                    return false;
                }
            }
            // Triggers, and words of other kinds that go on over several.
            0xA | 0xE | 0xF => {}
            _ => return false,
        }
    }
    latest.is_some()
}

/// The lines before the words, each of which begins with `%`, up to `% end` or up to the first line that does not.
#[derive(Default)]
struct Header {
    /// The bytes of the unfinished line. When the header is over: the first bytes of the words.
    line: Vec<u8>,
    is_over: bool,
    /// Whether there was a line.
    is_there: bool,
    version: Option<Version>,
    size: Option<Size>,
    /// The order of the bytes in a word.
    order: Option<String>,
}

impl Header {
    fn push(&mut self, byte: u8) {
        self.line.push(byte);
        // A word may begin with `%`, too: its fourth byte is no text.
        let is_word = self.line.len() == 4 && !is_text(byte);
        if self.line[0] != b'%' || is_word || self.line.len() > LONGEST_LINE {
            self.is_over = true;
        } else if byte == b'\n' {
            self.is_there = true;
            let line = std::mem::take(&mut self.line);
            self.line(&String::from_utf8_lossy(&line));
        }
    }

    fn line(&mut self, line: &str) {
        let text = line.trim_start_matches('%').trim();
        let (key, value) = text.split_once(' ').unwrap_or((text, ""));
        match key {
            "end" => self.is_over = true,
            "evt" => {
                self.version = Version::ALL.into_iter().find(|version| version.number() == value);
            }
            "format" => self.format(value),
            "geometry" => {
                let sides = value.split_once('x');
                self.size = sides.and_then(|(width, height)| size(width, height)).or(self.size);
            }
            _ => {}
        }
    }

    /// Reads the line `% format`: a name, and pairs of a key and a value.
    fn format(&mut self, text: &str) {
        let mut fields = text.split(';');
        let name = fields.next().unwrap_or_default();
        let version = Version::ALL.into_iter().find(|version| version.name() == name);
        self.version = version.or(self.version);
        let (mut width, mut height) = ("", "");
        for (key, value) in fields.filter_map(|field| field.split_once('=')) {
            match key {
                "width" => width = value,
                "height" => height = value,
                "endianness" => self.order = Some(value.to_owned()),
                _ => {}
            }
        }
        self.size = size(width, height).or(self.size);
    }
}

fn size(width: &str, height: &str) -> Option<Size> {
    Some(Size { width: width.trim().parse().ok()?, height: height.trim().parse().ok()? })
}

fn is_text(byte: u8) -> bool {
    matches!(byte, b' '..=b'~' | b'\t' | b'\r' | b'\n')
}
