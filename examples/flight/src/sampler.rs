//! Between sensor and queue: what is encoded, what is missing, and whether the sensor lives.

use spikewire::{Bank, Item, Put, Sample, Schemes, Start, Tick};

use crate::Counters;

/// What a sensor promises, and how long a doubt may last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan {
    /// From one sample to the next, in µs.
    pub period: u32,
    /// Samples left out after each start, while the sensor's filters settle.
    pub settle: u16,
    /// Samples from one keyframe to the next, at least 1; the first sample after a start has one too.
    pub keyframe_every: u16,
    /// How long the sensor may be silent, in µs.
    pub patience: u32,
    /// Samples for each data-ready edge: 1, or a FIFO's watermark.
    pub burst: u8,
    /// How many samples in a row may be alike in all bits of the three rates, or of the three accelerations. Noise changes
    /// some bit of a living sensor's sample all the time; one of two dies may freeze alone. As many samples in a row may
    /// be missing from what was read, those between two failed reads included.
    pub most_alike: u8,
    /// The most spikes that the code has for a channel and sample; 0 counts none as at the limit.
    pub most_spikes: u8,
}

impl Plan {
    /// Number of samples a second, rounded down.
    pub const fn samples_a_second(&self) -> u16 {
        let period = if self.period == 0 { 1 } else { self.period };
        let samples = 1_000_000 / period;
        if samples > u16::MAX as u32 { u16::MAX } else { samples as u16 }
    }
}

/// Why the sensor must be started.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Why {
    /// It never was.
    NotStarted,
    /// No data-ready edge within the plan's patience.
    Silent,
    /// Sample after sample has the same rates, or the same accelerations, in every bit.
    Stuck,
    /// Read after read failed.
    Failing,
}

/// The bank of a sensor's channels, with an eye on the sensor.
///
/// In the interrupt: [`take`](Self::take), with what was read. In main, some times within the plan's patience:
/// [`look`](Self::look), which says whether the sensor must be started; then [`started`](Self::started) or
/// [`failed_to_start`](Self::failed_to_start).
///
/// **The far end** is told by a [break](Item::Break) when the sensor is found dead, and again for each start that
/// fails: the link goes on, and its values are not exact until the sensor is back. Then the first sample has a keyframe.
pub struct Sampler<T: Schemes<N>, const N: usize> {
    bank: Bank<T, N>,
    plan: Plan,
    /// Why it is dead, if it is.
    dead: Option<Why>,
    /// The last data-ready edge, or the start.
    last: Tick,
    /// Whether `last` is an edge.
    has_come: bool,
    to_settle: u16,
    to_keyframe: u16,
    bits: [u32; N],
    /// Samples in a row with the same first half of the channels, and with the same second half.
    alike: [u8; 2],
    failed: u8,
    /// Which channels were at the limit of their code, by their addresses.
    at_limit: u32,
    counters: Counters,
}

