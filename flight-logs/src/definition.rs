//! Layouts of messages, parsed from the message definitions in a log, and paths to the numbers and texts in a message.
//!
//! A definition has a line `type name` for each field. In ROS, the definitions of nested messages follow, each after a
//! line `MSG: package/Type`.

use super::known::known;
use std::collections::HashMap;

/// Layout of a message and of the messages nested in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Definition {
    /// Layout of the message itself, followed by the layouts of nested messages.
    structs: Vec<Struct>,
}

/// Layout of one message: its fields.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Struct {
    /// Fields, in the order of their bytes.
    pub fields: Vec<Field>,
}

/// A field of a message.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Name of the field, unique in its message.
    pub name: String,
    /// Type of the field's value, or of each item if the field is an array.
    pub kind: Kind,
    /// Whether the field is a single value or an array.
    pub shape: Shape,
}

/// Type of a field's value, or of each item of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A number.
    Number(Number),
    /// A number that cannot be selected by name, such as PX4's time stamp or padding.
    Hidden(Number),
    /// A text of UTF-8, preceded by its length.
    Text,
    /// A character in a text of fixed length. The text is an array of this type.
    Character,
    /// A text with 2 or 4 bytes for each character. The definition does not tell the number of bytes, so the fields
    /// after the text cannot be read.
    WideText,
    /// A nested message. [`Definition::nested`] returns its layout for this index.
    Nested(usize),
}

/// Type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Number {
    /// Boolean: one byte, 0 or 1.
    Bool,
    /// One byte, signed.
    I8,
    /// One byte, unsigned.
    U8,
    /// Two bytes, signed.
    I16,
    /// Two bytes, unsigned.
    U16,
    /// Four bytes, signed.
    I32,
    /// Four bytes, unsigned.
    U32,
    /// Eight bytes, signed.
    I64,
    /// Eight bytes, unsigned.
    U64,
    /// A float of four bytes.
    F32,
    /// A float of eight bytes.
    F64,
}

impl Number {
    /// Returns the size of the number in bytes.
    pub fn size(self) -> usize {
        match self {
            Self::Bool | Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }
}

/// Whether a field is a single value or an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A single value.
    One,
    /// An array with this number of items.
    Fixed(usize),
    /// An array whose number of items is stored in the message.
    Counted,
}

/// Language in which a definition is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dialect {
    /// Message definitions of ROS 1, `.msg`.
    Ros1,
    /// Message definitions of ROS 2, `.msg`.
    Ros2,
    /// Format definitions in a PX4 log, such as `float[3] gyro_rad`.
    Px4,
}

/// Path from a message to a number or text in it, through fields and array items.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Path(pub Vec<Step>);

/// One step of a [`Path`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Step from a message to its field with this index.
    Field(usize),
    /// Step from an array to its item with this index.
    Item(usize),
}

/// Reason that a name does not select a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoNumber {
    /// No field has this name.
    Missing,
    /// The name selects a text.
    Text,
    /// The name selects a message or an array, and therefore several numbers.
    Several,
}

/// Paths to the two numbers that make up a time stamp.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stamp {
    /// Path to the seconds.
    pub seconds: Path,
    /// Path to the nanoseconds.
    pub nanoseconds: Path,
}

/// Maximum depth of nested messages.
const DEEPEST: usize = 16;
/// Maximum number of items in an array of fixed length; a definition with more is refused.
const LONGEST: usize = 1 << 28;
/// Name of the field with the time at which PX4 logged a message.
const TIME: &str = "timestamp";
/// Start of the names of padding fields in PX4 logs.
const PADDING: &str = "_padding";

impl Definition {
    /// Parses the text of a definition in a log; `name` is the message's type, such as `sensor_msgs/Imu`.
    ///
    /// # Errors
    /// Returns the reason if a line or a nested type cannot be understood, or if a message contains itself.
    pub fn parse(name: &str, text: &str, dialect: Dialect) -> Result<Self, String> {
        let mut texts = HashMap::new();
        let mut main = String::new();
        let mut current: Option<String> = None;
        for line in text.lines() {
            if line.starts_with("====") {
                continue;
            }
            if let Some(next) = line.trim().strip_prefix("MSG:") {
                current = Some(short(next.trim()));
                continue;
            }
            let text = match &current {
                None => &mut main,
                Some(name) => texts.entry(name.clone()).or_default(),
            };
            text.push_str(line);
            text.push('\n');
        }
        let name = short(name);
        texts.entry(name.clone()).or_insert(main);
        Parser::parse(&name, &|name| texts.get(name).cloned(), dialect)
    }

