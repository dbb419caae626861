//! Turn rates in, spikes out, turn rates back: the smallest program, to copy and begin with.

#![cfg_attr(target_os = "none", no_std, no_main)]

use core::fmt::{self, Write};
use spikewire::{Bank, Decoder, Scheme, temporal::StepForward};

/// A spike for every 0.1 rad/s. A jolt of more than that in one sample is caught up with in the next ones.
const GYRO: StepForward<f32> = StepForward::<f32>::checked(0.1);

fn run(out: &mut impl Write) -> fmt::Result {
    let mut bank = Bank::<_, 3>::new(GYRO); // on the flight controller
    let mut decoders = [GYRO.decoder(); 3]; // wherever the spikes go
    let (mut events, mut largest_error) = (0, 0.0);

    for (time_us, rates) in gyro() {
        bank.encode(time_us, rates, |event| {
            decoders[usize::from(event.address)].decode(event.polarity.into());
            events += 1;
            if events <= 5 {
                let _ = writeln!(out, "{event:?}");
            }
        });
        for (rate, decoder) in rates.iter().zip(&decoders) {
            largest_error = f32::max(largest_error, (rate - decoder.value()).abs());
        }
    }
    writeln!(out, "{events} events; the decoded rates are off by at most {largest_error} rad/s")
}

/// The gyroscope of a hexarotor that takes off and flies: time in µs, rates in rad/s.
fn gyro() -> impl Iterator<Item = (u32, [f32; 3])> {
    static RECORDING: &[u8] = flight_data::HEXAROTOR;
    let (records, _) = RECORDING.as_chunks::<28>();
    records.iter().take(2000).map(|record| {
        let (words, _) = record.as_chunks::<4>();
        (u32::from_le_bytes(words[0]), [1, 2, 3].map(|i| f32::from_le_bytes(words[i])))
    })
}

#[cfg_attr(target_os = "none", board::entry)]
fn main() -> ! {
    board::finish(run(&mut board::console()))
}
