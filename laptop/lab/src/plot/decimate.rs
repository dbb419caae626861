//! Decimates a long recording to the resolution of a picture.

/// A point of a curve, as x and y.
pub(super) type Point = (f64, f64);

/// A line that is reduced, as its points come, to the first, lowest, highest and last point in each column of pixels.
/// The order of the points stays.
///
/// A line through these points covers the same pixels as a line through all points.
#[derive(Default)]
pub(super) struct Line {
    kept: Vec<Point>,
    current: Option<Column>,
    /// Number of points so far.
    count: usize,
}

impl Line {
    /// Adds the next point. `column` is the column of pixels in which it lies.
    pub(super) fn add(&mut self, column: i64, point: Point) {
        let placed = (self.count, point);
        self.count += 1;
        match &mut self.current {
            Some(current) if current.number == column => current.take(placed),
            _ => {
                if let Some(before) = self.current.replace(Column::new(column, placed)) {
                    before.end(&mut self.kept);
                }
            }
        }
    }

    /// Returns the points that are kept.
    pub(super) fn end(mut self) -> Vec<Point> {
        if let Some(column) = self.current {
            column.end(&mut self.kept);
        }
        self.kept
    }
}

/// A point and its place in the line.
type Placed = (usize, Point);

struct Column {
    number: i64,
    first: Placed,
    low: Placed,
    high: Placed,
    last: Placed,
}

impl Column {
    fn new(number: i64, only: Placed) -> Self {
        Self { number, first: only, low: only, high: only, last: only }
    }

    fn take(&mut self, new: Placed) {
        if new.1.1 < self.low.1.1 {
            self.low = new;
        }
        if new.1.1 > self.high.1.1 {
            self.high = new;
        }
        self.last = new;
    }

    fn end(self, kept: &mut Vec<Point>) {
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
    use super::{Line, Point};

    fn decimated(points: impl IntoIterator<Item = Point>, columns: f64) -> Vec<Point> {
        let mut line = Line::default();
        points.into_iter().for_each(|point| line.add((point.0 * columns) as i64, point));
        line.end()
    }

    #[test]
    fn each_column_keeps_its_ends_and_extremes_in_order() {
        let points = [(0.0, 5.0), (0.1, 9.0), (0.2, 1.0), (0.3, 4.0), (0.4, 5.0), (1.0, 2.0)];
        let kept = decimated(points, 1.0);
        assert_eq!(kept, [(0.0, 5.0), (0.1, 9.0), (0.2, 1.0), (0.4, 5.0), (1.0, 2.0)]);
        assert_eq!(decimated(points, 500.0), points);
        let long = (0..1_000_000).map(|sample| (f64::from(sample), f64::from(sample % 1000)));
        assert_eq!(decimated(long, 5e-4).len(), 1500);
    }
}
