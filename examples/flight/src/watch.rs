//! The loop that samples: start, read, code, and start again.

use embassy_futures::select::{Either, select};
use embedded_hal_async::{delay::DelayNs, digital::Wait};
use spikewire::{Bank, Put, Tick};

use crate::{
    Alignment, Burst, CHANNELS, Counters, Fault, Imu, Pace, Rounds, Sample, Sampler, Schemes,
};

/// From one try to start the sensor to the next.
const RETRY_MS: u32 = 100;
/// Reads without a wait for the next edge: a FIFO that is full holds as many bursts.
const READS_IN_A_ROW: usize = 16;
/// How long the bus may take for a read, in µs.
const READ_LIMIT: u32 = 2_000;
/// How long a start may take, in ms.
const START_LIMIT_MS: u32 = 300;
/// Every start takes longer than this, in µs: the time must have gone on by it.
const SHORTEST_START: i32 = 1_000;

/// Samples for ever.
///
/// A sensor that does not start, falls silent, is stuck, or cannot be read is started again, and the far end of the link
/// is told: see [`Sampler`]. A bus that never answers is given up, and a clock that stands still is a fault like a
/// missing sensor.
pub struct Watch<I: Imu, P, W> {
    imu: I,
    data_ready: P,
    delay: W,
    now: fn() -> Tick,
    alignment: Alignment,
    sampler: Sampler<Schemes<I>, CHANNELS>,
    pace: Pace,
    report: fn(Counters, Option<Fault>),
    rounds: &'static Rounds,
}

impl<I: Imu, P: Wait, W: DelayNs + Clone> Watch<I, P, W> {
    /// A watch over a sensor whose data-ready line rises for every burst.
    ///
    /// - `delay` waits without blocking other tasks;
    /// - `report` hears each fault, and once a second that all is well: for the log;
    /// - `rounds` counts as long as this runs, with or without a sensor: whoever feeds the watchdog looks at it.
    pub const fn new(
        imu: I,
        data_ready: P,
        delay: W,
        now: fn() -> Tick,
        alignment: Alignment,
        report: fn(Counters, Option<Fault>),
        rounds: &'static Rounds,
    ) -> Self {
        let sampler = Sampler::new(Bank::per_channel(I::SCHEMES), I::PLAN);
        let pace = Pace::new(I::PLAN.period);
        Self { imu, data_ready, delay, now, alignment, sampler, pace, report, rounds }
    }

    /// Returns the sampler, for its counters and its bank.
    pub const fn sampler(&self) -> &Sampler<Schemes<I>, CHANNELS> {
        &self.sampler
    }

    /// Never returns: a task of its own.
    pub async fn run(&mut self, queue: impl Put + Copy) -> ! {
        loop {
            self.rounds.count();
            match self.start().await {
                Ok(()) => {
                    self.sampler.started((self.now)());
                    self.pace = Pace::new(I::PLAN.period);
                    self.sample(queue).await;
                    (self.report)(self.sampler.counters(), None);
                }
                Err(fault) => {
                    self.sampler.failed_to_start((self.now)(), queue);
                    (self.report)(self.sampler.counters(), Some(fault));
                    self.delay.delay_ms(RETRY_MS).await;
                }
            }
        }
    }

    async fn start(&mut self) -> Result<(), Fault> {
        let before = (self.now)();
        let Self { imu, delay, .. } = self;
        let mut pauses = delay.clone();
        match select(imu.start(&mut pauses), delay.delay_ms(START_LIMIT_MS)).await {
            Either::First(started) => started?,
            Either::Second(()) => return Err(Fault::Late),
        }
        let passed = (self.now)().since(before);
        if passed < SHORTEST_START { Err(Fault::Clock) } else { Ok(()) }
    }

    /// Returns when the sensor is dead.
    async fn sample(&mut self, queue: impl Put + Copy) {
        let a_second = u32::from(I::PLAN.samples_a_second());
        let mut reported = self.sampler.counters().samples;
        while self.sampler.look((self.now)(), queue).is_none() {
            self.rounds.count();
            let patience = self.delay.delay_us(I::PLAN.patience + 1);
            match select(self.data_ready.wait_for_rising_edge(), patience).await {
                Either::First(_) => self.read(queue).await,
                Either::Second(()) => {}
            }
            let counters = self.sampler.counters();
            if counters.samples.wrapping_sub(reported) >= a_second {
                reported = counters.samples;
                (self.report)(counters, None);
            }
        }
    }

    /// Codes what the sensor holds.
    async fn read(&mut self, queue: impl Put + Copy) {
        let Self { imu, delay, now, alignment, sampler, pace, report, .. } = self;
        for _ in 0..READS_IN_A_ROW {
            let edge = now();
            let fault = match select(imu.read(), delay.delay_us(READ_LIMIT)).await {
                Either::First(Ok(burst)) => {
                    // Less than a burst waits for the next edge.
                    let is_last = burst.left() < usize::from(I::PLAN.burst);
                    encode::<I>(sampler, pace, *alignment, edge, burst, queue);
                    if is_last {
                        return;
                    }
                    continue;
                }
                Either::First(Err(fault)) => fault,
                Either::Second(()) => Fault::Late,
            };
            if fault == Fault::Overrun {
                // All samples until now are lost.
                *pace = Pace::new(I::PLAN.period);
                imu.recover().await;
            }
            for _ in 0..I::PLAN.burst {
                sampler.take(pace.expected(edge), Err(fault), queue);
            }
            report(sampler.counters(), Some(fault));
            return;
        }
    }
}

/// Codes a burst that was read at this edge. An empty one is a failed read: the edge promised samples.
pub fn encode<I: Imu>(
    sampler: &mut Sampler<Schemes<I>, CHANNELS>,
    pace: &mut Pace,
    alignment: Alignment,
    edge: Tick,
    burst: Burst<impl ExactSizeIterator<Item = Option<Sample>>>,
    queue: impl Put + Copy,
) {
    if burst.held == 0 {
        return sampler.take(pace.expected(edge), Err(Fault::NoData), queue);
    }
    let holds_more = I::PLAN.burst > 1;
    if holds_more {
        pace.burst(edge, burst.held);
    }
    for sample in burst.samples {
        let tick = if holds_more { pace.sample() } else { edge };
        sampler.take(
            tick,
            sample.map(|sample| alignment.apply(sample)).ok_or(Fault::NoData),
            queue,
        );
    }
}
