//! Decodes the fields of messages in ROS 1's serialization, and in CDR, the serialization of ROS 2.

use super::definition::{Definition, Kind, Number, Path, Shape, Step, Struct};
use std::fmt;

/// Encoding of a message's bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wire {
    /// ROS 1's serialization: the fields one after the other, little-endian, without gaps. Readers of other formats
    /// convert their messages to this encoding.
    Ros1,
    /// CDR, the serialization of ROS 2: four bytes that give the byte order, followed by the fields. Numbers are
    /// aligned to their size.
    Cdr,
}

/// Reason that a field of a message cannot be decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The message ends before the field, or within it.
    Short,
    /// The message has another encoding than plain CDR, the only supported encoding of ROS 2. The value is the
    /// message's first two bytes, which identify the encoding.
    Encapsulation(u16),
    /// A field before this one is a wide text, whose length depends on the writer.
    WideText,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Short => f.write_str("the message is shorter than its definition"),
            Self::Encapsulation(kind) => write!(f, "encapsulation {kind:#06x} is not plain CDR"),
            Self::WideText => f.write_str("wide text stands before the field"),
        }
    }
}

/// Returns the number at a path in a message; `None` if the path leads beyond the end of an array.
pub(crate) fn number(
    wire: Wire,
    definition: &Definition,
    path: &Path,
    message: &[u8],
) -> Result<Option<f64>, Fault> {
    let mut input = Input::new(wire, message)?;
    match input.go(definition, path)? {
        Some(Kind::Number(kind) | Kind::Hidden(kind)) => input.number(kind).map(Some),
        _ => Ok(None),
    }
}

/// Returns whether a message has more bytes than the fields of its definition. In CDR, the encoding of ROS 2, up to
/// three bytes of padding are allowed after the fields.
pub(crate) fn is_longer(wire: Wire, definition: &Definition, message: &[u8]) -> bool {
    let filling = if wire == Wire::Cdr { 3 } else { 0 };
    length(wire, definition, message).is_ok_and(|length| length + filling < message.len())
}

/// Returns the number of bytes that the fields of `definition` take in a message.
pub(crate) fn length(wire: Wire, definition: &Definition, message: &[u8]) -> Result<usize, Fault> {
    let mut input = Input::new(wire, message)?;
    input.skip_struct(definition, definition.root())?;
    Ok(message.len() - input.bytes.len() + input.at)
}

/// Returns the text at a path in a message; `None` if the path does not lead to a text, or the message is too short.
pub(crate) fn text(
    wire: Wire,
    definition: &Definition,
    path: &Path,
    message: &[u8],
) -> Option<String> {
    let mut input = Input::new(wire, message).ok()?;
    if input.go(definition, path).ok()?? != Kind::Text {
        return None;
    }
    let length = input.count().ok()?;
    let start = input.at;
    input.skip(length).ok()?;
    let text = String::from_utf8_lossy(&input.bytes[start..input.at]);
    // In CDR, the length of a text includes its NUL.
    Some(text.trim_end_matches('\0').to_owned())
}

/// The bytes of a message, and the position of the next byte to decode.
struct Input<'a> {
    bytes: &'a [u8],
    at: usize,
    is_big: bool,
    is_aligned: bool,
}

impl<'a> Input<'a> {
    fn new(wire: Wire, message: &'a [u8]) -> Result<Self, Fault> {
        if wire == Wire::Ros1 {
            return Ok(Self { bytes: message, at: 0, is_big: false, is_aligned: false });
        }
        let (head, bytes) = message.split_first_chunk::<4>().ok_or(Fault::Short)?;
        match u16::from_be_bytes([head[0], head[1]]) {
            kind @ 0..=1 => Ok(Self { bytes, at: 0, is_big: kind == 0, is_aligned: true }),
            other => Err(Fault::Encapsulation(other)),
        }
    }

    /// Moves to the field at a path; returns its type, or `None` if the path leads beyond the end of an array.
    fn go(&mut self, definition: &Definition, path: &Path) -> Result<Option<Kind>, Fault> {
        let mut within = definition.root();
        let mut steps = path.0.iter().peekable();
        let mut found = None;
        while let Some(Step::Field(index)) = steps.next() {
            for before in within.fields.iter().take(*index) {
                self.skip_field(definition, before.kind, before.shape)?;
            }
            let Some(field) = within.fields.get(*index) else { return Ok(None) };
            if let Some(Step::Item(item)) = steps.next_if(|step| matches!(step, Step::Item(_))) {
                let count = match field.shape {
                    Shape::Counted => self.count()?,
                    Shape::Fixed(count) => count,
                    Shape::One => 1,
                };
                if *item >= count {
                    return Ok(None);
                }
                self.skip_many(definition, field.kind, *item)?;
            }
            if let Kind::Nested(index) = field.kind {
                within = definition.nested(index);
            }
            found = Some(field.kind);
        }
        Ok(found)
    }

    fn align(&mut self, size: usize) {
        if self.is_aligned {
            self.at = self.at.next_multiple_of(size);
        }
    }

    fn skip(&mut self, count: usize) -> Result<(), Fault> {
        self.at =
            self.at.checked_add(count).filter(|at| *at <= self.bytes.len()).ok_or(Fault::Short)?;
        Ok(())
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        self.align(N);
        let start = self.at;
        self.skip(N)?;
        let mut bytes = *self.bytes[start..].first_chunk().ok_or(Fault::Short)?;
        if self.is_big {
            bytes.reverse();
        }
        Ok(bytes)
    }

