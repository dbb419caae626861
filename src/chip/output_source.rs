//! Where tinyODIN's and ODIN's outputs come from.

/// What goes to the output bus.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum OutputSource {
    /// A neuron, when it fires.
    #[default]
    Neurons,
    /// A spike, when the chip has worked it off: in closed loop the neurons' and the inputs', in open loop
    /// the inputs' alone, which it echoes. In ODIN only at the monitored neuron.
    Queue,
}

impl OutputSource {
    pub(super) const fn bit(self) -> u32 {
        matches!(self, Self::Queue) as u32
    }
}
