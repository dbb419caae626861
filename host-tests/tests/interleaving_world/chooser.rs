//! Who chooses: every choice in turn, or chance.

use rand_core::Rng;
use rand_pcg::Pcg32;

/// Chooses a schedule.
#[derive(Clone, Debug)]
pub(crate) enum Chooser {
    /// Goes through all schedules.
    Every {
        /// The choices so far, each with the number of its options.
        choices: Vec<(u8, u8)>,
        next: usize,
    },
    /// Draws one.
    Random(Box<Pcg32>),
}

impl Chooser {
    pub(crate) fn every() -> Self {
        Self::Every { choices: Vec::new(), next: 0 }
    }

    pub(crate) fn random(seed: u64) -> Self {
        Self::Random(Box::new(Pcg32::new(seed, 7)))
    }

    /// One of so many options.
    pub(crate) fn choose(&mut self, options: u8) -> u8 {
        match self {
            Self::Every { choices, next } => {
                if *next == choices.len() {
                    choices.push((0, options));
                }
                let (chosen, _) = choices[*next];
                *next += 1;
                chosen
            }
            Self::Random(random) => (random.next_u32() % u32::from(options)) as u8,
        }
    }

    /// Goes on to the next schedule, if there is one.
    pub(crate) fn advance(&mut self) -> bool {
        let Self::Every { choices, next } = self else { return false };
        *next = 0;
        while let Some((chosen, options)) = choices.pop() {
            if chosen + 1 < options {
                choices.push((chosen + 1, options));
                return true;
            }
        }
        false
    }
}
