//! An STM32F405: watchdog, clocks and time.

use embassy_stm32::{
    Config, Peripherals, pac,
    peripherals::IWDG,
    rcc::{
        AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllMul, PllPDiv, PllPreDiv, PllQDiv,
        PllSource, Sysclk,
    },
    time::Hertz,
    wdg::IndependentWatchdog,
};
use embassy_time::{Duration, Instant};
use flight::{Spin, clock::Stm32F405};
use spikewire::Tick;

use crate::Reset;

/// The part's limit.
const CORE_HZ: u32 = 168_000_000;

/// The watchdog, which has a clock of its own and stands still while a debugger halts the core.
pub struct Watchdog(IndependentWatchdog<'static, IWDG>);

impl Watchdog {
    pub fn start(limit: Duration) -> Self {
        pac::DBGMCU.apb1fzr().modify(|frozen| frozen.set_iwdg(true));
        // SAFETY: nobody else takes the watchdog.
        let mut dog = IndependentWatchdog::new(unsafe { IWDG::steal() }, limit.as_micros() as u32);
        dog.unleash();
        Self(dog)
    }

    pub fn feed(&mut self) {
        self.0.pet();
    }

    pub fn reset(&self) -> Reset {
        let flags = pac::RCC.csr().read();
        pac::RCC.csr().modify(|flags| flags.set_rmvf(true));
        match (flags.wdgrstf(), flags.sftrstf()) {
            (true, _) => Reset::Watchdog,
            (_, true) => Reset::Software,
            _ => Reset::PowerOrPin,
        }
    }
}

/// Starts the clocks from the board's crystal; one that the part cannot take fails the build.
pub fn start<const CRYSTAL: u32>() -> Peripherals {
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
    embassy_stm32::init(config)
}

/// Waits by the core's cycles.
pub fn spin() -> Spin {
    Spin::new(CORE_HZ)
}

/// Microseconds since the start.
pub fn now() -> Tick {
    Tick::from_micros(Instant::now().as_micros())
}
