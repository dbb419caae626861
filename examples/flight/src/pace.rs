//! When the samples of a FIFO were taken.

use spikewire::Tick;

/// How far one burst may move the clock of the samples, in µs: the sensor's own is within 1 %, which is 10 µs in the
/// millisecond of a burst.
const SLEW: i32 = 16;

/// The ticks of samples that follow each other.
///
/// A FIFO that has not run over has every sample, so that each is a period after the one before it. When a burst is read
/// the newest packet has just come: that holds the sensor's clock and ours together, and a task that comes late moves it
/// little.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// The tick of the next sample.
    next: Option<Tick>,
    /// From one sample to the next, in µs.
    period: u32,
}

impl Pace {
    /// The pace before the first sample, of samples that are `period` µs apart.
    pub const fn new(period: u32) -> Self {
        Self { next: None, period }
    }

    /// Takes note of a burst of `held` samples, of which the newest came at `now`. One that is further than two periods from
    /// where it was expected does not follow the one before it.
    pub fn burst(&mut self, now: Tick, held: usize) {
        let period = self.period as i32;
        let oldest = now.shifted(-(held.saturating_sub(1) as i32 * period));
        self.next = Some(match self.next {
            Some(next) if oldest.since(next).abs() <= 2 * period => {
                next.shifted(oldest.since(next).clamp(-SLEW, SLEW))
            }
            _ => oldest,
        });
    }

    /// Returns the tick at which the next sample is expected, or `now` before the first one.
    pub fn expected(&self, now: Tick) -> Tick {
        self.next.unwrap_or(now)
    }

    /// Returns the next sample's tick.
    #[inline]
    pub fn sample(&mut self) -> Tick {
        let tick = self.next.unwrap_or(Tick::from_micros(0));
        self.next = Some(tick + self.period);
        tick
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bursts of eight, each read so late and with so many packets; the first sample's tick of each.
    fn ticks(bursts: &[(u32, usize)]) -> Vec<u32> {
        let mut pace = Pace::new(125);
        let one = |&(now, in_fifo)| {
            pace.burst(Tick::from(now), in_fifo);
            let first = pace.sample().micros();
            (1..8).for_each(|at| assert_eq!(pace.sample().micros(), first + 125 * at));
            first
        };
        bursts.iter().map(one).collect()
    }

    #[test]
    fn the_newest_packet_is_now() {
        assert_eq!(ticks(&[(10_000, 8), (11_000, 8)]), [9_125, 10_125]);
    }

    #[test]
    fn a_task_that_comes_late_moves_the_clock_little() {
        assert_eq!(ticks(&[(10_000, 8), (11_100, 8), (12_000, 8)]), [9_125, 10_141, 11_125]);
        // By more than a period: the count tells.
        assert_eq!(ticks(&[(10_000, 8), (11_400, 11)]), [9_125, 10_141]);
    }

    #[test]
    fn a_sensor_with_a_fast_clock_is_followed() {
        let bursts: Vec<_> = (0..1000).map(|burst| (10_000 + 990 * burst, 8)).collect();
        let last = ticks(&bursts)[999];
        assert_eq!(last, 10_000 + 990 * 999 - 875);
    }

    #[test]
    fn a_gap_is_a_gap() {
        assert_eq!(ticks(&[(10_000, 8), (30_000, 8)]), [9_125, 29_125]);
    }
}
