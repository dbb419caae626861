//! Units of a recording's channels: by a channel's name, or as the log gives them.

use crate::trial::Recording;
use spikewire_flight::{Axis, STANDARD_GRAVITY, UnitSize};

pub use spikewire_flight::unit_of_name;

/// Largest turn rate, in rad/s, of a channel whose name has no unit: 2000 °/s, the usual range of a gyroscope. A channel
/// with larger samples is not in rad/s.
const FASTEST: f64 = 35.0;

/// Largest acceleration, in m/s², of a channel whose name has no unit: 32 g, the largest usual range of an accelerometer.
const HARDEST: f64 = 32.0 * STANDARD_GRAVITY;

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
        let axis = Axis::of_name(name)?;
        // Counts of an accelerometer, whose size only the log's head tells.
        if unit.is_none() && name.to_ascii_lowercase().contains("accsmooth") {
            return None;
        }
        let (unit, is_assumed) = match unit.or_else(|| unit_of_name(name)) {
            Some(unit) => (unit, false),
            None if axis.is_rate => ("rad/s", true),
            None => ("m/s²", true),
        };
        if is_assumed && largest > if axis.is_rate { FASTEST } else { HARDEST } {
            return None;
        }
        let group = if axis.is_rate { 0 } else { 1 + usize::from(axis.is_along_thrust) };
        let size = UnitSize::of(unit)?;
        let size = if axis.is_rate { size.rate() } else { size.acceleration() };
        let per_si = 1.0 / size?;
        Some(Self { group, unit: unit.to_owned(), per_si, is_assumed })
    }
}

#[cfg(test)]
mod tests {
    use super::Inertial;

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
}
