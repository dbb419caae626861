//! The sample types: set-up conversions to and from `f64`, exact or rounded as documented.

use crate::common::{cases, float};
use fixed::types::{I0F16, I0F32, I1F15, I8F8, I16F0, I16F16, I32F0};
use host_tests::compare::Wire;
use proptest::prelude::*;
use spikewire::{Sample, SampleKind};

/// All inputs of a 16-bit type there and back, and halfway to the next.
fn check<S: Wire>(from_bits: impl Fn(i16) -> S) {
    let unit = from_bits(1).real().into();
    for bits in i16::MIN..=i16::MAX {
        let (x, next) = (from_bits(bits), from_bits(bits.saturating_add(1)));
        let value: f64 = x.real().into();
        assert_eq!(x.to_f64().to_bits(), value.to_bits());
        assert_eq!(S::from_f64(value), x);
        assert_eq!(S::from_f64(value + 0.5 * unit), next);
        assert_eq!(S::from_f64(value + 0.499 * unit), x);
        assert_eq!(S::from_f64(value - 0.5 * unit), x);
    }
}

#[test]
fn all_65536_inputs() {
    check(|bits| bits);
    check(I8F8::from_bits);
    check(I1F15::from_bits);
    check(I0F16::from_bits);
    check(I16F0::from_bits);
}

#[test]
fn ends_saturate_and_not_a_number_is_0() {
    fn check<S: Wire>(zero: S) {
        let [lowest, highest] = S::ends().map(Into::into);
        for (value, expected) in [
            (f64::NEG_INFINITY, lowest),
            (-1e300, lowest),
            (1e300, highest),
            (f64::INFINITY, highest),
        ] {
            assert_eq!(S::from_f64(value).to_f64(), expected);
        }
        assert_eq!(S::from_f64(f64::NAN), zero);
        assert_eq!(S::from_f64(-0.0), zero);
    }
    check(0_i16);
    check(I8F8::ZERO);
    check(I1F15::ZERO);
    check(I16F16::ZERO);
    check(I32F0::ZERO);
    check(I0F32::ZERO);
}

#[test]
fn thirty_two_bits() {
    proptest!(cases(4096), |(bits in any::<i32>(), part in (-499..=499_i16).prop_map(|part| f64::from(part) / 1000.0))| {
        let x = I16F16::from_bits(bits);
        prop_assert_eq!(x.to_f64(), f64::from(bits) / 65_536.0);
        prop_assert_eq!(I16F16::from_f64((f64::from(bits) + part) / 65_536.0), x);
        let x = I0F32::from_bits(bits);
        prop_assert_eq!(I0F32::from_f64((f64::from(bits) + part) / 4_294_967_296.0), x);
    });
}

#[test]
fn floats() {
    proptest!(cases(4096), |(x in float())| {
        prop_assert_eq!(f32::from_f64(x.to_f64()).to_bits(), (f64::from(x) as f32).to_bits());
    });
}

/// The number of a type leaves no room for more fraction than it has bits.
#[test]
fn fractions_end_with_their_bits() {
    for (kind, byte) in [
        (SampleKind::Fixed16 { fraction: 16 }, 17),
        (SampleKind::Fixed16 { fraction: 99 }, 17),
        (SampleKind::Fixed32 { fraction: 32 }, 50),
        (SampleKind::Fixed32 { fraction: 99 }, 50),
    ] {
        assert_eq!(kind.to_byte(), byte, "{kind:?}");
    }
}
