//! Finds the axes of the gyroscope and the accelerometer that flew, by the names of a recording's channels.

use super::names::is_instance;

/// A topic of a log, or a table, which has an empty name.
#[derive(Clone, Copy, Debug)]
pub struct Topic<'a> {
    /// Name of the topic.
    pub name: &'a str,
    /// Names of the fields that hold a number, or of the table's columns.
    pub fields: &'a [String],
    /// Number of messages.
    pub count: u64,
}

/// The inertial sensor that flew.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sensor {
    /// Name of its topic; empty in a table.
    pub topic: String,
    /// Names of its axes: turn rates, then accelerations, as far as the topic has both.
    pub fields: Vec<String>,
    /// Names of the other topics that have as many axes of a sensor, or three, best first.
    pub others: Vec<String>,
}

/// A quantity that an inertial sensor measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    Rate,
    Force,
}

/// Topics that hold what the flight controller flew on. Of two topics that are equal otherwise, such a one comes first.
const FLEW: [&str; 3] = ["sensor_combined", "vehicle_angular_velocity", "highres_imu"];

/// Rank of a topic. The fields are compared in their order.
#[allow(
    clippy::struct_excessive_bools,
    reason = "each is a question, and the order of the fields is the rule"
)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Rank {
    has_both_sensors: bool,
    has_three_axes: bool,
    has_rates: bool,
    flew: bool,
    /// Whether it is the first sensor of its kind, and not a further instance such as `IMU:1`.
    is_first: bool,
    /// Whether the numbers are no raw counts.
    has_unit: bool,
    count: u64,
}

/// Finds the inertial sensor that flew. Six axes come before three, turn rates before accelerations, the topics that a
/// flight controller flies on before others, the first sensor before further instances, and then the topic with more
/// messages. Returns `None` if no name tells an inertial sensor.
pub fn find(topics: &[Topic]) -> Option<Sensor> {
    let mut ranked = Vec::new();
    for topic in topics {
        let fields = axes(topic.name, topic.fields);
        let Some(first) = fields.first() else { continue };
        let lower = topic.name.to_lowercase();
        let rank = Rank {
            has_both_sensors: fields.len() == 6,
            has_three_axes: fields.len() >= 3,
            has_rates: quantity(topic.name, first) == Some(Quantity::Rate),
            flew: FLEW.contains(&lower.as_str()),
            is_first: !is_instance(topic.name),
            has_unit: !lower.contains("raw"),
            count: topic.count,
        };
        ranked.push((rank, topic.name, fields));
    }
    // The sort is stable: of equal topics, the first one in the log comes first.
    ranked.sort_by_key(|(rank, ..)| std::cmp::Reverse(*rank));
    let mut ranked = ranked.into_iter();
    let (_, topic, fields) = ranked.next()?;
    let least = fields.len().min(3);
    let others = ranked.filter(|(_, _, axes)| axes.len() >= least).map(|(_, name, _)| name);
    let others: Vec<String> = others.map(str::to_owned).collect();
    Some(Sensor { topic: topic.to_owned(), fields, others })
}

/// Returns the axes of the inertial sensor in a topic: turn rates, then accelerations if the topic has three of each. A
/// sensor whose axes have no names gives its first field.
pub fn axes(topic: &str, fields: &[String]) -> Vec<String> {
    if is_other_topic(&topic.to_lowercase()) {
        return Vec::new();
    }
    let forces = axes_of(topic, fields, Quantity::Force);
    let mut rates = axes_of(topic, fields, Quantity::Rate);
    if rates.is_empty() && forces.len() == 3 {
        // Beside `ax`, `gx` is a turn rate; without it, it may be a gravity.
        rates = three(fields, |field| is_letter(&field.to_lowercase(), &["g"]));
    }
    // A topic that is named after one sensor has the fields of that sensor alone.
    if rates.len() == 3 && forces.len() == 3 && rates[0] != forces[0] {
        rates.extend(forces);
        return rates;
    }
    if rates.len() >= forces.len() { rates } else { forces }
}

/// Returns the group of a bank's parameters to which a field belongs: 0 of turn rates, 1 of sideways forces, 2 of the
/// force along the thrust. Returns `None` if the field is no axis of an inertial sensor.
pub fn group(topic: &str, fields: &[String], field: &str) -> Option<usize> {
    let axes = axes(topic, fields);
    let place = axes.iter().position(|own| own == field);
    if let Some(place) = place.filter(|_| axes.len() == 6) {
        return Some([0, 0, 0, 1, 1, 2][place]);
    }
    match quantity(topic, field) {
        Some(Quantity::Force) => Some(if place == Some(2) { 2 } else { 1 }),
        Some(Quantity::Rate) => Some(0),
        // An axis whose name tells nothing without those beside it, as `gx` beside `ax`.
        None => place.map(|_| 0),
    }
}

