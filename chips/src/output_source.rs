//! The source of tinyODIN's and ODIN's outputs.

/// Which spikes go to the output bus.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum OutputSource {
    /// The spikes of neurons, when they fire.
    #[default]
    Neurons,
    /// The spikes of the chip's queue, when they have been processed: in closed loop those of neurons and inputs, in
    /// open loop those of inputs alone. In ODIN only those at the monitored neuron.
    Queue,
}

impl OutputSource {
    pub(super) const fn bit(self) -> u32 {
        matches!(self, Self::Queue) as u32
    }
}
