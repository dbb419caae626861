//! The trait of the ODIN family's chips: the input words, memories and registers in which they differ.

use core::fmt::Debug;

use super::super::ChipError;

/// The input words of a chip of the family, and the layout of its memories.
pub trait Input: Copy {
    /// A time step for all neurons, which the chip does not count by itself.
    const LEAK_ALL: Self;
    /// The last neuron that [`probe`](Self::probe) takes. A reset disables it if it was never written.
    const PROBED: u8;
    /// How many bytes a neuron has in memory, 16 at most.
    const NEURON_BYTES: u8;
    /// The bits of a neuron's bytes that do not change while the chip runs.
    const PARAMETERS: [u8; 16];
    /// The most clocks of the chip from a word's REQ to its ACK, for any word and a full queue. Waiting outputs and spikes
    /// between neurons add to it.
    const MAX_CLOCKS: u32;
    /// How many spikes and virtual events fit the chip's queue.
    const QUEUE: u32;
    /// The register that opens the loop: at 1, neurons' spikes go to the output bus only. It is 1 while the chip is
    /// programmed.
    const OPEN_LOOP: u16;
    /// The number of the chip in [`NetworkBytes`](super::NetworkBytes).
    const KIND: u8;

    /// A neuron's parameters and state.
    type Neuron: Copy + Debug + PartialEq;
    /// All configuration registers but the gate.
    type Registers: Copy + Debug + PartialEq;
    /// A synapse.
    type Synapse: Copy + Debug + PartialEq;

    /// A neuron that never fires.
    const DISABLED: Self::Neuron;

    /// The word of the input.
    ///
    /// # Errors
    /// Returns an error if a value is out of its range, or a virtual event has weight 0.
    fn word<B, P>(self) -> Result<u32, ChipError<B, P>>;

    /// The input of a spike from outside.
    fn spike(pre: u8) -> Self;

    /// A time step for one neuron, up to [`PROBED`](Self::PROBED): the chip must answer it when it runs.
    fn probe(neuron: u8) -> Self;

    /// The input of a virtual event, which acts on one neuron without a synapse.
    fn virtual_event(neuron: u8, weight: i8) -> Self;

    /// A neuron's bytes.
    ///
    /// # Errors
    /// Returns an error if a value is out of its range.
    fn neuron_bytes<B, P>(neuron: &Self::Neuron) -> Result<[u8; 16], ChipError<B, P>>;

    /// The neuron of these bytes.
    fn neuron(bytes: [u8; 16]) -> Self::Neuron;

    /// The neuron that a time step turns into this one without a spike; `None` if no neuron becomes this one.
    fn before_step(neuron: &Self::Neuron) -> Option<Self::Neuron>;

    /// A signed weight's 4 bits.
    ///
    /// # Errors
    /// Returns an error if the weight is out of its range.
    fn weight_bits<B, P>(weight: i8) -> Result<u8, ChipError<B, P>>;

    /// A synapse's 4 bits.
    ///
    /// # Errors
    /// Returns an error if the weight is out of its range.
    fn synapse_bits<B, P>(synapse: Self::Synapse) -> Result<u8, ChipError<B, P>>;

    /// The synapse of these 4 bits.
    fn synapse(bits: u8) -> Self::Synapse;

    /// Whether a synapse's sign is that of the presynaptic neuron.
    const SIGNS_BY_ROW: bool;

    /// The registers of a network with neurons up to this one. Bit `n % 16` of `inhibitory[n / 16]` is 1 if neuron `n`
    /// inhibits.
    fn registers(last_neuron: u8, is_open_loop: bool, inhibitory: [u16; 16]) -> Self::Registers;

    /// Calls `write` with the number and value of each register but the gate.
    ///
    /// # Errors
    /// Returns the error of `write`.
    fn each_register<E>(
        registers: &Self::Registers,
        write: impl FnMut(u16, u32) -> Result<(), E>,
    ) -> Result<(), E>;

    /// Checks the values of the registers.
    ///
    /// # Errors
    /// Returns an error if a value is out of its range.
    fn check_registers<B, P>(registers: &Self::Registers) -> Result<(), ChipError<B, P>>;

    /// Whether the loop is open: the neurons' spikes do not go to other neurons.
    fn is_open_loop(registers: &Self::Registers) -> bool;

    /// The most clocks that the chip takes for a spike, without outputs.
    fn sweep_clocks(registers: &Self::Registers) -> u32;
}
