//! The trait that covers the differences between tinyODIN and ODIN: input words, memories and registers.

use core::fmt::Debug;

use super::super::ChipError;

/// The input words of a chip of the ODIN family, and the layout of the chip's memories.
pub trait Input: Copy {
    /// The input that lets all neurons take a time step. The chip has no timer of its own, so the driver sends this
    /// input.
    const LEAK_ALL: Self;
    /// The highest neuron that [`probe`](Self::probe) accepts. [`reset`](super::OdinChip::reset) disables this neuron
    /// if it was never written.
    const PROBED: u8;
    /// Number of bytes in a neuron, 16 at most.
    const NEURON_BYTES: u8;
    /// Mask of the bits in a neuron's bytes that hold parameters, which do not change while the chip runs.
    const PARAMETERS: [u8; 16];
    /// Maximum number of clock cycles of the chip from the REQ of a word to its ACK, for the slowest word and a full
    /// queue. Not included: the time in which outputs wait for their ACK, and the time for spikes between neurons.
    const MAX_CLOCKS: u32;
    /// Number of spikes and virtual events that the chip's queue holds.
    const QUEUE: u32;
    /// Number of the register that opens the loop. While this register is 1, spikes of neurons go to the output bus,
    /// and not to other neurons. The driver keeps the register at 1 while the chip is gated.
    const OPEN_LOOP: u16;
    /// Code of the chip in [`NetworkBytes`](super::NetworkBytes).
    const KIND: u8;

    /// The parameters and the state of a neuron.
    type Neuron: Copy + Debug + PartialEq;
    /// All configuration registers, except for the one that gates the chip.
    type Registers: Copy + Debug + PartialEq;
    /// A synapse from one neuron or input to one neuron.
    type Synapse: Copy + Debug + PartialEq;

    /// A neuron that never fires.
    const DISABLED: Self::Neuron;

    /// Encodes this input as a word of the input bus.
    ///
    /// # Errors
    /// Returns an error if a value is out of its range, or if a virtual event has weight 0.
    fn word<B, P>(self) -> Result<u32, ChipError<B, P>>;

    /// Returns the input that sends a spike through all synapses in row `pre`.
    fn spike(pre: u8) -> Self;

    /// Returns the input that lets one neuron take a time step; `neuron` is at most [`PROBED`](Self::PROBED). A running
    /// chip acknowledges this input, and a gated chip does not.
    fn probe(neuron: u8) -> Self;

    /// Returns the input that adds `weight` to the potential of one neuron directly, without a synapse.
    fn virtual_event(neuron: u8, weight: i8) -> Self;

    /// Encodes a neuron as the bytes of the chip's memory.
    ///
    /// # Errors
    /// Returns an error if a field is out of its range.
    fn neuron_bytes<B, P>(neuron: &Self::Neuron) -> Result<[u8; 16], ChipError<B, P>>;

    /// Decodes a neuron from the bytes of the chip's memory.
    fn neuron(bytes: [u8; 16]) -> Self::Neuron;

    /// Returns the state from which one time step leads to the state `neuron` without firing. Returns `None` if there
    /// is no such state.
    fn before_step(neuron: &Self::Neuron) -> Option<Self::Neuron>;

    /// Encodes a signed weight as the 4 bits of a synapse.
    ///
    /// # Errors
    /// Returns an error if the weight is out of its range.
    fn weight_bits<B, P>(weight: i8) -> Result<u8, ChipError<B, P>>;

    /// Encodes a synapse as its 4 bits.
    ///
    /// # Errors
    /// Returns an error if the weight is out of its range.
    fn synapse_bits<B, P>(synapse: Self::Synapse) -> Result<u8, ChipError<B, P>>;

    /// Decodes a synapse from its 4 bits.
    fn synapse(bits: u8) -> Self::Synapse;

    /// Whether all synapses of a presynaptic neuron must have the same sign, because the chip stores the sign in a
    /// register and not in each synapse.
    const SIGNS_BY_ROW: bool;

    /// Returns the registers for a network that uses the neurons from 0 to `last_neuron`. If `is_open_loop` is true,
    /// the spikes of neurons do not reach other neurons. Bit `n % 16` of `inhibitory[n / 16]` is 1 if neuron `n` is
    /// inhibitory.
    fn registers(last_neuron: u8, is_open_loop: bool, inhibitory: [u16; 16]) -> Self::Registers;

    /// Calls `write` with the number and the value of each register, except for the one that gates the chip.
    ///
    /// # Errors
    /// Returns the first error of `write`.
    fn each_register<E>(
        registers: &Self::Registers,
        write: impl FnMut(u16, u32) -> Result<(), E>,
    ) -> Result<(), E>;

    /// Checks that all values of the registers are in range.
    ///
    /// # Errors
    /// Returns an error if a value is out of its range.
    fn check_registers<B, P>(registers: &Self::Registers) -> Result<(), ChipError<B, P>>;

    /// Returns whether these registers open the loop, so that the spikes of neurons do not reach other neurons.
    fn is_open_loop(registers: &Self::Registers) -> bool;

    /// Returns the maximum number of clock cycles that the chip takes to apply one spike to all neurons in use. Not
    /// included: the time in which outputs wait for their ACK.
    fn sweep_clocks(registers: &Self::Registers) -> u32;
}
