//! A bare STM32F405 with wires to sensor and bridge: its clocks, pins and DMA streams. Another board changes this file only.

use core::convert::Infallible;

use bmi323_driver::{Bmi323, SpiTransport};
use embassy_stm32::{
    bind_interrupts, dma,
    exti::{self, ExtiInput},
    gpio::{Input, Level, Output, Pull, Speed},
    interrupt::typelevel,
    mode::Async,
    peripherals::{DMA1_CH3, DMA1_CH4, DMA2_CH0, DMA2_CH3, IWDG, RNG},
    rng::{self, Rng},
    spi::{self, Spi, mode::Master},
    time::Hertz,
    wdg::IndependentWatchdog,
};
use embassy_time::Delay;
use flight::{
    Device, Plan, Timing,
    bmi323::{self, ReadError, StartError, in_units},
    clock::exact_spi,
    code::MOST,
};
use spikewire::{
    link::{MAX_FRAME, Transmitter},
    out::AsyncSpiSink,
};

use crate::{clock, edge::Stamp};

bind_interrupts!(struct Interrupts {
    // The stamp first: embassy's handler wakes the task, and then waits for nobody.
    EXTI3 => Stamp, exti::InterruptHandler<typelevel::EXTI3>;
    DMA1_STREAM3 => dma::InterruptHandler<DMA1_CH3>;
    DMA1_STREAM4 => dma::InterruptHandler<DMA1_CH4>;
    DMA2_STREAM0 => dma::InterruptHandler<DMA2_CH0>;
    DMA2_STREAM3 => dma::InterruptHandler<DMA2_CH3>;
    RNG => rng::InterruptHandler<RNG>;
});

/// The crystal, in Hz: one that the part cannot take fails the build.
pub const CRYSTAL: u32 = 8_000_000;

/// SPI1's 84 MHz by 16. Of the powers of two the HAL takes one near, which for the sensor's limit of 10 MHz
/// is 10.5.
const IMU_HZ: u32 = exact_spi(84_000_000, 5_250_000);
/// SPI2's 42 MHz by 32.
const BRIDGE_HZ: u32 = exact_spi(42_000_000, 1_312_500);
const IMU_TIMING: Timing = bmi323::TIMING.at(IMU_HZ);
const BRIDGE_TIMING: Timing = Timing { guard: 400, pause: 400 }.at(BRIDGE_HZ);

/// What the sensor promises.
pub const PLAN: Plan = bmi323::plan(MOST as u8);

type SpiDevice = Device<Spi<'static, Async, Master>, Output<'static>, Delay>;
type BusError = flight::SpiError<spi::Error, Infallible>;

pub type Link = AsyncSpiSink<SpiDevice, Transmitter, MAX_FRAME, Input<'static>>;

pub struct Board {
    pub imu: Imu,
    pub data_ready: ExtiInput<'static, Async>,
    pub link: Wires,
    pub watchdog: IndependentWatchdog<'static, IWDG>,
    /// A number from the part's generator: another after most starts.
    pub session: u16,
}

/// Rates in °/s, then accelerations in g.
pub struct Imu(Bmi323<SpiTransport<SpiDevice>>);

impl Imu {
    pub async fn start(&mut self) -> Result<(), StartError<BusError>> {
        bmi323::start(&mut self.0, &mut Delay).await
    }

    pub async fn read(&mut self) -> Result<[f32; 6], ReadError<BusError>> {
        bmi323::read(&mut self.0).await.map(in_units)
    }
}

/// The bridge's bus, and its ready line: high when it takes a frame, and when it is not wired.
pub struct Wires(SpiDevice, Input<'static>);

impl Wires {
    pub fn link(self, transmitter: Transmitter) -> Link {
        AsyncSpiSink::with_ready(self.0, transmitter, self.1)
    }
}

pub fn start() -> Board {
    let p = embassy_stm32::init(clock::config::<CRYSTAL>());
    let mut watchdog = IndependentWatchdog::new(p.IWDG, crate::WATCHDOG_US);
    watchdog.unleash();

    let bus = Spi::new(p.SPI1, p.PA5, p.PA7, p.PA6, p.DMA2_CH3, p.DMA2_CH0, Interrupts, at(IMU_HZ));
    let select = Output::new(p.PA4, Level::High, Speed::VeryHigh);
    let Ok(imu) = Device::new(bus, select, Delay, IMU_TIMING);

    let bus =
        Spi::new(p.SPI2, p.PB13, p.PB15, p.PB14, p.DMA1_CH4, p.DMA1_CH3, Interrupts, at(BRIDGE_HZ));
    let select = Output::new(p.PB12, Level::High, Speed::VeryHigh);
    let Ok(bridge) = Device::new(bus, select, Delay, BRIDGE_TIMING);

    Board {
        imu: Imu(Bmi323::new_spi(imu)),
        data_ready: ExtiInput::new(p.PA3, p.EXTI3, Pull::Down, Interrupts),
        link: Wires(bridge, Input::new(p.PB11, Pull::Up)),
        watchdog,
        session: Rng::new(p.RNG, Interrupts).next_u32() as u16,
    }
}

/// Mode 0, which is the default, at this frequency. At low speed of the pins SPI loses the last bit of a byte.
fn at(hertz: u32) -> spi::Config {
    let mut config = spi::Config::default();
    config.frequency = Hertz(hertz);
    config.gpio_speed = Speed::VeryHigh;
    config
}
