//! Reads `ArduPilot`'s binary logs, `.bin`. Each message is a header of three bytes, followed by its columns without
//! gaps.

use super::format::{Column, FMT, Format, Formats, Letter};
use crate::bytes::Bytes;
use crate::definition::Number;
use crate::faults::Faults;
use crate::topic::Topic;
use crate::window::Window;
use crate::{Entry, Log, Result};
use std::path::Path;

/// First two bytes of a message. The third byte is the message's type.
const HEAD: &[u8] = &[0xa3, 0x95];
/// Offset of the content in a message, in bytes: the length of the header.
const CONTENT: usize = 3;

/// Reader of a binary log.
pub(crate) struct Binary {
    window: Window,
    faults: Faults,
    formats: Formats,
    message: Vec<u8>,
    /// Time of the last message that contained a time, in ns.
    time: i64,
    /// Offset of the first byte of the range that is being skipped as damaged.
    damaged: Option<u64>,
}

/// Classification of the next bytes in the log.
enum Ahead {
    /// A message. The values are its type, and its length in bytes.
    Message(u8, usize),
    /// A message that the end of the file cuts off.
    Cut,
    /// Bytes that are no message.
    Odd,
}

/// Returns whether bytes begin with the head of a message, as far as there are bytes.
fn begins(bytes: &[u8]) -> bool {
    bytes.iter().zip(HEAD).all(|(byte, head)| byte == head)
}

/// Returns whether the first bytes of a file hold a message that defines a format, with which every log begins.
/// Usually the first such message defines `FMT` itself, but its format is fixed and needs no definition.
pub(crate) fn is_log(start: &[u8]) -> bool {
    /// Length of the content of an `FMT` message.
    const LENGTH: usize = 86;
    start.windows(CONTENT + LENGTH).enumerate().any(|(at, message)| {
        message.starts_with(HEAD)
            && message[HEAD.len()] == FMT
            && begins(&start[at + message.len()..])
            && matches!(
                Defined::of_format(&message[CONTENT..]),
                Some(Defined::Format(_, format)) if format.columns.is_ok()
            )
    })
}

impl Binary {
    pub(crate) fn open(path: &Path, faults: Faults) -> Result<Self> {
        Ok(Self {
            window: Window::new(Bytes::open(path)?),
            faults,
            formats: Formats::new(),
            message: Vec::new(),
            time: 0,
            damaged: None,
        })
    }

    /// Classifies the next bytes. Bytes count as a message if another message, blank bytes or the end of the file follow
    /// them. They also count if damaged bytes follow, unless a message begins within them: a message of which bytes are
    /// missing extends into the next one.
    fn look(&self) -> Ahead {
        let left = self.window.left();
        if !begins(left) {
            return Ahead::Odd;
        }
        let Some(&kind) = left.get(HEAD.len()) else { return Ahead::Cut };
        let Some(format) = self.formats.get(kind) else { return Ahead::Odd };
        match left.get(format.length..) {
            None => Ahead::Cut,
            Some(next) if begins(next) || self.window.blank(format.length).is_some() => {
                Ahead::Message(kind, format.length)
            }
            Some(_) if (CONTENT..format.length).any(|at| self.is_whole(at)) => Ahead::Odd,
            Some(_) => Ahead::Message(kind, format.length),
        }
    }

    /// Returns whether a message of a known kind begins at this index of the window, and another one follows it.
    fn is_whole(&self, at: usize) -> bool {
        let next = self.window.left().get(at..).unwrap_or_default();
        let format = next.get(HEAD.len()).and_then(|kind| self.formats.get(*kind));
        let behind = format.and_then(|format| next.get(format.length..));
        begins(next) && behind.is_some_and(begins)
    }

