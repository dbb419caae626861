//! The properties of tinyODIN: 256 neurons whose potentials have 12 bits, and signed weights of 4 bits.

use super::chip::{Drive, Input, Kind, Registers};

/// The properties of tinyODIN. Its registers: 0 gates the chip; 1 opens the loop; 2 selects the source of outputs; 3 is
/// the highest neuron in use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TinyOdin;

/// The sign bit of a potential.
const NEGATIVE: u16 = 0x800;

impl Kind for TinyOdin {
    const NEURON_BYTES: u16 = 4;
    const QUEUE: usize = 128;
    const POPS_AFTER_OUTPUT: bool = true;
    const GATE_WAITS: bool = false;

    fn decode(word: u32) -> Input {
        let low = word as u8;
        match word >> 8 & 3 {
            1 | 3 => Input::Leak((low != 0xFF).then_some(low)),
            2 => Input::Queued(low >> 4, low & 0xF),
            _ => Input::Queued(0, low),
        }
    }

    fn last_neuron(registers: &Registers) -> u8 {
        registers.0[3] as u8
    }

    fn outputs_are_popped(registers: &Registers) -> bool {
        registers.bit(2)
    }

    fn update(neuron: u128, drive: Drive, _: &Registers) -> (u128, bool) {
        let potential = neuron as u16 & 0xFFF;
        let threshold = (neuron >> 12) as u16 & 0xFFF;
        let leak = (neuron >> 24) as u16 & 0x7F;
        let weight = if drive.virtual_bits == 0 { drive.synapse } else { drive.virtual_bits };
        let next = match drive {
            Drive { is_event: false, .. } => potential,
            Drive { is_leak: true, .. } => leaked(potential, leak),
            _ => driven(potential, weight),
        };
        let fires = next & NEGATIVE == 0 && next >= threshold;
        let kept = if fires { 0 } else { next };
        (neuron & !0xFFF | u128::from(kept), fires)
    }

    fn is_disabled(neuron: u128) -> bool {
        neuron >> 31 & 1 == 1
    }

    fn is_plastic(_: u8, _: &Registers) -> bool {
        false
    }

    fn is_popped_at(_: u8, _: &Registers) -> bool {
        false
    }
}

/// Returns a potential after a leak, which moves it towards 0.
fn leaked(potential: u16, leak: u16) -> u16 {
    if potential & NEGATIVE == 0 {
        potential.saturating_sub(leak)
    } else {
        let next = potential + leak;
        if next >= 0x1000 { 0 } else { next }
    }
}

/// Adds a signed 4-bit weight to a signed 12-bit potential. The sum saturates at -2048 and 2047.
fn driven(potential: u16, weight: u8) -> u16 {
    let signed = i32::from((potential << 4) as i16 >> 4);
    let weight = i32::from((weight << 4) as i8 >> 4);
    ((signed + weight).clamp(-2048, 2047) & 0xFFF) as u16
}
