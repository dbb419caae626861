//! A Pico 2: its clocks, pins and DMA channels. Another board changes this file only.

use embassy_rp::{
    bind_interrupts,
    clocks::RoscRng,
    config::Config,
    dma,
    gpio::{Input, Level, Output, Pull},
    peripherals::{DMA_CH0, DMA_CH1, SPI0, UART0},
    spi::{self, Async, Spi},
    uart::{self, BufferedInterruptHandler, BufferedUartTx},
    watchdog::Watchdog,
};
use embassy_time::{Delay, Duration};
use flight::Timing;
use static_cell::StaticCell;

bind_interrupts!(struct Interrupts {
    DMA_IRQ_0 => dma::InterruptHandler<DMA_CH0>, dma::InterruptHandler<DMA_CH1>;
    UART0_IRQ => BufferedInterruptHandler<UART0>;
});

pub type Imu = flight::Device<Spi<'static, SPI0, Async>, Output<'static>, Delay>;

/// 150 MHz by 12; the sensor takes 24.
const IMU_HZ: u32 = 12_500_000;
const IMU_TIMING: Timing = Timing { guard: 100, pause: 0 }.at(IMU_HZ);
const BAUD: u32 = 921_600;
/// Longer than the sensor takes to start, with a pause to the next try.
pub const WATCHDOG: Duration = Duration::from_millis(500);

pub struct Board {
    pub imu: Imu,
    pub data_ready: Input<'static>,
    pub uart: BufferedUartTx,
    pub watchdog: Watchdog,
    /// Another number after most starts.
    pub session: u16,
}

/// The HAL's clocks: a crystal of 12 MHz, and 150 MHz for core and peripherals.
pub fn start() -> Board {
    static WAITING: StaticCell<[u8; 512]> = StaticCell::new();

    let p = embassy_rp::init(Config::default());
    let mut watchdog = Watchdog::new(p.WATCHDOG);
    watchdog.pause_on_debug(true);
    watchdog.start(WATCHDOG);

    let mut at = spi::Config::default(); // mode 0
    at.frequency = IMU_HZ;
    let (clock, out, back) = (p.PIN_18, p.PIN_19, p.PIN_16);
    let bus = Spi::new(p.SPI0, clock, out, back, p.DMA_CH0, p.DMA_CH1, Interrupts, at);
    let Ok(imu) = flight::Device::new(bus, Output::new(p.PIN_17, Level::High), Delay, IMU_TIMING);

    let mut line = uart::Config::default();
    line.baudrate = BAUD;
    let uart = BufferedUartTx::new(p.UART0, Interrupts, p.PIN_0, WAITING.init([0; 512]), line);
    Board {
        imu,
        data_ready: Input::new(p.PIN_20, Pull::Down),
        uart,
        watchdog,
        session: RoscRng.next_u32() as u16,
    }
}
