//! Turn rates in, spikes out, turn rates back: the smallest program, to copy and begin with.

#![cfg_attr(target_os = "none", no_std, no_main)]

use core::fmt::{self, Write};
use spikewire::{Bank, Scheme, Tick, temporal::StepForward};

/// A spike for every 0.1 rad/s. A jolt of more than that in one sample is caught up with in the next ones.
static GYRO: StepForward<f32> = StepForward::new(0.1);

fn run(out: &mut impl Write) -> fmt::Result {
    let mut bank = Bank::<_, 3>::new(&GYRO); // on the flight controller
    let mut decoders = [GYRO.decoder(); 3]; // wherever the spikes go
    let mut decoded = [0.0; 3];
    let (mut events, mut largest_error) = (0, 0.0);

    for (tick, rates) in gyro() {
        bank.encode(tick, rates, |event| {
            let channel = usize::from(event.address);
            decoded[channel] = decoders[channel].decode(event.polarity.into());
            events += 1;
            if events <= 5 {
                let _ = writeln!(out, "{event:?}");
            }
        });
        for (rate, decoded) in rates.iter().zip(decoded) {
            largest_error = f32::max(largest_error, (rate - decoded).abs());
        }
    }
    writeln!(out, "{events} events; the decoded rates are off by at most {largest_error} rad/s")
}

/// The gyroscope of a hexarotor that takes off and flies: rates in rad/s.
fn gyro() -> impl Iterator<Item = (Tick, [f32; 3])> {
    let records = flight_data::records(flight_data::HEXAROTOR).take(2000);
    records.map(|record| {
        let [roll, pitch, yaw, ..] = record.channels;
        (record.micros.into(), [roll, pitch, yaw])
    })
}

#[cfg_attr(target_os = "none", board::entry)]
fn main() -> ! {
    board::finish(run(&mut board::console()))
}
