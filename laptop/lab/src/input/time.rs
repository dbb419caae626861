//! Recognises columns of times and their unit, by the columns' names and values.

use super::TableKind;
use crate::Error;
use speedate::{DateTime, Duration};
use std::fmt;
use std::str::FromStr;

/// Number of picoseconds in a microsecond.
const MICROSECOND: i128 = 1_000_000;

/// A unit of time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub enum TimeUnit {
    /// Seconds.
    S,
    /// Milliseconds.
    Ms,
    /// Microseconds.
    Us,
    /// Nanoseconds.
    Ns,
}

impl TimeUnit {
    /// Returns the length of one unit in µs.
    pub(super) fn microseconds(self) -> f64 {
        self.picoseconds() as f64 / MICROSECOND as f64
    }

    /// Returns the length of one unit in ps.
    fn picoseconds(self) -> i128 {
        match self {
            Self::S => MICROSECOND * 1_000_000,
            Self::Ms => MICROSECOND * 1000,
            Self::Us => MICROSECOND,
            Self::Ns => MICROSECOND / 1000,
        }
    }

    fn of_word(word: &str) -> Option<Self> {
        Some(match word {
            "s" | "sec" | "secs" | "second" | "seconds" => Self::S,
            "ms" | "msec" | "msecs" | "millis" | "millisecond" | "milliseconds" => Self::Ms,
            "us" | "µs" | "μs" | "usec" | "usecs" | "micros" | "microsecond" | "microseconds" => {
                Self::Us
            }
            "ns" | "nsec" | "nsecs" | "nanos" | "nanosec" | "nanosecond" | "nanoseconds" => {
                Self::Ns
            }
            _ => return None,
        })
    }
}

impl FromStr for TimeUnit {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        Self::of_word(text).ok_or_else(|| TableKind::TimeUnit.into())
    }
}

impl fmt::Display for TimeUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::S => "s",
            Self::Ms => "ms",
            Self::Us => "µs",
            Self::Ns => "ns",
        })
    }
}

/// Information in a column's name about the times in the column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Named {
    /// The times are in the given unit.
    In(TimeUnit),
    /// The unit is guessed from the values. If these are whole numbers too small for times since 1970, the times are in
    /// the given unit.
    Whole(TimeUnit),
    /// The column holds times only if its values are dates.
    Dates,
}

/// Recognises a column of times by its name. Knows the names in exports of Betaflight, `ArduPilot`, PX4, ROS and
/// pandas. Returns `None` if the name does not stand for times.
pub(super) fn of_name(name: &str) -> Option<Named> {
    let name = name.trim().to_lowercase();
    match name.as_str() {
        // PX4's own exports count µs from the start; other programs count seconds from 1970.
        "timestamp" | "timestamp_sample" | "time_usec" => return Some(Named::Whole(TimeUnit::Us)),
        "timeus" => return Some(Named::In(TimeUnit::Us)),
        "timems" => return Some(Named::In(TimeUnit::Ms)),
        // PlotJuggler.
        "__time" => return Some(Named::In(TimeUnit::S)),
        // `rostopic echo -p`, `rosbag`.
        "%time" | "rosbagtimestamp" | "field.header.stamp" => return Some(Named::In(TimeUnit::Ns)),
        // The index of a pandas table.
        "" | "unnamed: 0" | "index" | "date" | "datetime" | "date_time" => {
            return Some(Named::Dates);
        }
        // A single letter, which may mean many other things.
        "s" => return None,
        _ => {}
    }
    if let Some(unit) = TimeUnit::of_word(&name) {
        return Some(Named::In(unit));
    }
    if is_time(&name) {
        return Some(Named::Whole(TimeUnit::S));
    }
    let (base, word) = last_word(&name)?;
    is_time(base.trim_end()).then_some(Named::In(TimeUnit::of_word(word)?))
}

/// Interprets the name of the column that the user chose for the times. If the name contains no unit, the unit is
/// guessed from the values. The guess is seconds unless the values or the name suggest another unit.
pub(super) fn of_given(name: &str) -> Named {
    match of_name(name) {
        Some(named @ (Named::In(_) | Named::Whole(_))) => named,
        _ => last_word(&name.trim().to_lowercase())
            .and_then(|(_, word)| TimeUnit::of_word(word))
            .map_or(Named::Whole(TimeUnit::S), Named::In),
    }
}

