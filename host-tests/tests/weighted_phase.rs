//! Weighted phase: the binary digits of a value's place in its range.

use crate::common::timing::{Lined, assert_law, check, code_of};
use crate::common::{Drawn, cases, flight_channels, hostile_recordings, ranges};
use fixed::types::{I1F15, I8F8, I16F16, I32F0};
use host_tests::reference::{Line, edge, weighted_phase};
use proptest::prelude::*;
use spikewire::timing::{PhaseBits, WeightedPhase};
use spikewire::{ConfigError, Scheme, dynamic};

/// A value's place by its definition, in the arithmetic of its line.
trait Place: Line {
    fn place(self, min: Self, max: Self, digits: u32) -> u32;
    fn of_place(place: u32, min: Self, max: Self, digits: u32) -> Self;
}

impl Place for i64 {
    fn place(self, min: i64, max: i64, digits: u32) -> u32 {
        let above = self.clamp(min, max) - min;
        ((above << digits) / (max - min)).min((1 << digits) - 1) as u32
    }

    fn of_place(place: u32, min: i64, max: i64, digits: u32) -> i64 {
        let number = |x: i64| x.place(min, max, digits) as usize;
        i64::middle(min..=max, number, place as usize..=place as usize, [0.0; 2])
    }
}

/// Each operation rounds once.
impl Place for f32 {
    fn place(self, min: f32, max: f32, digits: u32) -> u32 {
        let (range, mut rest) = (max - min, self.max(min) - min);
        (0..digits).fold(0, |place, _| {
            rest *= 2.0;
            let is_one = self >= max || rest >= range;
            if is_one {
                rest -= range;
            }
            2 * place + u32::from(is_one)
        })
    }

    fn of_place(place: u32, min: f32, max: f32, digits: u32) -> f32 {
        let part = (2 * place + 1) as f32 / (2 << digits) as f32;
        (max - min) * part + min
    }
}

fn check_digits<S: Lined<Line: Place>, const K: usize>([min, max]: [S; 2], x: &[S]) {
    let (low, high) = (min.line(), max.line());
    let scheme = WeightedPhase::<S, K>::try_new(min..=max).unwrap();
    let silence = S::on(Place::of_place(0, low, high, K as u32));
    let place = |x: S::Line| x.place(low, high, K as u32);
    let spikes = |x| weighted_phase(place(x), K as u32);
    check(&scheme, x, Some(silence), spikes, |x| Place::of_place(place(x), low, high, K as u32));
}

#[test]
fn check_values() {
    let scheme = WeightedPhase::<i16, 8>::new(0..=255);
    assert_eq!(scheme.encoder().encode(192), PhaseBits::new(0b1100_0000));
    for x in 0..=255 {
        assert_eq!(scheme.decoder().decode(scheme.encoder().encode(x)), x);
    }
    let scheme = WeightedPhase::<i16, 4>::new(0..=999);
    assert_eq!(scheme.encoder().encode(700), PhaseBits::new(0b1011));
    assert_eq!(scheme.decoder().decode(PhaseBits::new(0b1011)), 718);
    // An image's whole numbers, each on the edge of a cell: a range that is a power of two divides them exactly.
    let scheme = WeightedPhase::<f32, 8>::new(0.0..=256.0);
    assert!((0..256).all(|x: u16| scheme.encoder().encode(x.into()) == PhaseBits::new(x)));
    // The largest value below the maximum, whose distance from the minimum rounds to the range.
    let scheme = WeightedPhase::<f32, 4>::new(-1.0..=1.0);
    assert_eq!(scheme.encoder().encode(1.0_f32.next_down()), PhaseBits::new(0b1111));
    // Outside the range, and not a number.
    let digits = [-9.0, -1.0, 0.0, 1.0, 9.0, f32::NAN].map(|x| scheme.encoder().encode(x).digits());
    assert_eq!(digits, [0, 0, 8, 15, 15, 0]);
}

/// As from a chip: two spikes in a slot are one, and slots that there are not do not count.
#[test]
fn any_spikes_are_a_code() {
    let code = code_of::<PhaseBits<4>>(&[(0, 3), (0, 1), (0, 3), (0, 4), (1, 0)]);
    assert_eq!(code, PhaseBits::new(0b0101));
}

