//! Definitions of messages: `name:type field;type[8] field;`.

use std::collections::HashMap;

/// A message's layout, as far as its length and its kinds of fields go.
#[derive(Debug, PartialEq)]
pub(super) struct Format {
    /// Its name.
    pub name: String,
    /// Its fields in order.
    pub fields: Vec<Field>,
}

/// A field.
#[derive(Debug, PartialEq)]
pub(super) struct Field {
    /// The name.
    pub name: String,
    /// The type without its count.
    pub kind: String,
    /// How many, in an array.
    pub count: Option<usize>,
}

/// The formats of a log, by name.
pub(super) type Formats = HashMap<String, Format>;

impl Format {
    /// Reads the text of a definition; `None` if it is no text or not of this form.
    pub(super) fn parse(message: &[u8]) -> Option<Self> {
        let (name, fields) = str::from_utf8(message).ok()?.split_once(':')?;
        let fields = fields.split(';').map(str::trim).filter(|field| !field.is_empty());
        let fields = fields.map(Field::parse).collect::<Option<_>>()?;
        is_name(name).then(|| Self { name: name.to_owned(), fields })
    }

    /// How long a message is: without the padding at its end, which is not logged, and with it.
    pub(super) fn lengths(&self, formats: &Formats) -> Option<(usize, usize)> {
        /// The longest message.
        const LONGEST: usize = 1 << 16;
        let sizes: Vec<usize> =
            self.fields.iter().map(|field| field.size(formats, 0)).collect::<Option<_>>()?;
        let padding = self.fields.iter().zip(&sizes).rev();
        let padding: usize = padding
            .take_while(|(field, _)| field.name.starts_with("_padding"))
            .map(|(_, size)| size)
            .sum();
        let all = sizes.iter().try_fold(0_usize, |sum, size| sum.checked_add(*size))?;
        (all <= LONGEST).then_some((all - padding, all))
    }

    /// Fields of text.
    pub(super) fn texts(&self) -> impl Iterator<Item = &Field> {
        self.fields.iter().filter(|field| field.kind == "char")
    }

    /// The place of the time at which a message was logged, if its messages have it.
    pub(super) fn time(&self, formats: &Formats) -> Option<Number> {
        let mut offset = 0;
        for field in &self.fields {
            if field.name == "timestamp" && field.kind == "uint64_t" && field.count.is_none() {
                return Some(Number { kind: Kind::U64, offset });
            }
            offset += field.size(formats, 0)?;
        }
        None
    }

    /// All numbers of a message by name, but for its time: `field`, `array[0]`, `nested.field`. The message has a
    /// length.
    pub(super) fn numbers(&self, formats: &Formats) -> Vec<(String, Number)> {
        let mut numbers = Vec::new();
        self.add_numbers(formats, "", 0, &mut numbers);
        numbers.retain(|(name, _)| name != "timestamp");
        numbers
    }

    fn add_numbers(
        &self,
        formats: &Formats,
        prefix: &str,
        start: usize,
        numbers: &mut Vec<(String, Number)>,
    ) {
        let mut offset = start;
        for field in &self.fields {
            let name = format!("{prefix}{}", field.name);
            let length = field.size(formats, 0).unwrap_or_default();
            let one = length / field.count.unwrap_or(1).max(1);
            for index in 0..field.count.unwrap_or(1) {
                let name = field.count.map_or_else(|| name.clone(), |_| format!("{name}[{index}]"));
                let offset = offset + index * one;
                if let Some(nested) = formats.get(&field.kind) {
                    nested.add_numbers(formats, &format!("{name}."), offset, numbers);
                } else if let Some(kind) = Kind::of(&field.kind)
                    && !field.name.starts_with("_padding")
                {
                    numbers.push((name, Number { kind, offset }));
                }
            }
            offset += length;
        }
    }
}

/// A number of a message, by its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Number {
    kind: Kind,
    offset: usize,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    U8,
    U16,
    U32,
    U64,
    I8,
    I16,
    I32,
    I64,
    F32,
    F64,
}

impl Kind {
    /// Text is not a signal; booleans are the bytes that they are, as they may hold more than 0 and 1.
    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "uint8_t" | "bool" => Self::U8,
            "uint16_t" => Self::U16,
            "uint32_t" => Self::U32,
            "uint64_t" => Self::U64,
            "int8_t" => Self::I8,
            "int16_t" => Self::I16,
            "int32_t" => Self::I32,
            "int64_t" => Self::I64,
            "float" => Self::F32,
            "double" => Self::F64,
            _ => return None,
        })
    }
}

