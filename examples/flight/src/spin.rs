//! Short waits that are never too short.

use embedded_hal::delay::DelayNs;

/// Waits by counting the core's cycles.
///
/// A HAL's delay counts ticks of its clock and begins somewhere within one: with ticks of 1 µs, a wait of 2000 ns may end
/// after 1001. Cycles have no such error; wait states and interrupts only make the wait longer. While it waits nothing else
/// runs in this task, so it is for times of some µs.
#[derive(Clone, Copy, Debug)]
pub struct Spin {
    hertz: u32,
}

impl Spin {
    /// A wait for a core with this clock. A Cortex-M7 does two instructions of the loop in a cycle: give twice its clock.
    pub const fn new(hertz: u32) -> Self {
        Self { hertz }
    }

    /// Number of cycles that last at least `ns` nanoseconds.
    pub const fn cycles(self, ns: u32) -> u32 {
        let cycles = (ns as u64 * self.hertz as u64).div_ceil(1_000_000_000);
        if cycles > u32::MAX as u64 { u32::MAX } else { cycles as u32 }
    }
}

impl DelayNs for Spin {
    fn delay_ns(&mut self, ns: u32) {
        let cycles = self.cycles(ns);
        #[cfg(target_os = "none")]
        cortex_m::asm::delay(cycles);
        #[cfg(not(target_os = "none"))]
        (0..cycles).for_each(|_| core::hint::spin_loop());
    }
}

#[cfg(test)]
mod tests {
    use super::Spin;

    #[test]
    fn a_wait_has_at_least_the_cycles_of_its_time() {
        for hertz in [64_000_000, 125_000_000, 168_000_000, 800_000_000] {
            for ns in [0, 1, 100, 200, 2_000, 999_999, u32::MAX] {
                let cycles = u64::from(Spin::new(hertz).cycles(ns));
                assert!(cycles * 1_000_000_000 >= u64::from(ns) * u64::from(hertz), "{hertz} {ns}");
            }
        }
    }
}