#[test]
fn refusals() {
    for [min, max] in [[f32::NAN, 1.0], [0.0, f32::INFINITY], [1.0, 1.0]] {
        assert!(WeightedPhase::<f32, 4>::try_new(min..=max).is_err());
    }
    let wide = WeightedPhase::<f32, 4>::try_new(f32::MIN..=f32::MAX);
    assert!(matches!(wide, Err(ConfigError::OutOfRange { parameter: "max - min", .. })));
    for slots in [0, 1, 5] {
        let error = WeightedPhase::<i16, 4>::new(0..=9).try_with_slots(slots).unwrap_err();
        assert_eq!(error.to_string(), format!("slots {slots} must lie in 2..=4"));
    }
}

#[test]
fn flights_and_hostile_recordings() {
    for x in flight_channels() {
        check_digits::<f32, 8>([-4.0, 4.0], &x);
        let fixed: Vec<_> = x.iter().map(|&x| I16F16::from_num(x)).collect();
        check_digits::<_, 11>([-4, 4].map(I16F16::from_num), &fixed);
    }
    for x in hostile_recordings() {
        check_digits::<f32, 8>([-1.0, 1.0], &x);
        check_digits::<f32, 16>([0.0, f32::MAX / 2.0], &x);
        check_digits::<f32, 16>([-1e-40, 1e-40], &x);
    }
}

fn drawn<S: Lined<Line: Place> + Drawn>(max_range: f64) {
    proptest!(cases(48), |(x in S::recordings(), range in ranges::<S>())| {
        prop_assume!(range[1].to_f64() - range[0].to_f64() <= max_range);
        check_digits::<S, 2>(range, &x);
        check_digits::<S, 8>(range, &x);
        check_digits::<S, 10>(range, &x);
    });
}

#[test]
fn drawn_recordings() {
    drawn::<f32>((f32::MAX / 2.0).into());
    drawn::<i16>(f64::INFINITY);
    drawn::<I8F8>(f64::INFINITY);
    drawn::<I1F15>(f64::INFINITY);
    drawn::<I16F16>(f64::INFINITY);
    drawn::<I32F0>(f64::INFINITY);
}

/// Every input of 16 bits: spikes, values, and the error's law. Where there are as many cells as samples, the value is
/// exact.
#[test]
fn all_65536_inputs() {
    let all: Vec<_> = (i16::MIN..=i16::MAX).collect();
    for range in [[i16::MIN, i16::MAX], [0, 255], [-20_000, 25_001]] {
        let width = f64::from(range[1]) - f64::from(range[0]);
        check_digits::<i16, 4>(range, &all);
        check_digits::<i16, 8>(range, &all);
        let scheme = WeightedPhase::<i16, 8>::try_new(range[0]..=range[1]).unwrap();
        assert_law(&scheme, all.iter().copied(), range, |_| width / 512.0 + 1.0);
        let scheme = WeightedPhase::<i16, 16>::try_new(range[0]..=range[1]).unwrap();
        assert_law(&scheme, all.iter().copied(), range, |_| 0.0);
    }
    // The edges of the cells, where the doubled rest meets the range.
    for digits in 0..256_u32 {
        let at = edge(-20_000_i64, 25_001, digits, 256);
        let place = |x: f64| (x as i64).place(-20_000, 25_001, 8);
        assert_eq!(place(at.ceil()), digits);
    }
}

#[test]
fn shapes_at_run_time() {
    let all: Vec<_> = (i16::MIN..=i16::MAX).collect();
    let scheme = dynamic::WeightedPhase::<i16>::try_new(-20_000..=25_001).unwrap();
    let scheme = scheme.try_with_slots(6).unwrap();
    let silence = i64::of_place(0, -20_000, 25_001, 6) as i16;
    let place = |x: i64| x.place(-20_000, 25_001, 6);
    let value = |x| i64::of_place(place(x), -20_000, 25_001, 6);
    check(&scheme, &all, Some(silence), |x| weighted_phase(place(x), 6), value);
}
