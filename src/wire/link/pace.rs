//! Pace: how much time passes from sample to sample, and how many samples in a time.

/// By how many millionths the time from sample to sample may differ from the link's period unless a receiver is told
/// otherwise: 2 %, as of an RC oscillator, or of a sensor that takes samples by a clock of its own.
pub const CLOCK_TOLERANCE: u32 = 20_000;

/// The longest sub-timestep in µs, if a sample of so many must be over before the next one of a clock that is as fast as its
/// tolerance allows, in millionths; 0 if there is none of 1 µs or more.
pub const fn longest_slot(slots: usize, period: u16, clock_tolerance: u32) -> u32 {
    const MILLION: u64 = 1_000_000;
    let slower = MILLION.saturating_sub(clock_tolerance as u64);
    match (period as u64 * slower / MILLION).checked_div(slots as u64) {
        Some(longest) => longest as u32,
        None => 0,
    }
}

/// From so many samples on, the older half of what was learned is forgotten.
const LEARNED: u32 = 128;

/// The clock of samples may change by this part of its tolerance, 1 / 128, while its pace is measured and until the
/// sub-timesteps that it then tells apart: 156 millionths of 2 %.
const STEADY: u64 = 128;

/// The time from sample to sample: the link's period within a tolerance, or what was measured of it, whichever is known
/// better.
///
/// Each tick may be early or late by an eighth of a *unit*: of a period, or of a sub-timestep where there are some. A
/// quarter of a unit thus is the most by which the jitter of two ticks moves one against the other, and less than another
/// quarter is left for what is not known of the pace: together they stay below half a unit, where rounding decides.
///
/// Samples are *counted* by the period and its tolerance alone: a clock may change within the tolerance at any time, so that
/// what was measured before a silence says nothing of it. Sub-timesteps are shorter than what a tolerance leaves open: only
/// the measured pace tells them apart, and the clock must be [`STEADY`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    /// The link's period in µs, 1 or more.
    period: u32,
    /// In µs, 1 or more.
    unit: u32,
    /// In millionths.
    tolerance: u32,
    /// So many samples took so many µs; 0 if nothing was learned.
    samples: u32,
    span: u32,
    /// In so many pieces, between which the time of samples was not known: the ticks at the ends of each have a jitter.
    pieces: u32,
    /// Whether the next time comes right after those learned.
    is_linked: bool,
}

/// What a time since the last known sample means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Elapsed {
    /// So many samples later, in this sub-timestep.
    Samples { samples: u64, slot: u32 },
    /// About so many samples later, and so many that it does not matter how many there were.
    Settled { samples: u64 },
    /// The pace is not known well enough for that long.
    Unknown,
    /// A time at which there is no sample.
    Misfit,
}

impl Pace {
    pub(super) const fn new(tolerance: u32) -> Self {
        Self { period: 1, unit: 1, tolerance, samples: 0, span: 0, pieces: 0, is_linked: false }
    }

    pub(super) const fn with_tolerance(self, tolerance: u32) -> Self {
        Self { tolerance, ..self }
    }

    pub(super) const fn period(&self) -> u32 {
        self.period
    }

    /// Sets the period, and the unit in which ticks must be told apart.
    pub(super) fn set(&mut self, period: u32, unit: u32) {
        if (self.period, self.unit) != (period, unit) {
            (self.period, self.unit) = (period, unit);
            self.forget();
        }
    }

    /// Forgets what was learned.
    pub(super) fn forget(&mut self) {
        (self.samples, self.span, self.pieces) = (0, 0, 1);
    }

    /// Notes that the clock may have stepped since the last known sample, or be that of another start.
    pub(super) fn cut(&mut self) {
        self.is_linked = false;
    }

    /// Begins a piece: what comes is not right after what was learned before.
    pub(super) fn begin(&mut self) {
        self.is_linked = true;
        self.pieces = self.pieces.saturating_add(1);
        if self.samples == 0 || self.pieces > 8 {
            self.forget();
        }
    }

    /// Learns that so many samples took so many µs, right after those learned before.
    pub(super) fn learn(&mut self, since: i64, samples: u64) {
        if !self.is_linked {
            return self.begin();
        }
        let (Ok(since), Ok(samples)) = (u32::try_from(since), u32::try_from(samples)) else {
            return self.forget();
        };
        // Longer ones would overflow, and are no better.
        if samples > LEARNED || since > 1 << 30 {
            return self.forget();
        }
        if self.samples >= LEARNED {
            let half = self.samples / 2;
            self.span = self.time_of_learned(half);
            self.samples = half;
            self.pieces = self.pieces / 2 + 1;
        }
        self.samples = self.samples.wrapping_add(samples);
        self.span = self.span.saturating_add(since);
    }