    /// Processes the next message, which has type `kind`, and returns its entry. Stores the definition if the message
    /// contains one. Converts the message's columns to the layout that its topic's definition describes.
    fn take(&mut self, kind: u8, length: usize) -> Result<Option<Entry>> {
        let at = self.window.offset();
        let content = &self.window.left()[CONTENT..length];
        let Some(format) = self.formats.get(kind) else { return Ok(None) };
        self.message.clear();
        let mut instance = 0;
        let mut defined = None;
        if let Ok(columns) = &format.columns {
            let mut rest = content;
            for (index, column) in columns.iter().enumerate() {
                let Some((bytes, after)) = rest.split_at_checked(column.letter.size()) else {
                    break;
                };
                rest = after;
                convert(column.letter, bytes, &mut self.message);
                if format.instance == Some(index) {
                    instance = whole(column.letter, bytes).unwrap_or_default();
                }
                if let Some((_, unit)) = format.time.filter(|(time, _)| *time == index) {
                    let time = whole(column.letter, bytes).unwrap_or_default();
                    self.time = time.saturating_mul(unit);
                }
            }
            if kind == FMT {
                defined = Some(Defined::of_format(content));
            } else if let Some(units) = Defined::of_units(columns, content) {
                defined = Some(Some(units));
            }
        }
        let topic = self.formats.topic(kind, instance, false);
        self.window.pass(length);
        match defined {
            Some(Some(Defined::Format(kind, format))) => self.formats.define(kind, format),
            Some(Some(Defined::Units(kind, units))) => self.formats.units(kind, &units),
            Some(None) => self.faults.skip(at, "a definition that cannot be read")?,
            None => {}
        }
        Ok(topic.map(|topic| Entry { topic, time: self.time, at, sequence: None }))
    }

    /// Counts the range of damaged bytes that ends at the current position, if there is one. Blank bytes before another
    /// message are damage, too: they stand in the place of messages.
    fn end_damage(&mut self) -> Result<()> {
        let blank = self.window.end_blank();
        match self.damaged.take().or(blank) {
            None => Ok(()),
            Some(damaged) => {
                let count = self.window.offset() - damaged;
                self.faults.skip(damaged, format!("{count} bytes are no messages"))
            }
        }
    }
}

/// A definition that a message contains.
enum Defined {
    /// The format of a message type.
    Format(u8, Format),
    /// The units of a message type's columns.
    Units(u8, String),
}

impl Defined {
    /// Parses the content of an `FMT` message, which defines a format; returns `None` if the content is invalid.
    fn of_format(content: &[u8]) -> Option<Self> {
        let (&[kind, length], rest) = content.split_first_chunk()?;
        let (name, rest) = rest.split_at_checked(4)?;
        let (letters, columns) = rest.split_at_checked(16)?;
        let [name, letters, columns] = [name, letters, columns].map(printed);
        let (name, letters, columns) = (name?, letters?, columns?);
        let is_good = !name.is_empty() && usize::from(length) >= CONTENT;
        let format = || Format::new(name, length.into(), letters, columns);
        is_good.then(|| Self::Format(kind, format()))
    }

    /// Parses the content of an `FMTU` message, which assigns units to the columns of a message type. `columns` are the
    /// columns of the `FMTU` message itself. Returns `None` if `FmtType` or `UnitIds` is missing or invalid.
    fn of_units(columns: &[Column], content: &[u8]) -> Option<Self> {
        let column = |name: &str| {
            let index = columns.iter().position(|column| column.name == name)?;
            let before: usize = columns[..index].iter().map(|column| column.letter.size()).sum();
            content.get(before..before + columns[index].letter.size())
        };
        let kind = *column("FmtType")?.first()?;
        Some(Self::Units(kind, printed(column("UnitIds")?)?.to_owned()))
    }
}

/// Returns the text up to the first NUL; `None` if it contains anything but printable ASCII.
fn printed(bytes: &[u8]) -> Option<&str> {
    let text = bytes.split(|&byte| byte == 0).next()?;
    let is_printed = text.iter().all(|byte| matches!(byte, b' '..=b'~'));
    str::from_utf8(text).ok().filter(|_| is_printed)
}

/// Appends the bytes of a column to `message`, converted to the form that the topic's definition describes.
fn convert(letter: Letter, column: &[u8], message: &mut Vec<u8>) {
    match letter {
        Letter::Number(_) | Letter::Array | Letter::Mode => message.extend(column),
        Letter::Half => message.extend(half(column).to_le_bytes()),
        Letter::Scaled(_, unit) => {
            let number = whole(letter, column).unwrap_or_default() as f64 / f64::from(unit);
            message.extend(number.to_le_bytes());
        }
        Letter::Text(_) => {
            let text = column.split(|&byte| byte == 0).next().unwrap_or_default();
            message.extend((text.len() as u32).to_le_bytes());
            message.extend(text);
        }
    }
}

