//! Loads a network into the chip, and compares the chip's memory with a network.

use embedded_hal::spi::SpiDevice;

use super::network::check;
use super::sync::DISABLE;
use super::wire::Address;
use super::{AerPort, ChipError, Describe, Gated, Input, Outcome};

/// The progress of loading or comparing a network, in frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Progress {
    /// Number of frames of 5 bytes sent so far.
    pub done: u32,
    /// Total number of frames of 5 bytes.
    pub total: u32,
}

/// The network that the chip's memory contains.
#[derive(Debug)]
pub(super) struct Loaded<I: Input> {
    pub(super) neurons: u16,
    /// Number of rows of synapses.
    pub(super) rows: u16,
    /// The registers with which to run the network; `None` if the chip contains no network.
    pub(super) registers: Option<I::Registers>,
}

impl<I: Input> Loaded<I> {
    /// No network.
    pub(super) const NONE: Self = Self { neurons: 0, rows: 0, registers: None };

    fn new(network: &impl Describe<I>) -> Self {
        let registers = Some(network.registers());
        Self { neurons: network.neurons(), rows: network.rows(), registers }
    }
}

/// Number of neurons in a chip of the ODIN family.
const NEURONS: u16 = 256;

impl<I: Input, D: SpiDevice, P: AerPort> Gated<'_, I, D, P> {
    /// Writes a network to the chip, disables all neurons that the network does not use, and then reads everything
    /// back. Leaves synapses onto the disabled neurons as they are. Calls `progress` after each neuron and each row.
    ///
    /// **Time:** two frames of 5 bytes, a write and a read, for each byte of memory. A neuron takes 4 bytes (tinyODIN)
    /// or 16 bytes (ODIN), and two synapses take one byte. 256 neurons of tinyODIN with 256 rows take 67 584 frames,
    /// 4.1 s at an SCK of 656 kHz.
    ///
    /// # Errors
    /// Returns an error if the network does not fit; nothing was written then. Also returns an error if the bus failed,
    /// or if memory reads back a wrong value; then reset the chip.
    pub fn load(
        &mut self,
        network: &impl Describe<I>,
        mut progress: impl FnMut(Progress),
    ) -> Outcome<(), D, P> {
        check::<I, D::Error, P>(network)?;
        let half = frames(network);
        let total = half.wrapping_mul(2);
        let chip = &mut *self.chip;
        chip.loaded = Loaded::NONE;
        each_byte(
            network,
            |address, keep, value| chip.put_byte(address, keep, value),
            |done| progress(Progress { done, total }),
        )?;
        chip.check_sync()?;
        each_byte(
            network,
            |address, keep, value| chip.expect_byte(address, keep, value),
            |done| progress(Progress { done: half.wrapping_add(done), total }),
        )?;
        chip.check_sync()?;
        chip.loaded = Loaded::new(network);
        Ok(())
    }

    /// Compares the chip's memories with a network. This includes the neurons' potentials, which change when the
    /// network runs.
    ///
    /// # Errors
    /// Returns an error if the network does not fit or the bus failed. Returns [`ReadBack`](ChipError::ReadBack) at the
    /// first difference; then reset the chip.
    pub fn verify(
        &mut self,
        network: &impl Describe<I>,
        mut progress: impl FnMut(Progress),
    ) -> Outcome<(), D, P> {
        check::<I, D::Error, P>(network)?;
        let total = frames(network);
        let chip = &mut *self.chip;
        each_byte(
            network,
            |address, keep, value| chip.expect_byte(address, keep, value),
            |done| progress(Progress { done, total }),
        )?;
        chip.check_sync()?;
        chip.loaded = Loaded::new(network);
        Ok(())
    }
}

/// Returns the number of frames that reading or writing a network takes: one for each byte that [`each_byte`] visits.
fn frames<I: Input>(network: &impl Describe<I>) -> u32 {
    let (neurons, rows) = (u32::from(network.neurons()), u32::from(network.rows()));
    let bytes = u32::from(I::NEURON_BYTES);
    let disabled = u32::from(NEURONS).saturating_sub(neurons);
    let synapses = rows.wrapping_mul(neurons.div_ceil(2));
    neurons.wrapping_mul(bytes).wrapping_add(disabled).wrapping_add(synapses)
}

/// Calls `visit` for every byte of the chip's memories that the network uses, and for the byte that disables each
/// unused neuron. `visit` gets the byte's address, a mask of the bits that do not matter, and the value of the other
/// bits.
fn each_byte<I: Input, B, P>(
    network: &impl Describe<I>,
    mut visit: impl FnMut(Address, u8, u8) -> Result<(), ChipError<B, P>>,
    mut progress: impl FnMut(u32),
) -> Result<(), ChipError<B, P>> {
    let last = I::NEURON_BYTES.saturating_sub(1);
    let mut done = 0_u32;
    for neuron in 0..NEURONS {
        let neuron = neuron as u8;
        if u16::from(neuron) < network.neurons() {
            let bytes = I::neuron_bytes(&network.neuron(neuron))?;
            for (byte, value) in (0..=last).zip(bytes) {
                visit(Address::neuron(neuron, byte), 0, value)?;
                done = done.wrapping_add(1);
            }
        } else {
            visit(Address::neuron(neuron, last), !DISABLE, DISABLE)?;
            done = done.wrapping_add(1);
        }
        progress(done);
    }
    for row in 0..network.rows() {
        for post in (0..network.neurons()).step_by(2) {
            let (even, odd) = (post as u8, post as u8 | 1);
            let low = I::weight_bits(network.row_weight(row, even))?;
            let (keep, high) = if u16::from(odd) < network.neurons() {
                (0, I::weight_bits(network.row_weight(row, odd))?)
            } else {
                (0xF0, 0)
            };
            visit(Address::synapse(row as u8, even), keep, high << 4 | low)?;
            done = done.wrapping_add(1);
        }
        progress(done);
    }
    Ok(())
}
