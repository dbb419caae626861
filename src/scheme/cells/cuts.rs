//! The edges between cells, and the values that cells decode to.

use core::ops::RangeInclusive;

use super::Partition;
use crate::error::{self, tri};
use crate::num::{below_from_f64, floor_from_f64, from_f64, one, to_f64};
use crate::{ConfigError, Sample, SampleKind};

/// To which of two cells a sample on the edge between them belongs.
#[derive(Clone, Copy)]
pub(in crate::scheme) enum Side {
    /// To the lower.
    Low,
    /// To the upper.
    Up,
}

/// The edges of up to `C` cells over a range, before they become a [`Partition`].
///
/// Edges are reals, computed in double precision as the laws of the codes are written. In fixed point an edge at
/// a fraction of the range is exact.
#[derive(Clone, Copy)]
pub(in crate::scheme) struct Cuts<S, const C: usize> {
    /// The smallest sample of the first cell.
    min: S,
    /// The lower end of the first cell.
    start: f64,
    max: S,
    /// The largest sample of each cell: of the last one, the maximum.
    lasts: [S; C],
    /// The upper end of each cell.
    ends: [f64; C],
    /// How many cells there are.
    count: usize,
}

// Constants have no iterators, and every index is compared first.
#[allow(clippy::indexing_slicing)]
impl<S: Sample, const C: usize> Cuts<S, C> {
    /// Cells that all end where the range does, until [set](Self::set).
    ///
    /// # Errors
    /// Returns an error if the ends are not finite, or do not rise.
    pub(in crate::scheme) const fn new(
        range: &RangeInclusive<S>,
        count: usize,
    ) -> Result<Self, ConfigError> {
        let (min, max) = (*range.start(), *range.end());
        tri!(error::range(to_f64(min), to_f64(max)));
        let count = if count < C { count } else { C };
        Ok(Self { min, start: to_f64(min), max, lasts: [max; C], ends: [to_f64(max); C], count })
    }

    /// Leaves out the samples up to an edge: the first cell begins above it.
    pub(in crate::scheme) const fn starting_above(mut self, start: f64) -> Self {
        let below = to_f64::<S>(floor_from_f64(start));
        self.min = match S::KIND {
            SampleKind::F32 => from_f64((below as f32).next_up() as f64),
            _ => from_f64(below + one::<S>()),
        };
        self.start = start;
        self
    }

    /// Cells of one width: edges at `min + cR/count`, each of which belongs to the upper cell.
    ///
    /// # Errors
    /// Returns an error if [`new`](Self::new) does.
    pub(in crate::scheme) const fn even(
        range: &RangeInclusive<S>,
        count: usize,
    ) -> Result<Self, ConfigError> {
        let mut cuts = tri!(Self::new(range, count));
        let mut c = 1;
        while c < cuts.count {
            cuts = cuts.set(c - 1, cuts.at(c, cuts.count), Side::Up);
            c += 1;
        }
        Ok(cuts)
    }

    /// Cells around even points, of which the first and the last are the ends of the range: edges halfway between
    /// the points, each of which belongs to the lower cell.
    ///
    /// # Errors
    /// Returns an error if [`new`](Self::new) does.
    pub(in crate::scheme) const fn points(
        range: &RangeInclusive<S>,
        count: usize,
    ) -> Result<Self, ConfigError> {
        let mut cuts = tri!(Self::new(range, count));
        let mut c = 1;
        while c < cuts.count {
            let (part, parts) = (c.saturating_mul(2), cuts.count.saturating_mul(2));
            let edge = cuts.at(part.saturating_sub(1), parts.saturating_sub(2));
            cuts = cuts.set(c - 1, edge, Side::Low);
            c += 1;
        }
        Ok(cuts)
    }

