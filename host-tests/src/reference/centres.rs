//! Where the neurons of a population sit, in `f64`.
//!
//! Evenly: `mu[i] = min + (2i-1)/2*(max-min)/(m-2)` for `i` in `0..m`, `m >= 3`; the first lies half
//! a step below the minimum, the last half a step above the maximum.
//!
//! Gaussian-spaced, dense at the middle of the range: `z[i]` is the inverse of the normal
//! distribution at `(2i+1)/(2m)`, and `mu[i] = middle + (max-min)/2 * z[i]/z[m-1]`; the first lies on
//! the minimum, the last on the maximum.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use super::Precise;
use statrs::distribution::{ContinuousCDF, Normal};

/// `m` even centres.
///
/// # Panics
/// If `m` is less than 3.
pub fn even_centres(min: f64, max: f64, m: usize) -> Vec<f64> {
    assert!(m >= 3, "even centres are at least three");
    (0..m).map(|i| min + (2.0 * i as f64 - 1.0) / 2.0 * (max - min) / (m as f64 - 2.0)).collect()
}

/// The width of the receptive fields of `m` even centres: `sigma = (max-min)/(beta*(m-2))`.
pub fn receptive_field_width(min: f64, max: f64, m: usize, beta: f64) -> f64 {
    (max - min) / (beta * (m as f64 - 2.0))
}

/// `m` centres spaced as the quantiles of a normal distribution, exactly.
///
/// # Panics
/// If `m` is less than 2.
pub fn gaussian_centres(min: f64, max: f64, m: usize) -> Vec<f64> {
    assert!(m >= 2, "Gaussian-spaced centres are at least two");
    let half = (Precise::from(max) - min) / 2.0;
    let offset = |part: &Precise| (half.clone() * part.clone() + (half.clone() + min)).to_f64();
    spacings(m).iter().map(offset).collect()
}

/// `z[i]/z[m-1]`.
fn spacings(m: usize) -> Arc<[Precise]> {
    static KNOWN: Mutex<BTreeMap<usize, Arc<[Precise]>>> = Mutex::new(BTreeMap::new());
    let mut known = KNOWN.lock().expect("no thread panicked");
    let spaced = || {
        let upper: Vec<_> = (m / 2..m).map(|i| upper_quantile(2 * i + 1, 2 * m)).collect();
        let outermost = &upper[upper.len() - 1];
        let part = |i: usize| upper[i.max(m - 1 - i) - m / 2].clone() / outermost.clone();
        (0..m).map(|i| if 2 * i < m - 1 { -part(i) } else { part(i) }).collect()
    };
    known.entry(m).or_insert_with(spaced).clone()
}

/// The inverse of the normal distribution at a half or more, refined by Newton's steps from that of `statrs`.
fn upper_quantile(part: usize, parts: usize) -> Precise {
    let probability = Precise::from(part as f64) / parts as f64;
    let mut z = Precise::from(Normal::standard().inverse_cdf(part as f64 / parts as f64));
    if 2 * part == parts {
        return Precise::from(0.0);
    }
    let turn = Precise::from(-1.0).acos() * 2.0;
    for _ in 0..3 {
        // The part between 0 and z is the density at z times `z + z^3/3 + z^5/(3*5) + ...`.
        let square = z.clone() * z.clone();
        let density = (square.clone() / -2.0).exp() / turn.sqrt();
        let (mut term, mut sum) = (z.clone(), z.clone());
        for n in 1..120 {
            term = term * square.clone() / f64::from(2 * n + 1);
            sum = sum + term.clone();
        }
        z = z + (probability.clone() - 0.5 - density.clone() * sum) / density;
    }
    z
}

#[cfg(test)]
mod tests {
    use super::{even_centres, gaussian_centres, receptive_field_width};

    #[test]
    fn even_centres_straddle_the_range() {
        assert_eq!(even_centres(0.0, 1.0, 4), [-0.25, 0.25, 0.75, 1.25]);
        assert_eq!(even_centres(-1.0, 1.0, 3), [-2.0, 0.0, 2.0]);
        assert_eq!(receptive_field_width(0.0, 1.0, 4, 2.0), 0.25);
    }

    #[test]
    fn gaussian_centres_are_the_quantiles_scaled_to_the_range() {
        // The quantiles at 1/10, 3/10, 5/10, 7/10, 9/10.
        let ratio = 0.524_400_512_708_041 / 1.281_551_565_544_600_4;
        let expected = [-2.0, -2.0 * ratio, 0.0, 2.0 * ratio, 2.0];
        for (centre, expected) in gaussian_centres(-2.0, 2.0, 5).iter().zip(expected) {
            assert!((centre - expected).abs() < 1e-14, "{centre} and {expected}");
        }
    }

    #[test]
    fn gaussian_centres_rise_and_are_dense_in_the_middle() {
        for m in 4..64 {
            let centres = gaussian_centres(1.0, 3.0, m);
            let steps: Vec<f64> = centres.windows(2).map(|pair| pair[1] - pair[0]).collect();
            assert!((centres[0] - 1.0).abs() < 1e-15 && (centres[m - 1] - 3.0).abs() < 1e-15);
            for pair in steps[..=steps.len() / 2].windows(2).take(steps.len() / 2 - 1) {
                assert!(pair[0] > pair[1] && pair[1] > 0.0);
            }
        }
    }
}
