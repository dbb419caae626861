//! A crystal and its dividers, checked while the firmware is compiled.

/// The main PLL of an STM32F405, F415, F407 or F417: `sysclk = crystal / m * n / p`, and 48 MHz for USB and random numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stm32F405 {
    /// What the board has, in Hz.
    pub crystal: u32,
    /// Divider before the PLL.
    pub m: u32,
    /// Multiplier of the PLL.
    pub n: u32,
    /// Divider to the core's clock.
    pub p: u32,
    /// Divider to 48 MHz.
    pub q: u32,
}

impl Stm32F405 {
    /// The dividers that give 168 MHz, which is the part's limit. For constants: a crystal without such dividers fails
    /// the build.
    ///
    /// # Panics
    /// The crystal is not a whole number of MHz from 4 to 26, as RM0090 (6.3.2, 7.3.2) has it.
    pub const fn at_168_mhz(crystal: u32) -> Self {
        assert!(crystal.is_multiple_of(1_000_000), "a crystal of a whole number of MHz");
        let mhz = crystal / 1_000_000;
        assert!(mhz >= 4 && mhz <= 26, "the part takes crystals of 4 to 26 MHz");
        // 2 MHz into the PLL, which jitters least, or 1 MHz.
        let (m, n) = if mhz.is_multiple_of(2) { (mhz / 2, 168) } else { (mhz, 336) };
        Self { crystal, m, n, p: 2, q: 7 }.checked()
    }

    /// The same, after a look at every limit of the part.
    ///
    /// # Panics
    /// One of them is broken.
    pub const fn checked(self) -> Self {
        let Self { crystal, m, n, p, q } = self;
        assert!(m >= 2 && m <= 63 && n >= 50 && n <= 432 && q >= 2 && q <= 15, "a divider's range");
        assert!(p == 2 || p == 4 || p == 6 || p == 8, "p is 2, 4, 6 or 8");
        assert!(crystal.is_multiple_of(m), "m divides the crystal");
        let input = crystal / m;
        assert!(input >= 1_000_000 && input <= 2_000_000, "1 to 2 MHz into the PLL");
        let vco = input * n;
        assert!(vco >= 100_000_000 && vco <= 432_000_000, "the VCO runs at 100 to 432 MHz");
        assert!(vco / p <= 168_000_000, "the core runs at 168 MHz at most");
        assert!(vco / q == 48_000_000, "USB and the random generator need 48 MHz");
        self
    }

    /// Returns the core's clock in Hz.
    pub const fn sysclk(&self) -> u32 {
        self.crystal / self.m * self.n / self.p
    }
}

/// What an STM32 makes of its bus clock for SPI, which it divides by 2 to 256. For constants.
///
/// # Panics
/// No power of two gives exactly the asked frequency: a HAL would take another one, and perhaps a faster.
pub const fn exact_spi(bus: u32, asked: u32) -> u32 {
    let mut divider = 2;
    while divider <= 256 {
        if bus / divider == asked && bus.is_multiple_of(divider) {
            return asked;
        }
        divider *= 2;
    }
    panic!("SPI runs at its bus clock, divided by 2, 4, … 256");
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::catch_unwind;

    #[test]
    fn every_crystal_gives_168_mhz_or_no_build() {
        for mhz in 0..=50 {
            let made = catch_unwind(|| Stm32F405::at_168_mhz(mhz * 1_000_000));
            assert_eq!(made.is_ok(), (4..=26).contains(&mhz), "{mhz} MHz");
            if let Ok(made) = made {
                assert_eq!(made.sysclk(), 168_000_000, "{mhz} MHz");
            }
        }
        assert!(catch_unwind(|| Stm32F405::at_168_mhz(7_372_800)).is_err());
    }

    #[test]
    fn eight_megahertz_dividers_with_another_crystal_do_not_build() {
        let eight = Stm32F405::at_168_mhz(8_000_000);
        for crystal in [12_000_000, 16_000_000, 25_000_000, 26_000_000] {
            assert!(catch_unwind(|| Stm32F405 { crystal, ..eight }.checked()).is_err());
        }
        // What the part would do, as `docs/before-you-fly.md` says.
        assert_eq!(Stm32F405 { crystal: 12_000_000, ..eight }.sysclk(), 252_000_000);
    }

    #[test]
    fn spi_has_the_frequency_that_is_asked_for() {
        assert_eq!(exact_spi(84_000_000, 5_250_000), 5_250_000);
        assert_eq!(exact_spi(42_000_000, 656_250), 656_250);
        assert!(catch_unwind(|| exact_spi(84_000_000, 10_000_000)).is_err());
    }
}