    /// The µs from one sample to that so many later, by what was learned.
    fn time_of_learned(&self, samples: u32) -> u32 {
        let product = u64::from(self.span).wrapping_mul(samples.into());
        product.checked_div(self.samples.into()).unwrap_or(0) as u32
    }

    /// The pace as so many µs in so many samples.
    fn pace(&self) -> (u64, u64) {
        if self.is_learned() {
            (self.span.into(), self.samples.into())
        } else {
            (self.period.into(), 1)
        }
    }

    /// How many whole samples fit into this time.
    fn samples(&self, since: u64) -> u64 {
        // Divisions of 32 bits wherever they will do.
        let (span, samples) = self.pace();
        match u32::try_from(since.wrapping_mul(samples)) {
            Ok(product) if since < 1 << 24 => product.checked_div(span as u32).unwrap_or(0).into(),
            // Times have 48 bits, and what is learned fewer than 9.
            _ => since.wrapping_mul(samples).checked_div(span).unwrap_or(0),
        }
    }

    /// The µs from one sample to that so many later.
    pub(super) fn time_of(&self, sample: u64) -> u64 {
        let (span, samples) = self.pace();
        let product = sample.wrapping_mul(span).wrapping_add(samples / 2);
        match u32::try_from(product) {
            _ if samples == 1 => product,
            Ok(product) => product.checked_div(samples as u32).unwrap_or(0).into(),
            Err(_) => product.checked_div(samples).unwrap_or(0),
        }
    }

    /// Whether the pace is known better by what was learned than by the link's period.
    fn is_learned(&self) -> bool {
        self.samples > 0 && self.learned_doubt(1_000) < self.stated_doubt(1_000)
    }

    /// By how many µs the sample so many later may be early or late by the tolerance.
    fn stated_doubt(&self, samples: u64) -> u64 {
        const MILLION: u64 = 1_000_000;
        let tolerance = u64::from(self.tolerance);
        let nominal = samples.wrapping_mul(self.period.into());
        // In two parts, as the product of a time of 48 bits and a tolerance of 32 would not fit.
        let part = (nominal % MILLION).wrapping_mul(tolerance).div_ceil(MILLION);
        (nominal / MILLION).wrapping_mul(tolerance).wrapping_add(part)
    }

    /// The same, by the jitter of the ticks from which the pace was learned, by the change of the clock since, and by
    /// rounding.
    fn learned_doubt(&self, samples: u64) -> u64 {
        let jitter = samples.wrapping_mul(self.unit.into()).wrapping_mul(self.pieces.into());
        let jitter = jitter.div_ceil(u64::from(self.samples).wrapping_mul(4).max(1));
        let change = self.stated_doubt(samples).div_ceil(STEADY);
        jitter.wrapping_add(change).wrapping_add(1)
    }

    /// By how many µs the sample so many later may be early or late, beside the jitter of its own tick and the last one.
    fn doubt(&self, samples: u64) -> u64 {
        if self.is_learned() { self.learned_doubt(samples) } else { self.stated_doubt(samples) }
    }

    /// The shortest time from sample to sample, in µs.
    pub(super) fn shortest_period(&self) -> u32 {
        let shortest = u64::from(self.period).saturating_sub(self.stated_doubt(1));
        shortest as u32
    }

    /// How many samples later a tick may be that comes after so many µs, if jitter moves it by at most so many.
    fn may_be(&self, samples: u64, since: u64, jitter: u64) -> bool {
        let away = samples.wrapping_mul(self.period.into()).abs_diff(since);
        away <= jitter.wrapping_add(self.stated_doubt(samples))
    }

    /// The fewest samples that there may have been, if about so many were.
    fn least(&self, samples: u64) -> u64 {
        let doubt = self.stated_doubt(samples);
        let doubtful = doubt.checked_div(self.period.into()).unwrap_or(u64::MAX);
        samples.saturating_sub(doubtful).saturating_sub(1)
    }

    /// How many samples later a tick is that comes after so many µs, if jitter moves it by at most so many. It is certain
    /// only if the period and its tolerance allow one number. From `settled` silent samples on, it does not matter.
    fn count(&self, since: i64, jitter: u64, settled: u32) -> Elapsed {
        let Ok(since) = u64::try_from(since) else { return Elapsed::Misfit };
        let period = u64::from(self.period);
        let half_later = since.wrapping_add(period / 2);
        let samples = half_later.checked_div(period).unwrap_or(0).max(1);
        let may_be_fewer = samples > 1 && self.may_be(samples.wrapping_sub(1), since, jitter);
        if may_be_fewer || self.may_be(samples.wrapping_add(1), since, jitter) {
            let is_settled = self.least(samples) > u64::from(settled);
            return if is_settled { Elapsed::Settled { samples } } else { Elapsed::Unknown };
        }
        if self.may_be(samples, since, jitter) {
            Elapsed::Samples { samples, slot: 0 }
        } else {
            Elapsed::Misfit
        }
    }

