//! A Crazyflie 2.1 with its BMI088, 1000 samples a second; frames leave at the deck's TX2. The nRF51 keeps its firmware, and
//! is not spoken to.
//!
//! The pins are those of bitcraze/crazyflie-firmware: `src/drivers/src/i2c_drv.c` (sensors' bus),
//! `src/hal/src/sensors_bmi088_bmp3xx.c` (data-ready and axes), `src/deck/api/deck_constants.c` (deck),
//! `src/drivers/src/motors_def.c` (motors).

use embassy_stm32::{
    Peri, bind_interrupts, dma,
    exti::{self, ExtiInput},
    gpio::{AnyPin, Level, Output, OutputOpenDrain, Pull, Speed},
    i2c::{self, I2c, Master},
    interrupt::typelevel,
    mode::Async,
    peripherals::{DMA1_CH2, DMA1_CH4, DMA1_CH6, I2C3, RNG},
    rng::{self, Rng},
    time::Hertz,
    usart::{self, UartTx},
};
use flight::{Alignment, bmi088::Bmi088, free_bus};

use spikewire::link::Session;

use crate::{Board, part};

bind_interrupts!(struct Interrupts {
    EXTI15_10 => exti::InterruptHandler<typelevel::EXTI15_10>;
    I2C3_EV => i2c::EventInterruptHandler<I2C3>;
    I2C3_ER => i2c::ErrorInterruptHandler<I2C3>;
    DMA1_STREAM2 => dma::InterruptHandler<DMA1_CH2>;
    DMA1_STREAM4 => dma::InterruptHandler<DMA1_CH4>;
    DMA1_STREAM6 => dma::InterruptHandler<DMA1_CH6>;
    RNG => rng::InterruptHandler<RNG>;
});

pub type Imu = Bmi088<I2c<'static, Async, Master>>;
pub type DataReady = ExtiInput<'static, Async>;
pub type Port = UartTx<'static, Async>;

/// Bitcraze's firmware takes the axes as they come.
pub const ALIGNMENT: Alignment = Alignment::Cw0;
const CRYSTAL: u32 = 8_000_000;
/// The sensor's limit. A sample is 18 bytes and takes 0.42 ms of its millisecond.
const IMU_HZ: u32 = 400_000;
const BAUD: u32 = 921_600;

pub fn start() -> Board {
    let mut p = part::start::<CRYSTAL>();
    // The motors stand still. PA15 has a pull-up after a reset, as a debugger's line.
    let motors: [Peri<'static, AnyPin>; 4] =
        [p.PA15.into(), p.PA1.into(), p.PB11.into(), p.PB9.into()];
    for pin in motors {
        core::mem::forget(Output::new(pin, Level::Low, Speed::Low));
    }

    fn open(pin: Peri<'_, AnyPin>) -> OutputOpenDrain<'_> {
        OutputOpenDrain::new(pin, Level::High, Speed::Low)
    }
    let (scl, sda) = (p.PA8.reborrow().into(), p.PC9.reborrow().into());
    if !free_bus(&mut open(scl), &mut open(sda), &mut part::spin()) {
        defmt::error!("the sensor's bus is held low");
    }
    let mut at = i2c::Config::default();
    at.frequency = Hertz(IMU_HZ);
    let bus = I2c::new(p.I2C3, p.PA8, p.PC9, p.DMA1_CH4, p.DMA1_CH2, Interrupts, at);

    let mut at = usart::Config::default();
    at.baudrate = BAUD;
    let Ok(port) = UartTx::new(p.USART2, p.PA2, p.DMA1_CH6, Interrupts, at) else {
        panic!("no such baud rate")
    };
    Board {
        imu: Bmi088::new(bus),
        data_ready: ExtiInput::new(p.PC14, p.EXTI14, Pull::Down, Interrupts),
        port,
        session: Session::random(Rng::new(p.RNG, Interrupts).next_u64()),
    }
}