    /// `min + part * R / parts`; the maximum itself, where the sum may be rounded.
    pub(in crate::scheme) const fn at(&self, part: usize, parts: usize) -> f64 {
        if part == parts {
            return to_f64(self.max);
        }
        self.start + part as f64 * (to_f64(self.max) - self.start) / parts as f64
    }

    /// Ends a cell at an edge.
    pub(in crate::scheme) const fn set(mut self, cell: usize, end: f64, side: Side) -> Self {
        if cell < C {
            let last: S = match side {
                Side::Low => floor_from_f64(end),
                Side::Up => below_from_f64(end),
            };
            // An edge of -0, which total order places below 0, becomes 0.
            self.lasts[cell] = from_f64(to_f64(last) + 0.0);
            self.ends[cell] = end;
        }
        self
    }

    /// The largest sample of a cell.
    pub(in crate::scheme) const fn last(&self, cell: usize) -> S {
        if cell < C { self.lasts[cell] } else { self.max }
    }

    /// The value that a cell decodes to: the middle of its samples; in `f32` the middle of its ends, rounded.
    pub(in crate::scheme) const fn middle(&self, cell: usize) -> S {
        if matches!(S::KIND, SampleKind::F32) {
            let end = if cell < C { self.ends[cell] } else { to_f64(self.max) };
            return from_f64(f64::midpoint(self.start_of(cell), end));
        }
        floor_from_f64(f64::midpoint(to_f64(self.first(cell)), to_f64(self.last(cell))))
    }

    /// Keeps the first `count` cells.
    pub(in crate::scheme) const fn counted(self, count: usize) -> Self {
        Self { count: if count < C { count } else { C }, ..self }
    }

    /// The smallest sample of each cell; in `f32` its lower end, rounded.
    pub(in crate::scheme) const fn firsts(&self) -> [S; C] {
        let mut firsts = [S::ZERO; C];
        let mut cell = 0;
        while cell < self.count && cell < C {
            firsts[cell] = self.first(cell);
            cell += 1;
        }
        firsts
    }

    /// The smallest sample of a cell; in `f32` its lower end, rounded.
    const fn first(&self, cell: usize) -> S {
        match (S::KIND, cell.checked_sub(1)) {
            (SampleKind::F32, _) => from_f64(self.start_of(cell)),
            (_, Some(lower)) if lower < C => from_f64(to_f64(self.lasts[lower]) + one::<S>()),
            _ => self.min,
        }
    }

    /// The lower end of a cell.
    const fn start_of(&self, cell: usize) -> f64 {
        match cell.checked_sub(1) {
            Some(lower) if lower < C => self.ends[lower],
            _ => self.start,
        }
    }

    /// The cells as they are looked up, each of which stands for its middle.
    ///
    /// # Errors
    /// Returns an error if a cell holds no sample.
    pub(in crate::scheme) const fn partition(&self) -> Result<Partition<S, C>, ConfigError> {
        let mut middles = [S::ZERO; C];
        let mut cell = 0;
        while cell < self.count && cell < C {
            middles[cell] = self.middle(cell);
            cell += 1;
        }
        self.partition_of(middles)
    }

    /// The cells as they are looked up, each of which stands for a value.
    ///
    /// # Errors
    /// Returns an error if a cell holds no sample.
    pub(in crate::scheme) const fn partition_of(
        &self,
        values: [S; C],
    ) -> Result<Partition<S, C>, ConfigError> {
        tri!(self.check());
        Ok(Partition::new(values, self.lasts, self.count))
    }

    /// Checks that every cell holds a sample.
    ///
    /// # Errors
    /// Returns an error if a cell holds no sample.
    const fn check(&self) -> Result<(), ConfigError> {
        let mut cell = 0;
        while cell < self.count && cell < C {
            let last = to_f64(if cell + 1 < self.count { self.lasts[cell] } else { self.max });
            let has_samples = match cell.checked_sub(1) {
                None => last >= to_f64(self.min),
                Some(lower) => last > to_f64(self.last(lower)),
            };
            if !has_samples {
                return Err(ConfigError::EmptyCell { cell, cells: self.count });
            }
            cell += 1;
        }
        Ok(())
    }
}

