//! Time: microseconds in 32 bits, which wrap after 71.6 minutes.
//!
//! A tick says when within the last half hour; compare two that lie less than 2³¹ µs (35.8 minutes)
//! apart. Instants of other crates convert by their microseconds, with plain calls:
//!
//! - fugit, which RTIC uses: `tick::from_micros(now.duration_since_epoch().to_micros())`, and
//!   `fugit::TimerInstantU32::<1_000_000>::from_ticks(event.tick)` back;
//! - embassy: `tick::from_micros(Instant::now().as_micros())`, and
//!   `Instant::from_micros(tick::widen(event.tick, Instant::now().as_micros()))` back.
//!
//! ```
//! use spikewire::tick;
//!
//! let (before, after) = (0xFFFF_FFF0, 0x10); // 32 µs apart, over the wrap
//! assert_eq!(tick::difference(after, before), 32);
//! assert!(tick::is_before(before, after));
//!
//! let now: u64 = 3 * 3_600_000_000; // three hours
//! let tick = tick::from_micros(now - 250);
//! assert_eq!(tick::widen(tick, now), now - 250);
//! ```

use core::cmp::Ordering;

/// The tick of a time in microseconds: its low 32 bits.
pub const fn from_micros(micros: u64) -> u32 {
    micros as u32
}

/// The time in microseconds, of all with this tick, that is nearest to `now`.
///
/// Right whenever the two lie less than 2³¹ µs apart; never below 0 nor above `u64::MAX`, where it
/// takes the nearest time there is.
pub const fn widen(tick: u32, now: u64) -> u64 {
    const WRAP: u64 = 1 << 32;
    let away = difference(tick, from_micros(now)) as i64;
    match now.checked_add_signed(away) {
        Some(micros) => micros,
        None if away < 0 => now.wrapping_add_signed(away).wrapping_add(WRAP),
        None => now.wrapping_add_signed(away).wrapping_sub(WRAP),
    }
}

/// `later - earlier` in microseconds over the wrap, -2³¹ to 2³¹-1: negative if `later` is the
/// earlier one.
pub const fn difference(later: u32, earlier: u32) -> i32 {
    later.wrapping_sub(earlier) as i32
}

/// Whether `a` comes before `b`.
pub const fn is_before(a: u32, b: u32) -> bool {
    difference(a, b) < 0
}

/// The order in time. Over ticks that span 2³¹ µs or more it is no order: sort short recordings
/// only.
pub fn compare(a: u32, b: u32) -> Ordering {
    difference(a, b).cmp(&0)
}
