//! The message of a bad constant, written without `core::fmt`, which cannot run at compile time.

use super::ConfigError;

/// Returns the value, or panics with a message that names the parameter and its range. In a constant the panic
/// fails the build.
///
/// # Panics
/// Panics on an error.
#[track_caller]
pub(crate) const fn unwrap<T: Copy>(result: Result<T, ConfigError>) -> T {
    match result {
        Ok(value) => value,
        Err(error) => error.panic(),
    }
}

impl ConfigError {
    /// Panics with a message that names the parameter and what it may be. In a constant that fails the build, as the
    /// constructors of this crate do: it is for those of schemes and codes of your own.
    ///
    /// # Panics
    /// Always.
    #[cold]
    #[track_caller]
    pub const fn panic(self) -> ! {
        panic!("{}", Message::of(self).as_str())
    }
}

/// A text of up to 96 bytes. Longer texts are cut.
struct Message {
    bytes: [u8; 96],
    length: usize,
}

// Constants have no iterators, and every index is compared first.
#[allow(clippy::indexing_slicing)]
impl Message {
    const EMPTY: Self = Self { bytes: [0; 96], length: 0 };

    /// Names the parameter and its range.
    const fn of(error: ConfigError) -> Self {
        let message = Self::EMPTY;
        match error {
            ConfigError::NotPositive { parameter, .. } => {
                message.text(parameter).text(" must be above 0 and finite")
            }
            ConfigError::Negative { parameter, .. } => {
                message.text(parameter).text(" must be 0 or more and finite")
            }
            ConfigError::NotFinite { parameter, .. } => {
                message.text(parameter).text(" must be finite")
            }
            ConfigError::OutOfRange { parameter, min, max, .. } => {
                message.text(parameter).text(" must lie in ").number(min).text("..=").number(max)
            }
            ConfigError::NotRising { parameter, index, .. } => message
                .text(parameter)
                .text(" must rise strictly; see number ")
                .integer(index as u64),
            ConfigError::AllZero { parameter } => {
                message.text(parameter).text(" are all 0; at least one must not be")
            }
            ConfigError::EmptyCell { cell, cells } => message
                .text("number ")
                .integer(cell as u64)
                .text(" of the ")
                .integer(cells as u64)
                .text(" cells must hold a sample: a wider range, fewer cells"),
            ConfigError::FieldTooWide { field, lower } => message
                .text("field ")
                .integer(field as u64)
                .text(" is too wide: it wins where fields ")
                .integer(lower as u64)
                .text(" and ")
                .integer(lower as u64 + 1)
                .text(" meet"),
            ConfigError::TooFewSamples { needed, .. } => {
                message.text("a calibration needs samples, at least ").integer(needed as u64)
            }
        }
    }

    const fn byte(mut self, byte: u8) -> Self {
        if self.length < self.bytes.len() {
            self.bytes[self.length] = byte;
            self.length += 1;
        }
        self
    }

    const fn text(mut self, text: &str) -> Self {
        let mut i = 0;
        while i < text.len() {
            self = self.byte(text.as_bytes()[i]);
            i += 1;
        }
        self
    }

    const fn integer(mut self, value: u64) -> Self {
        let mut place = 1;
        while value / place >= 10 {
            place *= 10;
        }
        while place > 0 {
            self = self.byte(b'0' + (value / place % 10) as u8);
            place /= 10;
        }
        self
    }

