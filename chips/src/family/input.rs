//! The trait in which the ODIN family's chips differ: input words, memories and registers.

use core::fmt::Debug;

use super::super::ChipError;

/// The input words of a chip of the family, and the layout of its memories.
pub trait Input: Copy {
    /// The input that is a time step for all neurons. The driver sends it; the chip has no clock of its own.
    const LEAK_ALL: Self;
    /// Highest neuron that [`probe`](Self::probe) accepts. A reset disables this neuron if it was never written.
    const PROBED: u8;
    /// Number of bytes in a neuron, 16 at most.
    const NEURON_BYTES: u8;
    /// Mask of the bits in a neuron's bytes that do not change while the chip runs.
    const PARAMETERS: [u8; 16];
    /// Maximum number of the chip's clocks from a word's REQ to its ACK, for any word and a full queue. Waiting outputs
    /// and spikes between neurons add to it.
    const MAX_CLOCKS: u32;
    /// Number of spikes and virtual events that fit the chip's queue.
    const QUEUE: u32;
    /// Number of the register that opens the loop: at 1, neurons' spikes go to the output bus only. It is 1 while the
    /// chip is programmed.
    const OPEN_LOOP: u16;
    /// Number of the chip in [`NetworkBytes`](super::NetworkBytes).
    const KIND: u8;

    /// A neuron's parameters and state.
    type Neuron: Copy + Debug + PartialEq;
    /// All configuration registers except the gate.
    type Registers: Copy + Debug + PartialEq;
    /// A synapse.
    type Synapse: Copy + Debug + PartialEq;

    /// A neuron that never fires.
    const DISABLED: Self::Neuron;

    /// Returns the word of the input.
    ///
    /// # Errors
    /// Returns an error if a value is out of its range, or if a virtual event has weight 0.
    fn word<B, P>(self) -> Result<u32, ChipError<B, P>>;

    /// Returns the input that is a spike from outside.
    fn spike(pre: u8) -> Self;

    /// Returns the input that is a time step for one neuron, up to [`PROBED`](Self::PROBED). A running chip must
    /// acknowledge it.
    fn probe(neuron: u8) -> Self;

    /// Returns the input that is a virtual event, which acts on one neuron without a synapse.
    fn virtual_event(neuron: u8, weight: i8) -> Self;

    /// Returns a neuron's bytes.
    ///
    /// # Errors
    /// Returns an error if a value is out of its range.
    fn neuron_bytes<B, P>(neuron: &Self::Neuron) -> Result<[u8; 16], ChipError<B, P>>;

    /// Decodes a neuron from its bytes.
    fn neuron(bytes: [u8; 16]) -> Self::Neuron;

    /// Returns the neuron that a time step turns into this one without a spike; `None` if there is none.
    fn before_step(neuron: &Self::Neuron) -> Option<Self::Neuron>;

    /// Returns the 4 bits of a signed weight.
    ///
    /// # Errors
    /// Returns an error if the weight is out of its range.
    fn weight_bits<B, P>(weight: i8) -> Result<u8, ChipError<B, P>>;

    /// Returns the 4 bits of a synapse.
    ///
    /// # Errors
    /// Returns an error if the weight is out of its range.
    fn synapse_bits<B, P>(synapse: Self::Synapse) -> Result<u8, ChipError<B, P>>;

    /// Decodes a synapse from its 4 bits.
    fn synapse(bits: u8) -> Self::Synapse;

    /// Whether a synapse's sign is that of the presynaptic neuron.
    const SIGNS_BY_ROW: bool;

    /// Returns the registers of a network whose neurons go up to `last_neuron`. Bit `n % 16` of `inhibitory[n / 16]` is
    /// 1 if neuron `n` inhibits.
    fn registers(last_neuron: u8, is_open_loop: bool, inhibitory: [u16; 16]) -> Self::Registers;

    /// Calls `write` with the number and value of each register except the gate.
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

    /// Returns whether the loop is open, that is, whether neurons' spikes do not reach other neurons.
    fn is_open_loop(registers: &Self::Registers) -> bool;

    /// Returns the maximum number of clocks that the chip takes for a spike, without outputs.
    fn sweep_clocks(registers: &Self::Registers) -> u32;
}