    /// The sample of a tick so long after the last known sample, of a code without sub-timesteps. From `settled` silent
    /// samples on, it does not matter how many there were.
    pub(super) fn elapsed(&self, since: i64, settled: u32) -> Elapsed {
        let period = u64::from(self.period);
        let quarter = period / 4;
        // As most often: the next sample. Two would come after 1.5 periods or more, less a quarter of jitter.
        if self.tolerance <= 100_000
            && since.unsigned_abs().abs_diff(period) <= quarter
            && since > 0
        {
            return Elapsed::Samples { samples: 1, slot: 0 };
        }
        let elapsed = self.count(since, quarter, settled);
        let Elapsed::Samples { samples, .. } = elapsed else { return elapsed };
        // At most three eighths, so that a tick that is half a period early or late is always noticed; by the measured
        // pace, too.
        let most = period.wrapping_mul(3) / 8;
        let since = since.unsigned_abs();
        if samples.wrapping_mul(period).abs_diff(since) > most {
            // Drift may be so far off as well.
            let is_drift = self.stated_doubt(samples) > most.wrapping_sub(quarter);
            return if is_drift { Elapsed::Unknown } else { Elapsed::Misfit };
        }
        if self.time_of(samples).abs_diff(since) > most { Elapsed::Misfit } else { elapsed }
    }

    /// The sample and the sub-timestep of a tick so long after the last known sample.
    pub(super) fn slot(&self, since: i64, slots: u32) -> Elapsed {
        let unit = u64::from(self.unit);
        let Ok(since) = u64::try_from(since.saturating_add((unit / 2).cast_signed())) else {
            return Elapsed::Misfit;
        };
        let samples = self.samples(since);
        let doubt = self.doubt(samples);
        // With a quarter of jitter it must stay below half a unit.
        if doubt.saturating_mul(4) >= unit {
            return Elapsed::Unknown;
        }
        let Some(slot) = self.slot_of(samples, since, slots, doubt) else {
            return Elapsed::Misfit;
        };
        // Where a fast clock makes samples shorter than their sub-timesteps, it may be the last one of the sample before.
        let before = samples.checked_sub(1);
        if before.is_some_and(|before| self.slot_of(before, since, slots, doubt).is_some()) {
            return Elapsed::Unknown;
        }
        Elapsed::Samples { samples, slot }
    }

    /// The sub-timestep of this sample in which a tick lies that comes half a unit earlier than after so many µs.
    fn slot_of(&self, sample: u64, half_later: u64, slots: u32, doubt: u64) -> Option<u32> {
        let unit = u64::from(self.unit);
        let rest = half_later.saturating_sub(self.time_of(sample));
        let slot = rest.checked_div(unit)?;
        let away = slot.wrapping_mul(unit).wrapping_add(unit / 2).abs_diff(rest);
        // The events of the last known sample have its tick, to the microsecond. Others lie at most three eighths of a unit
        // away, so that a tick that is half a unit early or late is always noticed.
        let most = match sample {
            0 => 0,
            _ => (unit / 4).wrapping_add(doubt).min(unit.wrapping_mul(3) / 8),
        };
        u32::try_from(slot).ok().filter(|&slot| slot < slots && away <= most)
    }

    /// The sample of a heartbeat so long after the last known sample, of a code with sub-timesteps. Its tick says when the
    /// sample was taken, so that nothing but a count that matters makes it unknown.
    pub(super) fn beat(&self, since: i64, settled: u32) -> Elapsed {
        let jitter = u64::from(self.unit / 4);
        let elapsed = self.count(since, jitter, settled);
        let Elapsed::Samples { samples, .. } = elapsed else { return elapsed };
        let most = jitter.wrapping_add(self.doubt(samples));
        let is_near = self.time_of(samples).abs_diff(since.unsigned_abs()) <= most;
        if is_near { elapsed } else { Elapsed::Misfit }
    }

    /// How many samples are over for certain so long after the last known one.
    pub(super) fn over(&self, since: i64) -> u64 {
        let since = since.saturating_add((self.unit / 2).into()).max(0);
        let samples = self.samples(since.unsigned_abs());
        let is_certain = self.stated_doubt(samples).saturating_mul(4) < u64::from(self.period);
        if is_certain { samples } else { self.least(samples) }
    }
}
