//! The filters of the rate schemes, exactly.
//!
//! Their shapes first, at the heights that their formulas give; then scaled to a peak or to a sum,
//! which is `tap / (largest or sum) * wanted`.

use super::Precise;

/// MATLAB's `triang(n)`: for `k = 1..=n` up to the middle `2k/(n+1)` where `n` is odd, and
/// `(2k-1)/n` where it is even; falling as it rose.
pub fn triangular(n: usize) -> Vec<Precise> {
    let part = |k: usize| {
        let k = k.min(n + 1 - k) as f64;
        if n % 2 == 1 { (2.0 * k, n as f64 + 1.0) } else { (2.0 * k - 1.0, n as f64) }
    };
    (1..=n).map(part).map(|(part, parts)| Precise::from(part) / parts).collect()
}

/// Hann without its zeros: `sin²(π(k+1)/(n+1))` for `k` in `0..n`.
pub fn hann(n: usize) -> Vec<Precise> {
    let root = |k: usize| (Precise::from(k as f64 + 1.0) / (n as f64 + 1.0)).sin_pi();
    (0..n).map(|k| root(k) * root(k)).collect()
}

/// MATLAB's `gausswin(n, alpha)`: `exp(-1/2 (alpha (k - (n-1)/2) / ((n-1)/2))²)` for `k` in `0..n`;
/// a single tap is 1.
pub fn gaussian(n: usize, alpha: f64) -> Vec<Precise> {
    if n == 1 {
        return vec![Precise::from(1.0)];
    }
    let half = (n as f64 - 1.0) / 2.0;
    let root = |k: usize| Precise::from(k as f64 - half) * alpha / half;
    (0..n).map(|k| (root(k) * root(k) / -2.0).exp()).collect()
}

/// The same shape with its largest tap at `peak`.
pub fn scaled_to_peak(taps: &[Precise], peak: f64) -> Vec<Precise> {
    let largest = taps.iter().max_by(|a, b| a.to_f64().total_cmp(&b.to_f64()));
    let Some(largest) = largest else { return vec![] };
    taps.iter().map(|tap| tap.clone() * peak / largest.clone()).collect()
}

/// The same shape with its taps adding up to `sum`.
pub fn scaled_to_sum(taps: &[Precise], sum: f64) -> Vec<Precise> {
    let total = taps.iter().fold(Precise::from(0.0), |total, tap| total + tap.clone());
    taps.iter().map(|tap| tap.clone() * sum / total.clone()).collect()
}

/// The values as doubles, whose rounding to a sample type is that of the values.
pub fn doubles(values: &[Precise]) -> Vec<f64> {
    values.iter().map(Precise::to_f64).collect()
}

#[cfg(test)]
mod tests {
    use super::{doubles, gaussian, hann, scaled_to_peak, scaled_to_sum, triangular};
    use crate::reference::Precise;

    fn near(a: &[Precise], b: &[f64]) -> bool {
        a.len() == b.len() && doubles(a).iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-15)
    }

    #[test]
    fn triangular_is_that_of_matlab() {
        assert_eq!(doubles(&triangular(1)), [1.0]);
        assert_eq!(doubles(&triangular(2)), [0.5, 0.5]);
        assert_eq!(doubles(&triangular(3)), [0.5, 1.0, 0.5]);
        assert_eq!(doubles(&triangular(4)), [0.25, 0.75, 0.75, 0.25]);
        assert!(near(&triangular(9), &[0.2, 0.4, 0.6, 0.8, 1.0, 0.8, 0.6, 0.4, 0.2]));
        let fifteen = doubles(&triangular(15));
        assert_eq!((fifteen[0], fifteen[7], fifteen[14]), (0.125, 1.0, 0.125));
    }

    #[test]
    fn hann_leaves_out_the_zeros_at_its_ends() {
        assert_eq!(doubles(&hann(1)), [1.0]);
        assert_eq!(doubles(&hann(3)), [0.5, 1.0, 0.5]);
        assert_eq!(doubles(&hann(5)), [0.25, 0.75, 1.0, 0.75, 0.25]);
    }

    #[test]
    fn gaussian_is_that_of_matlab() {
        assert_eq!(doubles(&gaussian(1, 2.5)), [1.0]);
        let end = (-3.125_f64).exp();
        assert!(near(&gaussian(2, 2.5), &[end, end]));
        assert!(near(&gaussian(3, 2.5), &[end, 1.0, end]));
        assert!(near(
            &gaussian(5, 2.0),
            &[(-2.0_f64).exp(), (-0.5_f64).exp(), 1.0, (-0.5_f64).exp(), (-2.0_f64).exp(),]
        ));
    }

    #[test]
    fn scaling_keeps_the_shape() {
        assert_eq!(doubles(&scaled_to_peak(&triangular(4), 3.0)), [1.0, 3.0, 3.0, 1.0]);
        assert_eq!(doubles(&scaled_to_sum(&triangular(3), 4.0)), [1.0, 2.0, 1.0]);
        for n in 1..40 {
            for shape in [triangular(n), hann(n), gaussian(n, 2.5)] {
                let sum: f64 = doubles(&scaled_to_sum(&shape, 0.7)).iter().sum();
                assert!((sum - 0.7).abs() < 1e-14);
                let peak = doubles(&scaled_to_peak(&shape, 0.7)).into_iter().fold(0.0, f64::max);
                assert_eq!(peak, 0.7);
            }
        }
    }
}
