//! A recorded flight: timer interrupt, bank, queue, frames out of the UART; and back to values on the host.
//!
//! On the board this is the sending end, on the host the receiving one. The board decodes its spikes as they are
//! made; both print a digest of the values, which must be the same.

#![cfg_attr(target_os = "none", no_std, no_main)]

mod digest;
mod flight;

#[cfg(not(target_os = "none"))]
mod receive;
#[cfg(target_os = "none")]
mod send;
#[cfg(target_os = "none")]
mod uart;

use spikewire::temporal::StepForward;

/// Gyroscope x, y, z, then accelerometer x, y, z.
const CHANNELS: usize = 6;
/// A spike for every 0.1 rad/s.
const RATE: StepForward<f32> = StepForward::<f32>::checked(0.1);
/// A spike for every 0.5 m/s².
const ACCELERATION: StepForward<f32> = StepForward::<f32>::checked(0.5);

/// The same on both ends.
const SCHEMES: [StepForward<f32>; CHANNELS] =
    [RATE, RATE, RATE, ACCELERATION, ACCELERATION, ACCELERATION];

#[cfg(target_os = "none")]
#[board::entry]
fn main() -> ! {
    board::finish(send::run(&mut board::console()))
}

#[cfg(not(target_os = "none"))]
fn main() -> ! {
    board::finish(receive::run(&mut board::console()))
}