impl<T, S, const N: usize> Sampler<T, N>
where
    T: Schemes<N, Scheme: Start<Sample = S>>,
    S: Sample,
{
    /// A sampler whose sensor was not started.
    pub const fn new(bank: Bank<T, N>, plan: Plan) -> Self {
        let counters = Counters {
            samples: 0,
            discarded: 0,
            missed: 0,
            failed: 0,
            at_limit: 0,
            deaths: 0,
            starts: 0,
        };
        Self {
            bank,
            plan,
            dead: Some(Why::NotStarted),
            last: Tick::from_micros(0),
            has_come: false,
            to_settle: 0,
            to_keyframe: 0,
            bits: [0; N],
            alike: [0; 2],
            failed: 0,
            at_limit: 0,
            counters,
        }
    }

    /// Takes what a read brought, with the tick of its data-ready edge.
    pub fn take<E>(&mut self, edge: Tick, read: Result<[S; N], E>, queue: impl Put) {
        let is_stuck = read.as_ref().is_ok_and(|sample| self.is_stuck(sample.map(S::to_bits32)));
        self.take_judged(edge, read, is_stuck, queue);
    }

    /// Whether one half of the channels has had the same bits for too long.
    fn is_stuck(&mut self, bits: [u32; N]) -> bool {
        let halves = [0..N / 2, N / 2..N];
        for (alike, half) in self.alike.iter_mut().zip(halves) {
            let is_alike = !half.is_empty() && bits.get(half.clone()) == self.bits.get(half);
            *alike = if is_alike { alike.saturating_add(1) } else { 0 };
        }
        self.bits = bits;
        self.alike.iter().any(|&alike| alike >= self.plan.most_alike)
    }

    /// Takes what a read brought, where somebody else has looked at the sensor's bits: `is_stuck` says that they have not
    /// changed for too long.
    pub fn take_judged<E>(
        &mut self,
        edge: Tick,
        read: Result<[S; N], E>,
        is_stuck: bool,
        mut queue: impl Put,
    ) {
        if self.dead.is_some() {
            self.counters.discarded = self.counters.discarded.wrapping_add(1);
            return;
        }
        let missed = self.count_missed(edge);
        let Ok(sample) = read else {
            self.counters.failed = self.counters.failed.wrapping_add(1);
            // A bus that hangs until it is given up takes the samples between two reads with it.
            let between = if self.failed > 0 { missed } else { 0 };
            let all = u8::try_from(between.saturating_add(1)).unwrap_or(u8::MAX);
            self.failed = self.failed.saturating_add(all);
            if self.failed > self.plan.most_alike {
                self.end(Why::Failing, edge, queue);
            }
            return;
        };
        self.failed = 0;
        if is_stuck {
            return self.end(Why::Stuck, edge, queue);
        }
        if self.to_settle > 0 {
            self.to_settle -= 1;
            self.counters.discarded = self.counters.discarded.wrapping_add(1);
            return;
        }
        self.encode(edge, sample, &mut queue);
        if self.to_keyframe == 0 {
            self.to_keyframe = self.plan.keyframe_every;
            self.bank.keyframe_into(edge, queue);
        }
        self.to_keyframe = self.to_keyframe.saturating_sub(1);
    }

    fn encode(&mut self, edge: Tick, sample: [S; N], queue: &mut impl Put) {
        let (most, mut at_limit) = (self.plan.most_spikes, 0_u32);
        let (mut address, mut spikes) = (None, 0);
        self.bank.encode(edge, sample, |event| {
            spikes = if address == Some(event.address) { spikes + 1 } else { 1 };
            address = Some(event.address);
            if spikes == most {
                at_limit |= 1 << (event.address & 31);
            }
            queue.put(Item::Event(event));
        });
        // One spike is no limit yet; one after the other is.
        let counted = if most > 1 { at_limit } else { at_limit & self.at_limit };
        self.at_limit = at_limit;
        self.counters.at_limit = self.counters.at_limit.wrapping_add(counted.count_ones());
        self.counters.samples = self.counters.samples.wrapping_add(1);
    }

    /// Counts whole periods between two edges, which are samples that nobody saw, and returns their number.
    fn count_missed(&mut self, edge: Tick) -> u32 {
        let mut missed = 0;
        if self.has_come {
            let period = self.plan.period.max(1);
            let passed = edge.since(self.last).max(0).unsigned_abs();
            let periods = (passed + period / 2) / period;
            missed = periods.saturating_sub(1);
            self.counters.missed = self.counters.missed.wrapping_add(missed);
        }
        (self.last, self.has_come) = (edge, true);
        missed
    }

    /// Whether the sensor must be started, and why; tells the far end when that is news.
    pub fn look(&mut self, now: Tick, queue: impl Put) -> Option<Why> {
        // An edge may have come since the caller looked at its clock.
        if self.dead.is_none() && now.since(self.last) > self.plan.patience as i32 {
            self.end(Why::Silent, now, queue);
        }
        self.dead
    }

    fn end(&mut self, why: Why, now: Tick, queue: impl Put) {
        self.dead = Some(why);
        self.counters.deaths = self.counters.deaths.wrapping_add(1);
        self.bank.reset_into(now, queue);
    }

    /// The sensor was started, and has read back right.
    pub fn started(&mut self, now: Tick) {
        self.dead = None;
        (self.last, self.has_come) = (now, false);
        (self.alike, self.failed) = ([0; 2], 0);
        (self.to_settle, self.to_keyframe) = (self.plan.settle, 0);
        self.counters.starts = self.counters.starts.wrapping_add(1);
    }

    /// The sensor could not be started: the far end is told again.
    pub fn failed_to_start(&mut self, now: Tick, queue: impl Put) {
        self.bank.reset_into(now, queue);
    }

    /// Whether samples are encoded, or will be as soon as they have settled.
    pub const fn is_alive(&self) -> bool {
        self.dead.is_none()
    }

    /// What happened so far.
    pub const fn counters(&self) -> Counters {
        self.counters
    }

    /// The bank, for its counters.
    pub const fn bank(&self) -> &Bank<T, N> {
        &self.bank
    }
}
