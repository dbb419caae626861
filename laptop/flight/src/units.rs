//! Units of channels: how they are written, how large they are, and which ones names stand for.

use std::f64::consts::PI;

/// 1 g in m/s².
pub const STANDARD_GRAVITY: f64 = 9.806_65;

/// rad of 1°.
const RADIANS: f64 = PI / 180.0;

/// Size of a unit of an inertial sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UnitSize {
    /// A unit of turn rates, of so many rad/s.
    Rate(f64),
    /// A unit of accelerations, of so many m/s².
    Acceleration(f64),
}

/// Units of turn rates and accelerations, with their sizes.
const SIZES: [(&str, UnitSize); 10] = [
    ("rad/s", UnitSize::Rate(1.0)),
    ("mrad/s", UnitSize::Rate(1e-3)),
    ("deg/s", UnitSize::Rate(RADIANS)),
    ("°/s", UnitSize::Rate(RADIANS)),
    ("m/s²", UnitSize::Acceleration(1.0)),
    ("m/s^2", UnitSize::Acceleration(1.0)),
    ("m/s2", UnitSize::Acceleration(1.0)),
    ("m/s/s", UnitSize::Acceleration(1.0)), // as ArduPilot writes it
    ("g", UnitSize::Acceleration(STANDARD_GRAVITY)),
    ("mg", UnitSize::Acceleration(STANDARD_GRAVITY * 1e-3)),
];

impl UnitSize {
    /// Returns the size of a unit of turn rates or accelerations; `None` for any other unit. A part of a unit, such as
    /// `g/2048` or `deg/s/10`, is that of a sensor's counts.
    pub fn of(unit: &str) -> Option<Self> {
        if let Some((_, size)) = SIZES.iter().find(|(name, _)| *name == unit) {
            return Some(*size);
        }
        let (unit, counts) = unit.rsplit_once('/')?;
        let counts: f64 = counts.parse().ok()?;
        if !(counts.is_finite() && counts > 0.0) {
            return None;
        }
        let (_, size) = SIZES.iter().find(|(name, _)| *name == unit)?;
        Some(match size {
            Self::Rate(size) => Self::Rate(size / counts),
            Self::Acceleration(size) => Self::Acceleration(size / counts),
        })
    }

    /// Returns how many rad/s a unit of turn rates is.
    pub fn rate(self) -> Option<f64> {
        if let Self::Rate(size) = self { Some(size) } else { None }
    }

    /// Returns how many m/s² a unit of accelerations is.
    pub fn acceleration(self) -> Option<f64> {
        if let Self::Acceleration(size) = self { Some(size) } else { None }
    }
}

/// Words that stand for a unit in a name, and their unit.
const WORDS: [(&[&str], &str); 8] = [
    (&["rad", "s"], "rad/s"),
    (&["deg", "s"], "deg/s"),
    (&["m", "s2"], "m/s²"),
    (&["m", "s²"], "m/s²"),
    (&["m", "s"], "m/s"),
    (&["rps"], "rad/s"),
    (&["dps"], "deg/s"),
    (&["mg"], "mg"),
];

/// Returns the unit of a channel, if its name shows the unit: by words such as `_dps` or `[m/s^2]`, or because the name is
/// that of a field of a known format, such as `IMU.GyrX`.
pub fn unit_of_name(name: &str) -> Option<&'static str> {
    let name = normal(name);
    let has = |part: &str| name.contains(part);
    let words: Vec<&str> = words(&name).collect();
    let is_shown = |own: &[&str]| words.windows(own.len()).any(|window| window == own);
    if let Some((_, unit)) = WORDS.iter().find(|(own, _)| is_shown(own)) {
        return Some(unit);
    }
    let axis = Axis::named(&name)?;
    let unit = if axis.is_rate {
        if is_shown(&["deg"]) || has("gyroadc") || has("gyrounfilt") {
            "deg/s"
        } else if axis.is_mavlink && !has("highres_imu") && !has("hil_sensor") {
            "mrad/s"
        } else if is_shown(&["rad"])
            || axis.is_mavlink
            || has("angular_velocity")
            || is_ardupilot(&words)
        {
            "rad/s"
        } else {
            return None;
        }
    } else if is_shown(&["g"]) {
        "g"
    } else if axis.is_mavlink && !has("highres_imu") && !has("hil_sensor") {
        "mg"
    } else if axis.is_mavlink || has("linear_acceleration") || is_ardupilot(&words) {
        "m/s²"
    } else {
        return None;
    };
    Some(unit)
}

/// Returns a name in lower case, in which `m/s^2` is written `m/s2`.
fn normal(name: &str) -> String {
    name.to_ascii_lowercase().replace("^2", "2")
}

/// Returns the words of a name: its letters and digits, without what is between them.
fn words(name: &str) -> impl Iterator<Item = &str> {
    name.split(|letter: char| !letter.is_alphanumeric()).filter(|word| !word.is_empty())
}

/// Returns whether the last word of a name is a field of `ArduPilot`'s message `IMU`.
fn is_ardupilot(words: &[&str]) -> bool {
    const FIELDS: [&str; 6] = ["gyrx", "gyry", "gyrz", "accx", "accy", "accz"];
    words.last().is_some_and(|own| FIELDS.contains(own))
}