/// Returns the value of a column that holds an integer; `None` for other types.
fn whole(letter: Letter, column: &[u8]) -> Option<i64> {
    let (Letter::Number(number) | Letter::Scaled(number, _)) = letter else { return None };
    Some(match number {
        Number::I8 => i8::from_le_bytes(*column.first_chunk()?).into(),
        Number::U8 => u8::from_le_bytes(*column.first_chunk()?).into(),
        Number::I16 => i16::from_le_bytes(*column.first_chunk()?).into(),
        Number::U16 => u16::from_le_bytes(*column.first_chunk()?).into(),
        Number::I32 => i32::from_le_bytes(*column.first_chunk()?).into(),
        Number::U32 => u32::from_le_bytes(*column.first_chunk()?).into(),
        Number::I64 => i64::from_le_bytes(*column.first_chunk()?),
        Number::U64 => i64::try_from(u64::from_le_bytes(*column.first_chunk()?)).ok()?,
        Number::Bool | Number::F32 | Number::F64 => return None,
    })
}

/// Converts an IEEE 754 half-precision float, little-endian, to `f64`.
fn half(column: &[u8]) -> f64 {
    let bits = column.first_chunk().map_or(0, |bytes| u16::from_le_bytes(*bytes));
    let (exponent, fraction) = (i32::from(bits >> 10 & 0x1f), f64::from(bits & 0x3ff));
    let magnitude = match exponent {
        0 => fraction * 2_f64.powi(-24),
        0x1f if fraction == 0.0 => f64::INFINITY,
        0x1f => f64::NAN,
        _ => (1024.0 + fraction) * 2_f64.powi(exponent - 25),
    };
    if bits >> 15 == 1 { -magnitude } else { magnitude }
}

impl Log for Binary {
    fn next(&mut self) -> Result<Option<Entry>> {
        loop {
            self.window.fill(&mut self.faults)?;
            if self.window.pass_blank(0) {
                continue;
            }
            if self.window.left().is_empty() {
                if let Some(blank) = self.window.end_blank() {
                    self.faults.blank(blank, self.window.offset() - blank);
                }
                self.end_damage()?;
                return Ok(None);
            }
            match self.look() {
                Ahead::Message(kind, length) => {
                    self.end_damage()?;
                    if let Some(entry) = self.take(kind, length)? {
                        return Ok(Some(entry));
                    }
                }
                Ahead::Cut if self.damaged.is_none() => {
                    let offset = self.window.offset();
                    self.window.pass(usize::MAX);
                    self.faults.end(offset, "the log ends within a message")?;
                }
                Ahead::Cut | Ahead::Odd => {
                    let blank = self.window.end_blank();
                    self.damaged.get_or_insert(blank.unwrap_or(self.window.offset()));
                    let mut behind = self.window.left().iter().skip(1);
                    let next = behind.position(|byte| *byte == HEAD[0]);
                    self.window.pass(next.map_or(usize::MAX, |next| next + 1));
                }
            }
        }
    }

    fn topics(&self) -> &[Topic] {
        &self.formats.topics
    }

    fn message(&self) -> &[u8] {
        &self.message
    }

    fn faults(&mut self) -> &mut Faults {
        &mut self.faults
    }
}

#[cfg(test)]
mod tests {
    use super::half;

    #[test]
    fn halves_are_as_ieee_has_them() {
        for (bits, value) in [
            (0x0000, 0.0),
            (0x0001, 2_f64.powi(-24)),
            (0x03ff, 1023.0 * 2_f64.powi(-24)),
            (0x0400, 2_f64.powi(-14)),
            (0x3c00, 1.0),
            (0x3555, 0.333_251_953_125),
            (0xc000, -2.0),
            (0x7bff, 65504.0),
            (0xfc00, f64::NEG_INFINITY),
        ] {
            assert_eq!(half(&u16::to_le_bytes(bits)).to_bits(), f64::to_bits(value), "{bits:#06x}");
        }
        assert!(half(&[0xff, 0x7f]).is_nan());
    }
}
