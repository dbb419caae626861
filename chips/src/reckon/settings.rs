//! The registers of `ReckOn` that set its answers and its learning.

/// The kind of the chip's answers, and when they are returned. The chip sends one in every step, which proves the step:
/// one byte for a label, or two for each output's potential.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ReckOnAnswers {
    /// Returns a label after the sample: the output that was the highest in the most steps with
    /// [`ReckOnStep::counts`](super::ReckOnStep::counts).
    Label,
    /// Returns the outputs' potentials after the sample.
    Potentials,
    /// Returns the outputs' potentials after every step and after the sample.
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

/// The kind of targets from which the chip learns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ReckOnTask {
    /// The number of an output, given in the first step of a sample that learns.
    Classification,
    /// A potential for each output, given in every step that learns.
    Regression,
}

/// How the chip learns, by e-prop. Every field is a register of the chip, whose documentation describes how they act
/// together.
///
/// A step that learns takes up to 8 704 clocks more. Weights change by 1, at random. For a run that can be repeated,
/// seed the sources of random numbers: registers 85 to 92, with
/// [`Programmed::set_register`](super::Programmed::set_register).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ReckOnLearning {
    /// Whether weights from inputs, between neurons and to outputs learn.
    pub learns: [bool; 3],
    /// Shifts of the traces of inputs, neurons and outputs, 0 to 7 each.
    pub traces: [u8; 3],
    /// Shift of the learning signal, 0 to 15.
    pub signal: u8,
    /// Potentials that separate the five slopes in [`slopes`](Self::slopes), ascending.
    pub thresholds: [i16; 4],
    /// Slopes that replace the derivative of firing, -16 to 15 each.
    pub slopes: [i8; 5],
    /// How likely weights from inputs, between neurons and to outputs move: right shift and left shift, 0 to 31 each.
    pub rates: [(u8, u8); 3],
    /// Whether outputs are compared with targets directly, without the chip's hard sigmoid.
    pub is_linear: bool,
}

/// The registers with which the chip runs a network.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ReckOnSettings {
    /// Kind of the chip's answers.
    pub answers: ReckOnAnswers,
    /// Kind of the targets. Labels exist only in classification.
    pub task: ReckOnTask,
    /// How the chip learns; `None` switches learning off, which is on after reset.
    pub learning: Option<ReckOnLearning>,
}

impl ReckOnSettings {
    /// Settings without learning that return the outputs' potentials in each step.
    pub const POTENTIALS: Self = Self {
        answers: ReckOnAnswers::PotentialsEachStep,
        task: ReckOnTask::Regression,
        learning: None,
    };
    /// Settings without learning that return a label for each sample.
    pub const LABEL: Self =
        Self { answers: ReckOnAnswers::Label, task: ReckOnTask::Classification, learning: None };
}