    /// Creates the layout of a ROS 2 message. `look_up` returns the text of the definition of a type `package/Type`.
    /// `look_up` must know the message's type, and the types of nested messages.
    ///
    /// # Errors
    /// Returns the reason if a line or a nested type cannot be understood, or if a message contains itself.
    pub fn of_ros2(name: &str, look_up: &LookUp) -> Result<Self, String> {
        Parser::parse(&short(name), look_up, Dialect::Ros2)
    }

    /// Creates the layout of a message in a PX4 log. `texts` has the definitions in the log by name, with a line for
    /// each field.
    ///
    /// # Errors
    /// Returns the reason if a line or a nested type cannot be understood, or if a message contains itself.
    pub fn of_px4(name: &str, texts: &HashMap<String, String>) -> Result<Self, String> {
        Parser::parse(name, &|name| texts.get(name).cloned(), Dialect::Px4)
    }

    /// Creates the layout of a message with these fields, which must not contain nested messages.
    pub(crate) fn of_fields(fields: Vec<Field>) -> Self {
        Self { structs: vec![Struct { fields }] }
    }

    /// Returns the path to PX4's field `timestamp`, the time at which a message was logged, in µs; `None` if there is
    /// no such field.
    pub fn time(&self) -> Option<Path> {
        let is_time = |field: &Field| {
            let is_one = (field.kind, field.shape) == (Kind::Hidden(Number::U64), Shape::One);
            field.name == TIME && is_one
        };
        let index = self.root().fields.iter().position(is_time)?;
        Some(Path(vec![Step::Field(index)]))
    }

    /// Returns the number of padding bytes at the end of a PX4 message. Loggers usually leave these bytes out.
    pub fn padding(&self) -> usize {
        let fields = self.root().fields.iter().rev();
        let padding = fields.take_while(|field| field.name.starts_with(PADDING));
        let size = |field: &Field| match (field.kind, field.shape) {
            (Kind::Hidden(number), Shape::Fixed(count)) => number.size() * count,
            (Kind::Hidden(number), _) => number.size(),
            _ => 0,
        };
        padding.map(size).sum()
    }

    /// Returns the layout of the message itself, without the layouts of nested messages.
    pub fn root(&self) -> &Struct {
        self.structs.first().unwrap_or(const { &Struct { fields: Vec::new() } })
    }

    /// Returns the layout of a nested message; `index` is the one in [`Kind::Nested`].
    pub fn nested(&self, index: usize) -> &Struct {
        self.structs.get(index).unwrap_or(const { &Struct { fields: Vec::new() } })
    }

    /// Returns the path to a number, selected by a name such as `angular_velocity.x` or `ranges[5]`.
    ///
    /// # Errors
    /// Returns the reason if the name does not select a number.
    pub fn number(&self, asked: &str) -> Result<Path, NoNumber> {
        match self.find(asked)? {
            (path, Kind::Number(_)) => Ok(path),
            (_, Kind::Text | Kind::WideText | Kind::Character) => Err(NoNumber::Text),
            (_, Kind::Nested(_)) => Err(NoNumber::Several),
            (_, Kind::Hidden(_)) => Err(NoNumber::Missing),
        }
    }

    /// Returns the path to a text, selected by a name such as `header.frame_id`; `None` if the name does not select a
    /// text.
    pub fn text(&self, asked: &str) -> Option<Path> {
        self.find(asked).ok().filter(|(_, kind)| *kind == Kind::Text).map(|(path, _)| path)
    }

    /// Finds a time stamp by a name such as `header.stamp`; returns the paths to its seconds and nanoseconds. Returns
    /// `None` if the name does not select a time stamp.
    pub fn stamp(&self, asked: &str) -> Option<Stamp> {
        let Ok((path, Kind::Nested(index))) = self.find(asked) else { return None };
        let [seconds, nanoseconds] = &self.nested(index).fields[..] else { return None };
        let is_stamp = matches!(
            (seconds.name.as_str(), nanoseconds.name.as_str()),
            ("secs", "nsecs") | ("sec", "nanosec")
        );
        let within = |field| Path(path.0.iter().copied().chain([Step::Field(field)]).collect());
        is_stamp.then(|| Stamp { seconds: within(0), nanoseconds: within(1) })
    }

