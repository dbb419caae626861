//! The van Rossum distance, which measures how much two spike trains differ.

/// Factor by which an exponential with a time constant of 5 steps decays in one step: e to the power of -1/5.
const KEPT: f64 = 0.818_730_753_077_981_8;

/// The squared distance between two spike trains after van Rossum (2001), with an exponential kernel of 5 steps.
///
/// A missing or an extra spike counts 1; a spike that is `k` steps late counts `2 (1 - exp(-k / 5))`, at most 2.
#[derive(Clone, Copy, Debug, Default)]
pub struct Distance {
    difference: f64,
    sum: f64,
}

impl Distance {
    /// Adds a step, in which the first train has `one` spikes and the second has `other`.
    pub fn step(&mut self, one: usize, other: usize) {
        self.difference = self.difference * KEPT + (one as f64 - other as f64);
        self.sum += self.difference * self.difference;
    }

    /// Returns the distance between the two spike trains over the steps added so far. Further steps can only increase
    /// it.
    pub fn so_far(self) -> f64 {
        (1.0 - KEPT * KEPT) * self.sum
    }

    /// Returns the whole distance: [`so_far`](Self::so_far), plus the part that the exponentials add after the last
    /// step.
    pub fn value(self) -> f64 {
        let after = self.difference * self.difference * KEPT * KEPT / (1.0 - KEPT * KEPT);
        (1.0 - KEPT * KEPT) * (self.sum + after)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(one: &[usize], other: &[usize]) -> f64 {
        let mut distance = Distance::default();
        one.iter().zip(other).for_each(|(&one, &other)| distance.step(one, other));
        distance.value()
    }

    #[test]
    fn a_spike_counts_one_and_a_late_one_by_how_late_it_is() {
        assert_eq!(of(&[0, 1, 0, 2], &[0, 1, 0, 2]), 0.0);
        for (train, other, expected) in [
            (&[1, 0, 0, 0][..], &[0, 0, 0, 0][..], 1.0),
            (&[0, 0, 0, 1], &[0, 0, 0, 0], 1.0),
            (&[1, 0, 0, 0], &[0, 1, 0, 0], 2.0 * (1.0 - (-0.2_f64).exp())),
            (&[1, 0, 0, 0], &[0, 0, 0, 1], 2.0 * (1.0 - (-0.6_f64).exp())),
        ] {
            assert!((of(train, other) - expected).abs() < 1e-12, "{train:?} {other:?}");
        }
    }
}
