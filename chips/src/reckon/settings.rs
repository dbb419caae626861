//! The registers of `ReckOn` that set its answers and its learning.

/// The setting of the chip's answers: a label (one byte) or the outputs' potentials (two bytes for each output). Also
/// selects whether the driver returns an answer after every step, or only after the sample. With every setting the chip
/// sends an answer in each step, to prove that it has done the step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ReckOnAnswers {
    /// A label after the sample: the number of the output with the most points. In each step with
    /// [`counts`](super::ReckOnStep::counts) set, the output with the highest potential gets a point.
    Label,
    /// The outputs' potentials after the sample.
    Potentials,
    /// The outputs' potentials after every step and after the sample.
    PotentialsEachStep,
}

impl ReckOnAnswers {
    pub(super) const fn is_label(self) -> bool {
        matches!(self, Self::Label)
    }

    pub(super) const fn is_each_step(self) -> bool {
        matches!(self, Self::PotentialsEachStep)
    }
}

/// The kind of target from which the chip learns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ReckOnTask {
    /// The target is a label: the number of the output that should have the highest potential. Give the label once in a
    /// sample, in the first step that learns.
    Classification,
    /// The target is a potential for each output. Give the potentials in every step that learns.
    Regression,
}

/// The parameters of learning by eligibility propagation (e-prop). Every field is a register of the chip; the chip's
/// documentation describes how the registers act together.
///
/// A step that learns takes up to 8 704 clock cycles more. Weights change by 1, with a probability that depends on the
/// learning signal. To make a run repeatable, seed the chip's random generators: write registers 85 to 92 with
/// [`Programmed::set_register`](super::Programmed::set_register).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ReckOnLearning {
    /// Whether weights learn. The three entries are for the weights from inputs, between neurons and to outputs, in
    /// this order.
    pub learns: [bool; 3],
    /// Numbers of extra fractional bits of the traces, 0 to 7 each. The three entries are for the weights from inputs,
    /// between neurons and to outputs, in this order. A trace is a measure of recent spikes, from which weights learn.
    pub traces: [u8; 3],
    /// Left shift of the learning signal, 0 to 15. (After this shift, the chip divides the signal by 4096.)
    pub signal: u8,
    /// Four potentials, in ascending order. They divide the potentials of a neuron into five ranges. For each range,
    /// [`slopes`](Self::slopes) gives a slope of the surrogate gradient.
    pub thresholds: [i16; 4],
    /// Slopes of the surrogate gradient, -16 to 15: one for each of the five ranges of a neuron's potential.
    pub slopes: [i8; 5],
    /// Shifts that set how likely a weight is to change, as pairs of a right shift and a left shift, 0 to 31 each. The
    /// three pairs are for the weights from inputs, between neurons and to outputs, in this order.
    pub rates: [(u8, u8); 3],
    /// Whether outputs are compared with targets directly, without the chip's hard sigmoid.
    pub is_linear: bool,
}

/// The values of the registers that choose what the chip's outputs report, and how its weights learn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ReckOnSettings {
    /// The kind of the chip's answers, and whether the driver returns one after every step.
    pub answers: ReckOnAnswers,
    /// The kind of target from which the chip learns. [`Label`](ReckOnAnswers::Label) answers need
    /// [`Classification`](ReckOnTask::Classification).
    pub task: ReckOnTask,
    /// The parameters of learning; `None` switches learning off. (A reset of the chip switches learning on.)
    pub learning: Option<ReckOnLearning>,
}

impl ReckOnSettings {
    /// Settings without learning: the driver returns the outputs' potentials after every step and after the sample.
    pub const POTENTIALS: Self = Self {
        answers: ReckOnAnswers::PotentialsEachStep,
        task: ReckOnTask::Regression,
        learning: None,
    };
    /// Settings without learning: the driver returns a label after the sample.
    pub const LABEL: Self =
        Self { answers: ReckOnAnswers::Label, task: ReckOnTask::Classification, learning: None };
}
