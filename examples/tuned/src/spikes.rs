//! The yaw rate of a recorded flight through the constant that `spikewire tune` wrote: a line `sample,sign` for each
//! spike. `cargo verify tuned` compares them with those that the tuner scored.

#![cfg_attr(target_os = "none", no_std, no_main)]

use core::fmt::{self, Write};
use spikewire::{Output, Sample, Scheme};

include!(concat!(env!("OUT_DIR"), "/tuned.rs"));

/// The channel of the recording.
const YAW: usize = 2;

fn run(out: &mut impl Write) -> fmt::Result {
    let rates = flight_data::channel(flight_data::HEXAROTOR, YAW);
    let samples = rates.map(|rate| Sample::from_f64(rate.into()));
    let mut encoder = GYRO_Z.encoder();
    let mut index = 0;
    for sample in samples {
        if let Some(spike) = encoder.encode(sample).code() {
            print(out, &mut index, spike.sign())?;
        }
    }
    for spike in encoder.finish() {
        print(out, &mut index, spike.sign())?;
    }
    Ok(())
}

fn print(out: &mut impl Write, index: &mut usize, sign: i8) -> fmt::Result {
    if sign != 0 {
        writeln!(out, "{index},{sign}")?;
    }
    *index += 1;
    Ok(())
}

/// The same program on every board and on the host; `board` makes the difference.
#[cfg_attr(target_os = "none", board::entry)]
fn main() -> ! {
    board::finish(run(&mut board::console()))
}
