//! The properties of ODIN: 256 neurons whose potentials have 8 bits, and weights of 3 bits. A weight has the sign of
//! the presynaptic neuron.

use super::chip::{Drive, Input, Kind, Registers};

/// The properties of ODIN. Its registers: 0 gates the chip; 1 opens the loop; 2 to 17 hold the signs of neurons; 19
/// selects the source of outputs; 21 is the monitored neuron; 23 lets synapses without the mapping bit learn; 24 lets
/// these synapses act.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Odin;

impl Kind for Odin {
    const NEURON_BYTES: u16 = 16;
    const QUEUE: usize = 32;
    const POPS_AFTER_OUTPUT: bool = false;
    const GATE_WAITS: bool = true;

    fn decode(word: u32) -> Input {
        let (high, low) = ((word >> 8) as u8, word as u8);
        let one = (low >> 7 == 1).then_some(high);
        match low & 0x7F {
            _ if word >> 16 & 1 == 1 => Input::Synapse(high, low),
            0x7F => Input::Leak(one),
            0 => Input::Bistability(one),
            _ => Input::Queued(low >> 3, high),
        }
    }

    fn last_neuron(_: &Registers) -> u8 {
        255
    }

    fn outputs_are_popped(registers: &Registers) -> bool {
        registers.bit(19)
    }

    fn update(neuron: u128, drive: Drive, registers: &Registers) -> (u128, bool) {
        if neuron & 1 == 0 {
            return (neuron, false); // an Izhikevich neuron
        }
        let potential = (neuron >> 70) as u8;
        let threshold = (neuron >> 9) as u8;
        let leak = if neuron >> 8 & 1 == 1 { (neuron >> 1) as u8 & 0x7F } else { 0 };
        let is_unmapped = drive.synapse & 8 == 0 && !registers.bit(24);
        let (weight, is_inhibitory, is_leak) = if drive.virtual_bits == 0 {
            let sign = registers.0[2 + usize::from(drive.pre >> 4)] >> (drive.pre & 15) & 1 == 1;
            (if is_unmapped { 0 } else { drive.synapse & 7 }, sign, drive.is_leak)
        } else {
            let bits = drive.virtual_bits;
            (bits >> 2, bits & 2 != 0, bits & 1 == 1)
        };
        let next = match (drive.is_event, is_leak, is_inhibitory) {
            (false, ..) => potential,
            (_, true, _) => potential.saturating_sub(leak),
            (_, _, true) => potential.saturating_sub(weight),
            (_, _, false) => potential.saturating_add(weight),
        };
        let fires = next >= threshold;
        let kept = if fires { 0 } else { next };
        (neuron & !(0xFF << 70) | u128::from(kept) << 70, fires)
    }

    fn is_disabled(neuron: u128) -> bool {
        neuron >> 127 == 1
    }

    fn is_plastic(synapse: u8, registers: &Registers) -> bool {
        synapse & 8 != 0 || registers.bit(23)
    }

    fn is_popped_at(neuron: u8, registers: &Registers) -> bool {
        neuron == registers.0[21] as u8
    }
}
