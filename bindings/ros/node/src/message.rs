//! Numbers out of messages of any type, by the definitions that ROS 2 has of them.

use anyhow::{Context as _, Result, anyhow};
use flight_logs::definition::{self, Definition, Kind, NoNumber, Number, Shape, Step, Struct};
use serde::de::{DeserializeSeed, Deserializer, Error, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use std::cell::{Cell, RefCell};
use std::path::Path;
use std::rc::Rc;
use std::{env, fmt, fs};

/// What is wanted of a message.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Taken {
    /// The numbers; `None` for one that is beyond the end of an array.
    pub values: Vec<Option<f64>>,
    /// The stamp of the message's header, in nanoseconds, if it has one.
    pub stamp: Option<i64>,
    /// The frame of that header; empty without one.
    pub frame: String,
}

impl Taken {
    /// Returns the numbers of these fields.
    ///
    /// # Errors
    /// One is beyond the end of an array.
    pub(crate) fn all(&self, fields: &[&str]) -> Result<Vec<f64>> {
        let both = self.values.iter().zip(fields);
        both.map(|(value, field)| {
            value.with_context(|| format!("field {field}: the array is shorter"))
        })
        .collect()
    }
}

/// Paths to the wanted numbers and texts in messages of one type, by which a message is deserialized.
#[derive(Clone)]
pub(crate) struct Fields {
    message: Rc<Definition>,
    /// The paths to the numbers, then to the seconds and nanoseconds of the stamp.
    paths: Rc<[Vec<Step>]>,
    /// Number of the paths that lead to numbers.
    count: usize,
    /// The path to the header's frame.
    frame: Rc<[Step]>,
}

impl Fields {
    /// Finds numbers, such as `angular_velocity.x` or `ranges[3]`, in messages of a type, such as `sensor_msgs/Imu`.
    ///
    /// # Errors
    /// There is no definition of the type, or no such number in it; the text lists those that there are.
    pub(crate) fn find(expressions: &[&str], kind: &str) -> Result<Self> {
        let message = Definition::of_ros2(kind, &installed).map_err(|error| {
anyhow!("{kind}: {error}; those of share/PACKAGE/msg in AMENT_PREFIX_PATH are known, and a few more")
        })?;
        let path = |expression: &&str| {
            let number = message.number(&expression.replace('/', "."));
            number.map(|number| number.0).map_err(|why| {
                let (numbers, _) = message.names();
                let names = if numbers.is_empty() { "none".to_owned() } else { numbers.join(", ") };
                let why = match why {
                    NoNumber::Missing => "it has no such number",
                    NoNumber::Text => "it is no number, but text",
                    NoNumber::Several => "it is no number, but several",
                };
                anyhow!("field {expression}: {why}; numbers of {kind}: {names}")
            })
        };
        let mut paths = expressions.iter().map(path).collect::<Result<Vec<_>>>()?;
        let mut frame = Vec::new();
        if let Some(stamp) = message.stamp("header.stamp") {
            // A header is a stamp and a frame.
            frame.extend([stamp.seconds.0[0], Step::Field(1)]);
            paths.extend([stamp.seconds.0, stamp.nanoseconds.0]);
        }
        let count = expressions.len();
        Ok(Self { message: Rc::new(message), paths: paths.into(), count, frame: frame.into() })
    }
}

/// Returns the definition of a type: from the packages that are installed, or of our own messages.
fn installed(name: &str) -> Option<String> {
    let (package, own) = name.split_once('/')?;
    let prefixes = env::var_os("AMENT_PREFIX_PATH").unwrap_or_default();
    let file =
        |prefix: &Path| prefix.join("share").join(package).join("msg").join(format!("{own}.msg"));
    let found =
        env::split_paths(&prefixes).find_map(|prefix| fs::read_to_string(file(&prefix)).ok());
    found.or_else(|| {
        Some(match name {
            "spyke_msgs/Spyke" => include_str!("../../ros2/spyke_msgs/msg/Spyke.msg").to_owned(),
            "spyke_msgs/SpykeArray" => {
                include_str!("../../ros2/spyke_msgs/msg/SpykeArray.msg").to_owned()
            }
            "spyke_msgs/SpykeValue" => {
                include_str!("../../ros2/spyke_msgs/msg/SpykeValue.msg").to_owned()
            }
            _ => return None,
        })
    })
}

