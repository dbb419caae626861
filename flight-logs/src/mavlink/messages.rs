//! Layouts of common `MAVLink` messages, and the packets' checksum.

use crate::definition::Definition;
use std::collections::HashMap;
use std::sync::OnceLock;

/// Layout of a `MAVLink` message.
pub(crate) struct Message {
    pub name: &'static str,
    /// The byte `CRC_EXTRA`, which is not sent. The checksum is computed over the bytes of the packet, then over this
    /// byte. The byte is computed from the layout, so that the checksum fails if the sender uses a different layout.
    pub extra: u8,
    /// Length of all fields together, in bytes.
    pub length: usize,
    pub definition: Definition,
}

/// Number, name and fields of each message. The fields are in the order of their bytes. Fields after `|` are
/// extensions: older senders leave them out.
#[rustfmt::skip]
const MESSAGES: &[(u32, &str, &str)] = &[
    (0, "HEARTBEAT", "uint32_t custom_mode; uint8_t type autopilot base_mode system_status mavlink_version"),
    (1, "SYS_STATUS", "uint32_t onboard_control_sensors_present onboard_control_sensors_enabled onboard_control_sensors_health; uint16_t load voltage_battery; int16_t current_battery; uint16_t drop_rate_comm errors_comm errors_count1 errors_count2 errors_count3 errors_count4; int8_t battery_remaining | uint32_t onboard_control_sensors_present_extended onboard_control_sensors_enabled_extended onboard_control_sensors_health_extended"),
    (2, "SYSTEM_TIME", "uint64_t time_unix_usec; uint32_t time_boot_ms"),
    (24, "GPS_RAW_INT", "uint64_t time_usec; int32_t lat lon alt; uint16_t eph epv vel cog; uint8_t fix_type satellites_visible | int32_t alt_ellipsoid; uint32_t h_acc v_acc vel_acc hdg_acc; uint16_t yaw"),
    (26, "SCALED_IMU", "uint32_t time_boot_ms; int16_t xacc yacc zacc xgyro ygyro zgyro xmag ymag zmag | int16_t temperature"),
    (27, "RAW_IMU", "uint64_t time_usec; int16_t xacc yacc zacc xgyro ygyro zgyro xmag ymag zmag | uint8_t id; int16_t temperature"),
    (28, "RAW_PRESSURE", "uint64_t time_usec; int16_t press_abs press_diff1 press_diff2 temperature"),
    (29, "SCALED_PRESSURE", "uint32_t time_boot_ms; float press_abs press_diff; int16_t temperature | int16_t temperature_press_diff"),
    (30, "ATTITUDE", "uint32_t time_boot_ms; float roll pitch yaw rollspeed pitchspeed yawspeed"),
    (31, "ATTITUDE_QUATERNION", "uint32_t time_boot_ms; float q1 q2 q3 q4 rollspeed pitchspeed yawspeed | float[4] repr_offset_q"),
    (32, "LOCAL_POSITION_NED", "uint32_t time_boot_ms; float x y z vx vy vz"),
    (33, "GLOBAL_POSITION_INT", "uint32_t time_boot_ms; int32_t lat lon alt relative_alt; int16_t vx vy vz; uint16_t hdg"),
    (36, "SERVO_OUTPUT_RAW", "uint32_t time_usec; uint16_t servo1_raw servo2_raw servo3_raw servo4_raw servo5_raw servo6_raw servo7_raw servo8_raw; uint8_t port | uint16_t servo9_raw servo10_raw servo11_raw servo12_raw servo13_raw servo14_raw servo15_raw servo16_raw"),
    (65, "RC_CHANNELS", "uint32_t time_boot_ms; uint16_t chan1_raw chan2_raw chan3_raw chan4_raw chan5_raw chan6_raw chan7_raw chan8_raw chan9_raw chan10_raw chan11_raw chan12_raw chan13_raw chan14_raw chan15_raw chan16_raw chan17_raw chan18_raw; uint8_t chancount rssi"),
    (74, "VFR_HUD", "float airspeed groundspeed alt climb; int16_t heading; uint16_t throttle"),
    (83, "ATTITUDE_TARGET", "uint32_t time_boot_ms; float[4] q; float body_roll_rate body_pitch_rate body_yaw_rate thrust; uint8_t type_mask"),
    (85, "POSITION_TARGET_LOCAL_NED", "uint32_t time_boot_ms; float x y z vx vy vz afx afy afz yaw yaw_rate; uint16_t type_mask; uint8_t coordinate_frame"),
    (100, "OPTICAL_FLOW", "uint64_t time_usec; float flow_comp_m_x flow_comp_m_y ground_distance; int16_t flow_x flow_y; uint8_t sensor_id quality | float flow_rate_x flow_rate_y"),
    (105, "HIGHRES_IMU", "uint64_t time_usec; float xacc yacc zacc xgyro ygyro zgyro xmag ymag zmag abs_pressure diff_pressure pressure_alt temperature; uint16_t fields_updated | uint8_t id"),
    (107, "HIL_SENSOR", "uint64_t time_usec; float xacc yacc zacc xgyro ygyro zgyro xmag ymag zmag abs_pressure diff_pressure pressure_alt temperature; uint32_t fields_updated | uint8_t id"),
    (116, "SCALED_IMU2", "uint32_t time_boot_ms; int16_t xacc yacc zacc xgyro ygyro zgyro xmag ymag zmag | int16_t temperature"),
    (129, "SCALED_IMU3", "uint32_t time_boot_ms; int16_t xacc yacc zacc xgyro ygyro zgyro xmag ymag zmag | int16_t temperature"),
    (132, "DISTANCE_SENSOR", "uint32_t time_boot_ms; uint16_t min_distance max_distance current_distance; uint8_t type id orientation covariance | float horizontal_fov vertical_fov; float[4] quaternion; uint8_t signal_quality"),
    (140, "ACTUATOR_CONTROL_TARGET", "uint64_t time_usec; float[8] controls; uint8_t group_mlx"),
    (147, "BATTERY_STATUS", "int32_t current_consumed energy_consumed; int16_t temperature; uint16_t[10] voltages; int16_t current_battery; uint8_t id battery_function type; int8_t battery_remaining | int32_t time_remaining; uint8_t charge_state; uint16_t[4] voltages_ext; uint8_t mode; uint32_t fault_bitmask"),
    (163, "AHRS", "float omegaIx omegaIy omegaIz accel_weight renorm_val error_rp error_yaw"),
    (178, "AHRS2", "float roll pitch yaw altitude; int32_t lat lng"),
    (194, "PID_TUNING", "float desired achieved FF P I D; uint8_t axis | float SRate PDmod"),
    (241, "VIBRATION", "uint64_t time_usec; float vibration_x vibration_y vibration_z; uint32_t clipping_0 clipping_1 clipping_2"),
    (331, "ODOMETRY", "uint64_t time_usec; float x y z; float[4] q; float vx vy vz rollspeed pitchspeed yawspeed; float[21] pose_covariance velocity_covariance; uint8_t frame_id child_frame_id | uint8_t reset_counter estimator_type; int8_t quality"),
    (11030, "ESC_TELEMETRY_1_TO_4", "uint16_t[4] voltage current totalcurrent rpm count; uint8_t[4] temperature"),
];

