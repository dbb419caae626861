//! The setting that selects which spikes tinyODIN and ODIN send to their output bus.

/// The spikes that the chip sends to its output bus.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum OutputSource {
    /// The spikes of neurons, when the neurons fire.
    #[default]
    Neurons,
    /// The spikes from the chip's queue. tinyODIN sends a spike after it has applied the spike to all neurons in use.
    /// ODIN sends a spike when it applies the spike to its monitored neuron (register 21). If the loop is closed, the
    /// queue has the spikes of inputs and of neurons; if the loop is open, only those of inputs.
    Queue,
}

impl OutputSource {
    pub(super) const fn bit(self) -> u32 {
        matches!(self, Self::Queue) as u32
    }
}