    fn find(&self, asked: &str) -> Result<(Path, Kind), NoNumber> {
        let mut path = Path::default();
        let mut within = self.root();
        let mut parts = asked.split('.').peekable();
        while let Some(part) = parts.next() {
            let (name, item) = match part.strip_suffix(']').and_then(|part| part.split_once('[')) {
                Some((name, item)) => (name, Some(item.parse().map_err(|_| NoNumber::Missing)?)),
                None => (part, None),
            };
            let index = within.fields.iter().position(|field| field.name == name);
            let index = index.ok_or(NoNumber::Missing)?;
            let field = &within.fields[index];
            path.0.push(Step::Field(index));
            match (field.shape, item) {
                (Shape::One, None) => {}
                (Shape::Fixed(count), Some(item)) if item < count => path.0.push(Step::Item(item)),
                (Shape::Counted, Some(item)) => path.0.push(Step::Item(item)),
                (Shape::One, Some(_)) if field.kind == Kind::Text => return Err(NoNumber::Text),
                (_, None) if field.kind == Kind::Character => return Err(NoNumber::Text),
                (Shape::Fixed(_) | Shape::Counted, None) => return Err(NoNumber::Several),
                (Shape::One | Shape::Fixed(_), Some(_)) => return Err(NoNumber::Missing),
            }
            match (field.kind, parts.peek()) {
                (kind, None) => return Ok((path, kind)),
                (Kind::Nested(index), Some(_)) => within = self.nested(index),
                (_, Some(_)) => return Err(NoNumber::Missing),
            }
        }
        Err(NoNumber::Missing)
    }

    /// Returns the names of all numbers, and the names of all texts. An array of 9 items is named `name[0..9]`; an
    /// array of variable length is named `name[]`.
    pub fn names(&self) -> (Vec<String>, Vec<String>) {
        let (mut numbers, mut texts) = (Vec::new(), Vec::new());
        self.add_names(self.root(), "", &mut numbers, &mut texts);
        (numbers, texts)
    }

    fn add_names(
        &self,
        within: &Struct,
        prefix: &str,
        numbers: &mut Vec<String>,
        texts: &mut Vec<String>,
    ) {
        for field in &within.fields {
            let name = match field.shape {
                Shape::One => format!("{prefix}{}", field.name),
                Shape::Fixed(count) => format!("{prefix}{}[0..{count}]", field.name),
                Shape::Counted => format!("{prefix}{}[]", field.name),
            };
            match field.kind {
                Kind::Number(_) => numbers.push(name),
                Kind::Hidden(_) => {}
                Kind::Text | Kind::WideText => texts.push(name),
                Kind::Character => texts.push(format!("{prefix}{}", field.name)),
                Kind::Nested(index) => {
                    self.add_names(self.nested(index), &format!("{name}."), numbers, texts);
                }
            }
        }
    }
}

/// Shortens the name of a type from `package/msg/Type` to `package/Type`.
pub(crate) fn short(name: &str) -> String {
    name.replacen("/msg/", "/", 1)
}

/// Function that returns the text of a message type's definition, or `None` if the type is unknown.
type LookUp<'a> = dyn Fn(&str) -> Option<String> + 'a;

struct Parser<'a> {
    look_up: &'a LookUp<'a>,
    dialect: Dialect,
    structs: Vec<Struct>,
    indices: HashMap<String, usize>,
}

impl<'a> Parser<'a> {
    fn parse(name: &str, look_up: &'a LookUp<'a>, dialect: Dialect) -> Result<Definition, String> {
        let mut parser = Self { look_up, dialect, structs: Vec::new(), indices: HashMap::new() };
        parser.add(name, 0)?;
        Ok(Definition { structs: parser.structs })
    }

    /// Returns the index in `structs` of the layout of the message type `name`. The first call for a type parses its
    /// definition.
    fn add(&mut self, name: &str, depth: usize) -> Result<usize, String> {
        if depth > DEEPEST {
            return Err(format!("{name} is nested too deeply, perhaps within itself"));
        }
        if let Some(&index) = self.indices.get(name) {
            // A message whose definition is being parsed contains itself.
            return if index == usize::MAX {
                Err(format!("{name} holds itself"))
            } else {
                Ok(index)
            };
        }
        let text = (self.look_up)(name)
            .or_else(|| built_in(name, self.dialect).map(str::to_owned))
            .or_else(|| known(name).filter(|_| self.dialect == Dialect::Ros2))
            .ok_or_else(|| format!("there is no definition of {name}"))?;
        self.indices.insert(name.to_owned(), usize::MAX);
        let index = self.structs.len();
        self.structs.push(Struct::default());
        let mut fields = Vec::new();
        for line in text.lines() {
            if let Some((kind, name_of_field)) = declared(line) {
                fields.push(self.field(name, kind, name_of_field, depth)?);
            }
        }
        self.structs[index].fields = fields;
        self.indices.insert(name.to_owned(), index);
        Ok(index)
    }

