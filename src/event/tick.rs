//! Ticks: time stamps of 32 bits in microseconds, which wrap after 71.6 minutes.

use core::ops::{Add, AddAssign};

/// A time in microseconds, modulo 2³² (71.6 minutes).
///
/// Two ticks can be compared while they lie less than 2³¹ µs (35.8 minutes) apart. Other crates'
/// instants convert by their microseconds:
///
/// - fugit, which RTIC uses: `Tick::from_micros(now.duration_since_epoch().to_micros())`, and
///   `fugit::TimerInstantU32::<1_000_000>::from_ticks(event.tick.micros())` back;
/// - embassy: `Tick::from_micros(Instant::now().as_micros())`, and
///   `Instant::from_micros(event.tick.widen(Instant::now().as_micros()))` back.
///
/// ```
/// use spikewire::Tick;
///
/// let (before, after) = (Tick::from_micros(0xFFFF_FFF0), Tick::from_micros(0x1_0000_0010));
/// assert_eq!(after.since(before), 32); // µs, over the wrap
/// assert!(before.is_before(after));
/// assert_eq!(before + 32, after);
///
/// let now: u64 = 3 * 3_600_000_000; // three hours
/// assert_eq!(Tick::from_micros(now - 250).widen(now), now - 250);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(transparent)]
pub struct Tick(u32);

impl Tick {
    /// The tick of a time in microseconds: its low 32 bits.
    pub const fn from_micros(micros: u64) -> Self {
        Self(micros as u32)
    }

    /// The microseconds, below 2³².
    pub const fn micros(self) -> u32 {
        self.0
    }

    /// The microseconds from `earlier` to this tick, -2³¹ to 2³¹-1; negative if this one is earlier.
    pub const fn since(self, earlier: Self) -> i32 {
        self.0.wrapping_sub(earlier.0) as i32
    }

    /// Whether this tick comes before the other.
    pub const fn is_before(self, other: Self) -> bool {
        self.since(other) < 0
    }

    /// The time in microseconds with this tick that is nearest to `now`.
    ///
    /// Exact while the two lie less than 2³¹ µs apart. The result lies in 0 to `u64::MAX`: near the
    /// ends it is the nearest time in that range.
    pub const fn widen(self, now: u64) -> u64 {
        const WRAP: u64 = 1 << 32;
        let away = self.since(Self::from_micros(now)) as i64;
        match now.checked_add_signed(away) {
            Some(micros) => micros,
            None if away < 0 => now.wrapping_add_signed(away).wrapping_add(WRAP),
            None => now.wrapping_add_signed(away).wrapping_sub(WRAP),
        }
    }

    /// The tick this many microseconds later, or earlier if negative.
    #[must_use]
    pub const fn shifted(self, micros: i32) -> Self {
        Self(self.0.wrapping_add_signed(micros))
    }
}

/// The tick of this many microseconds.
impl From<u32> for Tick {
    fn from(micros: u32) -> Self {
        Self(micros)
    }
}

/// The tick this many microseconds later.
impl Add<u32> for Tick {
    type Output = Self;

    fn add(self, micros: u32) -> Self {
        Self(self.0.wrapping_add(micros))
    }
}

impl AddAssign<u32> for Tick {
    fn add_assign(&mut self, micros: u32) {
        *self = *self + micros;
    }
}