    fn count(&mut self) -> Result<usize, Fault> {
        Ok(u32::from_le_bytes(self.take()?) as usize)
    }

    fn number(&mut self, kind: Number) -> Result<f64, Fault> {
        Ok(match kind {
            Number::Bool | Number::U8 => u8::from_le_bytes(self.take()?).into(),
            Number::I8 => i8::from_le_bytes(self.take()?).into(),
            Number::I16 => i16::from_le_bytes(self.take()?).into(),
            Number::U16 => u16::from_le_bytes(self.take()?).into(),
            Number::I32 => i32::from_le_bytes(self.take()?).into(),
            Number::U32 => u32::from_le_bytes(self.take()?).into(),
            Number::I64 => i64::from_le_bytes(self.take()?) as f64,
            Number::U64 => u64::from_le_bytes(self.take()?) as f64,
            Number::F32 => f32::from_le_bytes(self.take()?).into(),
            Number::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    fn skip_field(
        &mut self,
        definition: &Definition,
        kind: Kind,
        shape: Shape,
    ) -> Result<(), Fault> {
        let count = match shape {
            Shape::One => 1,
            Shape::Fixed(count) => count,
            Shape::Counted => self.count()?,
        };
        self.skip_many(definition, kind, count)
    }

    fn skip_many(
        &mut self,
        definition: &Definition,
        kind: Kind,
        count: usize,
    ) -> Result<(), Fault> {
        if count == 0 {
            return Ok(());
        }
        match kind {
            Kind::Number(number) | Kind::Hidden(number) => {
                let size = number.size();
                self.align(size);
                self.skip(size.checked_mul(count).ok_or(Fault::Short)?)
            }
            Kind::Character => self.skip(count),
            Kind::Text => (0..count).try_for_each(|_| {
                let length = self.count()?;
                self.skip(length)
            }),
            Kind::WideText => Err(Fault::WideText),
            Kind::Nested(index) => {
                let nested = definition.nested(index);
                for _ in 0..count {
                    let before = self.at;
                    self.skip_struct(definition, nested)?;
                    // If one item takes no bytes, none does: skipping them one by one could take for ever.
                    if self.at == before {
                        break;
                    }
                }
                Ok(())
            }
        }
    }

    fn skip_struct(&mut self, definition: &Definition, within: &Struct) -> Result<(), Fault> {
        // In CDR, a message without fields takes one byte.
        if within.fields.is_empty() && self.is_aligned {
            return self.skip(1);
        }
        within
            .fields
            .iter()
            .try_for_each(|field| self.skip_field(definition, field.kind, field.shape))
    }
}

#[cfg(test)]
mod tests {
    use super::super::definition::Dialect;
    use super::{Definition, Fault, Wire, is_longer, number};

    const TEXT: &str = "uint8 a\nfloat64 b\nstring word\nint16[] list\nInner[2] two\n\
        ====\nMSG: t/Inner\nint8 small\nint32 large\n";

    /// Serializes the values 7, 1.5, "ab", [1, -2], (3, 4), (5, 6) for ROS 1, and as CDR. Reads the same numbers from
    /// both messages.
    #[test]
    fn both_ways_give_the_same_numbers() {
        let one = Definition::parse("t/T", TEXT, Dialect::Ros1).unwrap();
        let mut ros1 = vec![7];
        ros1.extend(1.5_f64.to_le_bytes());
        ros1.extend(*b"\x02\0\0\0ab\x02\0\0\0\x01\0\xfe\xff");
        ros1.extend(*b"\x03\x04\0\0\0\x05\x06\0\0\0");
        let mut cdr = vec![0, 1, 0, 0, 7, 0, 0, 0, 0, 0, 0, 0];
        cdr.extend(1.5_f64.to_le_bytes());
        cdr.extend(*b"\x03\0\0\0ab\0\0\x02\0\0\0\x01\0\xfe\xff");
        cdr.extend(*b"\x03\0\0\0\x04\0\0\0\x05\0\0\0\x06\0\0\0");
        for (name, value) in [
            ("a", Some(7.0)),
            ("b", Some(1.5)),
            ("list[1]", Some(-2.0)),
            ("list[2]", None),
            ("two[1].small", Some(5.0)),
            ("two[1].large", Some(6.0)),
        ] {
            let path = one.number(name).unwrap();
            assert_eq!(number(Wire::Ros1, &one, &path, &ros1), Ok(value), "{name}");
            assert_eq!(number(Wire::Cdr, &one, &path, &cdr), Ok(value), "{name} of CDR");
        }
        let path = one.number("two[1].large").unwrap();
        for length in 0..ros1.len() {
            assert_eq!(number(Wire::Ros1, &one, &path, &ros1[..length]), Err(Fault::Short));
        }
        for filling in 0..6 {
            ros1.push(0);
            assert!(is_longer(Wire::Ros1, &one, &ros1));
            assert_eq!(is_longer(Wire::Cdr, &one, &cdr), filling > 3);
            cdr.push(0);
        }
        cdr[1] = 7;
        assert_eq!(number(Wire::Cdr, &one, &path, &cdr), Err(Fault::Encapsulation(7)));
    }
}
