//! A SpeedyBee F405 V4: its clocks, pins and DMA streams. Another board of the kind changes this file only.
//!
//! The pins are those of `configs/SPEEDYBEEF405V4/config.h` of betaflight/config. Motors' pins stay inputs.

use embassy_stm32::{
    bind_interrupts, dma,
    exti::{self, ExtiInput},
    gpio::{Level, Output, Pull, Speed},
    interrupt::typelevel,
    mode::Async,
    peripherals::{DMA2_CH0, DMA2_CH3, DMA2_CH6, IWDG, RNG},
    rng::{self, Rng},
    spi::{self, Spi, mode::Master},
    time::Hertz,
    usart::{self, UartTx},
    wdg::IndependentWatchdog,
};
use embassy_time::Delay;
use flight::{Device, Timing, clock::exact_spi};

use crate::clock;

bind_interrupts!(struct Interrupts {
    EXTI4 => exti::InterruptHandler<typelevel::EXTI4>;
    DMA2_STREAM0 => dma::InterruptHandler<DMA2_CH0>;
    DMA2_STREAM3 => dma::InterruptHandler<DMA2_CH3>;
    DMA2_STREAM6 => dma::InterruptHandler<DMA2_CH6>;
    RNG => rng::InterruptHandler<RNG>;
});

/// `SYSTEM_HSE_MHZ`, in Hz: one that the part cannot take fails the build.
const CRYSTAL: u32 = 8_000_000;
/// SPI1's 84 MHz by 8; the sensor takes 24.
const IMU_HZ: u32 = exact_spi(84_000_000, 10_500_000);
const IMU_TIMING: Timing = Timing { guard: 100, pause: 0 }.at(IMU_HZ);
/// APB2's 84 MHz by 42: UART6 has no error there. At 8 kHz a flight has some thousand events a second.
const BAUD: u32 = 2_000_000;
/// Longer than the sensor takes to start, with a pause to the next try.
const WATCHDOG_US: u32 = 500_000;

pub type Imu = Device<Spi<'static, Async, Master>, Output<'static>, Delay>;
pub type DataReady = ExtiInput<'static, Async>;

pub struct Board {
    pub imu: Imu,
    pub data_ready: DataReady,
    /// The pad TX6.
    pub uart: UartTx<'static, Async>,
    pub watchdog: IndependentWatchdog<'static, IWDG>,
    /// A number from the part's generator: another after most starts.
    pub session: u16,
}

pub fn start() -> Board {
    let p = embassy_stm32::init(clock::config::<CRYSTAL>());
    let mut watchdog = IndependentWatchdog::new(p.IWDG, WATCHDOG_US);
    watchdog.unleash();

    let mut at = spi::Config::default(); // mode 0
    at.frequency = Hertz(IMU_HZ);
    at.gpio_speed = Speed::VeryHigh;
    let bus = Spi::new(p.SPI1, p.PA5, p.PA7, p.PA6, p.DMA2_CH3, p.DMA2_CH0, Interrupts, at);
    let select = Output::new(p.PA4, Level::High, Speed::VeryHigh);
    let Ok(imu) = Device::new(bus, select, Delay, IMU_TIMING);

    let mut at = usart::Config::default();
    at.baudrate = BAUD;
    let Ok(uart) = UartTx::new(p.USART6, p.PC6, p.DMA2_CH6, Interrupts, at) else {
        panic!("no such baud rate")
    };

    Board {
        imu,
        data_ready: ExtiInput::new(p.PC4, p.EXTI4, Pull::Down, Interrupts),
        uart,
        watchdog,
        session: Rng::new(p.RNG, Interrupts).next_u32() as u16,
    }
}
