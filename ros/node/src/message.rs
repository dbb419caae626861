//! Numbers out of messages of any type, by the definitions that ROS 2 has of them.

use anyhow::{Context, Result, bail};
use serde::de::{DeserializeSeed, Deserializer, Error, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use std::cell::Cell;
use std::path::Path;
use std::rc::Rc;
use std::{env, fmt, fs};

/// Deeper nesting has no use, and may have no end.
const DEEPEST: usize = 16;

/// What is wanted of a message.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Taken {
    /// The number; `None` if it is beyond the end of an array.
    pub value: Option<f64>,
    /// The stamp of the message's header, in nanoseconds, if it has one.
    pub stamp: Option<i64>,
}

/// Where in messages of a type a number is. Deserializes a message to what is wanted of it.
#[derive(Clone)]
pub(crate) struct Field {
    message: Kind,
    /// The paths to the number, and to the seconds and nanoseconds of the stamp.
    paths: Rc<[Vec<Step>]>,
}

#[derive(Clone, Debug)]
enum Kind {
    Number(Number),
    Text,
    /// Text whose length in bytes depends on the writer.
    WideText,
    Message(Rc<[Entry]>),
    /// As many as this, or as the message says.
    Array(Rc<Kind>, Option<usize>),
}

#[derive(Clone, Copy, Debug)]
enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

#[derive(Debug)]
struct Entry {
    name: String,
    kind: Kind,
}

/// A field of a message, or an item of an array, by its place.
type Step = usize;

impl Field {
    /// Finds a number, such as `angular_velocity.x` or `ranges[3]`, in messages of a type, such as `sensor_msgs/Imu`.
    ///
    /// # Errors
    /// There is no definition of the type, or no such number in it; the text lists those that there are.
    pub(crate) fn find(expression: &str, kind: &str) -> Result<Self> {
        let message = defined(kind, 0)?;
        let number = path(&message, expression).with_context(|| {
            let mut names = Vec::new();
            list(&message, "", &mut names);
            let names = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
            format!("field {expression}: numbers of {kind}: {names}")
        })?;
        let stamp = |part| path(&message, &format!("header.stamp.{part}"));
        let mut paths = vec![number];
        if let (Ok(seconds), Ok(nanoseconds)) = (stamp("sec"), stamp("nanosec")) {
            paths.extend([seconds, nanoseconds]);
        }
        Ok(Self { message, paths: paths.into() })
    }
}

/// Returns the layout of a type: from the packages that are installed, or one that is known here.
fn defined(name: &str, depth: usize) -> Result<Kind> {
    if depth > DEEPEST {
        bail!("{name} is nested too deeply, perhaps within itself");
    }
    let (package, own) =
        name.split_once('/').with_context(|| format!("{name}: it is no package/Type"))?;
    let prefixes = env::var_os("AMENT_PREFIX_PATH").unwrap_or_default();
    let file =
        |prefix: &Path| prefix.join("share").join(package).join("msg").join(format!("{own}.msg"));
    let installed =
        env::split_paths(&prefixes).find_map(|prefix| fs::read_to_string(file(&prefix)).ok());
    let text = installed.or_else(|| known(package, own)).with_context(|| {
        format!("{name}: there is no definition of it in share/{package}/msg of AMENT_PREFIX_PATH, and none here")
    })?;
    let entries = text.lines().filter_map(declared).map(|(kind, name)| {
        let kind = parsed(kind, package, depth).with_context(|| format!("{kind} {name}"))?;
        Ok(Entry { name: name.to_owned(), kind })
    });
    Ok(Kind::Message(entries.collect::<Result<Vec<_>>>()?.into()))
}

/// Returns the type and the name of a field, unless the line is empty or has a constant.
fn declared(line: &str) -> Option<(&str, &str)> {
    let line = line.split('#').next()?;
    let mut words = line.split_whitespace();
    let (kind, name) = (words.next()?, words.next()?);
    let is_constant = name.contains('=') || words.next().is_some_and(|word| word.starts_with('='));
    (!is_constant).then_some((kind, name))
}

