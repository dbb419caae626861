//! Cells on the line of values: which one a value lies in, and its middle.
//!
//! `E` is an edge at `min + part R/parts`, `R = max - min`. A value above it lies in a higher cell; a value on it does
//! where the edge goes "up". Integers are raw units: edges are exact fractions, and the middle of a cell is that of its
//! smallest and largest sample, rounded down. `f32` compares with edges in `f64`, and rounds the middle of two edges once.

use core::cmp::Ordering;
use core::fmt::Debug;
use core::ops::RangeInclusive;

/// A line of values: `f32`, or integers as `i64`.
pub trait Line: Copy + Debug + PartialOrd + Into<Exact> {
    /// The value beside `min + part R/parts`.
    fn beside(self, min: Self, max: Self, part: u32, parts: u32) -> Ordering;

    /// The value beside an edge.
    fn beside_real(self, edge: f64) -> Ordering;

    /// The middle of the samples in `min..=max` with these numbers; in `f32` of these ends.
    fn middle(
        range: RangeInclusive<Self>,
        number: impl Fn(Self) -> usize,
        numbers: RangeInclusive<usize>,
        ends: [f64; 2],
    ) -> Self;
}

/// A value as a double.
#[derive(Clone, Copy, Debug)]
pub struct Exact(pub f64);

impl From<f32> for Exact {
    fn from(value: f32) -> Self {
        Self(value.into())
    }
}

impl From<i64> for Exact {
    fn from(value: i64) -> Self {
        Self(value as f64)
    }
}

impl Line for f32 {
    fn beside(self, min: f32, max: f32, part: u32, parts: u32) -> Ordering {
        self.beside_real(edge(min, max, part, parts))
    }

    fn beside_real(self, edge: f64) -> Ordering {
        f64::from(self).partial_cmp(&edge).expect("finite")
    }

    fn middle(
        _: RangeInclusive<f32>,
        _: impl Fn(f32) -> usize,
        _: RangeInclusive<usize>,
        [low, high]: [f64; 2],
    ) -> f32 {
        f64::midpoint(low, high) as f32
    }
}

impl Line for i64 {
    fn beside(self, min: i64, max: i64, part: u32, parts: u32) -> Ordering {
        let scaled = |value: i64, by: u32| i128::from(value) * i128::from(by);
        scaled(self - min, parts).cmp(&scaled(max - min, part))
    }

    fn beside_real(self, edge: f64) -> Ordering {
        (self as f64).partial_cmp(&edge).expect("finite")
    }

    /// Numbers rise with the value: the ends are found by halving.
    fn middle(
        range: RangeInclusive<i64>,
        number: impl Fn(i64) -> usize,
        numbers: RangeInclusive<usize>,
        _: [f64; 2],
    ) -> i64 {
        let first_with = |least: usize| {
            let (mut low, mut high) = (*range.start(), *range.end() + 1);
            while low < high {
                let middle = (low + high) >> 1;
                if number(middle) >= least { high = middle } else { low = middle + 1 }
            }
            low
        };
        (first_with(*numbers.start()) + first_with(*numbers.end() + 1) - 1) >> 1
    }
}

/// `min + part R/parts`, each operation rounded once in `f64`; at its end the range is not rounded.
pub fn edge<T: Line>(min: T, max: T, part: u32, parts: u32) -> f64 {
    let (Exact(min), Exact(max)) = (min.into(), max.into());
    if part == parts {
        return max;
    }
    min + f64::from(part) * (max - min) / f64::from(parts)
}

/// The cell of a value among `cells` even ones, whose edges go up.
pub fn even<T: Line>(x: T, min: T, max: T, cells: u32) -> usize {
    (1..cells).filter(|&c| x.beside(min, max, c, cells).is_ge()).count()
}

/// The cell of a value among those around `cells` points, halfway to the lower.
pub fn points<T: Line>(x: T, min: T, max: T, cells: u32) -> usize {
    let parts = 2 * (cells - 1);
    (1..cells).filter(|&c| x.beside(min, max, 2 * c - 1, parts).is_gt()).count()
}
