//! Pace: how much time passes from sample to sample, and how many samples in a time.

/// By how many millionths the time from sample to sample may differ from the link's period unless a receiver is told
/// otherwise: 2 %, as of an RC oscillator, or of a sensor that takes samples by a clock of its own.
pub const CLOCK_TOLERANCE: u32 = 20_000;

/// From so many samples on, the older half of what was learned is forgotten.
const LEARNED: u32 = 128;

/// The time from sample to sample: the link's period within a tolerance, or what was measured of it, whichever is known
/// better.
///
/// Each tick may be early or late by an eighth of a *unit*: of a period, or of a sub-timestep where there are some. A
/// quarter of a unit thus is the most by which the jitter of two ticks moves one against the other, and another quarter is
/// left for what is not known of the pace.
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

    pub(super) const fn unit(&self) -> u32 {
        self.unit
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
    pub(super) fn samples(&self, since: u64) -> u64 {
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
        self.learned_doubt(1_000) < self.stated_doubt(1_000)
    }

    /// By how many µs the sample so many later may be early or late by the tolerance.
    fn stated_doubt(&self, samples: u64) -> u64 {
        let nominal = samples.wrapping_mul(self.period.into());
        nominal.wrapping_mul(self.tolerance.into()).div_ceil(1_000_000)
    }

    /// The same, by the jitter of the ticks from which it was learned.
    fn learned_doubt(&self, samples: u64) -> u64 {
        let jitter = samples.wrapping_mul(self.unit.into()).wrapping_mul(self.pieces.into());
        jitter.checked_div(u64::from(self.samples).wrapping_mul(4)).unwrap_or(u64::MAX)
    }

    /// By how many µs the sample so many later may be early or late, beside the jitter of its own tick and the last one.
    fn doubt(&self, samples: u64) -> u64 {
        if self.is_learned() {
            self.learned_doubt(samples).saturating_add(1) // of rounding
        } else {
            self.stated_doubt(samples)
        }
    }

    /// The fewest samples that there may have been, if about so many were and so many µs are in doubt.
    fn least(&self, samples: u64, doubt: u64) -> u64 {
        let doubtful = doubt.checked_div(self.period.into()).unwrap_or(u64::MAX);
        samples.saturating_sub(doubtful).saturating_sub(1)
    }

    /// How far a tick may lie from its sample or sub-timestep: at most three eighths of a unit, so that one that is half a
    /// unit early or late is always noticed.
    fn most_away(&self, quarter: u64, doubt: u64) -> u64 {
        let most = u64::from(self.unit).wrapping_mul(3).div_ceil(8);
        quarter.wrapping_add(doubt).min(most)
    }

    /// The sample of a tick so long after the last known sample, of a code without sub-timesteps. From `settled` silent
    /// samples on, it does not matter how many there were.
    pub(super) fn elapsed(&self, since: i64, settled: u32) -> Elapsed {
        let Ok(since) = u64::try_from(since) else { return Elapsed::Misfit };
        let quarter = u64::from(self.period / 4);
        // As most often: the next sample.
        if self.tolerance <= 100_000 && since.abs_diff(self.period.into()) <= quarter {
            return Elapsed::Samples { samples: 1, slot: 0 };
        }
        let samples = self.samples(since.wrapping_add(u64::from(self.period / 2)));
        let doubt = self.doubt(samples);
        if doubt > quarter {
            let least = self.least(samples, doubt);
            let is_settled = least > u64::from(settled);
            return if is_settled { Elapsed::Settled { samples } } else { Elapsed::Unknown };
        }
        let is_near = self.time_of(samples).abs_diff(since) <= self.most_away(quarter, doubt);
        if samples > 0 && is_near { Elapsed::Samples { samples, slot: 0 } } else { Elapsed::Misfit }
    }

    /// The sample and the sub-timestep of a tick so long after the last known sample.
    pub(super) fn slot(&self, since: i64, slots: u32) -> Elapsed {
        let half = u64::from(self.unit / 2);
        let Ok(since) = u64::try_from(since.saturating_add(half.cast_signed())) else {
            return Elapsed::Misfit;
        };
        let samples = self.samples(since);
        let rest = since.saturating_sub(self.time_of(samples));
        let Some(slot) = rest.checked_div(self.unit.into()) else { return Elapsed::Misfit };
        let quarter = u64::from(self.unit.div_ceil(4));
        let doubt = self.doubt(samples);
        if doubt > quarter {
            return Elapsed::Unknown;
        }
        let away = slot.wrapping_mul(self.unit.into()).wrapping_add(half).abs_diff(rest);
        // The events of one sample have its tick, to the microsecond.
        let most = if samples == 0 { 0 } else { self.most_away(quarter, doubt) };
        match u32::try_from(slot) {
            Ok(slot) if slot < slots && away <= most => Elapsed::Samples { samples, slot },
            _ => Elapsed::Misfit,
        }
    }

    /// The sample of a heartbeat so long after the last known sample, of a code with sub-timesteps. Its tick says when the
    /// sample was taken, so that nothing but a count that matters makes it unknown.
    pub(super) fn beat(&self, since: i64, settled: u32) -> Elapsed {
        let Ok(since) = u64::try_from(since) else { return Elapsed::Misfit };
        let period = u64::from(self.period);
        let samples = self.samples(since.wrapping_add(period / 2));
        let doubt = self.doubt(samples);
        if doubt.wrapping_add(u64::from(self.unit / 2)) > period / 2 {
            let least = self.least(samples, doubt);
            let is_settled = least > u64::from(settled);
            return if is_settled { Elapsed::Settled { samples } } else { Elapsed::Unknown };
        }
        let most = u64::from(self.unit.div_ceil(4)).wrapping_add(doubt);
        let is_near = self.time_of(samples).abs_diff(since) <= most;
        if samples > 0 && is_near { Elapsed::Samples { samples, slot: 0 } } else { Elapsed::Misfit }
    }
}
