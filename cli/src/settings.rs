//! A scheme's parameters, complete: all that encoding and decoding need.

/// Parameters of a scheme.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Settings {
    /// Temporal contrast (`tbr`).
    Contrast(Contrast),
    /// Step forward (`sf`).
    StepForward(StepForward),
    /// Moving window (`mw`).
    MovingWindow(MovingWindow),
    /// The rate codes (`hsa`, `t-hsa`, `bsa`).
    Rate(Rate),
    /// Position coding (`position`).
    Position(Centres),
    /// Gaussian receptive fields (`grf`).
    Gaussian(Evenly),
    /// The same with sub-timesteps (`grf-slots`).
    Slots(Slots),
    /// The same with probabilistic spiking (`grf-prob`).
    Probabilistic(Probabilistic),
}

/// Parameters of temporal contrast.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Contrast {
    /// What a difference must exceed.
    pub threshold: f64,
    /// The decoder's step.
    pub step: f64,
    /// The value before the first sample.
    pub start: f64,
}

/// Parameters of step forward.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StepForward {
    /// The step.
    pub threshold: f64,
    /// The first baseline.
    pub start: f64,
}

/// Parameters of the moving window.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MovingWindow {
    /// What the distance from the mean must exceed; also the decoder's step.
    pub threshold: f64,
    /// One less than the samples of a mean, as the paper counts.
    pub window: usize,
    /// The value before the first sample.
    pub start: f64,
    /// The window that the encoder starts from; not needed to decode.
    pub first: Vec<f64>,
}

/// Parameters of a rate code.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Rate {
    /// The filter.
    pub taps: Vec<f64>,
    /// The signal's minimum.
    pub shift: f64,
    /// When a sample spikes.
    pub rule: RateRule,
}

/// When a sample of a rate code spikes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum RateRule {
    /// Where the filter fits.
    Hough,
    /// Where the filter fits, nearly.
    ThresholdHough {
        /// The error allowed.
        threshold: f64,
    },
    /// `e1 <= e2 - threshold`, aligned.
    BenSubtractive {
        /// The gain demanded.
        threshold: f64,
    },
    /// `e1 <= e2 * threshold`, aligned.
    BenMultiplicative {
        /// The part allowed.
        threshold: f64,
    },
    /// `e1 <= e2 * threshold`, with the toolbox's indices.
    BenToolbox {
        /// The part allowed.
        threshold: f64,
    },
}

/// A number of neurons over a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Evenly {
    /// How many.
    pub neurons: usize,
    /// The signal's minimum.
    pub min: f64,
    /// The signal's maximum.
    pub max: f64,
}

/// Where the neurons of a position code are centred.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Centres {
    /// Evenly.
    Linear(Evenly),
    /// Densely in the middle.
    GaussianSpaced(Evenly),
    /// Where the user says.
    Listed(Vec<f64>),
}

impl Centres {
    /// How many neurons there are.
    pub(crate) fn neurons(&self) -> usize {
        match self {
            Self::Linear(range) | Self::GaussianSpaced(range) => range.neurons,
            Self::Listed(list) => list.len(),
        }
    }
}

/// Gaussian receptive fields.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fields {
    /// Where they are.
    pub range: Evenly,
    /// The wider, the smaller.
    pub beta: f64,
}

/// Parameters of receptive fields with sub-timesteps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slots {
    /// The fields.
    pub fields: Fields,
    /// Sub-timesteps a sample.
    #[expect(clippy::struct_field_names, reason = "its name in the options")]
    pub slots: usize,
    /// The lowest level that fires.
    pub floor: u16,
}

/// Parameters of receptive fields with probabilistic spiking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Probabilistic {
    /// The fields.
    pub fields: Fields,
    /// Where the generator starts.
    pub seed: u64,
}

impl Settings {
    /// The same in a unit of which `one` makes a 1.
    pub(crate) fn scaled(&self, one: f64) -> Self {
        let mut scaled = self.clone();
        scaled.visit(|_, value| *value *= one);
        scaled
    }

    /// Visits all numbers in the signal's unit, by the names that they have in files.
    pub(crate) fn visit(&mut self, mut visit: impl FnMut(&'static str, &mut f64)) {
        match self {
            Self::Contrast(contrast) => {
                visit("threshold", &mut contrast.threshold);
                visit("step", &mut contrast.step);
                visit("start", &mut contrast.start);
            }
            Self::StepForward(step_forward) => {
                visit("threshold", &mut step_forward.threshold);
                visit("start", &mut step_forward.start);
            }
            Self::MovingWindow(moving_window) => {
                visit("threshold", &mut moving_window.threshold);
                visit("start", &mut moving_window.start);
                moving_window.first.iter_mut().for_each(|value| visit("first", value));
            }
            Self::Rate(rate) => {
                rate.taps.iter_mut().for_each(|tap| visit("taps", tap));
                visit("shift", &mut rate.shift);
                if let RateRule::ThresholdHough { threshold }
                | RateRule::BenSubtractive { threshold } = &mut rate.rule
                {
                    visit("threshold", threshold);
                }
            }
            Self::Position(Centres::Listed(list)) => {
                for centre in list {
                    visit("centres", centre);
                }
            }
            Self::Position(Centres::Linear(range) | Centres::GaussianSpaced(range))
            | Self::Gaussian(range)
            | Self::Slots(Slots { fields: Fields { range, .. }, .. })
            | Self::Probabilistic(Probabilistic { fields: Fields { range, .. }, .. }) => {
                visit("min", &mut range.min);
                visit("max", &mut range.max);
            }
        }
    }

    /// What the encoder starts from; see [`crate::codec::Encode::prime`].
    pub(crate) fn first_window(&self) -> Vec<f64> {
        match self {
            Self::MovingWindow(moving_window) => moving_window.first.clone(),
            _ => self.start().into_iter().collect(),
        }
    }

    /// The value before the first sample, for decoders that add up.
    pub(crate) fn start(&self) -> Option<f64> {
        match self {
            Self::Contrast(Contrast { start, .. })
            | Self::StepForward(StepForward { start, .. })
            | Self::MovingWindow(MovingWindow { start, .. }) => Some(*start),
            _ => None,
        }
    }

    /// How many neurons there are.
    pub(crate) fn neurons(&self) -> usize {
        match self {
            Self::Position(centres) => centres.neurons(),
            Self::Gaussian(range) => range.neurons,
            Self::Slots(Slots { fields, .. })
            | Self::Probabilistic(Probabilistic { fields, .. }) => fields.range.neurons,
            _ => 1,
        }
    }

    /// How many sub-timesteps a sample has.
    pub(crate) fn slots(&self) -> usize {
        if let Self::Slots(slots) = self { slots.slots } else { 1 }
    }
}
