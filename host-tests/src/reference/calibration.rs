//! Calibration: what the paper takes from the whole recording.
//!
//! With the `L-1` differences `d[i] = x[i] - x[i-1]`, the threshold of temporal contrast is
//! `mean(d) + factor*std(d)`, `std` with N-1. The mean is signed, so that a falling recording can
//! give a threshold <= 0; the same over `|d|` cannot, for a factor >= 0. The shift of the rate
//! schemes is the minimum.
//!
//! In `f64`, by the two-pass formulas, whatever the sample type.

use super::Real;

/// Mean and standard deviation (N-1) of a list.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moments {
    /// The mean, signed.
    pub mean: f64,
    /// The standard deviation with N-1; 0 for a single value.
    pub deviation: f64,
}

/// What a recording tells about itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Calibration {
    /// The smallest sample.
    pub minimum: f64,
    /// The largest sample.
    pub maximum: f64,
    /// Of the differences between neighbours.
    pub differences: Moments,
    /// Of the differences without their sign.
    pub magnitudes: Moments,
}

impl Moments {
    /// `mean + factor*deviation`
    pub fn threshold(&self, factor: f64) -> f64 {
        self.mean + factor * self.deviation
    }

    fn of(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        let deviation = if values.len() > 1 { (squares / (count - 1.0)).sqrt() } else { 0.0 };
        Self { mean, deviation }
    }
}

/// Reads a whole recording; `None` with fewer than two samples, which have no difference.
pub fn calibrate<T: Real>(x: &[T]) -> Option<Calibration> {
    if x.len() < 2 {
        return None;
    }
    let values: Vec<f64> = x.iter().map(|&value| value.into()).collect();
    let differences: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let magnitudes: Vec<f64> = differences.iter().map(|d| d.abs()).collect();
    Some(Calibration {
        minimum: values.iter().copied().fold(f64::INFINITY, f64::min),
        maximum: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        differences: Moments::of(&differences),
        magnitudes: Moments::of(&magnitudes),
    })
}

#[cfg(test)]
mod tests {
    use super::calibrate;

    #[test]
    fn falling_ramp_gives_a_threshold_of_minus_one() {
        let ramp: Vec<f32> = (0..=10).rev().map(|value| value as f32).collect();
        let read = calibrate(&ramp).unwrap();
        assert_eq!((read.minimum, read.maximum), (0.0, 10.0));
        assert_eq!(read.differences.threshold(1.0), -1.0);
        assert_eq!(read.magnitudes.threshold(1.0), 1.0);
    }

    #[test]
    fn deviation_divides_by_one_less_than_the_count() {
        // Differences 1, 3: mean 2, squares 1 + 1 over 1.
        let read = calibrate(&[0.0, 1.0, 4.0]).unwrap();
        assert_eq!(read.differences.mean, 2.0);
        assert_eq!(read.differences.deviation, 2f64.sqrt());
        // Differences 1, -3: mean -1, squares 4 + 4; magnitudes as above.
        let read = calibrate(&[0.0, 1.0, -2.0]).unwrap();
        assert_eq!(read.differences.mean, -1.0);
        assert_eq!(read.differences.deviation, 8f64.sqrt());
        assert_eq!(read.magnitudes.mean, 2.0);
        assert_eq!(read.magnitudes.deviation, 2f64.sqrt());
        assert_eq!(read.magnitudes.threshold(0.5), 2.0 + 0.5 * 2f64.sqrt());
    }

    #[test]
    fn one_difference_has_no_deviation_and_one_sample_no_difference() {
        let read = calibrate(&[1.0, 1.5]).unwrap();
        assert_eq!(read.differences.threshold(7.0), 0.5);
        assert!(calibrate(&[1.0]).is_none());
        assert!(calibrate::<f32>(&[]).is_none());
    }
}
