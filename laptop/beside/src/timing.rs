//! Times in turns: this machine has other work, whose share a ratio within a turn leaves out.
//!
//! A processor learns which way the branches of a short signal go, if it sees that signal again and again, as it would not
//! in flight. So each turn has another variant of the signal, a little larger than the one before.

use std::time::Instant;

pub fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// How many variants of a signal there are. After the last one comes the first again.
const VARIANTS: usize = 16;

/// The variants of a signal.
pub fn variants(signal: &[f64]) -> Vec<Vec<f64>> {
    let larger = |variant: usize| 1.0 + 0.002 * variant as f64;
    (0..VARIANTS).map(|one| signal.iter().map(|x| x * larger(one)).collect()).collect()
}

/// Two programs of the same work in turns, each as often first as second.
pub struct Turns {
    pairs: Vec<[f64; 2]>,
}

impl Turns {
    /// Both programs take the variant of this index.
    pub fn take(rounds: usize, mut one: impl FnMut(usize), mut other: impl FnMut(usize)) -> Self {
        let pair = |round: usize| {
            let variant = round % VARIANTS;
            // Every variant comes first with the one and first with the other.
            if (round / VARIANTS + round) % 2 == 0 {
                [seconds(|| one(variant)), seconds(|| other(variant))]
            } else {
                let second = seconds(|| other(variant));
                [seconds(|| one(variant)), second]
            }
        };
        Self { pairs: (0..rounds).map(pair).collect() }
    }

    /// The median time of one of the two, in seconds.
    pub fn of(&self, which: usize) -> f64 {
        median(self.pairs.iter().map(|pair| pair[which]).collect())
    }

    /// How many times as long the second takes: the median of the turns' ratios.
    pub fn ratio(&self) -> f64 {
        median(self.pairs.iter().map(|pair| pair[1] / pair[0]).collect())
    }
}
