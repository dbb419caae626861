//! The setting that selects which spikes tinyODIN and ODIN send to their output bus.

/// The spikes that the chip sends to its output bus.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum OutputSource {
    /// The spikes of neurons, when the neurons fire.
    #[default]
    Neurons,
    /// The spikes that leave the queue, when the chip has processed them. In closed loop these are spikes of neurons
    /// and of inputs; in open loop, of inputs only. ODIN sends only spikes that act on its monitored neuron.
    Queue,
}

impl OutputSource {
    pub(super) const fn bit(self) -> u32 {
        matches!(self, Self::Queue) as u32
    }
}
