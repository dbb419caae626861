//! What both ends know of a session's frames, so that a short frame need not say it.

use super::Coding;
use super::crc::Register;
use super::session;
use super::time::Time;
use crate::Fingerprint;

/// How many low bits of a frame's number a short frame has.
const NUMBER_BITS: u32 = 8;

/// A short frame counts as late up to this many frames back, and beyond that as one ahead.
const LATE: u64 = 32;

/// A point of the grid on which samples are expected, a period apart from the session's first frame on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    pub(super) time: Time,
    /// The low bits of its number on the grid, as many as [`Coding::grid_bits`] says.
    pub(super) count: u32,
}

impl Point {
    /// The time of the last point whose count was 0. It is the same until the count begins anew.
    fn epoch(self, coding: Coding) -> u64 {
        // Fewer than 2²¹ µs.
        let micros = self.count.wrapping_mul(coding.period.get());
        self.time.before(micros.into()).micros()
    }
}

/// The point of a frame that comes after a known one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Next {
    pub(super) point: Point,
    /// Whether no count began anew between the two, so that both have one epoch.
    is_same_epoch: bool,
}

impl Next {
    /// Of a frame that is not begun.
    pub(super) const NONE: Self =
        Self { point: Point { time: Time::from_micros(0), count: 0 }, is_same_epoch: false };
}

/// The last frame of a session, as far as the next one goes on from it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known {
    pub(super) coding: Coding,
    pub(super) fingerprint: Option<Fingerprint>,
    pub(super) number: u64,
    pub(super) point: Point,
    /// The [bits](Coding::grid_bits) of a count, which cost a Cortex-M0 a call.
    pub(super) grid_bits: u32,
    /// The register after what short frames near this number and point leave out. It changes about once a second.
    register: Register,
}

impl Known {
    /// Before the first frame.
    pub(super) const fn nothing(coding: Coding) -> Self {
        let point = Point { time: Time::from_micros(0), count: 0 };
        let (grid_bits, register) = (coding.grid_bits(), Register::START);
        Self { coding, fingerprint: None, number: 0, point, grid_bits, register }
    }

    /// After this full frame.
    pub(super) fn new(
        coding: Coding,
        fingerprint: Option<Fingerprint>,
        number: u64,
        point: Point,
    ) -> Self {
        let mut known = Self { fingerprint, number, point, ..Self::nothing(coding) };
        known.register = known.left_out(number, point);
        known
    }

    /// After this short frame; returns the register after what it leaves out.
    #[inline]
    pub(super) fn go_to(&mut self, number: u64, next: Next) -> Register {
        let register = self.register_of(number, next);
        self.follow(number, next.point, register);
        register
    }

    /// After the short frame with this number, point and [register](Self::register_of).
    #[inline]
    pub(super) fn follow(&mut self, number: u64, point: Point, register: Register) {
        (self.number, self.point, self.register) = (number, point, register);
    }

    /// The register after what a short frame with this number and point leaves out.
    #[inline]
    pub(super) fn register_of(&self, number: u64, next: Next) -> Register {
        let has_same_number = number >> NUMBER_BITS == self.number >> NUMBER_BITS;
        if has_same_number && next.is_same_epoch {
            self.register
        } else {
            self.left_out(number, next.point)
        }
    }

    #[cold]
    #[inline(never)]
    fn left_out(&self, number: u64, point: Point) -> Register {
        let [p0, p1, p2, _] = self.coding.period.get().to_le_bytes();
        let described = u8::from(self.fingerprint.is_some());
        let fingerprint = self.fingerprint.map_or(0, Fingerprint::bits);
        let [f0, f1, f2, f3] = fingerprint.to_le_bytes();
        let [n0, n1, n2, n3, n4, _, _, _] = (number >> NUMBER_BITS).to_le_bytes();
        let [t0, t1, t2, t3, t4, t5, _, _] = point.epoch(self.coding).to_le_bytes();
        let (code, step) = (self.coding.byte(), self.coding.step_bits);
        Register::START.after(&[
            p0, p1, p2, code, step, described, f0, f1, f2, f3, n0, n1, n2, n3, n4, t0, t1, t2, t3,
            t4, t5,
        ])
    }

    /// The number of a short frame with these low bits.
    #[inline]
    pub(super) fn number_with(&self, low: u8) -> u64 {
        const COUNT: u64 = 1 << NUMBER_BITS;
        let next = session::next(self.number);
        let ahead = u64::from(low).wrapping_sub(next) % COUNT;
        let back = if ahead < COUNT - LATE { 0 } else { COUNT };
        session::masked(next.wrapping_add(ahead).wrapping_sub(back))
    }

    #[inline]
    const fn grid_mask(&self) -> u32 {
        1_u32.wrapping_shl(self.grid_bits).wrapping_sub(1)
    }

    /// The point so many periods later.
    #[inline]
    pub(super) fn later(&self, steps: i32) -> Next {
        let micros = i64::from(steps).wrapping_mul(self.coding.period.get().into());
        let count = self.point.count.wrapping_add(steps.cast_unsigned());
        let point = Point {
            time: self.point.time.after(micros.cast_unsigned()),
            count: count & self.grid_mask(),
        };
        // A count below 0 is a large number.
        Next { point, is_same_epoch: count <= self.grid_mask() }
    }

    /// The point of a short frame with this count: up to an eighth of all counts back, or ahead.
    #[inline]
    pub(super) fn point_with(&self, count: u32) -> Next {
        let counts = self.grid_mask().wrapping_add(1);
        let ahead = count.wrapping_sub(self.point.count) & self.grid_mask();
        let back = if ahead < counts - counts / 8 { 0 } else { counts };
        self.later(ahead.wrapping_sub(back).cast_signed())
    }

    /// Whether a receiver that got the frame before, or lost it with others, can tell a point so many periods later.
    #[inline]
    pub(super) fn can_tell(&self, steps: i32) -> bool {
        let counts = self.grid_mask().wrapping_add(1).cast_signed();
        (-(counts / 8)..=counts / 2).contains(&steps)
    }
}
