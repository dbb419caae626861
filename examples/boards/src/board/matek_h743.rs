//! A Matek H743 (SLIM, WING or MINI) with its ICM-42688-P, 8000 samples a second; frames leave at the pad TX1.
//!
//! Pins and alignment are those of `configs/MATEKH743/config.h` of betaflight/config.

use embassy_stm32::{
    bind_interrupts, dma,
    exti::{self, ExtiInput},
    gpio::{Level, Output, Pull, Speed},
    interrupt::typelevel,
    mode::Async,
    peripherals::{DMA1_CH0, DMA1_CH1, DMA1_CH2, RNG},
    rng::{self, Rng},
    spi::{self, Spi, mode::Master},
    time::Hertz,
    usart::{self, UartTx},
};
use flight::{Alignment, Bounced, Device, Spin};
use icm42688p::{Icm42688p, TIMING};

use spikewire::link::Session;

use crate::{Board, part};

bind_interrupts!(struct Interrupts {
    DMA1_STREAM0 => dma::InterruptHandler<DMA1_CH0>;
    DMA1_STREAM1 => dma::InterruptHandler<DMA1_CH1>;
    DMA1_STREAM2 => dma::InterruptHandler<DMA1_CH2>;
    EXTI2 => exti::InterruptHandler<typelevel::EXTI2>;
    RNG => rng::InterruptHandler<RNG>;
});

pub type Imu = Icm42688p<'static, Device<Spi<'static, Async, Master>, Output<'static>, Spin>>;
pub type DataReady = ExtiInput<'static, Async>;
/// Frames lie in the DTCM, which DMA1 does not reach.
pub type Port = Bounced<'static, UartTx<'static, Async>>;

/// `GYRO_1_ALIGN`.
pub const ALIGNMENT: Alignment = Alignment::Cw0Flip;
/// The sensor takes 24 MHz.
const IMU_HZ: u32 = part::SPI_HZ / 8;
const BAUD: u32 = 2_000_000;

pub fn start() -> Board {
    let p = part::start();
    let mut at = spi::Config::default(); // mode 0
    at.frequency = Hertz(IMU_HZ);
    at.gpio_speed = Speed::VeryHigh;
    at.miso_pull = Pull::Up;
    let bus = Spi::new(p.SPI1, p.PA5, p.PD7, p.PA6, p.DMA1_CH0, p.DMA1_CH1, Interrupts, at);
    let select = Output::new(p.PC15, Level::High, Speed::Medium);
    let Ok(imu) = Device::new(bus, select, part::spin(), const { TIMING.at(IMU_HZ) });

    let mut at = usart::Config::default();
    at.baudrate = BAUD;
    let Ok(port) = UartTx::new(p.USART1, p.PA9, p.DMA1_CH2, Interrupts, at) else {
        panic!("no such baud rate")
    };
    let part::Dma { imu: bytes, port: frame } = part::dma();
    Board {
        imu: Icm42688p::new(imu, bytes),
        data_ready: ExtiInput::new(p.PB2, p.EXTI2, Pull::Down, Interrupts),
        port: Bounced::new(port, frame),
        session: Session::random(Rng::new(p.RNG, Interrupts).next_u64()),
    }
}
