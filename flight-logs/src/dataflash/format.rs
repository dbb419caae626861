//! Formats of `ArduPilot`'s messages. Each `FMT` message defines the name of a message type, its columns, and a letter
//! for each column's type.

use crate::definition::{Definition, Field, Kind, Number, Shape};
use crate::topic::Topic;
use crate::wire::Wire;
use std::collections::HashMap;

/// Type of `FMT` messages, whose own format is fixed.
pub(crate) const FMT: u8 = 0x80;

/// The message formats defined so far in a log, and the topics of its messages.
#[derive(Default)]
pub(crate) struct Formats {
    of_type: HashMap<u8, Format>,
    by_name: HashMap<String, u8>,
    pub topics: Vec<Topic>,
}

/// The format of a message type.
pub(crate) struct Format {
    name: String,
    /// Length of a message in bytes, including its header of three bytes.
    pub length: usize,
    /// The columns in order, or the reason that the messages cannot be read.
    pub columns: Result<Vec<Column>, String>,
    /// Index of the column that holds the instance number, such as the number of the sensor. Each instance has a topic
    /// of its own.
    pub instance: Option<usize>,
    /// Index of the column with the time, and the length of the column's time unit in ns.
    pub time: Option<(usize, i64)>,
    /// Index in [`Formats::topics`] of each instance's topic.
    topics: HashMap<i64, usize>,
}

/// A column of a message.
pub(crate) struct Column {
    pub name: String,
    pub letter: Letter,
}

/// Type of a column. `FMT` messages write the type as a letter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Letter {
    /// A number, stored without a scale factor.
    Number(Number),
    /// A half-precision float, two bytes.
    Half,
    /// A fixed-point number: an integer that is to be divided by this factor, 100 or 10 million.
    Scaled(Number, u32),
    /// A text, padded with NUL to this number of bytes.
    Text(usize),
    /// An array of 32 `i16`.
    Array,
    /// A flight mode: a number in a binary log, a name in a text log.
    Mode,
}

impl Letter {
    fn of(letter: char) -> Option<Self> {
        Some(match letter {
            'a' => Self::Array,
            'b' => Self::Number(Number::I8),
            'B' => Self::Number(Number::U8),
            'g' => Self::Half,
            'h' => Self::Number(Number::I16),
            'H' => Self::Number(Number::U16),
            'i' => Self::Number(Number::I32),
            'I' => Self::Number(Number::U32),
            'f' => Self::Number(Number::F32),
            'd' => Self::Number(Number::F64),
            'q' => Self::Number(Number::I64),
            'Q' => Self::Number(Number::U64),
            'c' => Self::Scaled(Number::I16, 100),
            'C' => Self::Scaled(Number::U16, 100),
            'e' => Self::Scaled(Number::I32, 100),
            'E' => Self::Scaled(Number::U32, 100),
            'L' => Self::Scaled(Number::I32, 10_000_000),
            'M' => Self::Mode,
            'n' => Self::Text(4),
            'N' => Self::Text(16),
            'Z' => Self::Text(64),
            _ => return None,
        })
    }

    /// Returns the size of a column in a binary message, in bytes.
    pub(crate) fn size(self) -> usize {
        match self {
            Self::Number(number) | Self::Scaled(number, _) => number.size(),
            Self::Half => 2,
            Self::Text(size) => size,
            Self::Array => 64,
            Self::Mode => 1,
        }
    }
}

impl Format {
    /// Creates a format from the values of an `FMT` message. `letters` has one letter for each column, which gives the
    /// column's type. `columns` has the names of the columns, separated by commas.
    pub(crate) fn new(name: &str, length: usize, letters: &str, columns: &str) -> Self {
        let columns = self::columns(length, letters, columns);
        let time = columns.as_ref().ok().and_then(|columns| time(name, columns));
        let name = name.to_owned();
        Self { name, length, columns, instance: None, time, topics: HashMap::new() }
    }

    /// Returns the definition of this format's messages, as the reader converts them. In a binary log, fixed-point
    /// numbers and half-precision floats become `f64`. Set `is_text` for a text log, in which all numbers become `f64`.
    fn definition(&self, is_text: bool) -> Result<Definition, String> {
        let columns = self.columns.as_ref().map_err(Clone::clone)?;
        let field = |column: &Column| {
            let (kind, shape) = match column.letter {
                Letter::Text(_) => (Kind::Text, Shape::One),
                Letter::Mode | Letter::Array if is_text => (Kind::Text, Shape::One),
                _ if is_text => (Kind::Number(Number::F64), Shape::One),
                Letter::Number(number) if column.name.is_empty() => {
                    (Kind::Hidden(number), Shape::One)
                }
                Letter::Number(number) => (Kind::Number(number), Shape::One),
                Letter::Half | Letter::Scaled(..) => (Kind::Number(Number::F64), Shape::One),
                Letter::Mode => (Kind::Number(Number::I8), Shape::One),
                Letter::Array => (Kind::Number(Number::I16), Shape::Fixed(32)),
            };
            Field { name: column.name.clone(), kind, shape }
        };
        Ok(Definition::of_fields(columns.iter().map(field).collect()))
    }
}