#[cfg(test)]
#[allow(clippy::indexing_slicing, clippy::unwrap_used)]
mod tests {
    use super::{Cuts, Side};
    use crate::ConfigError;

    #[test]
    fn check_values() {
        let even = Cuts::<i16, 5>::even(&(0..=255), 5).unwrap();
        assert_eq!(even.lasts, [50, 101, 152, 203, 255]);
        assert_eq!([0, 1, 2, 3, 4].map(|cell| even.middle(cell)), [25, 76, 127, 178, 229]);
        assert_eq!([0, 1, 2, 3, 4].map(|cell| even.first(cell)), [0, 51, 102, 153, 204]);
        let points = Cuts::<i16, 5>::points(&(0..=255), 5).unwrap();
        assert_eq!(points.lasts, [31, 95, 159, 223, 255]);
    }

    /// Edges, cell by cell, are those of the definition, over all ranges of 8 bits and all numbers of cells to 12.
    #[test]
    fn even_cells_and_points_of_small_ranges() {
        for (min, range) in (-20..20).flat_map(|min| (1..64).map(move |range| (min, range))) {
            for count in 2..=12_usize {
                let cells = count as i32;
                let even = Cuts::<i16, 12>::even(&(min..=min + range), count).unwrap();
                let points = Cuts::<i16, 12>::points(&(min..=min + range), count).unwrap();
                let (min, range) = (i32::from(min), i32::from(range));
                let mut counts = [[0; 12]; 2];
                for p in 0..=range {
                    counts[0][(cells * p / range).min(cells - 1) as usize] += 1;
                    let near = (2 * p * (cells - 1) + range - 1).div_euclid(2 * range);
                    counts[1][near.clamp(0, cells - 1) as usize] += 1;
                }
                for (cuts, counts) in [even, points].iter().zip(counts) {
                    let mut end = min - 1;
                    for cell in 0..count {
                        end += counts[cell];
                        let last = i32::from(cuts.last(cell));
                        assert_eq!(last, end, "{min} {range} {count} {cell} {counts:?}");
                    }
                    let empty = counts[..count].iter().position(|&samples| samples == 0);
                    let error = empty.map(|cell| ConfigError::EmptyCell { cell, cells: count });
                    assert_eq!(cuts.partition().err(), error);
                }
            }
        }
    }

    /// A sample on the edge.
    #[test]
    fn sides() {
        let cuts = Cuts::<f32, 2>::new(&(0.0..=1.0), 2).unwrap();
        assert_eq!(cuts.set(0, 0.5, Side::Low).last(0), 0.5);
        assert_eq!(cuts.set(0, 0.5, Side::Up).last(0), 0.5_f32.next_down());
        assert_eq!(cuts.set(0, 0.1, Side::Up).last(0), 0.1_f32.next_down());
        assert_eq!(cuts.set(0, 0.5, Side::Up).middle(1), 0.75);
        assert_eq!(cuts.set(0, 1.0, Side::Low).partition().err(), {
            Some(ConfigError::EmptyCell { cell: 1, cells: 2 })
        });
    }

    /// What is cut at run time is looked up as what is cut at compile time.
    #[test]
    fn fewer_cells_than_there_is_room_for() {
        let range = -3000..=4000_i16;
        let exact = Cuts::<i16, 37>::even(&range, 37).unwrap().partition().unwrap();
        let roomy = Cuts::<i16, 256>::even(&range, 37).unwrap().partition().unwrap();
        for x in i16::MIN..=i16::MAX {
            assert_eq!(exact.number(x), roomy.number(x), "{x}");
            let cell = (i32::from(x) + 3000).clamp(0, 7000) * 37 / 7000;
            assert_eq!(exact.number(x), cell.min(36) as usize + 1);
        }
    }
}
