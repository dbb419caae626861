//! A Crazyflie 2.1: BMI088 on I2C3, frames out of the deck's UART2 (TX2). The nRF51 keeps its firmware, and is not spoken to.
//!
//! The pins are those of bitcraze/crazyflie-firmware: `src/drivers/src/i2c_drv.c` (sensors' bus),
//! `src/hal/src/sensors_bmi088_bmp3xx.c` (data-ready), `src/deck/api/deck_constants.c` (deck),
//! `src/drivers/src/motors_def.c` (motors).

use embassy_stm32::{
    Peri, bind_interrupts, dma,
    exti::{self, ExtiInput},
    gpio::{AnyPin, Level, Output, OutputOpenDrain, Pull, Speed},
    i2c::{self, I2c, Master},
    interrupt::typelevel,
    mode::Async,
    peripherals::{DMA1_CH2, DMA1_CH4, DMA1_CH6, I2C3, IWDG, RNG},
    rng::{self, Rng},
    time::Hertz,
    usart::{self, UartTx},
    wdg::IndependentWatchdog,
};
use embassy_time::Delay;
use flight::{
    Plan,
    bmi088::{self, Bmi088, StartError},
    code::MOST,
    free_bus,
};
use spikewire::link::Transmitter;

use crate::{clock, edge::Stamp, uart::UartLink};

bind_interrupts!(struct Interrupts {
    // The stamp first: embassy's handler wakes the task, and then waits for nobody.
    EXTI15_10 => Stamp, exti::InterruptHandler<typelevel::EXTI15_10>;
    I2C3_EV => i2c::EventInterruptHandler<I2C3>;
    I2C3_ER => i2c::ErrorInterruptHandler<I2C3>;
    DMA1_STREAM2 => dma::InterruptHandler<DMA1_CH2>;
    DMA1_STREAM4 => dma::InterruptHandler<DMA1_CH4>;
    DMA1_STREAM6 => dma::InterruptHandler<DMA1_CH6>;
    RNG => rng::InterruptHandler<RNG>;
});

/// The crystal, in Hz: one that the part cannot take fails the build.
pub const CRYSTAL: u32 = 8_000_000;

/// The sensor's limit. A sample is 18 bytes and takes 0.42 ms of its millisecond.
const IMU_HZ: u32 = 400_000;
const BAUD: u32 = 921_600;

/// What the sensor promises.
pub const PLAN: Plan = bmi088::plan(MOST as u8);

pub struct Board {
    pub imu: Imu,
    pub data_ready: ExtiInput<'static, Async>,
    pub link: Wires,
    pub watchdog: IndependentWatchdog<'static, IWDG>,
    /// A number from the part's generator: another after most starts.
    pub session: u16,
}

/// Rates in °/s, then accelerations in g.
pub struct Imu(Bmi088<I2c<'static, Async, Master>>);

impl Imu {
    pub async fn start(&mut self) -> Result<(), StartError<i2c::Error>> {
        self.0.start(&mut Delay).await
    }

    pub async fn read(&mut self) -> Result<[f32; 6], i2c::Error> {
        self.0.read().await
    }
}

/// The deck's UART.
pub struct Wires(UartTx<'static, Async>);

impl Wires {
    pub fn link(self, transmitter: Transmitter) -> UartLink {
        UartLink::new(self.0, transmitter)
    }
}

pub fn start() -> Board {
    let mut p = embassy_stm32::init(clock::config::<CRYSTAL>());
    // The motors stand still. PA15 has a pull-up after a reset, as a debugger's line.
    let motors: [Peri<'static, AnyPin>; 4] =
        [p.PA15.into(), p.PA1.into(), p.PB11.into(), p.PB9.into()];
    for pin in motors {
        core::mem::forget(Output::new(pin, Level::Low, Speed::Low));
    }
    let mut watchdog = IndependentWatchdog::new(p.IWDG, crate::WATCHDOG_US);
    watchdog.unleash();

    fn open(pin: Peri<'_, AnyPin>) -> OutputOpenDrain<'_> {
        OutputOpenDrain::new(pin, Level::High, Speed::Low)
    }
    let (scl, sda) = (p.PA8.reborrow().into(), p.PC9.reborrow().into());
    if !free_bus(&mut open(scl), &mut open(sda), &mut Delay) {
        defmt::error!("the sensor's bus is held low");
    }
    let mut at = i2c::Config::default();
    at.frequency = Hertz(IMU_HZ);
    let bus = I2c::new(p.I2C3, p.PA8, p.PC9, p.DMA1_CH4, p.DMA1_CH2, Interrupts, at);

    let mut at = usart::Config::default();
    at.baudrate = BAUD;
    let Ok(deck) = UartTx::new(p.USART2, p.PA2, p.DMA1_CH6, Interrupts, at) else {
        panic!("no such baud rate")
    };

    Board {
        imu: Imu(Bmi088::new(bus)),
        data_ready: ExtiInput::new(p.PC14, p.EXTI14, Pull::Down, Interrupts),
        link: Wires(deck),
        watchdog,
        session: Rng::new(p.RNG, Interrupts).next_u32() as u16,
    }
}
