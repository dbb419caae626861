//! Pace: how much time passes from sample to sample, and how many samples in a time.

/// By how many millionths the time from sample to sample may differ from the link's period unless a receiver is told
/// otherwise: 2 %, as of an RC oscillator, or of a sensor that takes samples by a clock of its own.
pub const CLOCK_TOLERANCE: u32 = 20_000;

/// The longest sub-timestep in µs, if a sample has so many and the next is taken a period later in µs, by a clock whose
/// tolerance is so many millionths; 0 if none of 1 µs fits. Where it runs as fast as it may, half of the last sub-timestep may
/// be missing: up to there a receiver can tell them apart.
pub const fn longest_slot(slots: u32, period: u32, clock_tolerance: u32) -> u32 {
    let halves = (slots as u64 * 2).saturating_sub(1);
    let shortest = shortest_period(period, clock_tolerance) as u64;
    match (period.checked_div(slots), (2 * shortest).checked_div(halves)) {
        (Some(longest), Some(by_clock)) if by_clock < longest as u64 => by_clock as u32,
        (Some(longest), _) => longest,
        (None, _) => 0,
    }
}

/// Whether a sub-timestep is no longer than the [longest](longest_slot), without a division by their number.
pub(super) fn slots_fit(slots: u32, slot_ticks: u32, period: u32, tolerance: u32) -> bool {
    let length = u64::from(slots).wrapping_mul(slot_ticks.into());
    let shortest = u64::from(shortest_period(period, tolerance));
    length <= u64::from(period) && length.saturating_sub(u64::from(slot_ticks / 2)) <= shortest
}

