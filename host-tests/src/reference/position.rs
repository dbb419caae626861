//! Position coding and GRF with one spike: the neuron whose centre is nearest fires.
//!
//! Ties go to the lower index, and values outside clamp to the end neurons. So the neuron is the
//! number of borders that the value lies beyond, each border halfway between two centres. In `f64`
//! for both sample types.

/// The neuron nearest to each sample: the number of `i` in `0..m-1` with `2x > mu[i] + mu[i+1]`, for
/// strictly rising centres.
pub fn nearest<T, C>(x: &[T], centres: &[C]) -> Vec<usize>
where
    T: Copy + Into<f64>,
    C: Copy + Into<f64>,
{
    x.iter()
        .map(|&value| {
            centres
                .windows(2)
                .filter(|pair| doubled_exceeds(value.into(), pair[0].into(), pair[1].into()))
                .count()
        })
        .collect()
}

/// Exactly `2x > low + high`. In `f64` the sum of two `f32` is rounded where their sizes are more than
/// 29 binary digits apart; what it was rounded by then decides whether a tie is one.
fn doubled_exceeds(x: f64, low: f64, high: f64) -> bool {
    let sum = low + high;
    let (larger, smaller) = if low.abs() > high.abs() { (low, high) } else { (high, low) };
    let lost = smaller - (sum - larger);
    2.0 * x > sum || (2.0 * x == sum && lost < 0.0)
}

/// The nearest of `m` even centres: the number of `i` in `0..m-1` with
/// `x > min + (i*(max-min))/(m-2)`.
pub fn nearest_even<T: Copy + Into<f64>>(x: &[T], min: T, max: T, m: usize) -> Vec<usize> {
    let (min, max): (f64, f64) = (min.into(), max.into());
    x.iter()
        .map(|&value| {
            (0..m - 1)
                .filter(|&i| value.into() > min + (i as f64 * (max - min)) / (m as f64 - 2.0))
                .count()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{nearest, nearest_even};
    use crate::reference::even_centres;

    #[test]
    fn ties_go_to_the_lower_index_and_values_outside_to_the_ends() {
        let centres = [-1.0, 0.0, 4.0];
        let x = [-9.0, -0.5, -0.4375, 2.0, 2.0625, f64::MAX / 4.0, f64::MIN / 4.0];
        assert_eq!(nearest(&x, &centres), [0, 0, 1, 1, 2, 2, 0]);
        let single = [-9.0_f32, -0.5, -0.4375, 2.0, 2.0625, f32::MAX, f32::MIN];
        assert_eq!(nearest(&single, &centres), [0, 0, 1, 1, 2, 2, 0]);
    }

    #[test]
    fn the_even_form_is_the_nearest_of_the_even_centres() {
        // Four neurons on 0..1: borders 0, 0.5 and 1, exact.
        let x: Vec<f32> = (-40..=60).map(|i| i as f32 / 32.0).collect();
        let centres = even_centres(0.0, 1.0, 4);
        assert_eq!(nearest_even(&x, 0.0, 1.0, 4), nearest(&x, &centres));
        assert_eq!(
            nearest_even(&[-0.1, 0.0, 0.001, 0.5, 0.501, 1.0, 1.001], 0.0, 1.0, 4),
            [0, 0, 1, 1, 2, 2, 3]
        );
    }

    #[test]
    fn it_is_the_first_smallest_distance() {
        // The paper's rule, in integers: the first of the smallest distances.
        let centres = [-17_i32, -3, 0, 1, 8, 40];
        for value in -60..60 {
            let first = (0..6).min_by_key(|&i| (value - centres[i]).abs());
            assert_eq!(nearest(&[value], &centres), [first.unwrap()], "{value}");
        }
    }
}
