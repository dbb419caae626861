//! Samples and spikes, as the crate and as the reference have them.

use fixed::types::extra::{LeEqU16, LeEqU32};
use fixed::{FixedI16, FixedI32};
use spikewire::{Sample, Spike};

use crate::reference::{Finite, Real, clamped, split_finite};

/// A sample type of the crate, and the number that the reference reads it as.
pub trait Wire: Sample {
    /// What the reference computes in.
    type Real: Real;

    /// The same value.
    fn real(self) -> Self::Real;

    /// Where the type saturates.
    fn ends() -> [Self::Real; 2];

    /// The nearest value of the type, halves upwards.
    fn nearest(value: f64) -> Self;

    /// The factor of a multiplicative BSA: in integers a multiple of 2⁻¹⁴.
    fn ratio(value: f32) -> Self::Real {
        Self::Real::rounded((f64::from(value) * 16_384.0 + 0.5).floor() / 16_384.0)
    }

    /// How large a residual can get, with taps whose magnitudes sum up to this.
    fn residual_limit(_: Self::Real) -> Option<Self::Real> {
        None
    }
}

/// The nearest integer, halves upwards.
fn nearest_integer(value: f64) -> f64 {
    let below = value.floor();
    if value - below >= 0.5 { below + 1.0 } else { below }
}

impl Wire for f32 {
    type Real = f32;

    fn real(self) -> f32 {
        self
    }

    fn ends() -> [f32; 2] {
        [f32::NEG_INFINITY, f32::INFINITY]
    }

    fn nearest(value: f64) -> f32 {
        value as f32
    }

    fn ratio(value: f32) -> f32 {
        value
    }
}

impl Wire for i16 {
    type Real = f64;

    fn real(self) -> f64 {
        f64::from(self)
    }

    fn ends() -> [f64; 2] {
        [-32768.0, 32767.0]
    }

    fn nearest(value: f64) -> i16 {
        nearest_integer(value) as i16
    }
}

macro_rules! fixed_wire {
    ($($Fixed:ident<$Limit:ident> $bits:ty { $($method:tt)* })*) => {$(
        impl<Frac: $Limit + Send + Sync + 'static> Wire for $Fixed<Frac> {
            type Real = f64;

            fn real(self) -> f64 {
                self.to_num()
            }

            fn ends() -> [f64; 2] {
                [Self::MIN.to_num(), Self::MAX.to_num()]
            }

            fn nearest(value: f64) -> Self {
                Self::from_bits(nearest_integer(value / Self::DELTA.to_num::<f64>()) as $bits)
            }

            $($method)*
        }
    )*};
}
fixed_wire! {
    FixedI16<LeEqU16> i16 {}
    FixedI32<LeEqU32> i32 {
        fn residual_limit(magnitude: f64) -> Option<f64> {
            Some(Self::MAX.to_num::<f64>() - magnitude)
        }
    }
}

/// A sample in units of its type's last place; of `f32` the bits.
pub fn whole<S: Sample>(sample: S) -> i64 {
    match size_of::<S>() {
        2 => i64::from((sample.to_bits32() as u16).cast_signed()),
        _ => i64::from(sample.to_bits32().cast_signed()),
    }
}

/// Samples as the reference reads them.
pub fn reals<S: Wire>(samples: &[S]) -> Vec<S::Real> {
    samples.iter().map(|sample| sample.real()).collect()
}

/// A recording as the reference reads it, sorted into finite samples and others.
pub fn finite<S: Wire>(samples: &[S]) -> Finite<S::Real> {
    split_finite(&reals(samples))
}

/// Values of the reference, cut to where the sample type saturates.
pub fn saturated<S: Wire>(values: &[S::Real]) -> Vec<S::Real> {
    let [lowest, highest] = S::ends();
    values.iter().map(|&value| clamped(value, lowest, highest)).collect()
}

/// Spikes as the reference writes them.
pub fn signs_of(spikes: &[Spike]) -> Vec<i8> {
    spikes.iter().map(|spike| spike.sign()).collect()
}

/// Spikes as the crate takes them.
///
/// # Panics
/// If a number is not -1, 0 or 1.
pub fn spikes_of(signs: &[i8]) -> Vec<Spike> {
    let spike = |sign: &i8| match sign {
        -1 => Spike::Down,
        0 => Spike::None,
        1 => Spike::Up,
        sign => panic!("{sign} is no spike"),
    };
    signs.iter().map(spike).collect()
}

/// Asserts the same values, bit for bit.
///
/// # Panics
/// If a bit differs.
pub fn assert_same_values<S: Wire>(ours: &[S], reference: &[S::Real]) {
    assert_eq!(ours.len(), reference.len());
    for (i, (ours, &reference)) in ours.iter().zip(reference).enumerate() {
        let (ours, reference): (f64, f64) = (ours.real().into(), reference.into());
        assert_eq!(ours.to_bits(), reference.to_bits(), "{ours} for {reference} at {i}");
    }
}