/// Returns the field of a topic that one looks at first: the first axis of its inertial sensor, or else a signal.
pub fn first_field<'a>(topic: &str, fields: &'a [String]) -> Option<&'a str> {
    let axes = axes(topic, fields);
    let first_axis = fields.iter().find(|field| axes.first() == Some(field));
    let signal = fields.iter().find(|field| !is_other(&field.to_lowercase()));
    first_axis.or(signal).or(fields.first()).map(String::as_str)
}

fn axes_of(topic: &str, fields: &[String], wanted: Quantity) -> Vec<String> {
    three(fields, |field| quantity(topic, field) == Some(wanted))
}

/// Returns the fields of the three axes, as many as there are, among the fields for which `is_meant` holds. Returns the
/// first such field if fewer than two have an axis.
fn three(fields: &[String], is_meant: impl Fn(&str) -> bool) -> Vec<String> {
    let meant: Vec<&String> = fields.iter().filter(|field| is_meant(field)).collect();
    let mut found: Vec<String> = Vec::new();
    for place in 0..3 {
        let field = meant.iter().find(|field| axis(field) == Some(place));
        found.extend(field.map(|field| (*field).clone()));
    }
    if found.len() < 2 {
        found = meant.first().map(|field| (*field).clone()).into_iter().collect();
    }
    found
}

/// Returns the quantity that the name of a field tells, if it is what an inertial sensor measured. Turn rates come first
/// where a name tells both.
fn quantity(topic: &str, field: &str) -> Option<Quantity> {
    const RATES: [&str; 9] = [
        "gyr",
        "angularvelocity",
        "angular_velocity",
        "angularrate",
        "angular_rate",
        "rotationrate",
        "rotation_rate",
        "bodyrate",
        "body_rate",
    ];
    const FORCES: [&str; 7] = [
        "accel",
        "accsmooth",
        "accadc",
        "linear_acc",
        "linearacc",
        "specific_force",
        "specificforce",
    ];
    let field = field.to_lowercase();
    if is_other(&field) {
        return None;
    }
    let name = if topic.is_empty() { field } else { format!("{}.{field}", topic.to_lowercase()) };
    let joined = name.replace(' ', "_");
    let has = |parts: &[&str]| parts.iter().any(|part| joined.contains(part));
    if has(&RATES) || is_letter(&name, &["w", "omega"]) {
        return Some(Quantity::Rate);
    }
    if has(&FORCES) || is_acc(&joined) || is_letter(&name, &["a"]) {
        return Some(Quantity::Force);
    }
    None
}

/// Returns whether `acc` stands in a lower-case name before an axis or at the end.
fn is_acc(name: &str) -> bool {
    name.match_indices("acc").any(|(place, acc)| {
        let next = name[place + acc.len()..].chars().next();
        next.is_none_or(|next| "xyz_.[".contains(next))
    })
}

/// Returns whether a word of a lower-case name is one of the letters of a quantity with an axis behind it, as `wx`, `w_x`
/// or, in `EuRoC`, `w_rs_s_x`.
fn is_letter(name: &str, letters: &[&str]) -> bool {
    let words = name.split(|letter: char| letter.is_whitespace() || "./[(,".contains(letter));
    for word in words {
        let mut parts = word.split('_');
        let first = parts.next().unwrap_or_default();
        for letter in letters {
            let Some(rest) = first.strip_prefix(letter) else { continue };
            let is_axis_next = rest.is_empty() && parts.clone().any(is_axis_letter);
            if is_axis_letter(rest) || is_axis_next {
                return true;
            }
        }
    }
    false
}

fn is_axis_letter(part: &str) -> bool {
    matches!(part, "x" | "y" | "z")
}

/// Returns whether a field, in lower case, is beside a sensor's samples or is made from them: a time, a setpoint, a
/// temperature.
fn is_other(field: &str) -> bool {
    const PARTS: [&str; 41] = [
        "header",
        "iteration",
        "counter",
        "time",
        "stamp",
        "setpoint",
        "desired",
        "target",
        "bias",
        "varian",
        "integral",
        "clip",
        "temp",
        "device",
        "error",
        "_dt",
        "scale",
        "offset",
        "status",
        "flag",
        "saturat",
        "calib",
        "thrust",
        "unfilt",
        "noise",
        "std",
        "samples",
        "priority",
        "health",
        "accuracy",
        "inconsist",
        "weight",
        "angular_acc",
        "angularacc",
        "hacc",
        "vacc",
        "sacc",
        "h_acc",
        "v_acc",
        "s_acc",
        "covar",
    ];
    PARTS.iter().any(|part| field.contains(part))
        || field.ends_with("seq")
        || field.split(|letter: char| !letter.is_alphanumeric()).any(|word| word == "sp")
}

