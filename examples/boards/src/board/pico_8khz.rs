//! A Raspberry Pi Pico or Pico 2 with an ICM-42688-P, 8000 samples a second.

use embassy_rp::{
    bind_interrupts, dma,
    gpio::{Input, Level, Output, Pull},
    peripherals::{DMA_CH0, DMA_CH1, SPI0, UART0},
    spi::{self, Async, Spi},
    uart::{self, BufferedInterruptHandler, BufferedUartTx},
};
use flight::{Alignment, Device, Spin};
use icm42688p::{Buffer, Icm42688p, NEW_BUFFER, TIMING};
use static_cell::StaticCell;

use crate::{Board, part};

bind_interrupts!(struct Interrupts {
    DMA_IRQ_0 => dma::InterruptHandler<DMA_CH0>, dma::InterruptHandler<DMA_CH1>;
    UART0_IRQ => BufferedInterruptHandler<UART0>;
});

pub type Imu = Icm42688p<'static, Device<Spi<'static, SPI0, Async>, Output<'static>, Spin>>;
pub type DataReady = Input<'static>;
pub type Port = BufferedUartTx;

/// The sensor's axes on the vehicle.
pub const ALIGNMENT: Alignment = Alignment::Cw0;
/// 125 MHz by 10, or 150 MHz by 12; the sensor takes 24.
const IMU_HZ: u32 = 12_500_000;
const MISO: usize = 16;
const BAUD: u32 = 921_600;

pub fn start() -> Board {
    static WAITING: StaticCell<[u8; 512]> = StaticCell::new();
    static BYTES: StaticCell<Buffer> = StaticCell::new();

    let p = part::start();
    let mut at = spi::Config::default(); // mode 0
    at.frequency = IMU_HZ;
    let (clock, out, back) = (p.PIN_18, p.PIN_19, p.PIN_16);
    let bus = Spi::new(p.SPI0, clock, out, back, p.DMA_CH0, p.DMA_CH1, Interrupts, at);
    part::pull_up(MISO);
    let select = Output::new(p.PIN_17, Level::High);
    let Ok(imu) = Device::new(bus, select, part::spin(), const { TIMING.at(IMU_HZ) });

    let mut line = uart::Config::default();
    line.baudrate = BAUD;
    Board {
        imu: Icm42688p::new(imu, BYTES.init(NEW_BUFFER)),
        data_ready: Input::new(p.PIN_20, Pull::Down),
        port: BufferedUartTx::new(p.UART0, Interrupts, p.PIN_0, WAITING.init([0; 512]), line),
        session: part::session(),
    }
}
