//! A sensor that is read at a steady rate, started and watched without waits.

use core::{pin::pin, task::Poll};
use embassy_futures::poll_once;
use spikewire::{Bank, Put, Schemes, Start, Tick};

use crate::{CHANNELS, Channels, Counters, Counts, Fault, OfCounts, Plan, Sample, Sampler, Why};

/// A sensor whose newest sample lies in registers.
///
/// Each step is a few transfers: whoever calls waits between them, by periods of the flight.
pub trait Registers {
    /// What a count is.
    const COUNTS: Counts;
    /// From the reset to the first access, in µs.
    const RESET_US: u32;
    /// From the configuration to samples that are good, in µs.
    const SETTLE_US: u32;

    /// Resets the sensor.
    ///
    /// # Errors
    /// Returns an error if the bus failed.
    fn reset(&mut self) -> impl Future<Output = Result<(), Fault>>;

    /// Reads the identity, and writes the settings.
    ///
    /// # Errors
    /// Returns an error if the sensor is missing, or is another one.
    fn configure(&mut self) -> impl Future<Output = Result<(), Fault>>;

    /// Reads the settings back.
    ///
    /// # Errors
    /// Returns an error if one was not kept.
    fn check(&mut self) -> impl Future<Output = Result<(), Fault>>;

    /// Reads the identity and the newest sample.
    ///
    /// # Errors
    /// Returns an error if this is not the sensor that was started, or it has no new sample.
    fn read(&mut self) -> impl Future<Output = Result<Sample, Fault>>;
}

/// What there is to log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum News {
    /// A second of the flight has passed.
    Second,
    /// The sensor was started, and its settings read back right.
    Started,
    /// The first fault after a time without any; or, every 100 ms, that of a start.
    Fault(Fault),
    /// The sensor was found dead. It is started again.
    Dead(Why),
}

/// What comes next.
#[derive(Clone, Copy, Debug)]
enum Step {
    Reset,
    Configure,
    Check,
    Sample,
}

/// From one try to start the sensor to the next, in µs.
const RETRY_US: u32 = 100_000;
/// How many samples in a row may be alike, or missing.
const MOST_ALIKE: u8 = 20;

/// A sensor, and the bank of a flight: one call for each period, from a timer's interrupt or a task.
///
/// A sensor that is missing, is another one, does not keep its settings, cannot be read, or says the same again and again
/// has no value: the far end is told by a [break](spikewire::Item::Break), a counter rises, there are [`News`] for the log,
/// and the sensor is started until it answers. A start waits by the periods that pass, never within a call.
pub struct Station<I, T: Schemes<N>, const N: usize> {
    sensor: I,
    channels: Channels<N>,
    sampler: Sampler<T, N>,
    period: u32,
    /// Periods since the start of the firmware.
    periods: u64,
    /// Periods to pass before the next step.
    pause: u32,
    step: Step,
    /// What the sensor said last, and how often in a row, of rates and accelerations.
    last: Sample,
    alike: [u8; 2],
    is_faulty: bool,
}

impl<I: Registers, T: Schemes<N, Scheme: Start<Sample: OfCounts>>, const N: usize>
    Station<I, T, N>
{
    /// A sensor before its first start. The items are those of the flight's module: `BANK`, `PERIOD`, `KEYFRAME_EVERY`.
    pub const fn new(
        sensor: I,
        channels: Channels<N>,
        bank: Bank<T, N>,
        period: u32,
        keyframe_every: u32,
    ) -> Self {
        let keyframe_every =
            if keyframe_every > u16::MAX as u32 { u16::MAX } else { keyframe_every as u16 };
        let plan = Plan {
            period,
            settle: 0,
            keyframe_every,
            patience: period * MOST_ALIKE as u32,
            burst: 1,
            most_alike: MOST_ALIKE,
            most_spikes: 0, // the scheme's own matter
        };
        Self {
            sensor,
            channels,
            sampler: Sampler::new(bank, plan),
            period,
            periods: 0,
            pause: 0,
            step: Step::Reset,
            last: [0; CHANNELS],
            alike: [0; 2],
            is_faulty: false,
        }
    }

    /// What happened so far.
    pub const fn counters(&self) -> Counters {
        self.sampler.counters()
    }

    /// The time of the current period. Ticks are whole periods: the timer that calls is the flight's clock.
    pub fn now(&self) -> Tick {
        Tick::from_micros(self.periods.wrapping_mul(u64::from(self.period)))
    }

    /// A period of a bus that does not wait for interrupts: [`tick`](Self::tick), to its end.
    pub fn tick_blocking(&mut self, queue: impl Put + Copy) -> Option<News> {
        match poll_once(pin!(self.tick(queue))) {
            Poll::Ready(news) => news,
            Poll::Pending => Some(News::Fault(Fault::Late)),
        }
    }

    /// A period: reads and codes a sample, or goes on with the start.
    pub async fn tick(&mut self, queue: impl Put + Copy) -> Option<News> {
        self.periods = self.periods.wrapping_add(1);
        if self.pause > 0 {
            self.pause -= 1;
            return self.second();
        }
        let done = match self.step {
            Step::Reset => self.sensor.reset().await.map(|()| (Step::Configure, I::RESET_US)),
            Step::Configure => self.sensor.configure().await.map(|()| (Step::Check, I::SETTLE_US)),
            Step::Check => self.sensor.check().await.map(|()| (Step::Sample, 0)),
            Step::Sample => return self.sample(queue).await,
        };
        let now = self.now();
        match done {
            Ok((Step::Sample, _)) => {
                self.sampler.started(now);
                (self.step, self.alike, self.is_faulty) = (Step::Sample, [0; 2], false);
                Some(News::Started)
            }
            Ok((next, wait)) => {
                (self.step, self.pause) = (next, self.periods_of(wait));
                self.second()
            }
            Err(fault) => {
                self.sampler.failed_to_start(now, queue);
                (self.step, self.pause) = (Step::Reset, self.periods_of(RETRY_US));
                Some(News::Fault(fault))
            }
        }
    }

    async fn sample(&mut self, queue: impl Put + Copy) -> Option<News> {
        let (read, now) = (self.sensor.read().await, self.now());
        let is_stuck = read.is_ok_and(|sample| self.is_stuck(sample));
        let sample = read.map(|sample| self.channels.sample(sample));
        self.sampler.take_judged(now, sample, is_stuck, queue);
        if let Some(why) = self.sampler.look(now, queue) {
            (self.step, self.pause) = (Step::Reset, 0);
            return Some(News::Dead(why));
        }
        let was_faulty = core::mem::replace(&mut self.is_faulty, read.is_err());
        match read {
            Err(fault) if !was_faulty => Some(News::Fault(fault)),
            _ => self.second(),
        }
    }

    /// Whether rates or accelerations have not changed for too long, in the sensor's own counts.
    fn is_stuck(&mut self, sample: Sample) -> bool {
        let half = CHANNELS / 2;
        let same = [sample[..half] == self.last[..half], sample[half..] == self.last[half..]];
        self.last = sample;
        for (alike, same) in self.alike.iter_mut().zip(same) {
            *alike = if same { alike.saturating_add(1) } else { 0 };
        }
        self.alike.iter().any(|&alike| alike >= MOST_ALIKE)
    }

    fn second(&self) -> Option<News> {
        let a_second = 1_000_000 / u64::from(self.period).max(1);
        self.periods.is_multiple_of(a_second).then_some(News::Second)
    }

    /// As many periods as last this long at least. The current one may be over at once.
    fn periods_of(&self, micros: u32) -> u32 {
        micros.div_ceil(self.period.max(1))
    }
}
