//! 168 MHz, the part's limit, from the board's crystal.

use embassy_stm32::{
    Config,
    rcc::{
        AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllMul, PllPDiv, PllPreDiv, PllQDiv,
        PllSource, Sysclk,
    },
    time::Hertz,
};
use flight::clock::Stm32F405;

/// The dividers of a crystal; one that the part cannot take fails the build.
pub fn config<const CRYSTAL: u32>() -> Config {
    let Stm32F405 { crystal, m, n, p, q } = const { Stm32F405::at_168_mhz(CRYSTAL) };
    let mut config = Config::default();
    config.rcc.hse = Some(Hse { freq: Hertz(crystal), mode: HseMode::Oscillator });
    config.rcc.pll_src = PllSource::HSE;
    config.rcc.pll = Some(Pll {
        prediv: PllPreDiv::from_bits(m as u8),
        mul: PllMul::from_bits(n as u16),
        divp: Some(PllPDiv::from_bits((p / 2 - 1) as u8)),
        divq: Some(PllQDiv::from_bits(q as u8)),
        divr: None,
    });
    config.rcc.sys = Sysclk::PLL1_P;
    config.rcc.ahb_pre = AHBPrescaler::DIV1;
    config.rcc.apb1_pre = APBPrescaler::DIV4;
    config.rcc.apb2_pre = APBPrescaler::DIV2;
    config
}
