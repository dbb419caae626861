//! Times in turns: this machine has other work, whose share a ratio within a turn leaves out.

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

/// Two programs of the same work in turns, each as often first as second.
pub struct Turns {
    pairs: Vec<[f64; 2]>,
}

impl Turns {
    pub fn take(rounds: usize, mut one: impl FnMut(), mut other: impl FnMut()) -> Self {
        let pair = |round: usize| {
            if round % 2 == 0 {
                [seconds(&mut one), seconds(&mut other)]
            } else {
                let second = seconds(&mut other);
                [seconds(&mut one), second]
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
