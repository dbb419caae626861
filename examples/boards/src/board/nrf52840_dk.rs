//! An nRF52840-DK with an ICM-42688-P, 8000 samples a second; frames leave at the DK's USB port.

use embassy_nrf::{
    bind_interrupts,
    gpio::{Input, Level, Output, OutputDrive, Pull},
    pac,
    peripherals::{SPI2, UARTE0},
    rng::Rng,
    spim::{self, Frequency, Spim},
    uarte::{self, Baudrate, UarteTx},
};
use flight::{Alignment, Device, Spin};
use icm42688p::{Buffer, Icm42688p, NEW_BUFFER, TIMING};
use static_cell::StaticCell;

use spikewire::link::Session;

use crate::{Board, part};

bind_interrupts!(struct Interrupts {
    SPI2 => spim::InterruptHandler<SPI2>;
    UARTE0 => uarte::InterruptHandler<UARTE0>;
});

pub type Imu = Icm42688p<'static, Device<Spim<'static>, Output<'static>, Spin>>;
pub type DataReady = Input<'static>;
pub type Port = UarteTx<'static>;

/// The sensor's axes on the vehicle.
pub const ALIGNMENT: Alignment = Alignment::Cw0;
/// The fastest of SPIM0 to 2; a burst takes 132 µs of each millisecond. SPIM3 is faster, and may send wrong bytes when the
/// processor writes to the same block of memory (anomaly 198).
const IMU: Frequency = Frequency::M8;
/// Exact. What the part calls 921 600 is 941 176.
const BAUD: Baudrate = Baudrate::Baud1m;

pub fn start() -> Board {
    // In RAM, as EasyDMA reaches nothing in flash.
    static BYTES: StaticCell<Buffer> = StaticCell::new();

    let p = part::start();
    let mut config = spim::Config::default(); // mode 0
    config.frequency = IMU;
    let (clock, back, out) = (p.P1_15, p.P1_14, p.P1_13);
    let bus = Spim::new(p.SPI2, Interrupts, clock, back, out, config);
    // The HAL leaves the line floating.
    pac::P1.pin_cnf(14).modify(|pin| pin.set_pull(pac::gpio::vals::Pull::Pullup));
    let select = Output::new(p.P1_12, Level::High, OutputDrive::Standard);
    let Ok(imu) = Device::new(bus, select, part::spin(), const { TIMING.at(8_000_000) });

    let mut config = uarte::Config::default();
    config.baudrate = BAUD;
    Board {
        imu: Icm42688p::new(imu, BYTES.init(NEW_BUFFER)),
        data_ready: Input::new(p.P1_11, Pull::Down),
        port: UarteTx::new(p.UARTE0, Interrupts, p.P0_06, config),
        session: Session::random(Rng::new_blocking(p.RNG).blocking_next_u64()),
    }
}
