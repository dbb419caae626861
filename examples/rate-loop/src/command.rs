//! From turn rates to commands against them.

use crate::{
    network::{NETWORK, RATES, TIME_STEP},
    rates,
    rig::{Rig, tenths},
    tape::Tape,
};
use board::digest::Digest;
use board::stopwatch::instructions;
use core::fmt::{self, Write};
use spikewire::{Bank, Readout};
use spikewire_chips::{Describe, Spikes, TinyOdinInput};

/// Of the commanded turn to the rate, per second.
const GAIN: f32 = -0.5;

pub fn fly(out: &mut impl Write) -> fmt::Result {
    let mut rig = Rig::start(&NETWORK, TIME_STEP, Tape::new(), "rates", out)?;
    let mut bank = Bank::<_, 1>::new(&RATES);
    let mut readout = Readout::<_, 1>::new(&RATES);
    let mut commands = Digest::new();
    let (mut steps, mut spikes_out, mut largest) = (0_u32, 0_u32, 0.0_f32);
    let (mut encoding, mut decoding) = (0_u64, 0_u64);
    for (now, rate) in rates() {
        let mut events = Spikes::<64>::new();
        let encode = || bank.encode(now, [rate], |event| events.push(event));
        encoding += u64::from(instructions(encode));

        let mut spikes = Spikes::<64>::new();
        let mut answers = NETWORK.answers(now, |event| spikes.push(event));
        let input = |event: spikewire::Event| {
            NETWORK.input(event.address).unwrap_or(TinyOdinInput::LeakAll)
        };
        rig.step(events.as_slice(), input, &mut answers)?;
        drop(answers);

        let mut value = 0.0;
        decoding += u64::from(instructions(|| [value] = readout.decode(now, spikes.as_slice())));
        let command = GAIN * value;
        commands.add([now.micros(), command.to_bits()]);
        largest = largest.max((value - rate.clamp(-8.0, 8.0)).abs());
        spikes_out += spikes.as_slice().len() as u32;
        steps += 1;
    }
    writeln!(out, "rates: {steps} rates, {spikes_out} spikes back, commands {commands}")?;
    // Within the neurons' range half the distance of two at most.
    if largest > 0.5 * 16.0 / 62.0 + 1e-5 {
        return Err(fmt::Error);
    }
    rig.cost.print("rates", out)?;
    if cfg!(target_os = "none") {
        let [encode, decode] = [encoding, decoding].map(|total| tenths(total, steps));
        writeln!(
            out,
            "rates: a sample takes the core {encode} instructions to encode, {decode} to decode"
        )?;
    }
    Ok(())
}