impl<'de> DeserializeSeed<'de> for Fields {
    type Value = Taken;

    fn deserialize<D: Deserializer<'de>>(self, input: D) -> Result<Taken, D::Error> {
        let found = vec![Found::default(); self.paths.len() + 1];
        let paths = self.paths.iter().map(Vec::as_slice).chain([&*self.frame]);
        let wanted: Vec<Wanted> =
            paths.zip(&found).map(|(path, found)| Wanted { path, found }).collect();
        let (message, place) = (&*self.message, Place::Message(self.message.root()));
        Walk { message, place, wanted: &wanted }.deserialize(input)?;
        let (numbers, frame) = found.split_at(self.paths.len());
        let mut values: Vec<_> = numbers.iter().map(|found| found.number.get()).collect();
        let stamp = match values.split_off(self.count)[..] {
            [Some(seconds), Some(nanos)] => Some(seconds as i64 * 1_000_000_000 + nanos as i64),
            _ => None,
        };
        Ok(Taken { values, stamp, frame: frame[0].text.take() })
    }
}

/// The number or text that was found for a path.
#[derive(Clone, Default)]
struct Found {
    number: Cell<Option<f64>>,
    text: RefCell<String>,
}

/// A number or a text that is wanted.
#[derive(Clone, Copy)]
struct Wanted<'a> {
    /// The rest of the way to it.
    path: &'a [Step],
    found: &'a Found,
}

/// What is read next of a message.
#[derive(Clone, Copy)]
enum Place<'a> {
    Message(&'a Struct),
    /// As many as this, or as the message says.
    Array(Kind, Option<usize>),
    One(Kind),
}

/// Goes through a place of a message, and finds what is wanted of it.
struct Walk<'a> {
    message: &'a Definition,
    place: Place<'a>,
    wanted: &'a [Wanted<'a>],
}

impl Walk<'_> {
    /// What is wanted within the field or item of a step.
    fn within(&self, step: Step) -> Vec<Wanted<'_>> {
        let within = |wanted: &Wanted| wanted.path.first() == Some(&step);
        let wanted = self.wanted.iter().copied().filter(within);
        wanted.map(|wanted| Wanted { path: &wanted.path[1..], ..wanted }).collect()
    }
}

impl<'de> DeserializeSeed<'de> for Walk<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(mut self, input: D) -> Result<(), D::Error> {
        if let Place::One(Kind::Nested(nested)) = self.place {
            self.place = Place::Message(self.message.nested(nested));
        }
        let number = match self.place {
            Place::Message(own) => return input.deserialize_tuple(own.fields.len(), self),
            Place::Array(_, Some(count)) => return input.deserialize_tuple(count, self),
            Place::Array(_, None) => return input.deserialize_seq(self),
            Place::One(Kind::Text) => {
                let text = String::deserialize(input)?;
                for wanted in self.wanted {
                    wanted.found.text.replace(text.clone());
                }
                return Ok(());
            }
            Place::One(Kind::Number(number) | Kind::Hidden(number)) => match number {
                Number::I8 => i8::deserialize(input)?.into(),
                Number::Bool | Number::U8 => u8::deserialize(input)?.into(),
                Number::I16 => i16::deserialize(input)?.into(),
                Number::U16 => u16::deserialize(input)?.into(),
                Number::I32 => i32::deserialize(input)?.into(),
                Number::U32 => u32::deserialize(input)?.into(),
                Number::I64 => i64::deserialize(input)? as f64,
                Number::U64 => u64::deserialize(input)? as f64,
                Number::F32 => f32::deserialize(input)?.into(),
                Number::F64 => f64::deserialize(input)?,
            },
            Place::One(_) => return Err(D::Error::custom("wide text stands before the field")),
        };
        self.wanted.iter().for_each(|wanted| wanted.found.number.set(Some(number)));
        Ok(())
    }
}

