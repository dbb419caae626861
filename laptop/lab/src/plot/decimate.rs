//! Decimates a long recording to the resolution of a picture.

use std::ops::Range;

/// Reduces points to the first, lowest, highest and last point in each column of pixels. Keeps the order of the points.
/// `columns` is the number of columns, and `range` the range of x that all columns together cover.
///
/// A line through these points covers the same pixels as a line through all points.
pub(super) fn decimate(
    points: impl IntoIterator<Item = (f64, f64)>,
    range: &Range<f64>,
    columns: u32,
) -> Vec<(f64, f64)> {
    let mut kept = Vec::new();
    let mut current: Option<Column> = None;
    for (place, point) in points.into_iter().enumerate() {
        let number = column(point.0, range, columns);
        match &mut current {
            Some(column) if column.number == number => column.take(place, point),
            _ => {
                let next = Column::new(number, place, point);
                if let Some(column) = current.replace(next) {
                    column.end(&mut kept);
                }
            }
        }
    }
    if let Some(column) = current {
        column.end(&mut kept);
    }
    kept
}

/// Returns the column of pixels in which `x` lies. `columns` is the number of columns, and `range` the range of x that
/// all columns together cover.
pub(super) fn column(x: f64, range: &Range<f64>, columns: u32) -> i64 {
    let width = range.end - range.start;
    if width > 0.0 { ((x - range.start) / width * f64::from(columns)) as i64 } else { 0 }
}

type Point = (usize, (f64, f64));

struct Column {
    number: i64,
    first: Point,
    low: Point,
    high: Point,
    last: Point,
}

impl Column {
    fn new(number: i64, place: usize, point: (f64, f64)) -> Self {
        let only = (place, point);
        Self { number, first: only, low: only, high: only, last: only }
    }

    fn take(&mut self, place: usize, point: (f64, f64)) {
        let new = (place, point);
        if point.1 < self.low.1.1 {
            self.low = new;
        }
        if point.1 > self.high.1.1 {
            self.high = new;
        }
        self.last = new;
    }

    fn end(self, kept: &mut Vec<(f64, f64)>) {
        let mut points = [self.first, self.low, self.high, self.last];
        points.sort_by_key(|&(place, _)| place);
        let mut before = None;
        for (place, point) in points {
            if before != Some(place) {
                kept.push(point);
            }
            before = Some(place);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::decimate;

    #[test]
    fn each_column_keeps_its_ends_and_extremes_in_order() {
        let points = [(0.0, 5.0), (0.1, 9.0), (0.2, 1.0), (0.3, 4.0), (0.4, 5.0), (1.0, 2.0)];
        let kept = decimate(points, &(0.0..2.0), 2);
        assert_eq!(kept, [(0.0, 5.0), (0.1, 9.0), (0.2, 1.0), (0.4, 5.0), (1.0, 2.0)]);
        assert_eq!(decimate(points, &(0.0..2.0), 1000), points);
        let long = (0..1_000_000).map(|sample| (f64::from(sample), f64::from(sample % 1000)));
        assert_eq!(decimate(long, &(0.0..1e6), 500).len(), 1500);
    }
}
