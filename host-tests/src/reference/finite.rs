//! Non-finite samples.
//!
//! A NaN or an infinity emits nothing and leaves the state as it was. So an encoder is run on the
//! finite samples alone, and the rejected ones are counted here.

use super::Real;

/// The samples of a recording, sorted into those that an encoder accepts and those that it counts.
#[derive(Debug, Clone, PartialEq)]
pub struct Finite<T> {
    /// The finite samples, in order.
    pub accepted: Vec<T>,
    /// Where in the recording each accepted sample was.
    pub positions: Vec<usize>,
    /// Where in the recording the rejected samples were.
    pub rejected: Vec<usize>,
}

/// Sorts out the samples that are not finite.
pub fn split_finite<T: Real>(x: &[T]) -> Finite<T> {
    let (positions, rejected): (Vec<usize>, Vec<usize>) =
        (0..x.len()).partition(|&i| x[i].finite());
    Finite { accepted: positions.iter().map(|&i| x[i]).collect(), positions, rejected }
}

#[cfg(test)]
mod tests {
    use super::split_finite;

    #[test]
    fn says_which_samples_were_rejected() {
        let split = split_finite(&[1.0, f32::NAN, 2.0, f32::INFINITY, f32::NEG_INFINITY, -0.0]);
        assert_eq!(split.accepted, [1.0, 2.0, -0.0]);
        assert_eq!(split.positions, [0, 2, 5]);
        assert_eq!(split.rejected, [1, 3, 4]);
    }

    #[test]
    fn keeps_the_largest_and_smallest_numbers() {
        let x = [f64::MAX, f64::MIN, f64::MIN_POSITIVE, 5e-324];
        assert_eq!(split_finite(&x).accepted, x);
    }
}