fn is_time(name: &str) -> bool {
    // DJI's logs have `OSD.flyTime`.
    let is_part = name.rsplit_once('.').is_some_and(|(_, part)| part == "flytime");
    is_part
        || matches!(
            name,
            "time"
                | "timestamp"
                | "t"
                | "ts"
                | "stamp"
                | "elapsed"
                | "elapsed time"
                | "elapsed_time"
                | "header.stamp"
                | "unixtime"
                | "unix_time"
                | "epoch"
        )
}

/// Splits a name into the part before its last word and the last word, which may be a unit. Examples are `time (us)`,
/// `time [us]`, `time_us`, `time us` and `stamp.secs`. Returns `None` if the name has only one word.
fn last_word(name: &str) -> Option<(&str, &str)> {
    let bracketed = |open, close| {
        let (base, word) = name.strip_suffix(close)?.rsplit_once(open)?;
        Some((base.trim_end_matches([' ', '_']), word.trim()))
    };
    bracketed('(', ')')
        .or_else(|| bracketed('[', ']'))
        .or_else(|| name.rsplit_once(['_', ' ', '.', '-', ':']))
}

/// The format of a column's times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reading {
    /// Times as numbers in the given unit.
    Numbers(TimeUnit),
    /// Dates with a time, such as `2024-05-01 12:00:00.005`.
    Dates,
    /// Durations as pandas writes them: `0 days 00:00:00.005`.
    Durations,
}

impl Reading {
    /// Finds the format of a column's times. `named` tells what the column's name says about the times, and `first`
    /// holds the first fields of the column. Returns `None` if the fields are not times.
    pub(super) fn new(named: Named, first: &[&[u8]], has_commas: bool) -> Option<Self> {
        let numbers: Option<Vec<f64>> =
            first.iter().map(|field| number(field, has_commas)).collect();
        match (numbers, named) {
            (Some(numbers), Named::Whole(unit)) => Some(Self::Numbers(by_value(&numbers, unit))),
            (Some(_), Named::In(unit)) => Some(Self::Numbers(unit)),
            (Some(_), Named::Dates) => None,
            (None, _) => {
                let all = |reading: Self| {
                    first.iter().all(|field| reading.read(field, has_commas).is_some())
                };
                [Self::Dates, Self::Durations].into_iter().find(|&reading| all(reading))
            }
        }
    }

    /// Reads a field, and returns its time in ps. Returns `None` if the field is not a time. If `has_commas` is true,
    /// numbers may have a decimal comma.
    pub(super) fn read(self, field: &[u8], has_commas: bool) -> Option<i128> {
        let seconds = |whole: i64| i128::from(whole) * TimeUnit::S.picoseconds();
        match self {
            Self::Numbers(unit) => decimal(field, unit, has_commas).or_else(|| {
                let number = number(field, has_commas)?;
                number.is_finite().then(|| (number * unit.picoseconds() as f64) as i128)
            }),
            Self::Dates => {
                let date = DateTime::parse_str(text(field)?).ok()?;
                Some(seconds(date.timestamp_tz()) + i128::from(date.time.microsecond) * MICROSECOND)
            }
            Self::Durations => {
                let duration = Duration::parse_str(text(field)?).ok()?;
                let rest = i128::from(duration.signed_microseconds()) * MICROSECOND;
                Some(seconds(duration.signed_total_seconds()) + rest)
            }
        }
    }
}

/// Converts a time from ps to µs, because recordings have times in whole µs. Rounds to the nearest µs, and rounds
/// halves up.
pub(super) fn microseconds(picoseconds: i128) -> i64 {
    let rounded = picoseconds.saturating_add(MICROSECOND / 2).div_euclid(MICROSECOND);
    rounded.clamp(i64::MIN.into(), i64::MAX.into()) as i64
}

