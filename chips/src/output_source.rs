//! The choice of spikes on tinyODIN's and ODIN's output bus.

/// Which spikes go to the output bus.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum OutputSource {
    /// Spikes of neurons, when they fire.
    #[default]
    Neurons,
    /// Spikes of the chip's queue, when they have been processed. In closed loop they come from neurons and inputs, in
    /// open loop from inputs alone. ODIN puts out only those that its monitored neuron gets.
    Queue,
}

impl OutputSource {
    pub(super) const fn bit(self) -> u32 {
        matches!(self, Self::Queue) as u32
    }
}
