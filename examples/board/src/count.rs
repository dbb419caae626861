//! What a piece of work takes.

use core::ops::AddAssign;

/// Instructions, and the lower and the upper bound of their cycles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Count {
    pub instructions: u32,
    /// A Cortex-M0's are those of a Cortex-M0+ and its own, both exact. 0 where nobody counts them.
    pub cycles: [u32; 2],
}

impl Count {
    pub fn saturating_sub(self, other: Self) -> Self {
        self.with(other, u32::saturating_sub)
    }

    /// Shared evenly, rounded up.
    pub fn div_ceil(self, parts: u32) -> Self {
        self.with(self, |all, _| all.div_ceil(parts))
    }

    /// The larger of each.
    pub fn max(self, other: Self) -> Self {
        self.with(other, u32::max)
    }

    fn with(self, other: Self, of: impl Fn(u32, u32) -> u32) -> Self {
        let [least, most] = [0, 1].map(|at| of(self.cycles[at], other.cycles[at]));
        Self { instructions: of(self.instructions, other.instructions), cycles: [least, most] }
    }
}

impl AddAssign for Count {
    fn add_assign(&mut self, other: Self) {
        *self = self.with(other, u32::wrapping_add);
    }
}
