//! What the chips of the family do differently.

use core::fmt::Debug;

use super::super::ChipError;

/// What goes into a chip of the family, and what its memories hold.
pub trait Input: Copy {
    /// A time step for all neurons: the chip has no clock of its own for time.
    const LEAK_ALL: Self;
    /// A time step for one neuron, [`PROBED`](Self::PROBED): the chip must answer it when it runs.
    const PROBE: Self;
    /// The neuron of [`PROBE`](Self::PROBE).
    const PROBED: u8;
    /// How many bytes a neuron has in memory, 16 at most.
    const NEURON_BYTES: u8;
    /// Of a neuron's bytes, the bits that stay as they are while the chip runs.
    const PARAMETERS: [u8; 16];
    /// The most clocks of the chip from a word's REQ to its ACK, of all words and with the queue full;
    /// outputs that wait and spikes that the chip sends itself come on top.
    const MAX_CLOCKS: u32;
    /// How many spikes and virtual events wait in the chip's queue.
    const QUEUE: u32;
    /// The register that keeps the neurons' spikes to the output bus. It is 1 while the chip is
    /// programmed.
    const OPEN_LOOP: u16;
    /// In [`Bytes`](super::NetworkBytes): which chip they are for.
    const KIND: u8;

    /// A neuron's parameters and state.
    type Neuron: Copy + Debug + PartialEq;
    /// All configuration registers but the gate.
    type Registers: Copy + Debug + PartialEq;
    /// A synapse, read back.
    type Synapse: Copy + Debug + PartialEq;

    /// A neuron that never fires.
    const DISABLED: Self::Neuron;

    /// The word, or what is wrong with it.
    ///
    /// # Errors
    /// A value that there is not, or a virtual event of weight 0.
    fn word<B, P>(self) -> Result<u32, ChipError<B, P>>;

    /// A spike that comes in from outside.
    fn spike(pre: u8) -> Self;

    /// A virtual event.
    fn virtual_event(neuron: u8, weight: i8) -> Self;

    /// A neuron's bytes.
    ///
    /// # Errors
    /// A value that there is not.
    fn neuron_bytes<B, P>(neuron: &Self::Neuron) -> Result<[u8; 16], ChipError<B, P>>;

    /// The neuron of these bytes.
    fn neuron(bytes: [u8; 16]) -> Self::Neuron;

    /// Whether a time step alone changes nothing that is seen: the neuron is disabled, or neither leaks nor
    /// would fire.
    fn is_unmoved(neuron: &Self::Neuron) -> bool;

    /// A signed weight's 4 bits.
    ///
    /// # Errors
    /// A weight that there is not.
    fn weight_bits<B, P>(weight: i8) -> Result<u8, ChipError<B, P>>;

    /// A synapse's 4 bits.
    ///
    /// # Errors
    /// A weight that there is not.
    fn synapse_bits<B, P>(synapse: Self::Synapse) -> Result<u8, ChipError<B, P>>;

    /// The synapse of these 4 bits.
    fn synapse(bits: u8) -> Self::Synapse;

    /// Whether a synapse's sign is that of the neuron it comes from.
    const SIGNS_BY_ROW: bool;

    /// The registers of a network with neurons up to this one. Bit `n % 16` of `inhibitory[n / 16]` says
    /// that neuron `n` inhibits.
    fn registers(last_neuron: u8, is_open_loop: bool, inhibitory: [u16; 16]) -> Self::Registers;

    /// Each register's number and value, the gate excepted.
    ///
    /// # Errors
    /// A value that there is not, or the error of `write`.
    fn each_register<E>(
        registers: &Self::Registers,
        write: impl FnMut(u16, u32) -> Result<(), E>,
    ) -> Result<(), E>;

    /// What is wrong with the registers.
    ///
    /// # Errors
    /// A value that there is not.
    fn check_registers<B, P>(registers: &Self::Registers) -> Result<(), ChipError<B, P>>;

    /// Whether the neurons' spikes stay out of the queue.
    fn is_open_loop(registers: &Self::Registers) -> bool;

    /// The most clocks that a spike takes the chip, without outputs.
    fn sweep_clocks(registers: &Self::Registers) -> u32;
}