/// Parses the columns of a message format. `letters` has a letter for the type of each column; `names` has the names,
/// separated by commas.
///
/// # Errors
/// Returns the reason if a letter is unknown, or if `length` is not the total size of header and columns in bytes.
fn columns(length: usize, letters: &str, names: &str) -> Result<Vec<Column>, String> {
    const HEAD: usize = 3;
    let mut names = names.split(',').map(str::trim);
    let mut columns = Vec::new();
    for letter in letters.chars() {
        let letter =
            Letter::of(letter).ok_or_else(|| format!("format letter `{letter}` is not known"))?;
        // A column without a name cannot be selected.
        columns.push(Column { name: names.next().unwrap_or_default().to_owned(), letter });
    }
    let sum = HEAD + columns.iter().map(|column| column.letter.size()).sum::<usize>();
    if sum == length {
        Ok(columns)
    } else {
        Err(format!("letters `{letters}` are {sum} bytes, the definition says {length}"))
    }
}

/// Returns the index of the column with the time since boot, and the length of the column's time unit in ns. This
/// column is the first one if its name is `TimeUS` or `TimeMS`. In other `GPS` and `GPS2` messages, it is the column
/// `T`; a later column `TimeMS` has the satellites' time there. In messages `TIME` of sdlog2, it is `StartTime`. Returns `None` if there is no column with the time.
fn time(name: &str, columns: &[Column]) -> Option<(usize, i64)> {
    const MICROSECOND: i64 = 1_000;
    const MILLISECOND: i64 = 1_000_000;
    match columns.first()?.name.as_str() {
        "TimeUS" => Some((0, MICROSECOND)),
        "TimeMS" => Some((0, MILLISECOND)),
        // The logger sdlog2 of early PX4 writes the time as a message of its own.
        "StartTime" if name == "TIME" => Some((0, MICROSECOND)),
        _ if matches!(name, "GPS" | "GPS2") => {
            let index = columns.iter().position(|column| column.name == "T")?;
            Some((index, MILLISECOND))
        }
        _ => None,
    }
}

impl Formats {
    /// Returns the formats that are known before any message is read: only that of `FMT` messages.
    pub(crate) fn new() -> Self {
        let mut formats = Self::default();
        let columns = "Type,Length,Name,Format,Columns";
        formats.define(FMT, Format::new("FMT", 89, "BBnNZ", columns));
        formats
    }

    pub(crate) fn get(&self, kind: u8) -> Option<&Format> {
        self.of_type.get(&kind)
    }

    /// Returns the number of the message type called `name`, if such a type is defined.
    pub(crate) fn named(&self, name: &str) -> Option<u8> {
        self.by_name.get(name).copied()
    }

    /// Defines or replaces the format of the message type `kind`. If the old format has the same name, its instance
    /// column is kept.
    pub(crate) fn define(&mut self, kind: u8, mut format: Format) {
        let before = self.of_type.get(&kind).filter(|before| before.name == format.name);
        format.instance = before.and_then(|before| before.instance);
        self.by_name.insert(format.name.clone(), kind);
        self.of_type.insert(kind, format);
    }

    /// Sets the units of a message type's columns. `units` has a letter for each column. The letter `#` marks the
    /// instance column.
    pub(crate) fn units(&mut self, kind: u8, units: &str) {
        let Some(format) = self.of_type.get_mut(&kind) else { return };
        let count = format.columns.as_ref().map_or(0, Vec::len);
        format.instance = units.find('#').filter(|index| *index < count);
        format.topics.clear();
    }

    /// Returns the index of the topic for messages of type `kind` from the sensor with number `instance`; adds the
    /// topic if it is new. For example, the topic of instance 0 is `IMU`, and that of instance 1 is `IMU:1`. Returns
    /// `None` if the type is not defined.
    pub(crate) fn topic(&mut self, kind: u8, instance: i64, is_text: bool) -> Option<usize> {
        let format = self.of_type.get_mut(&kind)?;
        if let Some(&known) = format.topics.get(&instance) {
            return Some(known);
        }
        let name = match instance {
            0 => format.name.clone(),
            instance => format!("{}:{instance}", format.name),
        };
        let definition = format.definition(is_text);
        let topic = Topic { name, kind: String::new(), wire: Wire::Ros1, definition };
        let index = topic.index_in(&mut self.topics);
        format.topics.insert(instance, index);
        Some(index)
    }
}
