//! Converts samples to doubles and back, at run time and at compile time.
//!
//! Constants cannot call trait methods. These functions read the bytes of the sample, which is plain old data,
//! and its [`SampleKind`] instead.

use bytemuck::{Pod, must_cast_slice};

use super::{Sample, SampleKind};

/// The value as a double, exactly.
pub(crate) const fn to_f64<S: Sample>(value: S) -> f64 {
    let values = [value];
    let bytes: &[u8] = must_cast_slice(&values);
    match (S::KIND, bytes) {
        (SampleKind::F32, &[a, b, c, d]) => f32::from_ne_bytes([a, b, c, d]) as f64,
        (SampleKind::Fixed16 { fraction }, &[a, b]) => {
            i16::from_ne_bytes([a, b]) as f64 / power_of_two(fraction)
        }
        (SampleKind::Fixed32 { fraction }, &[a, b, c, d]) => {
            i32::from_ne_bytes([a, b, c, d]) as f64 / power_of_two(fraction)
        }
        _ => 0.0,
    }
}

/// The value in units of the type's last place, exactly; in `f32` the value itself.
pub(crate) const fn units<S: Sample>(value: S) -> f64 {
    match S::KIND {
        SampleKind::F32 => to_f64(value),
        SampleKind::Fixed16 { fraction } | SampleKind::Fixed32 { fraction } => {
            to_f64(value) * power_of_two(fraction)
        }
    }
}

/// The size of one of the [`units`]: that of the type's last place; 1 in `f32`.
pub(crate) const fn one<S: Sample>() -> f64 {
    match S::KIND {
        SampleKind::F32 => 1.0,
        SampleKind::Fixed16 { fraction } | SampleKind::Fixed32 { fraction } => {
            1.0 / power_of_two(fraction)
        }
    }
}

/// The largest step of a scheme in this type: 10³¹ in `f32`, in fixed point the type's largest value.
pub(crate) const fn largest_step<S: Sample>() -> f64 {
    match S::KIND {
        SampleKind::F32 => crate::error::LARGEST_STEP as f64,
        SampleKind::Fixed16 { fraction } => i16::MAX as f64 / power_of_two(fraction),
        SampleKind::Fixed32 { fraction } => i32::MAX as f64 / power_of_two(fraction),
    }
}

/// The nearest value of the type, halves upwards, saturating; NaN gives 0 in fixed point.
pub(crate) const fn from_f64<S: Sample>(value: f64) -> S {
    match S::KIND {
        SampleKind::F32 => word((value as f32).to_bits() as u64),
        SampleKind::Fixed16 { fraction } | SampleKind::Fixed32 { fraction } => {
            integer(round(value * power_of_two(fraction)))
        }
    }
}

/// The largest value of the type that is not above `value`, saturating.
pub(crate) const fn floor_from_f64<S: Sample>(value: f64) -> S {
    match S::KIND {
        SampleKind::F32 => {
            let nearest = value as f32;
            let floor = if nearest as f64 > value { nearest.next_down() } else { nearest };
            word(floor.to_bits() as u64)
        }
        SampleKind::Fixed16 { fraction } | SampleKind::Fixed32 { fraction } => {
            integer(floor(value * power_of_two(fraction)))
        }
    }
}

/// The largest value of the type that is below `value`, saturating.
pub(crate) const fn below_from_f64<S: Sample>(value: f64) -> S {
    match S::KIND {
        SampleKind::F32 => {
            let nearest = value as f32;
            let below = if nearest as f64 >= value { nearest.next_down() } else { nearest };
            word(below.to_bits() as u64)
        }
        SampleKind::Fixed16 { fraction } | SampleKind::Fixed32 { fraction } => {
            // The floor below a value is the negative of the floor above its negative, less 1.
            integer((-1_i64).saturating_sub(floor(-value * power_of_two(fraction))))
        }
    }
}

/// A number of 2, 4 or 8 bytes, made of the low bits of `bits`.
pub(crate) const fn word<T: Pod>(bits: u64) -> T {
    // Repeated, so that the first bytes hold the number on machines of either byte order.
    let filled = match size_of::<T>() {
        2 => {
            let half = bits & 0xffff;
            half | half << 16 | half << 32 | half << 48
        }
        4 => {
            let half = bits & 0xffff_ffff;
            half | half << 32
        }
        _ => bits,
    };
    let words = [filled];
    let values: &[T] = must_cast_slice(&words);
    match values {
        [first, ..] => *first,
        [] => panic!("a number has no more than 8 bytes"),
    }
}

/// The sample of this raw integer, saturating.
const fn integer<S: Sample>(value: i64) -> S {
    let (min, max) = match S::KIND {
        SampleKind::Fixed16 { .. } => (i16::MIN as i64, i16::MAX as i64),
        _ => (i32::MIN as i64, i32::MAX as i64),
    };
    let value = if value < min {
        min
    } else if value > max {
        max
    } else {
        value
    };
    word(value as u64)
}

const fn power_of_two(exponent: u8) -> f64 {
    (1_u64 << exponent) as f64
}

/// The nearest integer, halves upwards, saturating.
pub(super) const fn round(value: f64) -> i64 {
    let towards_zero = value as i64;
    let rest = value - towards_zero as f64;
    if rest >= 0.5 {
        towards_zero.saturating_add(1)
    } else if rest < -0.5 {
        towards_zero.saturating_sub(1)
    } else {
        towards_zero
    }
}

/// The largest integer that is not above `value`, saturating.
pub(super) const fn floor(value: f64) -> i64 {
    let towards_zero = value as i64;
    if (towards_zero as f64) > value { towards_zero.saturating_sub(1) } else { towards_zero }
}
