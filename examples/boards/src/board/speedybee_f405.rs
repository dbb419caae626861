//! A SpeedyBee F405 V4 with its ICM-42688-P, 8000 samples a second.
//!
//! Pins and alignment are those of `configs/SPEEDYBEEF405V4/config.h` of betaflight/config. Motors' pins stay inputs.

use embassy_stm32::{
    bind_interrupts, dma,
    exti::{self, ExtiInput},
    gpio::{Level, Output, Pull, Speed},
    interrupt::typelevel,
    mode::Async,
    peripherals::{DMA2_CH0, DMA2_CH3, DMA2_CH6, RNG},
    rng::{self, Rng},
    spi::{self, Spi, mode::Master},
    time::Hertz,
    usart::{self, UartTx},
};
use flight::{Alignment, Device, Spin, clock::exact_spi};
use icm42688p::{Buffer, Icm42688p, NEW_BUFFER, TIMING};
use static_cell::StaticCell;

use spikewire::link::Session;

use crate::{Board, part};

bind_interrupts!(struct Interrupts {
    EXTI4 => exti::InterruptHandler<typelevel::EXTI4>;
    DMA2_STREAM0 => dma::InterruptHandler<DMA2_CH0>;
    DMA2_STREAM3 => dma::InterruptHandler<DMA2_CH3>;
    DMA2_STREAM6 => dma::InterruptHandler<DMA2_CH6>;
    RNG => rng::InterruptHandler<RNG>;
});

pub type Imu = Icm42688p<'static, Device<Spi<'static, Async, Master>, Output<'static>, Spin>>;
pub type DataReady = ExtiInput<'static, Async>;
pub type Port = UartTx<'static, Async>;

/// `GYRO_1_ALIGN`.
pub const ALIGNMENT: Alignment = Alignment::Cw90;
/// `SYSTEM_HSE_MHZ`, in Hz.
const CRYSTAL: u32 = 8_000_000;
/// SPI1's 84 MHz by 8; the sensor takes 24.
const IMU_HZ: u32 = exact_spi(84_000_000, 10_500_000);
/// APB2's 84 MHz by 42: UART6 has no error there.
const BAUD: u32 = 2_000_000;

pub fn start() -> Board {
    static BYTES: StaticCell<Buffer> = StaticCell::new();

    let p = part::start::<CRYSTAL>();
    let mut at = spi::Config::default(); // mode 0
    at.frequency = Hertz(IMU_HZ);
    // At low speed of the pins an STM32's SPI loses the last bit of a byte.
    at.gpio_speed = Speed::VeryHigh;
    at.miso_pull = Pull::Up;
    let bus = Spi::new(p.SPI1, p.PA5, p.PA7, p.PA6, p.DMA2_CH3, p.DMA2_CH0, Interrupts, at);
    let select = Output::new(p.PA4, Level::High, Speed::VeryHigh);
    let Ok(imu) = Device::new(bus, select, part::spin(), const { TIMING.at(IMU_HZ) });

    let mut at = usart::Config::default();
    at.baudrate = BAUD;
    // The pad TX6.
    let Ok(port) = UartTx::new(p.USART6, p.PC6, p.DMA2_CH6, Interrupts, at) else {
        panic!("no such baud rate")
    };
    Board {
        imu: Icm42688p::new(imu, BYTES.init(NEW_BUFFER)),
        data_ready: ExtiInput::new(p.PC4, p.EXTI4, Pull::Down, Interrupts),
        port,
        session: Session::random(Rng::new(p.RNG, Interrupts).next_u64()),
    }
}