    fn field(&mut self, of: &str, kind: &str, name: &str, depth: usize) -> Result<Field, String> {
        let not_understood = || format!("`{kind} {name}` is not understood");
        let (base, shape) = match kind.strip_suffix(']').and_then(|kind| kind.split_once('[')) {
            None => (kind, Shape::One),
            Some((base, "")) => (base, Shape::Counted),
            Some((base, bound)) if bound.starts_with("<=") => (base, Shape::Counted),
            Some((base, count)) => {
                let count = count.parse().ok().filter(|&count: &usize| count <= LONGEST);
                (base, Shape::Fixed(count.ok_or_else(not_understood)?))
            }
        };
        let base = base.split("<=").next().unwrap_or(base);
        let kind = match base {
            "bool" => Kind::Number(Number::Bool),
            "byte" if self.dialect == Dialect::Ros1 => Kind::Number(Number::I8),
            "int8" | "int8_t" => Kind::Number(Number::I8),
            "char" if self.dialect == Dialect::Px4 => Kind::Character,
            "uint8" | "uint8_t" | "char" | "byte" => Kind::Number(Number::U8),
            "int16" | "int16_t" => Kind::Number(Number::I16),
            "uint16" | "uint16_t" => Kind::Number(Number::U16),
            "int32" | "int32_t" => Kind::Number(Number::I32),
            "uint32" | "uint32_t" => Kind::Number(Number::U32),
            "int64" | "int64_t" => Kind::Number(Number::I64),
            "uint64" | "uint64_t" => Kind::Number(Number::U64),
            "float32" | "float" => Kind::Number(Number::F32),
            "float64" | "double" => Kind::Number(Number::F64),
            "string" => Kind::Text,
            "wstring" => Kind::WideText,
            "time" | "duration" if self.dialect == Dialect::Ros1 => {
                Kind::Nested(self.add(base, depth + 1)?)
            }
            "Header" => Kind::Nested(self.add("std_msgs/Header", depth + 1)?),
            nested => {
                let is_name = |byte: u8| byte.is_ascii_alphanumeric() || b"_/".contains(&byte);
                if nested.is_empty() || !nested.bytes().all(is_name) {
                    return Err(not_understood());
                }
                let nested = if nested.contains('/') || self.dialect == Dialect::Px4 {
                    short(nested)
                } else {
                    let package = of.split_once('/').map_or("", |(package, _)| package);
                    format!("{package}/{nested}")
                };
                Kind::Nested(self.add(&nested, depth + 1)?)
            }
        };
        let is_time = depth == 0 && name == TIME;
        let kind = match kind {
            Kind::Number(number)
                if self.dialect == Dialect::Px4 && (is_time || name.starts_with(PADDING)) =>
            {
                Kind::Hidden(number)
            }
            kind => kind,
        };
        Ok(Field { name: name.to_owned(), kind, shape })
    }
}

/// Returns type and name of the field that a line declares; `None` for a constant or a comment.
pub(crate) fn declared(line: &str) -> Option<(&str, &str)> {
    let line = line.split('#').next().unwrap_or(line).trim();
    let (kind, rest) = line.split_once(char::is_whitespace)?;
    let rest = rest.trim_start();
    // A blank and a default value may follow a field's name; `=` and a value follow a constant's.
    let name = rest.split(|c: char| c.is_whitespace() || c == '=').next()?;
    let behind = rest.get(name.len()..)?.trim_start();
    (!name.is_empty() && !behind.starts_with('=')).then_some((kind, name))
}

