//! `ReckOn`'s registers, as far as a network, its answers and its learning need them.

/// The kind of the chip's answers, and when they are returned. The chip sends one in every step, as a proof of the step:
/// one byte for a label, two for each output's potential.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ReckOnAnswers {
    /// After the sample: the output that was the highest in the most steps with [`ReckOnStep::counts`](super::ReckOnStep::counts).
    Label,
    /// After the sample: the outputs' potentials.
    Potentials,
    /// After every step and after the sample: the outputs' potentials.
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

/// The kind of a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ReckOnTask {
    /// The number of an output, told in the first step of a sample that learns.
    Classification,
    /// A potential for each output, told in every step that learns.
    Regression,
}

/// How the chip learns, by e-prop. Every field is a register of the chip; its documentation says how they act together.
///
/// A step that learns takes up to 8 704 clocks more. Weights change by 1, at random: seed the sources for a run that
/// can be repeated, with [`Programmed::set_register`](super::Programmed::set_register), registers 85 to 92.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ReckOnLearning {
    /// Whether weights of inputs, of neurons and of outputs learn.
    pub learns: [bool; 3],
    /// Shifts of the traces of inputs, neurons and outputs, 0 to 7 each.
    pub traces: [u8; 3],
    /// Shift of the learning signal, 0 to 15.
    pub signal: u8,
    /// Potentials below which the slope is one of the first four in [`slopes`](Self::slopes), ascending.
    pub thresholds: [i16; 4],
    /// The slope that stands in for the derivative of firing, -16 to 15 each.
    pub slopes: [i8; 5],
    /// How likely weights of inputs, neurons and outputs move: shift right and shift left, 0 to 31 each.
    pub rates: [(u8, u8); 3],
    /// Whether outputs are compared as they are, without the chip's hard sigmoid.
    pub is_linear: bool,
}

/// The registers with which the chip runs a network.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ReckOnSettings {
    /// The kind of the chip's answers.
    pub answers: ReckOnAnswers,
    /// The kind of targets. Labels exist in classification only.
    pub task: ReckOnTask,
    /// How the chip learns; `None` switches learning off, which after reset is on.
    pub learning: Option<ReckOnLearning>,
}

impl ReckOnSettings {
    /// Without learning: the outputs' potentials in each step.
    pub const POTENTIALS: Self = Self {
        answers: ReckOnAnswers::PotentialsEachStep,
        task: ReckOnTask::Regression,
        learning: None,
    };
    /// Without learning: a label for each sample.
    pub const LABEL: Self =
        Self { answers: ReckOnAnswers::Label, task: ReckOnTask::Classification, learning: None };
}
