//! Quantiles of a recording whose range is not known in advance.

/// A histogram of equal cells, whose range doubles when a sample lies outside.
///
/// The samples' range covers between a quarter and all of the cells, so a quantile is exact to 1/2048 of that range.
pub(super) struct Quantiles {
    /// Lower end of the first cell.
    low: f64,
    /// Width of a cell; 0 before the first sample.
    width: f64,
    counts: Vec<u64>,
    /// First and last cell with samples.
    filled: (usize, usize),
}

const CELLS: usize = 8192;

impl Quantiles {
    pub(super) fn new() -> Self {
        Self { low: 0.0, width: 0.0, counts: vec![0; CELLS], filled: (CELLS - 1, 0) }
    }

    /// Adds the next sample, which must be finite.
    pub(super) fn observe(&mut self, sample: f64) {
        if self.width == 0.0 {
            // So narrow that a second value widens it.
            self.width = (sample.abs() * 1e-12).max(1e-300);
            self.low = sample - self.width * 0.5 * CELLS as f64;
        }
        while sample < self.low {
            self.low -= self.width * CELLS as f64;
            self.double(CELLS / 2);
        }
        while sample >= self.low + self.width * CELLS as f64 {
            self.double(0);
        }
        let cell = ((sample - self.low) / self.width) as usize;
        let cell = cell.min(CELLS - 1);
        self.counts[cell] += 1;
        self.filled = (self.filled.0.min(cell), self.filled.1.max(cell));
    }

    /// Merges pairs of cells; the first pair goes to the cell at `place`. Between two values that are far apart this
    /// happens a thousand times, so only cells with samples are processed.
    fn double(&mut self, place: usize) {
        self.width *= 2.0;
        let (first, last) = (self.filled.0 / 2, self.filled.1 / 2);
        if first > last {
            return; // there is none yet
        }
        let old = &mut self.counts[2 * first..2 * last + 2];
        let halved: Vec<u64> = old.chunks(2).map(|pair| pair.iter().sum()).collect();
        old.fill(0);
        self.filled = (place + first, place + last);
        self.counts[place + first..=place + last].copy_from_slice(&halved);
    }

    /// Returns the values below which shares of the samples lie; `None` without samples. The shares must rise.
    pub(super) fn quantiles(&self, parts: impl Iterator<Item = f64>) -> Option<Vec<f64>> {
        let all = self.counts.iter().sum::<u64>() as f64;
        let mut cells = self.counts.iter().enumerate().filter(|(_, count)| **count > 0);
        let (mut cell, mut count, mut below) = (0, 0.0, 0.0);
        let quantile = |part: f64| {
            while part * all - below > count || count == 0.0 {
                below += count;
                let (next, own) = cells.next()?;
                (cell, count) = (next, *own as f64);
            }
            Some(self.low + self.width * (cell as f64 + (part * all - below) / count))
        };
        parts.map(quantile).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::Quantiles;

    /// The quantiles are compared with the sorted samples, for ranges near 0, far from it, tiny and large, in any
    /// order.
    #[test]
    fn quantiles_of_what_was_seen() {
        for (scale, offset) in [(1.0, 0.0), (1e-9, 0.0), (1e9, -3e9), (0.5, -9.81), (1.0, 1e6)] {
            let mut quantiles = Quantiles::new();
            assert_eq!(quantiles.quantiles([0.5].into_iter()), None);
            let spread = |i: u32| f64::from(i * 7919 % 10_007) / 10_007.0;
            let mut samples: Vec<f64> =
                (0..10_007).map(|i| spread(i).powi(3) * scale + offset).collect();
            for sample in &samples {
                quantiles.observe(*sample);
            }
            samples.sort_by(f64::total_cmp);
            let parts = [0.01, 0.1, 0.25, 0.5, 0.75, 0.9, 0.99];
            let found = quantiles.quantiles(parts.into_iter()).unwrap();
            for (part, own) in parts.into_iter().zip(found) {
                let sorted = samples[(part * 10_007.0) as usize];
                assert!((own - sorted).abs() <= scale / 1000.0, "{part}: {own} for {sorted}");
            }
        }
    }

    #[test]
    fn one_value_is_every_quantile() {
        for value in [0.0, -9.81, 1e30] {
            let mut quantiles = Quantiles::new();
            for _ in 0..5 {
                quantiles.observe(value);
            }
            let own = quantiles.quantiles([0.3].into_iter()).unwrap()[0];
            assert!((own - value).abs() <= value.abs() * 1e-8 + 1e-290, "{own} for {value}");
        }
    }
}
