//! The part's clocks, pins and DMA streams. Another board changes this file only.

use embassy_stm32::{
    Config, bind_interrupts, dma,
    exti::{self, ExtiInput},
    gpio::{Input, Level, Output, Pull, Speed},
    interrupt::typelevel,
    mode::Async,
    peripherals::{DMA1_CH3, DMA1_CH4, DMA2_CH0, DMA2_CH3, RNG},
    rcc::{
        AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllMul, PllPDiv, PllPreDiv, PllQDiv,
        PllSource, Sysclk,
    },
    rng::{self, Rng},
    spi::{self, Spi, mode::Master},
    time::Hertz,
};
use embassy_time::Delay;
use embedded_hal_bus::spi::ExclusiveDevice;

bind_interrupts!(struct Interrupts {
    EXTI3 => exti::InterruptHandler<typelevel::EXTI3>;
    DMA1_STREAM3 => dma::InterruptHandler<DMA1_CH3>;
    DMA1_STREAM4 => dma::InterruptHandler<DMA1_CH4>;
    DMA2_STREAM0 => dma::InterruptHandler<DMA2_CH0>;
    DMA2_STREAM3 => dma::InterruptHandler<DMA2_CH3>;
    RNG => rng::InterruptHandler<RNG>;
});

pub type SpiDevice = ExclusiveDevice<Spi<'static, Async, Master>, Output<'static>, Delay>;

/// SPI1's 84 MHz by 16. Of the powers of two the HAL takes one near, which for the sensor's limit of 10 MHz
/// is 10.5.
const IMU_HZ: u32 = 5_250_000;
/// SPI2's 42 MHz by 32.
const BRIDGE_HZ: u32 = 1_312_500;

pub struct Board {
    pub imu: SpiDevice,
    pub data_ready: ExtiInput<'static, Async>,
    pub bridge: SpiDevice,
    /// High when the bridge takes a frame, and when it is not wired.
    pub bridge_ready: Input<'static>,
    /// A number from the part's generator: another after most starts.
    pub session: u16,
}

pub fn start() -> Board {
    let p = embassy_stm32::init(clocks());

    let bus = Spi::new(p.SPI1, p.PA5, p.PA7, p.PA6, p.DMA2_CH3, p.DMA2_CH0, Interrupts, at(IMU_HZ));
    let select = Output::new(p.PA4, Level::High, Speed::High);
    let Ok(imu) = ExclusiveDevice::new(bus, select, Delay);

    let bus =
        Spi::new(p.SPI2, p.PB13, p.PB15, p.PB14, p.DMA1_CH4, p.DMA1_CH3, Interrupts, at(BRIDGE_HZ));
    let select = Output::new(p.PB12, Level::High, Speed::High);
    let Ok(bridge) = ExclusiveDevice::new(bus, select, Delay);

    Board {
        imu,
        data_ready: ExtiInput::new(p.PA3, p.EXTI3, Pull::Down, Interrupts),
        bridge,
        bridge_ready: Input::new(p.PB11, Pull::Up),
        session: Rng::new(p.RNG, Interrupts).next_u32() as u16,
    }
}

/// Mode 0, which is the default, at this frequency.
fn at(hertz: u32) -> spi::Config {
    let mut config = spi::Config::default();
    config.frequency = Hertz(hertz);
    config
}

/// The crystal of most flight controllers; 168 MHz is the part's limit.
fn clocks() -> Config {
    let mut config = Config::default();
    config.rcc.hse = Some(Hse { freq: Hertz(8_000_000), mode: HseMode::Oscillator });
    config.rcc.pll_src = PllSource::HSE;
    config.rcc.pll = Some(Pll {
        prediv: PllPreDiv::DIV4,
        mul: PllMul::MUL168,
        divp: Some(PllPDiv::DIV2),
        divq: Some(PllQDiv::DIV7),
        divr: None,
    });
    config.rcc.sys = Sysclk::PLL1_P;
    config.rcc.ahb_pre = AHBPrescaler::DIV1;
    config.rcc.apb1_pre = APBPrescaler::DIV4;
    config.rcc.apb2_pre = APBPrescaler::DIV2;
    config
}
