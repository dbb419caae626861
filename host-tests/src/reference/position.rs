//! Position coding and GRF with one spike: the neuron whose centre is nearest fires.
//!
//! Ties go to the lower index, and values outside clamp to the end neurons. So the neuron is the
//! number of borders that the value lies beyond, each border halfway between two centres. Compared
//! exactly, in `f64` with what its sums leave out: for centres of the user's as they are rounded to the
//! sample type, for even ones as they are before.

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
/// `x > min + i*(max-min)/(m-2)`, exactly: `(m-2)*x > (m-2-i)*min + i*max`. `f64` holds each product of a
/// sample of 32 bits.
pub fn nearest_even<T: Copy + Into<f64>>(x: &[T], min: T, max: T, m: usize) -> Vec<usize> {
    let (min, max): (f64, f64) = (min.into(), max.into());
    x.iter()
        .map(|&value| {
            (0..m - 1)
                .filter(|&i| {
                    let (parts, i) = ((m - 2) as f64, i as f64);
                    is_positive([parts * value.into(), (i - parts) * min, -(i * max)])
                })
                .count()
        })
        .collect()
}

/// The sum of two numbers, rounded, and what the rounding left out (Knuth's `TwoSum`).
fn sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let other = sum - a;
    (sum, (a - (sum - other)) + (b - other))
}

/// Whether three numbers sum up to more than 0, exactly.
fn is_positive([a, b, c]: [f64; 3]) -> bool {
    let (two, first) = sum(a, b);
    let (three, second) = sum(two, c);
    // If `c` takes most of the other two away, it does so exactly, and `second` is 0. If it does not,
    // `three` is larger than what was left out.
    three + (first + second) > 0.0
}

#[cfg(test)]
mod tests {
    use super::{is_positive, nearest, nearest_even};
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
    fn the_even_form_is_exact_where_doubles_are_not() {
        // The border at 0.5 (1 - 2^-100): rounded to a double it would be 0.5 itself.
        let tiny = -(2.0_f32.powi(-100));
        assert_eq!(nearest_even(&[0.5_f32.next_down(), 0.5], tiny, 1.0, 4), [1, 2]);
        assert_eq!(nearest_even(&[0.5, 0.5_f32.next_up()], -tiny, 1.0, 4), [1, 2]);
    }

    #[test]
    fn three_numbers_are_summed_exactly() {
        let (large, tiny) = (2.0_f64.powi(100), 2.0_f64.powi(-100));
        for (numbers, expected) in [
            ([large, 1.0, -large], true),
            ([large, -1.0, -large], false),
            ([large, tiny, -large], true),
            ([tiny, large, -large], true),
            ([large, -large, -tiny], false),
            ([large, 1.0, tiny], true),
            ([1.0, -1.0, 0.0], false),
            ([-large, 1.0, large.next_up()], true),
            ([-large, 1.0, large.next_down()], false),
        ] {
            assert_eq!(is_positive(numbers), expected, "{numbers:?}");
        }
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