/// An axis of an inertial sensor, as a channel's name tells it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axis {
    /// Whether it is one of a gyroscope, and not of an accelerometer.
    pub is_rate: bool,
    /// Whether it is the third axis, along which the rotors push.
    pub is_along_thrust: bool,
    /// Whether the axis stands before the quantity, as in `xgyro` of `MAVLink`.
    is_mavlink: bool,
}

impl Axis {
    /// Returns the axis that a name tells, if it is one of a gyroscope or an accelerometer. The axis is `x`,
    /// `y`, `z`, `0`, `1` or `2` at the end of the name, before the unit if there is one; `MAVLink` writes it first, as in
    /// `xgyro`.
    pub fn of_name(name: &str) -> Option<Self> {
        Self::named(&normal(name))
    }

    /// Returns the axis that a [`normal`] name tells.
    fn named(name: &str) -> Option<Self> {
        const RATES: [&str; 5] =
            ["gyr", "angular_velocity", "angular_rate", "rotation_rate", "body_rate"];
        const FORCES: [&str; 3] = ["acc", "linear_acceleration", "specific_force"];
        /// Words of units.
        const UNITS: [&str; 10] = ["rad", "deg", "dps", "rps", "m", "s", "s2", "s²", "g", "mg"];
        let has = |parts: &[&str]| parts.iter().any(|part| name.contains(part));
        let is_rate = has(&RATES);
        if !is_rate && !has(&FORCES) || has(&["accuracy", "raw_imu"]) {
            return None;
        }
        let units = |word: &&str| UNITS.contains(word);
        let all: Vec<&str> = words(name).collect();
        let last = all.iter().rfind(|word| !units(word))?;
        let is_mavlink = matches!(*last, "xgyro" | "ygyro" | "zgyro" | "xacc" | "yacc" | "zacc");
        let mut letters = last.chars();
        let is_along_thrust = match if is_mavlink { letters.next() } else { letters.next_back() }? {
            'x' | 'y' | '0' | '1' => false,
            'z' | '2' => true,
            _ => return None,
        };
        Some(Self { is_rate, is_along_thrust, is_mavlink })
    }
}

/// Ways to write a unit that are not read, in lower case, each with the way that is.
const MISSPELLED: [(&str, &str); 22] = [
    ("dps", "deg/s"),
    ("deg/sec", "deg/s"),
    ("deg_s", "deg/s"),
    ("degs", "deg/s"),
    ("deg s-1", "deg/s"),
    ("deg s^-1", "deg/s"),
    ("degree/s", "deg/s"),
    ("degrees/s", "deg/s"),
    ("degrees/second", "deg/s"),
    ("degrees per second", "deg/s"),
    ("°/sec", "deg/s"),
    ("rads", "rad/s"),
    ("rads/s", "rad/s"),
    ("rad/sec", "rad/s"),
    ("rad_s", "rad/s"),
    ("rad s-1", "rad/s"),
    ("rad s^-1", "rad/s"),
    ("radians/s", "rad/s"),
    ("radians per second", "rad/s"),
    ("mps2", "m/s²"),
    ("m_s2", "m/s²"),
    ("gs", "g"),
];

/// Returns the way to write a unit, if it is written in a known way that is not read.
pub(crate) fn meant(unit: &str) -> Option<&'static str> {
    let lower = unit.to_lowercase();
    let (_, meant) = MISSPELLED.iter().find(|(written, _)| *written == lower)?;
    Some(meant)
}

#[cfg(test)]
mod tests {
    use super::{MISSPELLED, SIZES, UnitSize, meant, unit_of_name};

    #[test]
    fn names_show_units() {
        for (name, unit) in [
            ("gyro_x_dps", Some("deg/s")),
            ("gyro_dps_x", Some("deg/s")),
            ("GyroDeg_Deg_S", Some("deg/s")),
            ("rate_rad_s[2]", Some("rad/s")),
            ("accelerometer_m_s2[0]", Some("m/s²")),
            ("accel_z_g", Some("g")),
            ("mag_x_g", None),
            ("gyro_x", None),
            ("vx_m_s", Some("m/s")),
            ("v_m_s[2]", Some("m/s")),
            ("gyroADC[0]", Some("deg/s")),
            ("SCALED_IMU.xgyro", Some("mrad/s")),
            ("seg", None),
            ("", None),
        ] {
            assert_eq!(unit_of_name(name), unit, "{name}");
        }
    }

    #[test]
    fn no_unit_that_is_read_is_misspelled() {
        for (written, right) in MISSPELLED {
            assert_eq!(meant(written), Some(right));
            assert_eq!(meant(right), None);
        }
        assert_eq!(meant("DPS"), Some("deg/s"));
        assert!(SIZES.iter().all(|(unit, _)| meant(unit).is_none()));
        assert_eq!(meant("V"), None);
    }

    #[test]
    fn parts_of_units_have_their_size() {
        assert_eq!(UnitSize::of("g/2048"), Some(UnitSize::Acceleration(9.806_65 / 2048.0)));
        let rate = UnitSize::of("deg/s/16.4").and_then(UnitSize::rate).unwrap();
        assert!((rate * 16.4 * 180.0 / std::f64::consts::PI - 1.0).abs() < 1e-12);
        for unit in ["", "V", "m/s", "g/0", "g/-1", "g/x", "V/10", "/10", "rad/s/inf"] {
            assert_eq!(UnitSize::of(unit), None, "{unit}");
        }
    }
}