impl Number {
    /// The number in a message.
    pub(super) fn read(self, message: &[u8]) -> Option<f64> {
        let bytes = message.get(self.offset..)?;
        Some(match self.kind {
            Kind::U8 => u8::from_le_bytes(*bytes.first_chunk()?).into(),
            Kind::U16 => u16::from_le_bytes(*bytes.first_chunk()?).into(),
            Kind::U32 => u32::from_le_bytes(*bytes.first_chunk()?).into(),
            Kind::U64 => u64::from_le_bytes(*bytes.first_chunk()?) as f64,
            Kind::I8 => i8::from_le_bytes(*bytes.first_chunk()?).into(),
            Kind::I16 => i16::from_le_bytes(*bytes.first_chunk()?).into(),
            Kind::I32 => i32::from_le_bytes(*bytes.first_chunk()?).into(),
            Kind::I64 => i64::from_le_bytes(*bytes.first_chunk()?) as f64,
            Kind::F32 => f32::from_le_bytes(*bytes.first_chunk()?).into(),
            Kind::F64 => f64::from_le_bytes(*bytes.first_chunk()?),
        })
    }

    /// A time in µs, whole.
    pub(super) fn read_time(self, message: &[u8]) -> Option<i64> {
        let bytes = message.get(self.offset..)?.first_chunk()?;
        Some(u64::from_le_bytes(*bytes) as i64)
    }
}

impl Field {
    fn parse(text: &str) -> Option<Self> {
        let (kind, name) = text.split_once(char::is_whitespace)?;
        let (kind, count) = match kind.strip_suffix(']').and_then(|kind| kind.split_once('[')) {
            Some((kind, count)) => {
                (kind, Some(count.parse().ok().filter(|&count| count <= 1 << 16)?))
            }
            None => (kind, None),
        };
        let name = name.trim();
        (is_name(kind) && is_name(name)).then(|| Self {
            name: name.to_owned(),
            kind: kind.to_owned(),
            count,
        })
    }

    fn size(&self, formats: &Formats, depth: usize) -> Option<usize> {
        /// A format within itself has no length.
        const DEEPEST: usize = 16;
        let one = match self.kind.as_str() {
            "int8_t" | "uint8_t" | "bool" | "char" => 1,
            "int16_t" | "uint16_t" => 2,
            "int32_t" | "uint32_t" | "float" => 4,
            "int64_t" | "uint64_t" | "double" => 8,
            nested if depth < DEEPEST => {
                let fields = &formats.get(nested)?.fields;
                let sizes = fields.iter().map(|field| field.size(formats, depth + 1));
                sizes.sum::<Option<usize>>()?
            }
            _ => return None,
        };
        one.checked_mul(self.count.unwrap_or(1))
    }
}

fn is_name(text: &str) -> bool {
    text.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_')
        && text.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
}

#[cfg(test)]
mod tests {
    use super::{Format, Formats};

    #[test]
    fn lengths_texts_and_numbers() {
        let mut formats = Formats::new();
        for text in [
            "inner:uint16_t a;char[5] word;",
            "outer:bool on;uint64_t timestamp;inner[2] two;int8_t[2] t;uint8_t[3] _padding0;",
            "endless:uint64_t timestamp;endless again;",
        ] {
            let format = Format::parse(text.as_bytes()).unwrap();
            formats.insert(format.name.clone(), format);
        }
        let outer = &formats["outer"];
        assert_eq!(outer.lengths(&formats), Some((25, 28)));
        assert!(outer.time(&formats).is_some() && formats["inner"].time(&formats).is_none());
        let mut message = vec![3];
        message.extend(0x0102_0304_0506_0708_u64.to_le_bytes());
        message.extend(*b"\x01\x01word1\x02\x02word2\xff\x7f");
        assert_eq!(message.len(), 25);
        let read = |(name, number): (String, super::Number)| (name, number.read(&message).unwrap());
        let numbers: Vec<_> = outer.numbers(&formats).into_iter().map(read).collect();
        let named = |(name, number): (&str, f64)| (name.to_owned(), number);
        let expected = [
            ("on", 3.0),
            ("two[0].a", 257.0),
            ("two[1].a", 514.0),
            ("t[0]", -1.0),
            ("t[1]", 127.0),
        ];
        assert_eq!(numbers, expected.map(named));
        let time = outer.time(&formats).unwrap();
        assert_eq!(time.read_time(&message), Some(0x0102_0304_0506_0708));
        assert_eq!(formats["inner"].texts().count(), 1);
        assert_eq!(formats["endless"].lengths(&formats), None);
        for bad in [&b"x"[..], b"x:float", b"x:float\xff a;", b"x:float[q] a;", b"1x:float a;"] {
            assert_eq!(Format::parse(bad), None, "{bad:?}");
        }
    }
}