/// Parses a number in `unit`, and converts it to ps. Keeps all digits down to 1 ps, while a float would keep only 15
/// digits. The decimal sign is a point. If `has_commas`, a comma is a decimal sign as well. Returns `None` for a number
/// in another form, such as one with an exponent, and for a number with more than 24 digits before the decimal sign.
fn decimal(field: &[u8], unit: TimeUnit, has_commas: bool) -> Option<i128> {
    /// Maximum number of digits before the decimal point. The limit keeps the time in ps within 128 bits.
    const MOST: usize = 24;
    let (is_negative, digits) = match field {
        [b'-', digits @ ..] => (true, digits),
        [b'+', digits @ ..] | digits => (false, digits),
    };
    let mut parts = digits.splitn(2, |byte| *byte == b'.' || has_commas && *byte == b',');
    let (whole, part) = (parts.next()?, parts.next().unwrap_or_default());
    let is_decimal = whole.iter().chain(part).all(u8::is_ascii_digit);
    if !is_decimal || whole.is_empty() || whole.len() > MOST {
        return None;
    }
    let digit = |byte: &u8| i128::from(byte - b'0');
    let mut scale = unit.picoseconds();
    let mut sum = whole.iter().fold(0, |sum, byte| sum * 10 + digit(byte)) * scale;
    for byte in part {
        scale /= 10;
        sum += digit(byte) * scale;
    }
    Some(if is_negative { -sum } else { sum })
}

/// Parses a number, with a decimal comma if `has_commas`.
pub(super) fn number(field: &[u8], has_commas: bool) -> Option<f64> {
    fast_float2::parse(field).ok().or_else(|| {
        let text = str::from_utf8(field).ok().filter(|_| has_commas)?;
        fast_float2::parse(text.replacen(',', ".", 1)).ok()
    })
}

fn text(field: &[u8]) -> Option<&str> {
    let text = str::from_utf8(field).ok()?.trim();
    // Without the colon, a plain number would be read as seconds.
    text.contains(':').then_some(text)
}

/// Guesses the unit of times. Large numbers are times since 1970, and their size shows the unit. Smaller numbers are in
/// seconds if any has a fraction; otherwise, they are in the unit `whole`.
fn by_value(values: &[f64], whole: TimeUnit) -> TimeUnit {
    let size = values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    match size {
        1e18.. => TimeUnit::Ns,
        1e15..1e17 => TimeUnit::Us,
        1e12..1e14 => TimeUnit::Ms,
        _ if values.iter().any(|value| value.fract() != 0.0) => TimeUnit::S,
        _ => whole,
    }
}

/// Returns the rate in Hz that the first times of a recording, in ps, would give, if no inertial sensor has such a rate.
/// Two times may be those of a table that is as short; more are needed.
pub(super) fn odd_rate(times: &[i128]) -> Option<f64> {
    const RATES: std::ops::RangeInclusive<f64> = 1.0..=50_000.0;
    const FEWEST: usize = 8;
    let [first, .., last] = times else { return None };
    let rate = (times.len() - 1) as f64 / (last - first) as f64 * 1e12;
    (times.len() >= FEWEST && rate.is_finite() && rate > 0.0 && !RATES.contains(&rate))
        .then_some(rate)
}

/// Returns a note for the user if the first times of a recording, in ps, are implausible. They are implausible if all
/// are equal, or if their median step is below 1 ns or above 1 minute. A median step of 0 is allowed if some step is
/// longer than 0.
pub(super) fn implausible(times: &[i128]) -> Option<String> {
    const SHORTEST: f64 = 1e-3;
    const LONGEST: f64 = 60e6;
    let step = |pair: &[i128]| pair[1].abs_diff(pair[0]) as f64 / MICROSECOND as f64;
    let mut steps: Vec<f64> = times.windows(2).map(step).collect();
    steps.sort_by(f64::total_cmp);
    let (longest, usual) = (*steps.last()?, *steps.get(steps.len() / 2)?);
    if longest == 0.0 {
        return Some(format!("the first {} are all equal", times.len()));
    }
    let seconds = (usual * 1e-6) as f32;
    if usual > 0.0 && usual < SHORTEST {
        return Some(format!("the usual step is {seconds} s, less than a nanosecond"));
    }
    (usual > LONGEST).then(|| format!("the usual step is {seconds} s, more than a minute"))
}

#[cfg(test)]
mod tests {
    use super::{Named, Reading, TimeUnit, microseconds, of_given, of_name};

