//! The number types in which samples are encoded.

use super::error::{Error, ErrorKind};
use spikewire::{Sample, SampleKind};
use std::fmt;
use std::str::FromStr;

/// A sample type, with the name that options and files use.
///
/// Fixed point is arithmetic on raw integers, in any unit. Therefore every format of 16 bits runs as the crate's `i16`,
/// and every format of 32 bits as its `FixedI32`, in the unit that the name states.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SampleType {
    /// `f32`.
    #[default]
    F32,
    /// `i16` or `qI.F` with I + F = 16.
    Fixed16 {
        /// Bits after the binary point.
        fraction: u8,
    },
    /// `i32` or `qI.F` with I + F = 32.
    Fixed32 {
        /// Bits after the binary point.
        fraction: u8,
    },
}

/// The type as which every format of 32 bits runs.
pub type Fixed32 = fixed::types::I16F16;

/// Evaluates an expression with a type parameter set to the crate's type for a sample type.
#[macro_export]
macro_rules! for_sample_type {
    ($sample:expr, $S:ident => $body:expr) => {
        match $sample {
            $crate::run::SampleType::F32 => {
                type $S = f32;
                $body
            }
            $crate::run::SampleType::Fixed16 { .. } => {
                type $S = i16;
                $body
            }
            $crate::run::SampleType::Fixed32 { .. } => {
                type $S = $crate::run::Fixed32;
                $body
            }
        }
    };
}
impl SampleType {
    /// Returns the number that represents 1 in the unit of the crate's type: a power of two.
    pub fn one(self) -> f64 {
        match self {
            Self::F32 => 1.0,
            Self::Fixed16 { fraction } => 2_f64.powi(fraction.into()),
            Self::Fixed32 { fraction } => 2_f64.powi(i32::from(fraction) - 16),
        }
    }

    /// Returns the distance between adjacent values; 0 for floating point.
    pub fn step(self) -> f64 {
        match self {
            Self::F32 => 0.0,
            Self::Fixed16 { fraction } | Self::Fixed32 { fraction } => {
                2_f64.powi(-i32::from(fraction))
            }
        }
    }

    /// Returns the value that stands for this one in fixed point; floating point keeps it as it is.
    pub fn rounded(self, value: f64) -> f64 {
        if self == Self::F32 {
            return value;
        }
        for_sample_type!(self, S => S::from_f64(value * self.one()).to_f64()) / self.one()
    }

    /// Returns the smallest and the largest value.
    pub fn range(self) -> (f64, f64) {
        let (bits, fraction) = match self {
            Self::F32 => return (f32::MIN.into(), f32::MAX.into()),
            Self::Fixed16 { fraction } => (15, fraction),
            Self::Fixed32 { fraction } => (31, fraction),
        };
        let (half, step) = (2_f64.powi(bits), 2_f64.powi(-i32::from(fraction)));
        (-half * step, (half - 1.0) * step)
    }
}

/// The type as a link names it.
impl From<SampleType> for SampleKind {
    fn from(sample: SampleType) -> Self {
        match sample {
            SampleType::F32 => Self::F32,
            SampleType::Fixed16 { fraction } => Self::Fixed16 { fraction },
            SampleType::Fixed32 { fraction } => Self::Fixed32 { fraction },
        }
    }
}

impl fmt::Display for SampleType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::F32 => write!(f, "f32"),
            Self::Fixed16 { fraction: 0 } => write!(f, "i16"),
            Self::Fixed32 { fraction: 0 } => write!(f, "i32"),
            Self::Fixed16 { fraction } => write!(f, "q{}.{fraction}", 16 - fraction),
            Self::Fixed32 { fraction } => write!(f, "q{}.{fraction}", 32 - fraction),
        }
    }
}

impl FromStr for SampleType {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        match name {
            "f32" => return Ok(Self::F32),
            "i16" => return Ok(Self::Fixed16 { fraction: 0 }),
            "i32" => return Ok(Self::Fixed32 { fraction: 0 }),
            _ => {}
        }
        let parts = name.strip_prefix('q').and_then(|bits| bits.split_once('.'));
        let bits = parts.and_then(|(whole, fraction)| {
            Some((whole.parse::<u8>().ok()?, fraction.parse::<u8>().ok()?))
        });
        match bits {
            Some((whole @ 1.., fraction)) if whole.checked_add(fraction) == Some(16) => {
                Ok(Self::Fixed16 { fraction })
            }
            Some((whole @ 1.., fraction)) if whole.checked_add(fraction) == Some(32) => {
                Ok(Self::Fixed32 { fraction })
            }
            _ => Err(ErrorKind::NoSampleType { name: name.to_owned() }.into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::SampleType;

    #[test]
    fn names_and_ranges() {
        for (name, min, max) in [
            ("i16", -32768.0, 32767.0),
            ("q8.8", -128.0, 127.996_093_75),
            ("q1.15", -1.0, 1.0 - 2_f64.powi(-15)),
            ("q16.16", -32768.0, 32768.0 - 2_f64.powi(-16)),
            ("i32", -2_147_483_648.0, 2_147_483_647.0),
        ] {
            let sample: SampleType = name.parse().unwrap();
            assert_eq!((sample.to_string().as_str(), sample.range()), (name, (min, max)));
        }
        for name in ["f64", "q8.9", "q0.16", "q8", "qa.b", "q255.255"] {
            assert!(name.parse::<SampleType>().is_err(), "{name}");
        }
    }
}