impl Message {
    /// Returns the layout of the message with this number; `None` if the message is not listed.
    pub(crate) fn of(number: u32) -> Option<&'static Self> {
        static ALL: OnceLock<HashMap<u32, Message>> = OnceLock::new();
        let all = || {
            let read = |&(number, name, fields)| Some((number, Self::read(name, fields)?));
            MESSAGES.iter().filter_map(read).collect()
        };
        ALL.get_or_init(all).get(&number)
    }

    fn read(name: &'static str, text: &'static str) -> Option<Self> {
        let (first, later) = text.split_once('|').unwrap_or((text, ""));
        let mut extra = Checksum::default();
        extra.take(format!("{name} ").as_bytes());
        for (kind, field) in fields(first) {
            let (kind, count) = kind.split_once('[').unwrap_or((kind, ""));
            extra.take(format!("{kind} {field} ").as_bytes());
            extra.take(count.trim_end_matches(']').parse().ok().as_slice());
        }
        let mut lines = String::new();
        let mut length = 0;
        for (kind, field) in fields(first).chain(fields(later)) {
            let (of, count) = kind.split_once('[').unwrap_or((kind, "1]"));
            length += size(of)? * count.trim_end_matches(']').parse::<usize>().ok()?;
            lines.extend([kind, " ", field, "\n"]);
        }
        let texts = [(name.to_owned(), lines)].into();
        let definition = Definition::of_px4(name, &texts).ok()?;
        let [low, high] = extra.0.to_le_bytes();
        Some(Self { name, extra: low ^ high, length, definition })
    }
}

/// Parses a list of fields, such as `float roll pitch; uint8_t mode`; returns the type and the name of each field.
fn fields(text: &'static str) -> impl Iterator<Item = (&'static str, &'static str)> {
    text.split(';').flat_map(|group| {
        let mut words = group.split_whitespace();
        let kind = words.next().unwrap_or_default();
        words.map(move |field| (kind, field))
    })
}

fn size(kind: &str) -> Option<usize> {
    Some(match kind {
        "uint8_t" | "int8_t" => 1,
        "uint16_t" | "int16_t" => 2,
        "uint32_t" | "int32_t" | "float" => 4,
        "uint64_t" => 8,
        _ => return None,
    })
}

/// Running checksum of a packet, CRC-16/MCRF4XX.
#[derive(Clone, Copy)]
pub(crate) struct Checksum(pub u16);

impl Default for Checksum {
    fn default() -> Self {
        Self(0xffff)
    }
}

impl Checksum {
    pub(crate) fn take(&mut self, bytes: &[u8]) {
        for byte in bytes {
            let low = byte ^ self.0 as u8;
            let low = u16::from(low ^ low << 4);
            self.0 = self.0 >> 8 ^ low << 8 ^ low << 3 ^ low >> 4;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Checksum, MESSAGES, Message};

    #[test]
    fn checksums_are_those_of_mavlink() {
        let mut check = Checksum::default();
        check.take(b"123456789");
        assert_eq!(check.0, 0x6f91);
        // The values that the generator of MAVLink computes from `common.xml`.
        for (number, extra, length) in
            [(0, 50, 9), (26, 170, 24), (27, 144, 29), (30, 39, 28), (31, 246, 48), (105, 93, 63)]
        {
            let message = Message::of(number).unwrap();
            assert_eq!((message.extra, message.length), (extra, length), "{number}");
        }
        assert!(MESSAGES.iter().all(|(number, ..)| Message::of(*number).is_some()));
    }
}
