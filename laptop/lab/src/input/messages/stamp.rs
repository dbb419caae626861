//! Finds the time at which a sensor took its samples in the messages of a log.

use crate::input::time::TimeUnit;
use flight_logs::definition::{Definition, Path, Stamp};
use flight_logs::{Fault, Topic, microseconds};

/// A field of a message that holds a time.
pub(super) enum Time {
    /// The time at which the message was recorded, which is in no field.
    Recorded,
    /// Seconds and nanoseconds, as in ROS.
    Stamp(Stamp),
    /// A number in a unit.
    Number(Path, TimeUnit),
}

/// The stamp that a sensor's driver put on its samples.
pub(super) struct SensorStamp {
    pub name: &'static str,
    pub time: Time,
}

impl SensorStamp {
    /// Finds the stamp in messages of this definition. Returns `None` if they have none but the time of recording.
    pub(super) fn of(definition: &Definition) -> Option<Self> {
        const NUMBERS: [(&str, TimeUnit); 3] = [
            ("timestamp_sample", TimeUnit::Us),
            ("time_usec", TimeUnit::Us),
            ("time_boot_ms", TimeUnit::Ms),
        ];
        if let Some(stamp) = definition.stamp("header.stamp") {
            return Some(Self { name: "header.stamp", time: Time::Stamp(stamp) });
        }
        NUMBERS.into_iter().find_map(|(name, unit)| {
            let path = definition.number(name).ok()?;
            Some(Self { name, time: Time::Number(path, unit) })
        })
    }
}

impl Time {
    /// Returns the time of a message in µs. `recorded` is the time in ns at which the message was recorded; it is used
    /// if the message holds no other time.
    pub(super) fn read(&self, topic: &Topic, message: &[u8], recorded: i64) -> Result<i64, Fault> {
        Ok(match self {
            Self::Recorded => microseconds(recorded),
            Self::Stamp(stamp) => microseconds(topic.stamp(stamp, message)?.unwrap_or(recorded)),
            Self::Number(path, unit) => match topic.number(path, message)? {
                Some(time) => (time * unit.microseconds()).round() as i64,
                None => microseconds(recorded),
            },
        })
    }
}