fn parsed(kind: &str, package: &str, depth: usize) -> Result<Kind> {
    if let Some((base, count)) = kind.strip_suffix(']').and_then(|kind| kind.rsplit_once('[')) {
        let item = Rc::new(parsed(base, package, depth)?);
        let count =
            if count.is_empty() || count.starts_with("<=") { None } else { Some(count.parse()?) };
        return Ok(Kind::Array(item, count));
    }
    Ok(Kind::Number(match kind.split("<=").next().unwrap_or(kind) {
        "bool" | "byte" | "char" | "uint8" => Number::U8,
        "int8" => Number::I8,
        "int16" => Number::I16,
        "uint16" => Number::U16,
        "int32" => Number::I32,
        "uint32" => Number::U32,
        "int64" => Number::I64,
        "uint64" => Number::U64,
        "float32" => Number::F32,
        "float64" => Number::F64,
        "string" => return Ok(Kind::Text),
        "wstring" => return Ok(Kind::WideText),
        "Header" => return defined("std_msgs/Header", depth + 1),
        other if other.contains('/') => {
            return defined(&other.replacen("/msg/", "/", 1), depth + 1);
        }
        other => return defined(&format!("{package}/{other}"), depth + 1),
    }))
}

/// Returns the definition of a type that nodes need without any ROS beside them.
fn known(package: &str, name: &str) -> Option<String> {
    let text = match (package, name) {
        ("builtin_interfaces", "Time") => "int32 sec\nuint32 nanosec",
        ("std_msgs", "Header") => "builtin_interfaces/Time stamp\nstring frame_id",
        (
            "std_msgs",
            "Bool" | "Int8" | "Int16" | "Int32" | "Int64" | "String" | "UInt8" | "UInt16"
            | "UInt32" | "UInt64" | "Float32" | "Float64",
        ) => {
            return Some(format!("{} data", name.to_lowercase()));
        }
        ("geometry_msgs", "Vector3" | "Point") => "float64 x\nfloat64 y\nfloat64 z",
        ("geometry_msgs", "Quaternion") => "float64 x\nfloat64 y\nfloat64 z\nfloat64 w",
        ("sensor_msgs", "Imu") => {
            "Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n\
             geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n\
             geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance"
        }
        ("spyke_msgs", "Spyke") => include_str!("../../ros2/spyke_msgs/msg/Spyke.msg"),
        ("spyke_msgs", "SpykeArray") => include_str!("../../ros2/spyke_msgs/msg/SpykeArray.msg"),
        ("spyke_msgs", "SpykeValue") => include_str!("../../ros2/spyke_msgs/msg/SpykeValue.msg"),
        _ => return None,
    };
    Some(text.to_owned())
}

/// Returns the way to a number.
fn path(message: &Kind, expression: &str) -> Result<Vec<Step>> {
    let (mut steps, mut within) = (Vec::new(), message);
    for part in expression.split(['.', '/']) {
        let mut names = part.split('[');
        let name = names.next().unwrap_or_default();
        let Kind::Message(entries) = within else {
            bail!("`{name}`: there is no message before it")
        };
        let place = entries.iter().position(|entry| entry.name == name);
        let place = place.with_context(|| format!("it has no `{name}`"))?;
        steps.push(place);
        within = &entries[place].kind;
        for item in names {
            let item = item.strip_suffix(']').and_then(|item| item.parse().ok());
            let item: Step = item.with_context(|| format!("`{part}` cannot be read"))?;
            let Kind::Array(kind, count) = within else { bail!("`{name}` is no array") };
            if count.is_some_and(|count| item >= count) {
                bail!("`{name}` has {} items", count.unwrap_or_default());
            }
            steps.push(item);
            within = kind;
        }
    }
    match within {
        Kind::Number(_) => Ok(steps),
        Kind::Text | Kind::WideText => bail!("it is no number, but text"),
        Kind::Message(_) | Kind::Array(..) => bail!("it is no number, but several"),
    }
}

