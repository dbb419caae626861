//! MW, moving window.
//!
//! The base of `x[i]` is the mean of the `n = W+1` samples before it; +1 if
//! `x > base + threshold`, -1 if `x < base - threshold`. Without a division: `d = n*x - sum`, +1 if
//! `d > n*threshold`, -1 if `d < -(n*threshold)`.
//!
//! The order of the sum ("two stacks"), which cannot drift: sample `i` lies in slot `i mod n` of
//! block `i div n`. At slot `p` of a block the window is slots `p..n` of the block before (older)
//! and slots `0..p` of its own (newer). The older part is summed from its newest sample to its
//! oldest, the newer part from its oldest to its newest, and the two are added.

use super::Real;

/// Encodes a recording with windows of `n` samples.
///
/// Primed with the `n` samples before the recording, every sample is compared; unprimed, the first
/// `n` emit nothing. Primed with its own first `n` samples, those are compared with their own mean.
///
/// # Panics
/// If `n` is 0, or if there are not exactly `n` priming samples.
pub fn moving_window<T: Real>(x: &[T], n: usize, threshold: T, primed: Option<&[T]>) -> Vec<i8> {
    assert!(n > 0, "a window holds at least one sample");
    let silent = if let Some(history) = primed {
        assert_eq!(history.len(), n, "the priming samples fill the window");
        0
    } else {
        n.min(x.len())
    };
    let history = primed.unwrap_or(&[]);
    let seen: Vec<T> = history.iter().chain(x).copied().collect();
    let mut spikes = vec![0; silent];
    for i in n..seen.len() {
        let difference = T::count(n) * seen[i] - window_sum(&seen, i, n);
        let margin = T::count(n) * threshold;
        spikes.push(if difference > margin {
            1
        } else if difference < -margin {
            -1
        } else {
            0
        });
    }
    spikes
}

/// The sum of the `n` samples before sample `i >= n`.
fn window_sum<T: Real>(seen: &[T], i: usize, n: usize) -> T {
    let block = i - i % n;
    let mut older = seen[block - 1];
    for k in (i - n..block - 1).rev() {
        older = seen[k] + older;
    }
    let mut newer = T::ZERO;
    for &value in &seen[block..i] {
        newer = newer + value;
    }
    older + newer
}

#[cfg(test)]
mod tests {
    use super::{moving_window, window_sum};

    /// The law of the page, with its special first window, in exact integers.
    fn by_the_page(x: &[i64], w: usize, threshold: i64) -> Vec<i8> {
        let n = w + 1;
        let count = i64::try_from(n).unwrap();
        (0..x.len())
            .map(|i| {
                let window = if i < n { &x[..n] } else { &x[i - n..i] };
                let sum: i64 = window.iter().sum();
                let scaled = count * x[i];
                let margin = count * threshold;
                i8::from(scaled > sum + margin) - i8::from(scaled < sum - margin)
            })
            .collect()
    }

    fn integers(count: usize) -> Vec<i64> {
        let mut state = 12345_i64;
        (0..count)
            .map(|_| {
                state = (state * 1_103_515_245 + 12345) % 2_147_483_648;
                state / 65536 % 2001 - 1000
            })
            .collect()
    }

    #[test]
    fn primed_with_its_own_start_it_is_the_law_of_the_page() {
        let x = integers(400);
        let floats: Vec<f64> = x.iter().map(|&value| value as f64).collect();
        for w in 0..9 {
            for threshold in [1, 100, 400] {
                let expected = by_the_page(&x, w, threshold);
                let primed = moving_window(&floats, w + 1, threshold as f64, Some(&floats[..=w]));
                assert_eq!(primed, expected, "window {w}, threshold {threshold}");
                let unprimed = moving_window(&floats, w + 1, threshold as f64, None);
                assert_eq!(unprimed[w + 1..], expected[w + 1..]);
                assert!(unprimed[..=w].iter().all(|&spike| spike == 0));
            }
        }
    }

    #[test]
    fn the_sum_is_taken_in_the_order_of_the_two_stacks() {
        let v: [f32; 8] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8];
        assert_eq!(window_sum(&v, 4, 4), v[0] + (v[1] + (v[2] + v[3])));
        assert_eq!(window_sum(&v, 5, 4), (v[1] + (v[2] + v[3])) + v[4]);
        assert_eq!(window_sum(&v, 6, 4), (v[2] + v[3]) + (v[4] + v[5]));
        assert_eq!(window_sum(&v, 7, 4), v[3] + ((v[4] + v[5]) + v[6]));
    }
}
