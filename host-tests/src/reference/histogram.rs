//! Histogram over even cells, and the quantiles that make centres.
//!
//! A sample: `h[cell] += 1`, and when `Σh = L` every `h >>= 1`; the cell is `min(C-1, ⌊Cp/R⌋)` with
//! `R = max-min` and `p = clamp(x)-min`. With `w = h+1`, `W = Σw`, `c_b = Σ_{a<b} w_a` and `b` the first with
//! `2M·c_{b+1} >= (2i+1)W`, quantile `i` of `M` is `min+R(b+((2i+1)W-2M·c_b)/(2M·w_b))/C`. In `f64`.

/// The cell of a sample, as the last whose border, times `C`, is not above it.
pub fn even_cell(x: f64, min: f64, max: f64, cells: usize) -> usize {
    let above = x.clamp(min, max) - min;
    (1..cells).filter(|&cell| above * cells as f64 >= cell as f64 * (max - min)).count()
}

/// The counts after these samples.
pub fn histogram(x: &[f64], min: f64, max: f64, cells: usize, limit: u32) -> Vec<u32> {
    let mut counts = vec![0; cells];
    for &x in x {
        counts[even_cell(x, min, max, cells)] += 1;
        if counts.iter().sum::<u32>() == limit {
            for count in &mut counts {
                *count >>= 1;
            }
        }
    }
    counts
}

/// The quantiles `(2i+1)/2M`.
pub fn quantile_centres(counts: &[u32], min: f64, max: f64, m: usize) -> Vec<f64> {
    let weights: Vec<u64> = counts.iter().map(|&count| u64::from(count) + 1).collect();
    let sum_below = |b: usize| weights[..b].iter().sum::<u64>();
    let (all, parts) = (sum_below(weights.len()), 2 * m as u64);
    (0..m as u64)
        .map(|i| {
            let wanted = (2 * i + 1) * all;
            let is_reached = |b: &usize| parts * sum_below(b + 1) >= wanted;
            let b = (0..weights.len()).find(is_reached).unwrap_or(weights.len() - 1);
            let part = (wanted - parts * sum_below(b)) as f64 / (parts * weights[b]) as f64;
            min + (max - min) * (b as f64 + part) / counts.len() as f64
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{even_cell, histogram, quantile_centres};

    #[test]
    fn even_counts_give_even_centres() {
        assert_eq!(quantile_centres(&[3; 4], 0.0, 8.0, 4), [1.0, 3.0, 5.0, 7.0]);
        assert_eq!(quantile_centres(&[0; 3], 0.0, 6.0, 2), [1.5, 4.5]);
    }

    #[test]
    fn a_border_belongs_to_the_upper_cell() {
        let cells =
            [-9.0, 0.0, 50.0, 51.0, 254.0, 255.0, 300.0].map(|x| even_cell(x, 0.0, 255.0, 5));
        assert_eq!(cells, [0, 0, 0, 1, 4, 4, 4]);
    }

    #[test]
    fn halves_where_the_limit_is_reached() {
        // 3 and 1 of 4 become 1 and 0.
        assert_eq!(histogram(&[0.0, 0.0, 9.0, 0.0, 9.0], 0.0, 10.0, 2, 4), [1, 1]);
    }
}