/// Adds the expressions of all numbers; of an array, the first's.
fn list(kind: &Kind, name: &str, names: &mut Vec<String>) {
    match kind {
        Kind::Number(_) => names.push(name.to_owned()),
        Kind::Text | Kind::WideText => {}
        Kind::Array(item, _) => list(item, &format!("{name}[0]"), names),
        Kind::Message(entries) => {
            for entry in entries.iter() {
                let dot = if name.is_empty() { "" } else { "." };
                list(&entry.kind, &format!("{name}{dot}{}", entry.name), names);
            }
        }
    }
}

impl<'de> DeserializeSeed<'de> for Field {
    type Value = Taken;

    fn deserialize<D: Deserializer<'de>>(self, input: D) -> Result<Taken, D::Error> {
        let found = [const { Cell::new(None) }; 3];
        let wanted: Vec<Wanted> =
            self.paths.iter().zip(&found).map(|(path, found)| Wanted { path, found }).collect();
        Walk { kind: &self.message, wanted: &wanted }.deserialize(input)?;
        let [value, seconds, nanoseconds] = found.map(Cell::into_inner);
        let stamp = seconds.zip(nanoseconds);
        let stamp = stamp.map(|(sec, nano): (f64, f64)| sec as i64 * 1_000_000_000 + nano as i64);
        Ok(Taken { value, stamp })
    }
}

/// A number that is wanted.
#[derive(Clone, Copy)]
struct Wanted<'a> {
    /// The rest of the way to it.
    path: &'a [Step],
    found: &'a Cell<Option<f64>>,
}

/// Goes through what has this layout, and finds what is wanted of it.
struct Walk<'a> {
    kind: &'a Kind,
    wanted: &'a [Wanted<'a>],
}

impl Walk<'_> {
    /// What is wanted within the field or item at a place.
    fn within(&self, place: Step) -> Vec<Wanted<'_>> {
        let within = |wanted: &Wanted| wanted.path.first() == Some(&place);
        let wanted = self.wanted.iter().copied().filter(within);
        wanted.map(|wanted| Wanted { path: &wanted.path[1..], ..wanted }).collect()
    }
}

impl<'de> DeserializeSeed<'de> for Walk<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, input: D) -> Result<(), D::Error> {
        let number = match self.kind {
            Kind::Message(entries) => return input.deserialize_tuple(entries.len(), self),
            Kind::Array(_, Some(count)) => return input.deserialize_tuple(*count, self),
            Kind::Array(_, None) => return input.deserialize_seq(self),
            Kind::Text => return String::deserialize(input).map(drop),
            Kind::WideText => return Err(D::Error::custom("wide text stands before the field")),
            Kind::Number(number) => match number {
                Number::I8 => i8::deserialize(input)?.into(),
                Number::U8 => u8::deserialize(input)?.into(),
                Number::I16 => i16::deserialize(input)?.into(),
                Number::U16 => u16::deserialize(input)?.into(),
                Number::I32 => i32::deserialize(input)?.into(),
                Number::U32 => u32::deserialize(input)?.into(),
                Number::I64 => i64::deserialize(input)? as f64,
                Number::U64 => u64::deserialize(input)? as f64,
                Number::F32 => f32::deserialize(input)?.into(),
                Number::F64 => f64::deserialize(input)?,
            },
        };
        self.wanted.iter().for_each(|wanted| wanted.found.set(Some(number)));
        Ok(())
    }
}