impl<'de> Visitor<'de> for Walk<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a message of the type that its publisher names")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<(), A::Error> {
        for at in 0.. {
            let (place, step) = match self.place {
                Place::Message(own) => match own.fields.get(at) {
                    Some(field) => (placed(field), Step::Field(at)),
                    None => return Ok(()),
                },
                Place::Array(kind, _) => (Place::One(kind), Step::Item(at)),
                Place::One(_) => return Ok(()),
            };
            let wanted = self.within(step);
            let walk = Walk { message: self.message, place, wanted: &wanted };
            if items.next_element_seed(walk)?.is_none() {
                let is_whole = matches!(self.place, Place::Array(..));
                return if is_whole { Ok(()) } else { Err(A::Error::invalid_length(at, &self)) };
            }
        }
        Ok(())
    }
}

fn placed<'a>(field: &definition::Field) -> Place<'a> {
    match field.shape {
        Shape::One => Place::One(field.kind),
        Shape::Fixed(count) => Place::Array(field.kind, Some(count)),
        Shape::Counted => Place::Array(field.kind, None),
    }
}

#[cfg(test)]
mod tests {
    use super::{Fields, Taken};
    use ros2_client::dds::rustdds::serialization::CdrDeserializeSeedDecoder;
    use ros2_client::dds::rustdds::{RepresentationIdentifier, no_key::Decode};
    use std::marker::PhantomData;

    fn taken(fields: &[&str], kind: &str, bytes: &[u8]) -> Option<Taken> {
        let seed = Fields::find(fields, kind).unwrap();
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
            let taken = taken(&[field], "spyke_msgs/SpykeArray", &bytes).unwrap();
            assert_eq!((&taken.values[..], taken.stamp), (&[value][..], None), "{field}");
        }
        for length in 0..bytes.len() {
            assert!(
                taken(&["input"], "spyke_msgs/SpykeArray", &bytes[..length]).is_none(),
                "{length}"
            );
        }
    }

    #[test]
    fn two_numbers_a_stamp_and_a_frame() {
        let mut bytes = [7_i32.to_le_bytes(), 9_i32.to_le_bytes(), 2_i32.to_le_bytes()].concat();
        bytes.extend(*b"x\0\0\0");
        bytes.extend((0..37).flat_map(|number: i32| f64::from(number).to_le_bytes()));
        let fields = ["angular_velocity.z", "orientation.x"];
        let taken = taken(&fields, "sensor_msgs/Imu", &bytes).unwrap();
        assert_eq!(
            (&taken.values[..], taken.stamp),
            (&[Some(15.0), Some(0.0)][..], Some(7_000_000_009))
        );
        assert_eq!(taken.frame, "x");
    }

    #[test]
    fn numbers_and_what_is_none() {
        for (field, kind, why) in [
            ("angular_velocity.w", "sensor_msgs/Imu", "it has no such number"),
            ("orientation", "sensor_msgs/Imu", "it is no number, but several"),
            ("header.frame_id", "sensor_msgs/Imu", "it is no number, but text"),
            ("angular_velocity[", "sensor_msgs/Imu", "it has no such number"),
            ("orientation_covariance[9]", "sensor_msgs/Imu", "it has no such number"),
            ("data", "std_msgs/String", "numbers of std_msgs/String: none"),
            ("data", "own_msgs/Own", "there is no definition of own_msgs/Own"),
        ] {
            let told = format!("{:#}", Fields::find(&[field], kind).err().unwrap());
            assert!(told.contains(why), "{field}: {told}");
        }
        let told = format!("{:#}", Fields::find(&["w"], "sensor_msgs/Imu").err().unwrap());
        assert!(
            told.contains(
                "numbers of sensor_msgs/Imu: header.stamp.sec, header.stamp.nanosec, orientation.x,"
            ),
            "{told}"
        );
    }
}