    /// Up to six digits, enough to distinguish the end of a range from the next whole number; with a power of ten if
    /// the number is large or small.
    const fn number(mut self, value: f32) -> Self {
        if value < 0.0 {
            return self.byte(b'-').number(-value);
        }
        if value <= 1e6 && value as u32 as f32 == value {
            return self.integer(value as u64);
        }
        let mut mantissa = value as f64;
        let mut exponent = 0;
        while mantissa >= 9.999_995 {
            mantissa /= 10.0;
            exponent += 1;
        }
        while mantissa < 0.999_999_5 {
            mantissa *= 10.0;
            exponent -= 1;
        }
        let mut digits = (mantissa * 1e5 + 0.5) as u64;
        let mut places = 5;
        while places > 0 && digits.is_multiple_of(10) {
            digits /= 10;
            places -= 1;
        }
        let one = 10_u64.pow(places);
        self = self.integer(digits / one);
        if places > 0 {
            self = self.byte(b'.');
            let rest = digits % one;
            let mut place = one / 10;
            while place > 0 {
                self = self.byte(b'0' + (rest / place % 10) as u8);
                place /= 10;
            }
        }
        match exponent {
            0 => self,
            1.. => self.byte(b'e').integer(exponent as u64),
            _ => self.byte(b'e').byte(b'-').integer(-exponent as u64),
        }
    }

    const fn as_str(&self) -> &str {
        let (text, _) = self.bytes.split_at(self.length);
        match core::str::from_utf8(text) {
            Ok(text) => text,
            Err(_) => "a parameter is out of its range",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{ConfigError, Message, unwrap};

    #[test]
    fn every_message_names_the_parameter_and_its_range() {
        let (parameter, value) = ("threshold", -0.5);
        let table = [
            (ConfigError::NotPositive { parameter, value }, "threshold must be above 0 and finite"),
            (ConfigError::Negative { parameter, value }, "threshold must be 0 or more and finite"),
            (ConfigError::NotFinite { parameter, value }, "threshold must be finite"),
            (
                ConfigError::OutOfRange { parameter, value, min: 1e-45, max: 1e31 },
                "threshold must lie in 1.4013e-45..=1e31",
            ),
            (
                ConfigError::OutOfRange { parameter: "floor", value, min: 1.0, max: 10.0 },
                "floor must lie in 1..=10",
            ),
            (
                ConfigError::NotRising { parameter: "centres", index: 12, value, previous: 0.0 },
                "centres must rise strictly; see number 12",
            ),
            (
                ConfigError::AllZero { parameter: "filter taps" },
                "filter taps are all 0; at least one must not be",
            ),
            (
                ConfigError::EmptyCell { cell: 3, cells: 16 },
                "number 3 of the 16 cells must hold a sample: a wider range, fewer cells",
            ),
            (
                ConfigError::FieldTooWide { field: 3, lower: 0 },
                "field 3 is too wide: it wins where fields 0 and 1 meet",
            ),
            (
                ConfigError::TooFewSamples { seen: 2, needed: 3 },
                "a calibration needs samples, at least 3",
            ),
            (
                ConfigError::OutOfRange {
                    parameter: "sum of the filter taps' magnitudes",
                    value,
                    min: 0.0,
                    max: f32::MAX,
                },
                "sum of the filter taps' magnitudes must lie in 0..=3.40282e38",
            ),
        ];
        for (error, text) in table {
            assert_eq!(Message::of(error).as_str(), text);
        }
    }

    #[test]
    fn what_is_too_long_is_cut() {
        let parameter = "0123456789_0123456789_0123456789_0123456789_0123456789_0123456789_0123456789_0123456789_0123456789";
        let message = Message::of(ConfigError::NotFinite { parameter, value: 0.0 });
        assert_eq!(message.as_str(), &parameter[..96]);
    }

    #[test]
    #[should_panic(expected = "step must be above 0 and finite")]
    fn a_refusal_panics_with_its_message() {
        unwrap(crate::error::positive("step", -1.0));
    }

    #[test]
    fn a_value_passes() {
        assert_eq!(unwrap(Ok(5)), 5);
    }

    #[test]
    fn numbers() {
        for (value, text) in [
            (0.0, "0"),
            (-3.0, "-3"),
            (1e6, "1000000"),
            (1e31, "1e31"),
            (-1e31, "-1e31"),
            (0.5, "5e-1"),
            (1.0 / 16_384.0, "6.10352e-5"),
            (4.0 - 1.0 / 16_384.0, "3.99994"),
            (2.25, "2.25"),
        ] {
            assert_eq!(Message::EMPTY.number(value).as_str(), text);
        }
    }
}