impl<'de> Visitor<'de> for Walk<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a message of the type that its publisher names")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<(), A::Error> {
        let mut place = 0;
        loop {
            let kind = match self.kind {
                Kind::Message(entries) => match entries.get(place) {
                    Some(entry) => &entry.kind,
                    None => return Ok(()),
                },
                Kind::Array(item, _) => item,
                _ => return Ok(()),
            };
            let wanted = self.within(place);
            if items.next_element_seed(Walk { kind, wanted: &wanted })?.is_none() {
                let is_whole = matches!(self.kind, Kind::Array(..));
                return if is_whole { Ok(()) } else { Err(A::Error::invalid_length(place, &self)) };
            }
            place += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Field, Taken, defined, list, parsed};
    use ros2_client::dds::rustdds::serialization::CdrDeserializeSeedDecoder;
    use ros2_client::dds::rustdds::{RepresentationIdentifier, no_key::Decode};
    use std::marker::PhantomData;

    fn taken(field: &str, kind: &str, bytes: &[u8]) -> Option<Taken> {
        let seed = Field::find(field, kind).unwrap();
        let decoder = CdrDeserializeSeedDecoder::new(seed, PhantomData::<()>);
        decoder.decode_bytes(bytes, RepresentationIdentifier::CDR_LE).ok()
    }

    /// `int8[] [1, 0, -1]`, five `float32`, `"sf"`, 7 s and 9 ns.
    #[test]
    fn numbers_behind_an_array_and_a_text() {
        let mut bytes = vec![3, 0, 0, 0, 1, 0, 0xff, 0];
        for number in [0.5_f32, -1.0, 1.0, 0.25, 0.75] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend(*b"\x03\0\0\0sf\0\0\x07\0\0\0\x09\0\0\0");
        for (field, value) in [
            ("spike[2]", Some(-1.0)),
            ("spike[3]", None),
            ("input", Some(0.75)),
            ("timestamp.sec", Some(7.0)),
            ("timestamp/nanosec", Some(9.0)),
        ] {
            let taken = taken(field, "spyke_msgs/SpykeArray", &bytes).unwrap();
            assert_eq!((taken.value, taken.stamp), (value, None), "{field}");
        }
        for length in 0..bytes.len() {
            assert!(
                taken("input", "spyke_msgs/SpykeArray", &bytes[..length]).is_none(),
                "{length}"
            );
        }
    }

    #[test]
    fn a_stamp() {
        let mut bytes = [7_i32.to_le_bytes(), 9_i32.to_le_bytes(), 2_i32.to_le_bytes()].concat();
        bytes.extend(*b"x\0\0\0");
        bytes.extend((0..37).flat_map(|number: i32| f64::from(number).to_le_bytes()));
        let taken = taken("angular_velocity.z", "sensor_msgs/Imu", &bytes).unwrap();
        assert_eq!((taken.value, taken.stamp), (Some(15.0), Some(7_000_000_009)));
    }

    #[test]
    fn definitions_as_packages_have_them() {
        let mut names = Vec::new();
        let text = "# Words\nuint8 ONE=1\nint32 TWO = 2\nfloat32[<=4] few  # some\nstring<=9 word\nint16 a 7\n";
        for (kind, name) in text.lines().filter_map(super::declared) {
            list(&parsed(kind, "own_msgs", 0).unwrap(), name, &mut names);
        }
        assert_eq!(names, ["few[0]", "a"]);
        assert!(defined("std_msgs/Header", 17).is_err());
    }

    #[test]
    fn numbers_and_what_is_none() {
        for (field, kind, why) in [
            ("angular_velocity.w", "sensor_msgs/Imu", "it has no `w`"),
            ("orientation", "sensor_msgs/Imu", "it is no number, but several"),
            ("header.frame_id", "sensor_msgs/Imu", "it is no number, but text"),
            ("angular_velocity[", "sensor_msgs/Imu", "cannot be read"),
            ("orientation_covariance[9]", "sensor_msgs/Imu", "has 9 items"),
            ("data", "std_msgs/String", "numbers of std_msgs/String: none"),
            ("data", "own_msgs/Own", "there is no definition of it"),
        ] {
            let told = format!("{:#}", Field::find(field, kind).err().unwrap());
            assert!(told.contains(why), "{field}: {told}");
        }
        let told = format!("{:#}", Field::find("w", "sensor_msgs/Imu").err().unwrap());
        assert!(
            told.contains(
                "numbers of sensor_msgs/Imu: header.stamp.sec, header.stamp.nanosec, orientation.x,"
            ),
            "{told}"
        );
    }
}
