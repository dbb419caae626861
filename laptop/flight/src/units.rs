//! Units of channels: how they are written, and which ones the ends of names stand for.

/// Ends of names that stand for units.
const ENDS: [(&str, &str); 5] =
    [("_dps", "deg/s"), ("_deg_s", "deg/s"), ("_rad_s", "rad/s"), ("_m_s2", "m/s²"), ("_g", "g")];

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

/// Returns the unit for which the end of a channel's name stands, brackets and the letter of an axis aside: `deg/s` for
/// `gyro_x_dps` and `gyro_dps[0]`. The end `_g` stands for the acceleration only if the name has `acc`, because a
/// magnetometer's means gauss.
pub fn unit_of_name(name: &str) -> Option<&'static str> {
    let name = name.to_ascii_lowercase();
    let bracket = name.strip_suffix(']').and_then(|name| name.rsplit_once('['));
    let name = bracket.map_or(name.as_str(), |(name, _)| name);
    let name = ["_x", "_y", "_z"].iter().find_map(|axis| name.strip_suffix(axis)).unwrap_or(name);
    let (_, unit) = ENDS.iter().find(|(end, _)| name.ends_with(end))?;
    (*unit != "g" || name.contains("acc")).then_some(unit)
}

/// Returns the way to write a unit, if it is written in a known way that is not read.
pub(crate) fn meant(unit: &str) -> Option<&'static str> {
    let lower = unit.to_lowercase();
    let (_, meant) = MISSPELLED.iter().find(|(written, _)| *written == lower)?;
    Some(meant)
}

#[cfg(test)]
mod tests {
    use super::{ENDS, MISSPELLED, meant, unit_of_name};

    #[test]
    fn ends_of_names_are_units() {
        for (name, unit) in [
            ("gyro_x_dps", Some("deg/s")),
            ("gyro_dps_x", Some("deg/s")),
            ("GyroDeg_Deg_S", Some("deg/s")),
            ("rate_rad_s[2]", Some("rad/s")),
            ("accelerometer_m_s2[0]", Some("m/s²")),
            ("accel_z_g", Some("g")),
            ("mag_x_g", None),
            ("gyro_x", None),
            ("dps", None),
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
        assert!(ENDS.iter().all(|(_, unit)| meant(unit).is_none()));
        assert_eq!(meant("V"), None);
    }
}
