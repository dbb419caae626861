//! A recorded flight around a whole loop: turn rates, spikes, tinyODIN's driver, the chip, spikes, commands; then the same
//! flight through a recurrent network on ReckOn.
//!
//! A chip is its model, clock by clock, behind the pins of a port. All lines but those of instructions are the same
//! on a board and on the host.

#![cfg_attr(target_os = "none", no_std, no_main)]

extern crate alloc;

mod command;
#[cfg(target_os = "none")]
mod heap;
mod network;
mod recurrent;
mod rig;
mod roll;
mod tape;
mod trained;
mod turns;

use core::fmt::{self, Write};
use spikewire::Tick;

/// The recording's times, and its roll rates in rad/s.
fn rates() -> impl Iterator<Item = (Tick, f32)> {
    let records = flight_data::records(flight_data::HEXAROTOR);
    records.map(|record| (record.micros.into(), record.channels[0]))
}

fn run(out: &mut impl Write) -> fmt::Result {
    command::fly(out)?;
    trained::fly(out)?;
    recurrent::fly(out)
}

#[cfg_attr(target_os = "none", board::entry)]
fn main() -> ! {
    #[cfg(target_os = "none")]
    heap::init();
    board::finish(run(&mut board::console()))
}
