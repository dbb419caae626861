//! A neuron that compares its potential with its threshold once a step, in tinyODIN's integers.

use super::shape::Shape;

/// A neuron that compares its potential with its threshold once a step, and the weights that lead to the neuron. The
/// chip lowers the potentials of all neurons by an offset during a step. Potentials are given here without this offset.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct GatedNeuron {
    /// The weights that lead to the neuron, one for each input of the layer. In a recurrent layer, one weight for each
    /// neuron of the layer follows. The chip splits each weight over one or more rows of synapses.
    pub weights: Vec<i16>,
    /// Amount that the bias adds to the potential in every step.
    pub bias: i16,
    /// Potential at which the neuron fires.
    pub threshold: u16,
    /// Amount by which a leak moves the neuron's potential on the chip towards 0.
    pub leak: u8,
    /// Amount by which a rung raises the potential. A rung is one of the events that raise the neurons in a step.
    pub rung: u8,
    /// Number of additional leaks in a step in which the neuron fires. Other neurons do not receive these leaks.
    pub own_leaks: u16,
    /// Number of weights that exceeded the chip's range and were clipped.
    pub clipped: usize,
}

/// The sums of the weights that act on a neuron in a step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Added {
    /// Sum of all weights that act on the neuron in the step.
    pub all: i32,
    /// Sum of the positive weights only. The potential may rise by this sum during the step, because positive weights
    /// may arrive before negative ones.
    pub raised: i32,
}

impl Added {
    pub(super) fn add(&mut self, weight: i16) {
        self.all += i32::from(weight);
        self.raised += i32::from(weight.max(0));
    }
}

fn towards(potential: i32, centre: i32, by: i32) -> i32 {
    let away = potential - centre;
    centre + away.signum() * (away.abs() - by).max(0)
}

/// Returns the potential after all leaks of a step. Each leak moves the potential by at most `leak` towards the height
/// of the leak. `turn` has one entry for each leak, as in [`Shape::leaks`]. The leaks come from the lowest height to
/// the highest. `height` converts an entry to the height of its leak.
fn leaked(potential: i32, turn: &[u16], leak: i32, height: impl Fn(u16) -> i32) -> i32 {
    // The leaks below the potential move it down, all but the last of them by the whole leak. When one comes, the leaks
    // before have moved the potential already.
    let (mut below, mut end) = (0, turn.len());
    while below < end {
        let middle = usize::midpoint(below, end);
        let is_below = height(turn[middle]) < potential - middle as i32 * leak;
        (below, end) = if is_below { (middle + 1, end) } else { (below, middle) };
    }
    let (downwards, upwards) = turn.split_at(below);
    let lowered = downwards
        .last()
        .map_or(potential, |last| (potential - below as i32 * leak).max(height(*last)));
    upwards.iter().fold(lowered, |potential, fallen| (potential + leak).min(height(*fallen)))
}

impl GatedNeuron {
    /// Runs one step, which changes `potential`. Returns whether the neuron fires. `turn` has one entry for each leak
    /// that acts on all neurons in the step, as in [`Shape::leaks`]. `added` contains the sums of the weights that act
    /// on the neuron in the step.
    #[inline]
    pub(super) fn step(
        &self,
        shape: &Shape,
        turn: &[u16],
        potential: &mut i32,
        added: Added,
    ) -> bool {
        let (above, below) = (i32::from(shape.above), i32::from(shape.below));
        let (threshold, rung) = (i32::from(self.threshold), i32::from(self.rung));
        let (leak, early) = (i32::from(self.leak), threshold + (above + below) * rung);
        let fires = *potential + added.all >= threshold || *potential + added.raised >= early;
        *potential = (*potential + added.all).max(below * rung - 2048);
        if fires {
            // On the chip, a neuron that fires returns to 0 before all rungs have come. The other rungs then raise it,
            // as many as fit into the excess over its threshold. If they lead to the threshold again, the neuron fires
            // again, which counts once.
            let beyond = (*potential - threshold).max(0);
            let again = (threshold + above * rung - 1) / rung.max(1) + 1;
            *potential = if rung > 0 { (beyond / rung % again - above) * rung } else { 0 };
        }
        *potential = leaked(*potential, turn, leak, |fallen| (i32::from(fallen) - above) * rung);
        if fires {
            let centre = (below - i32::from(shape.lift)) * rung;
            *potential = towards(*potential, centre, leak * i32::from(self.own_leaks));
        }
        fires
    }

    /// Splits `weight` into synapses, one in each row, and returns the synapse in row `row`. `rows` has one entry for
    /// each row: the number of events that a spike sends on the row. The sum of all synapses, each multiplied by the
    /// entry of its row, is `weight`. Synapses other than 0 have the sign of `weight`.
    pub(super) fn part(weight: i16, row: usize, rows: &[u16]) -> i8 {
        let (mut rest, mut part) = (weight, 0);
        for &times in rows.iter().take(row + 1) {
            part = (rest / times as i16).clamp(-8, 7);
            rest -= part * times as i16;
        }
        part as i8
    }

    /// Returns the initial potential and the threshold that the chip stores for the neuron. The initial potential is
    /// below 0, by [`below`](Shape::below) times [`rung`](Self::rung). The stored threshold is
    /// [`threshold`](Self::threshold) plus [`above`](Shape::above) times `rung`.
    pub(super) fn held(&self, shape: &Shape) -> (i16, u16) {
        let rung = i16::from(self.rung);
        (-rung * shape.below as i16, self.threshold + shape.above * u16::from(self.rung))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leaks_of_a_step_act_one_after_the_other() {
        for (turn, leak) in [(&[0, 3, 5, 8, 8, 9][..], 4), (&[2, 4, 6], 30), (&[5], 2), (&[], 3)] {
            let height = |fallen: u16| 7 * (i32::from(fallen) - 5);
            for potential in -90..90 {
                let each =
                    turn.iter().fold(potential, |v, fallen| towards(v, height(*fallen), leak));
                assert_eq!(
                    leaked(potential, turn, leak, height),
                    each,
                    "{turn:?} {leak} {potential}"
                );
            }
        }
    }

    #[test]
    fn rows_add_up_to_their_weight() {
        for rows in [&[1][..], &[4, 1], &[8, 1], &[8, 8, 1], &[24, 8, 1]] {
            let sum: u16 = rows.iter().sum();
            for weight in -8 * sum as i16..=7 * sum as i16 {
                let parts = (0..rows.len()).map(|row| GatedNeuron::part(weight, row, rows));
                let parts: Vec<i8> = parts.collect();
                assert!(parts.iter().all(|part| (-8..=7).contains(part)), "{weight} {parts:?}");
                let all =
                    parts.iter().zip(rows).map(|(&part, &times)| i16::from(part) * times as i16);
                assert_eq!(all.sum::<i16>(), weight, "{parts:?}");
                assert!(
                    parts.iter().all(|part| weight == 0 || part * (weight.signum() as i8) >= 0)
                );
            }
        }
    }
}
