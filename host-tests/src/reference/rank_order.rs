//! Rank order coding with equal widths and stored centres: the `k` nearest fire, the nearest first, of two alike the
//! lower.
//!
//! `h(i,j) = ⌊(mu[i]+mu[j])/2⌋` in integers. The decoder: `a = min-1`, `b = max`; the winner `w` makes
//! `a = max(a,h(w-1,w))` and `b = min(b,h(w,w+1))`; of the neighbours `l`, `r` of those that fired, `r` before `l` makes
//! `a = max(a,h(l,r))`, `l` before `r` `b = min(b,h(l,r))`; `y = (a+1+b)>>1`. A spike that is neither `l` nor `r`, or
//! leaves `a >= b`, ends it.

/// The order in which neurons fire, of a value within the range, by distances.
pub fn nearest_first(x: i64, centres: &[i64], k: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..centres.len()).collect();
    order.sort_by_key(|&i| ((x - centres[i]).abs(), i));
    order.truncate(k);
    order
}

/// The value of an order, or `None` if not even its first spike makes sense.
pub fn rank_order_value(order: &[usize], centres: &[i64], min: i64, max: i64) -> Option<i64> {
    let half = |i: usize, j: usize| (centres[i] + centres[j]).div_euclid(2);
    let last = centres.len() - 1;
    let &winner = order.first()?;
    let (mut a, mut b) = (min - 1, max);
    if winner > 0 {
        a = a.max(half(winner - 1, winner));
    }
    if winner < last {
        b = b.min(half(winner, winner + 1));
    }
    if a >= b {
        return None;
    }
    let (mut low, mut high) = (winner, winner);
    for &neuron in &order[1..] {
        let (left, right) = (low.checked_sub(1), Some(high + 1).filter(|&right| right <= last));
        let (mut next_a, mut next_b) = (a, b);
        if Some(neuron) == right {
            next_a = left.map_or(a, |left| a.max(half(left, neuron)));
        } else if Some(neuron) == left {
            next_b = right.map_or(b, |right| b.min(half(neuron, right)));
        } else {
            break;
        }
        if next_a >= next_b {
            break;
        }
        (a, b) = (next_a, next_b);
        (low, high) = (low.min(neuron), high.max(neuron));
    }
    Some((a + 1 + b) >> 1)
}

#[cfg(test)]
mod tests {
    use super::{nearest_first, rank_order_value};

    #[test]
    fn the_printed_check_values() {
        let centres = [0, 10, 30, 70, 150];
        for (order, value) in [(&[2][..], 35), (&[2, 1], 30), (&[2, 1, 3], 38)] {
            assert_eq!(nearest_first(37, &centres, order.len()), order);
            assert_eq!(rank_order_value(order, &centres, 0, 150), Some(value));
        }
        // What no value explains ends it.
        assert_eq!(rank_order_value(&[2, 4], &centres, 0, 150), Some(35));
        assert_eq!(rank_order_value(&[2, 1, 1], &centres, 0, 150), Some(30));
    }
}