/// The shortest time from sample to sample in µs, by a tolerance in millionths.
const fn shortest_period(period: u32, tolerance: u32) -> u32 {
    let fastest = (period as u64 * tolerance as u64).div_ceil(1_000_000);
    (period as u64).saturating_sub(fastest) as u32
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

    pub(super) const fn tolerance(&self) -> u32 {
        self.tolerance
    }

    /// The shortest time from sample to sample, in µs.
    pub(super) const fn shortest_period(&self) -> u32 {
        shortest_period(self.period, self.tolerance)
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
        // At most three eighths of a unit, so that a tick that is half a unit early or late is always noticed.
        let widest = (unit / 4).wrapping_add(doubt);
        let most = widest.min(unit.wrapping_mul(3) / 8);
        let Some(slot) = self.slot_of(samples, since, slots, most) else { return Elapsed::Misfit };
        // Where samples may be about as short as their sub-timesteps, the tick may as well lie in the last one of the sample
        // before, or be that of the next sample.
        let before = samples.checked_sub(1);
        let is_before =
            before.is_some_and(|before| self.slot_of(before, since, slots, widest).is_some());
        let next = samples.wrapping_add(1);
        let until_next = self.time_of(next).wrapping_add(unit / 2).saturating_sub(since);
        if is_before || until_next <= (unit / 4).wrapping_add(self.doubt(next)) {
            return Elapsed::Unknown;
        }
        Elapsed::Samples { samples, slot }
    }

    /// The sub-timestep of this sample from which a tick is at most so far away that comes half a unit earlier than after so
    /// many µs.
    fn slot_of(&self, sample: u64, half_later: u64, slots: u32, most: u64) -> Option<u32> {
        let unit = u64::from(self.unit);
        let rest = half_later.saturating_sub(self.time_of(sample));
        let slot = rest.checked_div(unit)?;
        let away = slot.wrapping_mul(unit).wrapping_add(unit / 2).abs_diff(rest);
        // The events of the last known sample have its tick, to the microsecond.
        let most = if sample == 0 { 0 } else { most };
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

#[cfg(test)]
mod tests {
    use super::{Elapsed, LEARNED, Pace, longest_slot, slots_fit};
    use std::vec::Vec;

    /// Numbers that look random.
    struct Random(u64);

    impl Random {
        /// A number from 0 up to this one, without it.
        fn below(&mut self, end: u64) -> u64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (self.0 >> 33) % end
        }

        /// A number within this far of 0.
        fn around(&mut self, most: f64) -> f64 {
            (self.below(1_000_001) as f64 / 500_000.0 - 1.0) * most
        }

        /// A rate within this far of 0, often at an end.
        fn rate(&mut self, widest: f64) -> f64 {
            match self.below(3) {
                0 => self.around(widest),
                1 => widest,
                _ => -widest,
            }
        }

        /// A whole tick that is at most so far from this time.
        fn tick(&mut self, time: f64, most: f64) -> i64 {
            let (first, last) = ((time - most).ceil(), (time + most).floor());
            if first > last {
                return time.round() as i64;
            }
            first as i64 + self.below((last - first) as u64 + 1) as i64
        }
    }

    /// What became of silences of a code that counts samples.
    #[derive(Debug, Default)]
    struct Counted {
        known: u32,
        settled: u32,
        lost: u32,
    }

    /// Samples whose clock changes at any time to any rate within the tolerance, in steps, and a pace that must never count
    /// others than there were.
    fn count(period: u32, tolerance: u32, longest: u64, settled: u32) -> Counted {
        let mut random = Random(u64::from(period) + u64::from(tolerance) + longest);
        let mut pace = Pace::new(tolerance);
        pace.set(period, period);
        pace.begin();
        let eighth = f64::from(period) / 8.0;
        let widest = f64::from(tolerance) / 1e6;
        let (mut time, mut anchor, mut rate) = (1e6, 1_000_000, 0.0);
        let mut counted = Counted::default();
        for _ in 0..20_000 {
            let silence = 1 + random.below(longest);
            // The clock changes once in a few silences, within one of them.
            let change = random.below(3 * silence);
            for sample in 0..silence {
                if sample == change {
                    rate = random.rate(widest);
                }
                time += f64::from(period) * (1.0 + rate);
            }
            let tick = random.tick(time, eighth);
            let since = tick - anchor;
            anchor = tick;
            match pace.elapsed(since, settled) {
                Elapsed::Samples { samples, .. } => {
                    assert_eq!(samples, silence, "{period} {tolerance} {since}: {pace:?}");
                    pace.learn(since, samples);
                    counted.known += 1;
                }
                Elapsed::Settled { .. } => {
                    assert!(silence > u64::from(settled), "{period} {tolerance} {since}: {pace:?}");
                    pace.begin();
                    counted.settled += 1;
                }
                Elapsed::Misfit => {
                    pace.forget();
                    pace.begin();
                    counted.lost += 1;
                }
                Elapsed::Unknown => {
                    pace.begin();
                    counted.lost += 1;
                }
            }
        }
        counted
    }

    #[test]
    fn a_clock_that_changes_within_its_tolerance_is_never_counted_wrong() {
        for period in [4, 7, 40, 1_000, 4_999] {
            // Drift and jitter stay below three eighths of a period, but where the clock has just changed.
            for (tolerance, longest) in [(0, 300), (20_000, 6), (100_000, 1), (1_000, 120)] {
                let counted = count(period, tolerance, longest, 100_000);
                let are_known = counted.known > 19_500 || period < 1_000;
                assert!(are_known, "{period} {tolerance}: {counted:?}");
            }
            for tolerance in [1_000, 20_000, 100_000, 200_000, 249_000, 400_000, 1_000_000] {
                let counted = count(period, tolerance, 90, 40);
                assert!(
                    counted.lost > 0 || tolerance < 20_000,
                    "{period} {tolerance}: {counted:?}"
                );
                let is_settled = counted.settled > 300 || !(20_000..=200_000).contains(&tolerance);
                assert!(is_settled, "{period} {tolerance}: {counted:?}");
            }
        }
    }

    /// Within what a tolerance of 40 % allows, one sample may look like two.
    #[test]
    fn the_next_sample_is_certain_only_with_a_clock_known_well() {
        let elapsed = |tolerance| {
            let mut pace = Pace::new(tolerance);
            pace.set(1_000, 1_000);
            pace.elapsed(1_200, 100)
        };
        assert_eq!(elapsed(20_000), Elapsed::Samples { samples: 1, slot: 0 });
        assert_eq!(elapsed(100_000), Elapsed::Samples { samples: 1, slot: 0 });
        assert_eq!(elapsed(400_000), Elapsed::Unknown);
    }

    #[test]
    fn a_tick_half_a_period_away_fits_no_sample() {
        for tolerance in [0, 20_000] {
            let mut pace = Pace::new(tolerance);
            pace.set(1_000, 1_000);
            for samples in 1..6 {
                for away in [-499, -438, -380, 380, 438, 500] {
                    let elapsed = pace.elapsed(samples * 1_000 + away, 100);
                    assert_eq!(elapsed, Elapsed::Misfit, "{tolerance} {samples} {away}");
                }
            }
            assert_eq!(pace.elapsed(0, 100), Elapsed::Misfit);
            assert_eq!(pace.elapsed(-1_000, 100), Elapsed::Misfit);
        }
        // A quarter of jitter, and 20 µs of drift in the one sample.
        let mut pace = Pace::new(20_000);
        pace.set(1_000, 1_000);
        for since in [730, 1_270] {
            assert_eq!(pace.elapsed(since, 100), Elapsed::Samples { samples: 1, slot: 0 });
        }
        assert_eq!([729, 1_271].map(|since| pace.elapsed(since, 100)), [Elapsed::Misfit; 2]);
        // A clock at one end of its tolerance, as measured.
        let mut pace = Pace::new(20_000);
        pace.set(1_000, 1_000);
        pace.begin();
        for _ in 0..LEARNED {
            pace.learn(1_019, 1);
        }
        assert_eq!(pace.elapsed(10_190, 100), Elapsed::Samples { samples: 10, slot: 0 });
        assert_eq!(pace.elapsed(10_190 + 560, 100), Elapsed::Misfit);
    }

    /// From seven samples of 2 % on, drift and jitter may reach three eighths of a period.
    #[test]
    fn drift_beyond_three_eighths_of_a_period_is_unknown() {
        let mut pace = Pace::new(20_000);
        pace.set(1_000, 1_000);
        for samples in 7..13 {
            for away in [374, -374] {
                let certain = Elapsed::Samples { samples, slot: 0 };
                assert_eq!(pace.elapsed(samples as i64 * 1_000 + away, 100), certain);
            }
            for away in [376, -376, 390, -390] {
                let elapsed = pace.elapsed(samples as i64 * 1_000 + away, 100);
                assert_eq!(elapsed, Elapsed::Unknown, "{samples} {away}");
            }
        }
    }

    /// A world of sub-timesteps.
    #[derive(Clone, Copy, Debug)]
    struct World {
        period: u32,
        unit: u32,
        slots: u32,
        tolerance: u32,
        /// Samples from heartbeat to heartbeat.
        beat: u64,
    }

    /// Samples of a clock that is steady: what is told apart must be so. Returns how many of the events were.
    fn tell_apart(world: World, seed: u64) -> f64 {
        let World { period, unit, slots, tolerance, beat } = world;
        let mut random = Random(seed);
        let mut pace = Pace::new(tolerance);
        pace.set(period, unit);
        let eighth = f64::from(unit) / 8.0;
        let widest = f64::from(tolerance) / 1e6;
        let mut rate = random.rate(widest);
        let mut time = 1e6;
        // The last known sample, and how many samples ago it was; whether sub-timesteps may be told apart from it.
        let mut anchor: Option<(i64, u64)> = None;
        let mut is_timed = false;
        let (mut events, mut told) = (0_u32, 0_u32);
        for sample in 1..8_000_u64 {
            if sample.is_multiple_of(320) {
                rate = (rate + random.around(widest / 128.0)).clamp(-widest, widest);
            }
            time += f64::from(period) * (1.0 + rate);
            let taken = random.tick(time, eighth);
            if let Some((_, ago)) = &mut anchor {
                *ago += 1;
            }
            if random.below(3) == 0 {
                let slot = random.below(slots.into()) as u32;
                let tick = taken + i64::from(slot * unit);
                events += 1;
                if let Some((known, ago)) = anchor.filter(|_| is_timed) {
                    match pace.slot(tick - known, slots) {
                        Elapsed::Samples { samples, slot: heard } => {
                            assert_eq!((samples, heard), (ago, slot), "{world:?} {pace:?}");
                            pace.learn(taken - known, samples);
                            anchor = Some((taken, 0));
                            told += 1;
                        }
                        Elapsed::Unknown => is_timed = false,
                        Elapsed::Misfit | Elapsed::Settled { .. } => {
                            pace.forget();
                            anchor = None;
                            is_timed = false;
                        }
                    }
                }
            }
            if sample.is_multiple_of(beat) {
                match anchor.map(|(known, ago)| (taken - known, ago)) {
                    None => pace.begin(),
                    Some((0, _)) => {}
                    Some((since, ago)) => match pace.beat(since, 0) {
                        Elapsed::Samples { samples, .. } => {
                            assert_eq!(samples, ago, "{world:?} {pace:?}");
                            pace.learn(since, samples);
                        }
                        Elapsed::Settled { .. } | Elapsed::Unknown => pace.begin(),
                        Elapsed::Misfit => {
                            pace.forget();
                            pace.begin();
                        }
                    },
                }
                anchor = Some((taken, 0));
                is_timed = true;
            }
        }
        f64::from(told) / f64::from(events)
    }

    /// Sub-timesteps of 1 µs and more: those of a few are known only with the clock of the ticks, as rounding takes all of
    /// what jitter may.
    #[test]
    fn sub_timesteps_are_never_mistaken() {
        let mut told = Vec::new();
        for unit in (1..17).chain([24, 49, 62, 100, 499]) {
            for (slots, tolerance, beat) in
                [(2, 20_000, 9), (8, 20_000, 12), (8, 100_000, 4), (8, 5_000, 5)]
            {
                for room in [0, unit / 2, 3 * unit] {
                    // As long as all sub-timesteps, or longer.
                    let period = slots * unit + room;
                    let world = World { period, unit, slots, tolerance, beat };
                    if !slots_fit(slots, unit, period, tolerance) {
                        continue;
                    }
                    for seed in 0..3 {
                        told.push((world, tell_apart(world, seed)));
                    }
                }
            }
            let world = World { period: 8 * unit, unit, slots: 8, tolerance: 0, beat: 50 };
            let exact = tell_apart(world, u64::from(unit));
            assert!(exact > 0.9 || unit < 4, "{world:?} {exact}");
        }
        for (world, told) in told {
            let has_room = world.period >= world.slots * world.unit + world.unit;
            let is_due = world.unit >= 49 && has_room && world.tolerance == 20_000;
            assert!(told > 0.9 || !is_due, "{world:?} {told}");
        }
    }

    /// A tick up to 3/8 of a unit away may be jitter and doubt; one further away fits none.
    #[test]
    fn a_tick_half_a_sub_timestep_away_fits_none() {
        let mut pace = Pace::new(10);
        pace.set(10_000, 64);
        for (away, fits) in
            [(0, true), (17, true), (-17, true), (18, false), (-18, false), (31, false)]
        {
            let slot = pace.slot(10_000 + 3 * 64 + away, 100);
            let expected =
                if fits { Elapsed::Samples { samples: 1, slot: 3 } } else { Elapsed::Misfit };
            assert_eq!(slot, expected, "{away}");
        }
        assert_eq!(
            pace.slot(3 * 64 + 1, 100),
            Elapsed::Misfit,
            "the last known sample has no jitter"
        );
        assert_eq!(pace.slot(3 * 64, 100), Elapsed::Samples { samples: 0, slot: 3 });
        // A clock known less well, with which a quarter of jitter and the doubt of 10 µs are more than 3/8.
        let mut pace = Pace::new(1_000);
        pace.set(10_000, 64);
        for (away, fits) in [(24, true), (-24, true), (25, false), (-25, false), (26, false)] {
            let slot = pace.slot(10_000 + 3 * 64 + away, 100);
            let is_told = slot == Elapsed::Samples { samples: 1, slot: 3 };
            assert!(if fits { is_told } else { slot == Elapsed::Misfit }, "{away} {slot:?}");
        }
    }

    /// Samples as short as their sub-timesteps: a late tick of the last one may be an early one of the next sample, which is
    /// known less well.
    #[test]
    fn a_tick_that_may_be_the_next_samples_is_unknown() {
        let mut pace = Pace::new(20_000);
        pace.set(1_000, 100);
        // 65 µs before the next sample: 25 of jitter, and 20 of drift in each of two samples.
        for (after, slot) in [(900, Some(9)), (934, Some(9)), (935, None), (937, None)] {
            let known = |slot| Elapsed::Samples { samples: 1, slot };
            assert_eq!(
                pace.slot(1_000 + after, 10),
                slot.map_or(Elapsed::Unknown, known),
                "{after}"
            );
        }
    }

    /// A heartbeat is a quarter of a sub-timestep early or late, and by what is not known of the pace.
    #[test]
    fn a_heartbeat_has_the_jitter_of_two_ticks() {
        let one = Elapsed::Samples { samples: 1, slot: 0 };
        let mut pace = Pace::new(1_000);
        pace.set(10_000, 64);
        for away in [0, 16, -16, 26, -26] {
            assert_eq!(pace.beat(10_000 + away, 0), one, "{away}");
        }
        assert_eq!([10_027, 9_973].map(|since| pace.beat(since, 0)), [Elapsed::Misfit; 2]);
        // A clock that was measured for 120 samples is known to 4 µs, whatever its tolerance.
        let mut pace = Pace::new(20_000);
        pace.set(10_000, 64);
        pace.begin();
        for _ in 0..120 {
            pace.learn(10_000, 1);
        }
        assert_eq!([10_020, 9_980].map(|since| pace.beat(since, 0)), [one; 2]);
        assert_eq!([10_021, 9_979].map(|since| pace.beat(since, 0)), [Elapsed::Misfit; 2]);
    }

    /// Half a period after a sample it is over; from some number of samples on, one less is certain.
    #[test]
    fn samples_are_over_half_a_period_later() {
        let mut pace = Pace::new(20_000);
        pace.set(1_000, 1_000);
        for (since, samples) in [
            (-1_000, 0),
            (499, 0),
            (500, 1),
            (1_499, 1),
            (1_500, 2),
            (12_000, 12),
            (13_000, 12),
            (20_000, 19),
            (60_000, 58),
        ] {
            assert_eq!(pace.over(since), samples, "{since}");
        }
        // 25 µs in each of ten samples are a quarter of a period, which is too much.
        let mut pace = Pace::new(25_000);
        pace.set(1_000, 1_000);
        assert_eq!([9_000, 10_000].map(|since| pace.over(since)), [9, 9]);
    }

    /// Longer pieces than can be measured, and another period, begin anew.
    #[test]
    fn what_cannot_be_measured_is_forgotten() {
        let longest = i64::from(1 << 30);
        for (since, samples, learned) in [
            (1_280_000, 128, 120 + 128),
            (1_290_000, 129, 0),
            (longest, 100, 120 + 100),
            (longest + 1, 100, 0),
            (-1, 1, 0),
        ] {
            let mut pace = learned_in(1);
            pace.learn(since, samples);
            assert_eq!(pace.samples, learned, "{since} {samples}");
        }
        for (period, unit, learned) in [(10_000, 1_000, 120), (10_001, 1_000, 0), (10_000, 999, 0)]
        {
            let mut pace = learned_in(1);
            pace.set(period, unit);
            assert_eq!(pace.samples, learned, "{period} {unit}");
        }
    }

    #[test]
    fn the_measured_time_is_rounded_to_the_nearest() {
        for (last, time) in [(10_060, 10_000), (10_061, 10_001)] {
            let mut pace = learned_in(1);
            pace.learn(last, 1);
            assert_eq!(pace.time_of(1), time, "121 samples in {}", pace.span);
        }
    }

    /// 8 sub-timesteps of 4 µs, 0.5 % fast: with a quarter of jitter and one of doubt the nearest is not the right one.
    #[test]
    fn a_doubt_of_a_quarter_is_too_much() {
        let mut pace = Pace::new(5_000);
        pace.set(46, 4);
        pace.begin();
        assert_eq!(pace.slot(184, 8), Elapsed::Unknown);
    }

    #[test]
    fn each_piece_of_what_is_learned_has_its_jitter() {
        // 100 samples by 120: 1000 / 4 of jitter in each piece; 20 000 / 128 of change; 1 of rounding.
        let change = 157;
        for (pieces, samples, jitter) in [(1, 120, 209), (2, 120, 417), (8, 120, 1_667)] {
            let pace = learned_in(pieces);
            assert_eq!((pace.samples, pace.doubt(100)), (samples, jitter + change + 1), "{pieces}");
        }
        // Half of the samples has half of the pieces, and that between them.
        for (pieces, jitter) in [(1, 329), (2, 658), (8, 1_645)] {
            let mut pace = learned_in(pieces);
            for _ in 0..20 {
                pace.learn(10_000, 1);
            }
            assert_eq!((pace.samples, pace.doubt(100)), (76, jitter + change + 1), "{pieces}");
        }
        // More would say little, and the first eight are forgotten.
        assert_eq!(learned_in(10).samples, 24);
    }

    /// A pace learned from 120 samples in so many pieces.
    fn learned_in(pieces: u32) -> Pace {
        let mut pace = Pace::new(20_000);
        pace.set(10_000, 1_000);
        for _ in 0..pieces {
            pace.begin();
            for _ in 0..120 / pieces {
                pace.learn(10_000, 1);
            }
        }
        pace
    }

    /// The older half is forgotten: a clock that changed is measured anew.
    #[test]
    fn what_was_learned_long_ago_is_forgotten() {
        let mut pace = Pace::new(20_000);
        pace.set(10_000, 1_000);
        pace.begin();
        for time in [10_000, 10_150] {
            for _ in 0..10 * LEARNED {
                pace.learn(time, 1);
            }
            let (span, samples) = pace.pace();
            assert!(samples <= 2 * u64::from(LEARNED));
            assert!((span / samples).abs_diff(time as u64) <= 1, "{time}: {pace:?}");
        }
        // Nothing is learned of the time over a break.
        pace.cut();
        pace.learn(5_000_000, 1);
        let (span, samples) = pace.pace();
        assert!((span / samples).abs_diff(10_150) <= 1);
    }

    #[test]
    fn the_doubt_of_years_is_no_overflow() {
        let mut pace = Pace::new(u32::MAX);
        pace.set(1, 1);
        let doubt = ((1_u128 << 48) * u128::from(u32::MAX)).div_ceil(1_000_000);
        assert_eq!(u128::from(pace.stated_doubt(1 << 48)), doubt);
        assert_eq!(pace.elapsed(1 << 47, 3), Elapsed::Unknown);
    }

    #[test]
    fn sub_timesteps_have_room_by_the_fastest_clock() {
        for (slots, slot_ticks, tolerance, fits) in [
            (8, 125, 0, true),
            (8, 126, 0, false),
            (8, 125, 62_000, true),
            (8, 125, 63_000, false),
            (25, 40, 20_000, true),
            (50, 20, 20_000, false),
            (1, 1, 2_000_000, false),
            (u32::MAX, u32::MAX, u32::MAX, false),
        ] {
            assert_eq!(slots_fit(slots, slot_ticks, 1_000, tolerance), fits, "{slots} {tolerance}");
        }
        assert_eq!(longest_slot(0, 1_000, 0), 0);
        for (slots, period) in
            [(1, 1), (8, 1_000), (35, 2_000), (50, 2_500), (50, 40), (256, 65_535)]
        {
            for tolerance in [0, 20_000, 21_111, 100_000, 3_000_000] {
                let fits = |length: &u32| slots_fit(slots, *length, period, tolerance);
                let longest = (0..=period).take_while(fits).last();
                assert_eq!(Some(longest_slot(slots, period, tolerance)), longest);
            }
        }
    }
}
