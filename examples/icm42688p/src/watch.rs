//! What runs for ever: start, sample, encode, and start again.

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

use embassy_futures::select::{Either, select};
use embedded_hal_async::{delay::DelayNs, digital::Wait, spi::SpiDevice};
use flight::{Counters, Plan, Sampler};
use spikewire::{Put, Tick, temporal::StepForward};

use crate::{Burst, Fault, Icm42688p, Pace, WATERMARK};

/// Samples a second.
pub const SAMPLE_RATE: u16 = 8_000;
/// From one sample to the next, in µs.
pub const PERIOD: u16 = (1_000_000 / SAMPLE_RATE as u32) as u16;
/// Rates about x, y and z, then accelerations along them.
pub const CHANNELS: usize = 6;

/// A spike for every 6 °/s: it follows 47 800 °/s².
static RATE: StepForward<i16> = StepForward::new(98);
/// A spike for every 0.16 g: it follows 1281 g/s, the steepest of 1 g at 200 Hz.
static ACCELERATION: StepForward<i16> = StepForward::new(328);

/// A scheme for each channel, in counts: 16.4 for 1 °/s, 2048 for 1 g.
pub const SCHEMES: Schemes = [&RATE, &RATE, &RATE, &ACCELERATION, &ACCELERATION, &ACCELERATION];
/// One for each channel.
pub type Schemes = [&'static StepForward<i16>; CHANNELS];

/// The driver's start has let the sensor settle. Ten milliseconds of silence, or of equal samples, are no accident.
pub const PLAN: Plan = Plan {
    period: PERIOD,
    settle: 0,
    keyframe_every: SAMPLE_RATE,
    patience: 10_000,
    most_alike: 80,
    most_spikes: 1,
};

/// From one try to start the sensor to the next.
const RETRY_MS: u32 = 100;
/// Reads without a wait: the FIFO holds sixteen bursts.
const READS_IN_A_ROW: usize = 16;

/// Samples for ever.
///
/// A sensor that does not start, falls silent, is stuck, or cannot be read is started again, and the far end of the link
/// is told: see [`Sampler`]. A FIFO that ran over is emptied; its samples count as missed.
pub struct Watch<'b, D, P, W> {
    /// The sensor.
    pub imu: Icm42688p<'b, D>,
    /// Its INT1.
    pub data_ready: P,
    /// Pauses.
    pub delay: W,
    /// The time.
    pub now: fn() -> Tick,
    /// The encoders.
    pub sampler: Sampler<Schemes, CHANNELS>,
    /// The samples' time.
    pub pace: Pace,
    /// Told of each fault, and once a second that all is well: for the log.
    pub report: fn(Counters, Option<Fault>),
    /// Rises as long as this runs, with or without a sensor: what feeds a watchdog looks at it.
    pub rounds: &'static AtomicU32,
}

impl<D: SpiDevice, P: Wait, W: DelayNs> Watch<'_, D, P, W> {
    /// Never returns: a task of its own.
    pub async fn run(&mut self, queue: impl Put + Copy) -> ! {
        loop {
            self.rounds.fetch_add(1, Relaxed);
            let start = self.imu.start(&mut self.delay).await;
            let now = (self.now)();
            match start {
                Ok(()) => {
                    self.sampler.started(now);
                    self.pace = Pace::new();
                    self.sample(queue).await;
                    (self.report)(self.sampler.counters(), None);
                }
                Err(fault) => {
                    self.sampler.failed_to_start(now, queue);
                    (self.report)(self.sampler.counters(), Some(fault));
                    self.delay.delay_ms(RETRY_MS).await;
                }
            }
        }
    }

    /// Returns when the sensor is dead.
    async fn sample(&mut self, queue: impl Put + Copy) {
        let mut reported = self.sampler.counters().samples;
        while self.sampler.look((self.now)(), queue).is_none() {
            self.rounds.fetch_add(1, Relaxed);
            let patience = self.delay.delay_us(PLAN.patience + 1);
            match select(self.data_ready.wait_for_rising_edge(), patience).await {
                Either::First(_) => self.read(queue).await,
                Either::Second(()) => {}
            }
            let counters = self.sampler.counters();
            if counters.samples.wrapping_sub(reported) >= u32::from(SAMPLE_RATE) {
                reported = counters.samples;
                (self.report)(counters, None);
            }
        }
    }

    /// Encodes what the FIFO holds.
    async fn read(&mut self, queue: impl Put + Copy) {
        let mut now = (self.now)();
        for _ in 0..READS_IN_A_ROW {
            match self.imu.read().await {
                Ok(burst) => {
                    encode(&mut self.sampler, &mut self.pace, now, &burst, queue);
                    // Less than a burst waits for the next interrupt.
                    if burst.left() < WATERMARK {
                        return;
                    }
                }
                Err(fault) => {
                    if fault == Fault::Overrun {
                        // All samples until now are lost. If this fails, so does the next read.
                        self.pace = Pace::new();
                        _ = self.imu.flush().await;
                    }
                    self.sampler.take(self.pace.expected(now), Err(fault), queue);
                    (self.report)(self.sampler.counters(), Some(fault));
                    return;
                }
            }
            now = (self.now)();
        }
    }
}

/// Encodes a burst that was read at this time. An empty one is a failed read: an interrupt promised packets.
pub fn encode(
    sampler: &mut Sampler<Schemes, CHANNELS>,
    pace: &mut Pace,
    now: Tick,
    burst: &Burst<'_>,
    queue: impl Put + Copy,
) {
    if burst.in_fifo() == 0 {
        return sampler.take(pace.expected(now), Err(()), queue);
    }
    pace.burst(now, burst.in_fifo());
    for sample in burst.samples() {
        sampler.take(pace.sample(), sample.ok_or(()), queue);
    }
}
