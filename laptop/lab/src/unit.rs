//! Units of channels: by a channel's name, or as the log gives them.

use crate::trial::Recording;
use std::f64::consts::PI;

/// 1 g in m/s².
const G: f64 = 9.806_65;

/// Largest turn rate, in rad/s, of a channel whose name has no unit: 2000 °/s, the usual range of a gyroscope. A channel
/// with larger samples is not in rad/s.
const FASTEST: f64 = 35.0;

/// Largest acceleration, in m/s², of a channel whose name has no unit: 32 g, the largest usual range of an accelerometer.
const HARDEST: f64 = 32.0 * G;

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
pub fn known_unit(name: &str) -> Option<&'static str> {
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
#[derive(Clone, Copy, Debug, PartialEq)]
struct Axis {
    is_rate: bool,
    is_along_thrust: bool,
    /// Whether the axis stands before the quantity, as in `xgyro` of `MAVLink`.
    is_mavlink: bool,
}

impl Axis {
    /// Returns the axis that a [`normal`] name tells, if it is one of a gyroscope or an accelerometer. The axis is `x`,
    /// `y`, `z`, `0`, `1` or `2` at the end of the name, before the unit if there is one; `MAVLink` writes it first, as in
    /// `xgyro`.
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

/// A channel of an inertial sensor whose unit is known, or taken to be the SI unit.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Inertial {
    /// Position of the channel's parameters among the groups of a bank: turn rates, sideways forces, the force along the
    /// thrust.
    pub(crate) group: usize,
    /// Unit of the samples, as a flight file has it.
    pub(crate) unit: String,
    /// The number that stands for 1 rad/s or 1 m/s² in the log.
    pub(crate) per_si: f64,
    /// Whether neither the log nor the name tells the unit, so that the SI unit is only assumed.
    pub(crate) is_assumed: bool,
}

impl Inertial {
    /// Returns the channel of a recording, if it is one of an inertial sensor and its unit is known.
    pub(crate) fn of(recording: &Recording) -> Option<Self> {
        let largest = recording.values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        Self::new(&recording.name, recording.unit.as_deref(), largest)
    }

    /// Returns whether the channel is a turn rate, and not an acceleration.
    pub(crate) fn is_rate(&self) -> bool {
        self.group == 0
    }

    /// Returns the channel `name`, if it is an axis of a gyroscope or an accelerometer. `unit` is the unit that the log
    /// gives, and `largest` is the largest absolute sample. Returns `None` if the unit is unknown: if it is another than
    /// those of turn rates or accelerations, or if nothing tells it and the samples are too large for SI units.
    pub(crate) fn new(name: &str, unit: Option<&str>, largest: f64) -> Option<Self> {
        let lower = normal(name);
        let axis = Axis::named(&lower)?;
        // Counts of an accelerometer, whose size only the log's head tells.
        if unit.is_none() && lower.contains("accsmooth") {
            return None;
        }
        let (unit, is_assumed) = match unit.or_else(|| known_unit(name)) {
            Some(unit) => (unit, false),
            None if axis.is_rate => ("rad/s", true),
            None => ("m/s²", true),
        };
        if is_assumed && largest > if axis.is_rate { FASTEST } else { HARDEST } {
            return None;
        }
        let group = if axis.is_rate { 0 } else { 1 + usize::from(axis.is_along_thrust) };
        let per_si = per_si(unit, axis.is_rate)?;
        Some(Self { group, unit: unit.to_owned(), per_si, is_assumed })
    }
}

/// Returns the number that stands for 1 rad/s or 1 m/s² in this unit. A unit such as `g/2048` is that of a sensor's counts.
fn per_si(unit: &str, is_rate: bool) -> Option<f64> {
    let counts =
        unit.rsplit_once('/').and_then(|(base, counts)| Some((base, counts.parse().ok()?)));
    let (base, counts) = counts.unwrap_or((unit, 1.0));
    let size = match base {
        "rad/s" if is_rate => 1.0,
        "mrad/s" if is_rate => 1000.0,
        "deg/s" if is_rate => 180.0 / PI,
        "m/s²" if !is_rate => 1.0,
        "g" if !is_rate => 1.0 / G,
        "mg" if !is_rate => 1000.0 / G,
        _ => return None,
    };
    Some(size * counts)
}

#[cfg(test)]
mod tests {
    use super::{Inertial, known_unit};

    fn of(name: &str) -> Option<(usize, String, f64)> {
        let own = Inertial::new(name, None, 1.0)?;
        Some((own.group, own.unit, own.per_si.round()))
    }

    #[test]
    fn channels_are_known_by_their_names() {
        for (name, group, unit, per_si) in [
            ("gyro_x", 0, "rad/s", 1.0),
            ("imu.angular_velocity.z", 0, "rad/s", 1.0),
            ("gyroADC[2]", 0, "deg/s", 57.0),
            ("sensor_combined.gyro_rad[1]", 0, "rad/s", 1.0),
            ("sensor_combined.accelerometer_m_s2[0]", 1, "m/s²", 1.0),
            ("AccZ", 2, "m/s²", 1.0),
            ("zacc", 2, "mg", 102.0),
            ("gyro_x_dps", 0, "deg/s", 57.0),
            ("gyro_x_deg_s", 0, "deg/s", 57.0),
            ("gyro_x_rad_s", 0, "rad/s", 1.0),
            ("gyro_x [deg/s]", 0, "deg/s", 57.0),
            ("acc_x [m/s^2]", 1, "m/s²", 1.0),
            ("acc_x (mg)", 1, "mg", 102.0),
            ("SCALED_IMU.xgyro", 0, "mrad/s", 1000.0),
            ("HIGHRES_IMU.xgyro", 0, "rad/s", 1.0),
            ("HIL_SENSOR.zacc", 2, "m/s²", 1.0),
            ("acc_z_g", 2, "g", 0.0),
        ] {
            assert_eq!(of(name), Some((group, unit.to_owned(), per_si)), "{name}");
        }
        for name in [
            "accSmooth[2]",
            "baro",
            "RAW_IMU.xgyro",
            "GPS_RAW_INT.h_acc",
            "GPS.HAcc",
            "vehicle_gps_position.horizontal_accuracy",
            "AHRS.accel_weight",
            "accelerometer_m_s2",
        ] {
            assert_eq!(of(name), None, "{name}");
        }
    }

    #[test]
    fn a_log_s_unit_counts_and_large_samples_have_no_assumed_unit() {
        let counts = Inertial::new("accSmooth[2]", Some("g/2048"), 4096.0).unwrap();
        assert_eq!((counts.group, counts.is_assumed), (2, false));
        assert!((counts.per_si - 2048.0 / 9.806_65).abs() < 1e-9);
        assert!(Inertial::new("gyro_x", None, 34.0).unwrap().is_assumed);
        assert_eq!(Inertial::new("gyro_x", None, 300.0), None);
        assert!(!Inertial::new("gyro_x_dps", None, 300.0).unwrap().is_assumed);
        assert_eq!(Inertial::new("gyro_x", Some("V"), 1.0), None);
    }

    #[test]
    fn a_unit_is_shown_by_words() {
        assert_eq!(known_unit("vx_m_s"), Some("m/s"));
        assert_eq!(known_unit("v_m_s[2]"), Some("m/s"));
        assert_eq!(known_unit("gyro_x"), None);
        assert_eq!(known_unit("seg"), None);
    }
}