/// Returns whether a topic, in lower case, holds something other than the samples of a sensor.
fn is_other_topic(topic: &str) -> bool {
    const PARTS: [&str; 13] = [
        "estimator",
        "local_position",
        "setpoint",
        "bias",
        "status",
        "fifo",
        "selection",
        "debug",
        "calib",
        "health",
        "allocat",
        "fft",
        "angular_acc",
    ];
    PARTS.iter().any(|part| topic.contains(part))
}

/// Returns the number of the axis that a field's name tells, 0 to 2.
fn axis(field: &str) -> Option<usize> {
    /// Words of units that may stand behind the axis.
    const UNITS: [&str; 9] = ["rad", "deg", "dps", "rps", "m", "s", "s2", "g", "mg"];
    let field = field.to_lowercase().replace("^2", "2");
    // The unit in brackets, as in `w_x [rad s^-1]`, is no axis.
    let mut stem = field.split(" [").next().unwrap_or_default();
    if let Some((name, _)) = stem.strip_suffix(')').and_then(|rest| rest.rsplit_once('(')) {
        stem = name.trim_end();
    }
    if let Some((rest, index)) = stem.strip_suffix(']').and_then(|rest| rest.rsplit_once('[')) {
        match index.parse::<usize>() {
            Ok(index) => return (index < 3).then_some(index),
            Err(_) => stem = rest,
        }
    }
    for (place, turn) in ["roll", "pitch", "yaw"].iter().enumerate() {
        if stem.contains(turn) {
            return Some(place);
        }
    }
    let is_unit = |word: &&str| UNITS.contains(word);
    let words: Vec<&str> = stem
        .split(|letter: char| !letter.is_alphanumeric())
        .filter(|word| !word.is_empty())
        .collect();
    let last = words.iter().rfind(|word| !is_unit(word))?;
    // MAVLink writes the axis first.
    let is_first = matches!(*last, "xgyro" | "ygyro" | "zgyro" | "xacc" | "yacc" | "zacc");
    let letter = if is_first { last.chars().next() } else { last.chars().next_back() };
    match letter? {
        'x' => Some(0),
        'y' => Some(1),
        'z' => Some(2),
        'p' if *last == "p" => Some(0),
        'q' if *last == "q" => Some(1),
        'r' if *last == "r" => Some(2),
        // A remark may stand behind the axis, as in `a_x, raw`.
        _ => {
            let axis = words.iter().rfind(|word| is_axis_letter(word))?;
            ["x", "y", "z"].iter().position(|letter| letter == axis)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Topic, find};

    fn three(name: &str) -> Vec<String> {
        (0..3).map(|item| format!("{name}[{item}]")).collect()
    }

    /// Returns the fields that `names` lists, with `*` in the place of the axis.
    fn xyz(names: &str) -> Vec<String> {
        let mut all = Vec::new();
        for name in names.split(',').filter(|name| !name.is_empty()) {
            if name.contains('*') {
                all.extend(["x", "y", "z"].map(|axis| name.replace('*', axis)));
            } else {
                all.push(name.to_owned());
            }
        }
        all
    }

    #[test]
    fn fields_have_their_group_in_a_bank() {
        let fields = xyz("temperature,gyro_*,accel_*,mag_x");
        let groups: Vec<_> = fields.iter().map(|field| super::group("", &fields, field)).collect();
        let [rate, side, up] = [Some(0), Some(1), Some(2)];
        assert_eq!(groups, [None, rate, rate, rate, side, side, up, None]);
        let fields = xyz("a*,g*");
        assert_eq!(super::group("", &fields, "gz"), rate);
        assert_eq!(super::group("sensor_accel", &xyz("*"), "z"), up);
        let remarks = ["x", "y", "z"].map(|axis| format!("a_RS_S_{axis}, \"raw\" [m s^-2]"));
        assert_eq!(super::group("", &remarks, &remarks[2]), up);
        assert_eq!(super::first_field("", &xyz("timestamp,alpha")), Some("alpha"));
        assert_eq!(super::first_field("", &xyz("alpha,gyro_*")), Some("gyro_x"));
    }

    fn check(topics: &[(&str, u64, Vec<String>)], topic: &str, fields: &[String], others: &[&str]) {
        let topics: Vec<Topic> = topics
            .iter()
            .map(|(name, count, fields)| Topic { name, fields, count: *count })
            .collect();
        let found = find(&topics).unwrap();
        assert_eq!((found.topic.as_str(), &found.fields[..]), (topic, fields), "{topics:?}");
        assert_eq!(found.others, others, "{topics:?}");
    }

    #[test]
    fn what_flew_is_found_by_its_names() {
        let combined =
            [three("gyro_rad"), xyz("gyro_integral_dt"), three("accelerometer_m_s2")].concat();
        let six = [three("gyro_rad"), three("accelerometer_m_s2")].concat();
        check(
            &[
                ("actuator_outputs", 9, three("output")),
                ("sensor_combined", 30, combined.clone()),
                ("sensor_gyro", 90, xyz("timestamp_sample,device_id,*,temperature")),
                ("vehicle_imu_status", 99, three("gyro_vibration")),
            ],
            "sensor_combined",
            &six,
            &["sensor_gyro"],
        );
        check(
            &[
                ("sensor_accel", 90, xyz("*")),
                ("sensor_gyro", 990, xyz("device_id,*")),
                ("sensor_gyro:1", 999, xyz("device_id,*")),
                ("vehicle_rates_setpoint", 90, xyz("roll,pitch,yaw")),
            ],
            "sensor_gyro",
            &xyz("*"),
            &["sensor_gyro:1", "sensor_accel"],
        );
        check(
            &[("sensor_gyro", 990, xyz("*")), ("vehicle_angular_velocity", 90, three("xyz"))],
            "vehicle_angular_velocity",
            &three("xyz"),
            &["sensor_gyro"],
        );
        let imu = xyz("header.seq,orientation.*,angular_velocity.*,linear_acceleration.*");
        check(
            &[("/clock", 9, xyz("clock")), ("/imu", 90, imu.clone()), ("/imu_raw", 99, imu)],
            "/imu",
            &xyz("angular_velocity.*,linear_acceleration.*"),
            &["/imu_raw"],
        );
        let blackbox = [
            xyz("loopIteration,time"),
            three("axisP"),
            three("gyroADC"),
            three("gyroUnfilt"),
            three("accSmooth"),
        ];
        check(
            &[("main", 9, blackbox.concat())],
            "main",
            &[three("gyroADC"), three("accSmooth")].concat(),
            &[],
        );
        let upper = |name: &str| ["X", "Y", "Z"].map(|axis| format!("{name}{axis}")).to_vec();
        let imu = [xyz("TimeUS"), upper("Gyr"), upper("Acc"), xyz("EG,EA,T")].concat();
        check(
            &[
                ("ATT", 9, xyz("DesRoll,Roll")),
                ("GPS", 9, xyz("HAcc,VAcc,SAcc")),
                ("IMU", 90, imu.clone()),
                ("IMU:1", 91, imu),
            ],
            "IMU",
            &[upper("Gyr"), upper("Acc")].concat(),
            &["IMU:1"],
        );
        let telemetry = xyz("*acc,*gyro,*mag");
        check(
            &[("RAW_IMU", 100, telemetry.clone()), ("SCALED_IMU2", 20, telemetry.clone())],
            "SCALED_IMU2",
            &xyz("*gyro,*acc"),
            &["RAW_IMU"],
        );
    }

    #[test]
    fn tables_are_recognised() {
        for (columns, fields) in [
            (
                "#timestamp [ns],w_RS_S_* [rad s^-1],a_RS_S_* [m s^-2]",
                "w_RS_S_* [rad s^-1],a_RS_S_* [m s^-2]",
            ),
            ("time_us,gyro_*_dps,acc_*_g,battery", "gyro_*_dps,acc_*_g"),
            ("t,a*,g*,m*", "g*,a*"),
            ("Time (s),Gyro * (deg/s),Acc *,Angular velocity", "Gyro * (deg/s),Acc *"),
            ("field.header.seq,field.angular_velocity.*", "field.angular_velocity.*"),
            ("time_us,alpha,gyro_x", "gyro_x"),
            (
                "IMU_ATTI(0):gyro*,IMU_ATTI(0):accel*,IMU_ATTI(1):gyro*",
                "IMU_ATTI(0):gyro*,IMU_ATTI(0):accel*",
            ),
        ] {
            check(&[("", 0, xyz(columns))], "", &xyz(fields), &[]);
        }
        for columns in ["time,alpha", "g*,m*", "roll_rate_sp,yaw_sp", "accuracy,gyro_temp", ""] {
            let fields = xyz(columns);
            assert_eq!(find(&[Topic { name: "", fields: &fields, count: 0 }]), None, "{columns}");
        }
    }
}
