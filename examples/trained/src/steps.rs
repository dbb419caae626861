//! A trained network on recorded spikes: a line for each step with the outputs that fired, then the potentials of the
//! last layer. `cargo xtask network` compares them with those of the host.

#![cfg_attr(target_os = "none", no_std, no_main)]

use board::stopwatch::instructions;
use core::fmt::{self, Write};
use spikewire_network::{Network, State};

include!(concat!(env!("OUT_DIR"), "/trained.rs"));

/// One step. The emulator of the RP2040 knows it by its name, and counts its cycles.
#[unsafe(no_mangle)]
#[inline(never)]
fn network_step(state: &mut <network::Trained as Network>::State, inputs: &[u16]) {
    network::NETWORK.step(state, inputs);
}

fn run(out: &mut impl Write) -> fmt::Result {
    writeln!(out, "is intact: {}", network::is_intact())?;
    let mut state = network::NETWORK.state();
    let (mut sum, mut most) = (0, 0);
    for inputs in SPIKES {
        let count = instructions(|| network_step(&mut state, inputs));
        (sum, most) = (sum + count, most.max(count));
        for output in state.spikes() {
            write!(out, "{output} ")?;
        }
        writeln!(out)?;
    }
    writeln!(out, "{:?}", state.values())?;
    writeln!(out, "rejected: {}, saturated: {}", state.rejected(), state.saturated())?;
    // Only an emulator with a clock of instructions knows these.
    writeln!(out, "# instructions a step: {} ({most})", sum / SPIKES.len() as u32)
}

/// The same program on every board and on the host; `board` makes the difference.
#[cfg_attr(target_os = "none", board::entry)]
fn main() -> ! {
    board::finish(run(&mut board::console()))
}
