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
    /// From the text of a definition; `None` if it is no text or not of this form.
    pub(super) fn parse(message: &[u8]) -> Option<Self> {
        let (name, fields) = str::from_utf8(message).ok()?.split_once(':')?;
        let fields = fields.split(';').map(str::trim).filter(|field| !field.is_empty());
        let fields = fields.map(Field::parse).collect::<Option<_>>()?;
        is_name(name).then(|| Self { name: name.to_owned(), fields })
    }

    /// The definition again, with booleans as the bytes that they are: they may hold more than 0 and 1.
    pub(super) fn text(&self) -> String {
        let fields = self.fields.iter().map(|Field { name, kind, count }| {
            let kind = if kind == "bool" { "uint8_t" } else { kind };
            let count = count.map_or(String::new(), |count| format!("[{count}]"));
            format!("{kind}{count} {name};")
        });
        format!("{}:{}", self.name, fields.collect::<String>())
    }

    /// Whether messages say when they were logged.
    pub(super) fn is_timed(&self) -> bool {
        self.fields.iter().any(|field| {
            field.name == "timestamp" && field.kind == "uint64_t" && field.count.is_none()
        })
    }

    /// How long a message is: without the padding at its end, which is not logged, and with it.
    pub(super) fn lengths(&self, formats: &Formats) -> Option<(usize, usize)> {
        /// No message is longer.
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
    fn lengths_texts_and_booleans() {
        let mut formats = Formats::new();
        for text in [
            "inner:uint16_t a;char[5] word;",
            "outer:uint64_t timestamp;bool on;inner[2] two;uint8_t[3] _padding0;",
            "endless:uint64_t timestamp;endless again;",
        ] {
            let format = Format::parse(text.as_bytes()).unwrap();
            formats.insert(format.name.clone(), format);
        }
        let outer = &formats["outer"];
        assert_eq!(outer.lengths(&formats), Some((23, 26)));
        assert!(outer.is_timed() && !formats["inner"].is_timed());
        assert!(outer.text().contains("uint8_t on;inner[2] two;"), "{}", outer.text());
        assert_eq!(formats["inner"].texts().count(), 1);
        assert_eq!(formats["endless"].lengths(&formats), None);
        for bad in [&b"x"[..], b"x:float", b"x:float\xff a;", b"x:float[q] a;", b"1x:float a;"] {
            assert_eq!(Format::parse(bad), None, "{bad:?}");
        }
    }
}