    /// Columns such as `gyro_ms` and `s` are not times: the first name lacks a word for a time, and the second is
    /// nothing but a unit. A name with both, such as `time_us`, is a name of times. The tests of the command-line
    /// program cover the names in common exports.
    #[test]
    fn names_that_are_no_times() {
        let is = |unit| Some(Named::In(unit));
        for (name, named) in [
            ("time_us", is(TimeUnit::Us)),
            ("timestamp_ns", is(TimeUnit::Ns)),
            ("timestamp (µs)", is(TimeUnit::Us)),
            ("gyro_x", None),
            ("gyro_ms", None),
            ("s", None),
            ("temperature_t", None),
        ] {
            assert_eq!(of_name(name), named, "{name}");
        }
        assert_eq!(of_given("clock"), Named::Whole(TimeUnit::S));
        assert_eq!(of_given("clock (ms)"), Named::In(TimeUnit::Ms));
    }

    #[test]
    fn values_tell_what_names_leave_open() {
        let whole = |unit| Named::Whole(unit);
        let numbers = |unit| Some(Reading::Numbers(unit));
        for (named, value, reading) in [
            (whole(TimeUnit::Us), "1000", numbers(TimeUnit::Us)),
            (whole(TimeUnit::Us), "1714564800.005", numbers(TimeUnit::S)),
            (whole(TimeUnit::S), "1714564800005", numbers(TimeUnit::Ms)),
            (whole(TimeUnit::S), "1714564800005000", numbers(TimeUnit::Us)),
            (whole(TimeUnit::S), "1714564800005000000", numbers(TimeUnit::Ns)),
            (whole(TimeUnit::S), "5", numbers(TimeUnit::S)),
            (Named::In(TimeUnit::Ms), "5.5", numbers(TimeUnit::Ms)),
            (Named::Dates, "5", None),
            (Named::Dates, "2024-05-01 12:00:00.005", Some(Reading::Dates)),
            (whole(TimeUnit::S), "2024-05-01T12:00:00.005+02:00", Some(Reading::Dates)),
            (whole(TimeUnit::S), "0 days 00:00:00.005000", Some(Reading::Durations)),
            (whole(TimeUnit::S), "later", None),
        ] {
            assert_eq!(Reading::new(named, &[value.as_bytes()], false), reading, "{value}");
        }
        let read = |reading: Reading, text: &str| reading.read(text.as_bytes(), false).unwrap();
        let step = read(Reading::Dates, "2024-05-01 12:00:01.005")
            - read(Reading::Dates, "2024-05-01 12:00:00");
        assert_eq!(microseconds(step), 1_005_000);
        let duration = read(Reading::Durations, "1 days 00:00:00.005");
        assert_eq!(microseconds(duration), 86_400_005_000);
    }

    /// All digits of a time stamp are used. As a float, 1520530308199447453 ns would become 1520530308199447.5 µs, and
    /// would be rounded up to the next µs.
    #[test]
    fn all_digits_of_a_stamp_count() {
        for (text, unit, commas, time) in [
            ("1520530308199447453", TimeUnit::Ns, false, 1_520_530_308_199_447),
            ("1403636579758555392", TimeUnit::Ns, false, 1_403_636_579_758_555),
            ("1403636579.7585555", TimeUnit::S, false, 1_403_636_579_758_556),
            ("1403636579.758555499999", TimeUnit::S, false, 1_403_636_579_758_555),
            ("1403636579,758555499999", TimeUnit::S, true, 1_403_636_579_758_555),
            ("-1.5", TimeUnit::Us, false, -1),
            ("+12.", TimeUnit::Ms, false, 12_000),
            ("1.5e3", TimeUnit::Ms, false, 1_500_000),
            ("1e300", TimeUnit::S, false, i64::MAX),
            ("-99999999999999999999999999", TimeUnit::S, false, i64::MIN),
        ] {
            let read = Reading::Numbers(unit).read(text.as_bytes(), commas);
            assert_eq!(read.map(microseconds), Some(time), "{text}");
        }
        assert_eq!(Reading::Numbers(TimeUnit::S).read(b"1403636579x", false), None);
    }
}
