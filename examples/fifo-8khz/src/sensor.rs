//! The recorded flight in an ICM-42688-P.

use core::{cell::RefCell, convert::Infallible};

use embedded_hal_async::spi::{ErrorType, Operation, SpiDevice};
use icm42688p::{PACKET, SAMPLE_RATE, WATERMARK};

/// From one sample to the next, in µs.
pub const PERIOD: u32 = 1_000_000 / SAMPLE_RATE as u32;

/// Counts of 1 rad/s at ±2000 °/s, and of 1 m/s² at ±16 g.
const COUNTS: [f32; 6] = {
    let (rate, acceleration) = (16.384 * 57.295_78, 2048.0 / 9.806_65);
    [rate, rate, rate, acceleration, acceleration, acceleration]
};

/// Status, count, and a burst of packets: what a read brings.
pub type Fifo = [u8; 3 + WATERMARK * PACKET];

/// The flight, sample by sample.
pub struct Sensor {
    /// The record that lies before the next sample.
    record: usize,
    /// The next sample's time.
    micros: u32,
    noise: u32,
}

impl Sensor {
    pub fn new() -> Self {
        Self { record: 0, micros: record(0).0, noise: 1 }
    }

    /// The watermark's bit, the count, and the next packets.
    pub fn fill(&mut self, fifo: &mut Fifo) {
        fifo[..3].copy_from_slice(&[0x04, 0, (WATERMARK * PACKET) as u8]);
        for at in 0..WATERMARK {
            let [rx, ry, rz, ax, ay, az] = self.sample();
            let packet = &mut fifo[3 + at * PACKET..][..PACKET];
            packet[0] = 0x68;
            for (to, value) in packet[1..].chunks_exact_mut(2).zip([ax, ay, az, rx, ry, rz]) {
                to.copy_from_slice(&value.to_be_bytes());
            }
        }
    }

    fn sample(&mut self) -> [i16; 6] {
        while record(self.record + 1).0 <= self.micros {
            self.record += 1;
        }
        let ((start, from), (end, to)) = (record(self.record), record(self.record + 1));
        let part = (self.micros - start) as f32 / (end - start) as f32;
        self.micros += PERIOD;
        core::array::from_fn(|channel| {
            self.noise = self.noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let value = from[channel] + part * (to[channel] - from[channel]);
            (value * COUNTS[channel]) as i16 + (self.noise >> 31) as i16
        })
    }
}

fn record(number: usize) -> (u32, [f32; 6]) {
    let record = flight_data::record(flight_data::HEXAROTOR, number);
    record.map_or((u32::MAX, [0.0; 6]), |record| (record.micros, record.channels))
}

/// The bus.
pub struct Bus<'a>(pub &'a RefCell<Fifo>);

impl ErrorType for Bus<'_> {
    type Error = Infallible;
}

impl SpiDevice for Bus<'_> {
    async fn transaction(
        &mut self,
        operations: &mut [Operation<'_, u8>],
    ) -> Result<(), Infallible> {
        for operation in operations {
            if let Operation::TransferInPlace([_, received @ ..]) = operation {
                received.copy_from_slice(&*self.0.borrow());
            }
        }
        Ok(())
    }
}