/// Returns the definition of a type that is part of ROS itself. Logs leave such definitions out.
fn built_in(name: &str, dialect: Dialect) -> Option<&'static str> {
    Some(match (name, dialect) {
        ("time", Dialect::Ros1) => "uint32 secs\nuint32 nsecs",
        ("duration", Dialect::Ros1) => "int32 secs\nint32 nsecs",
        ("builtin_interfaces/Time" | "builtin_interfaces/Duration", Dialect::Ros2) => {
            "int32 sec\nuint32 nanosec"
        }
        ("std_msgs/Header", Dialect::Ros1) => "uint32 seq\ntime stamp\nstring frame_id",
        ("std_msgs/Header", Dialect::Ros2) => "builtin_interfaces/Time stamp\nstring frame_id",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::{Definition, Dialect, NoNumber, Path, Step};

    const IMU: &str = "\
Header header # when
int8 A=1
string NAME=with # sign
float64[9] covariance
geometry_msgs/Vector3 rate
float32[] ranges
Point[2] two
================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
================================================================================
MSG: test/Point
uint8 a
";

    #[test]
    fn names_lead_to_numbers() {
        use Step::{Field, Item};
        let imu = Definition::parse("test/Imu", IMU, Dialect::Ros1).unwrap();
        let path = |steps: &[Step]| Ok(Path(steps.to_vec()));
        for (name, found) in [
            ("rate.y", path(&[Field(2), Field(1)])),
            ("header.stamp.nsecs", path(&[Field(0), Field(1), Field(1)])),
            ("covariance[8]", path(&[Field(1), Item(8)])),
            ("covariance[9]", Err(NoNumber::Missing)),
            ("covariance", Err(NoNumber::Several)),
            ("ranges[500]", path(&[Field(3), Item(500)])),
            ("two[1].a", path(&[Field(4), Item(1), Field(0)])),
            ("two.a", Err(NoNumber::Several)),
            ("rate", Err(NoNumber::Several)),
            ("rate.x.x", Err(NoNumber::Missing)),
            ("header.frame_id", Err(NoNumber::Text)),
            ("header.frame_id[0]", Err(NoNumber::Text)),
            ("A", Err(NoNumber::Missing)),
            ("", Err(NoNumber::Missing)),
        ] {
            assert_eq!(imu.number(name), found, "{name}");
        }
        let stamp = imu.stamp("header.stamp").unwrap();
        assert_eq!(stamp.nanoseconds, Path(vec![Field(0), Field(1), Field(1)]));
        assert_eq!(imu.stamp("rate"), None);
        let (numbers, texts) = imu.names();
        assert_eq!(texts, ["header.frame_id"]);
        let all = "header.seq header.stamp.secs header.stamp.nsecs covariance[0..9] rate.x rate.y ranges[] two[0..2].a";
        assert_eq!(numbers.join(" "), all);
    }

    #[test]
    fn ros2_has_bounds_defaults_and_two_part_packages() {
        let text = "\
std_msgs/Header header
string<=10 word \"hello\"
int32[<=3] few
float32 gain 1.5
uint8 MOST = 5
";
        let parsed = Definition::parse("test/msg/Two", text, Dialect::Ros2).unwrap();
        let (numbers, texts) = parsed.names();
        assert_eq!(numbers.join(" "), "header.stamp.sec header.stamp.nanosec few[] gain");
        assert_eq!(texts, ["header.frame_id", "word"]);
    }

    #[test]
    fn px4s_time_and_padding_have_no_names() {
        use Step::{Field, Item};
        let texts = [
            ("inner", "uint16_t a\nchar[5] word"),
            ("outer", "bool on\nuint64_t timestamp\ninner[2] two\nuint8_t[3] _padding0"),
            ("endless", "uint64_t timestamp\nendless again"),
        ];
        let texts = texts.map(|(name, text)| (name.to_owned(), text.to_owned())).into();
        let outer = Definition::of_px4("outer", &texts).unwrap();
        assert_eq!(
            outer.names(),
            (vec!["on".into(), "two[0..2].a".into()], vec!["two[0..2].word".into()])
        );
        assert_eq!((outer.time(), outer.padding()), (Some(Path(vec![Field(1)])), 3));
        for (name, found) in [
            ("two[1].a", Ok(Path(vec![Field(2), Item(1), Field(0)]))),
            ("two[1].word", Err(NoNumber::Text)),
            ("two[1].word[0]", Err(NoNumber::Text)),
            ("timestamp", Err(NoNumber::Missing)),
            ("_padding0[0]", Err(NoNumber::Missing)),
        ] {
            assert_eq!(outer.number(name), found, "{name}");
        }
        assert!(Definition::of_px4("endless", &texts).is_err());
        assert_eq!(Definition::of_px4("inner", &texts).unwrap().time(), None);
    }

    #[test]
    fn what_is_no_definition_is_said() {
        for (text, words) in [
            ("Endless again", "t/Endless holds itself"),
            ("other/Unknown a", "there is no definition of other/Unknown"),
            ("float32[x] a", "`float32[x] a` is not understood"),
            ("fl\u{f6}at a", "is not understood"),
        ] {
            let error = Definition::parse("t/Endless", text, Dialect::Ros1).unwrap_err();
            assert!(error.contains(words), "{error}");
        }
    }
}
