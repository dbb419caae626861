//! A Pico: its clocks and pins. Another board changes this file only.

use core::convert::Infallible;

use cortex_m::peripheral::syst::SystClkSource;
use embedded_hal::spi::MODE_0;
use flight::{Device, bmi323};
use rp2040_hal::{
    Clock, Sio, Spi, Timer, Watchdog,
    clocks::init_clocks_and_plls,
    fugit::{ExtU32, RateExtU32},
    gpio::{
        FunctionSio, FunctionSpi, FunctionUart, Pin, Pins, PullDown, PullNone, SioInput, SioOutput,
        bank0::{Gpio0, Gpio1, Gpio16, Gpio17, Gpio18, Gpio19, Gpio20},
    },
    pac,
    rosc::RingOscillator,
    spi,
    uart::{self, DataBits, StopBits, UartConfig, UartPeripheral},
};

const CRYSTAL_HZ: u32 = 12_000_000;
/// The HAL takes what it can of 125 MHz below that: 7.8.
const IMU_HZ: u32 = 8_000_000;
const BAUD: u32 = 921_600;
/// A start of the sensor takes 4 ms, and main is else never away for so long.
const WATCHDOG_US: u32 = 500_000;
/// How often main wakes, with a sample or without, in Hz.
const WAKE_HZ: u32 = 1_000;

/// Sets up the flash before anything else runs; W25Q080 is what the Pico has.
#[unsafe(link_section = ".boot2")]
#[used]
static BOOT_LOADER: [u8; 256] = rp2040_boot2::BOOT_LOADER_W25Q080;

type SpiPin<P> = Pin<P, FunctionSpi, PullNone>;
type SpiPins = (SpiPin<Gpio19>, SpiPin<Gpio16>, SpiPin<Gpio18>);
type ChipSelect = Pin<Gpio17, FunctionSio<SioOutput>, PullNone>;
type UartPins = (Pin<Gpio0, FunctionUart, PullNone>, Pin<Gpio1, FunctionUart, PullNone>);

pub type ImuDevice = Device<Spi<spi::Enabled, pac::SPI0, SpiPins, 8>, ChipSelect, Timer>;
pub type BusError = flight::SpiError<Infallible, Infallible>;
pub type DataReady = Pin<Gpio20, FunctionSio<SioInput>, PullDown>;
pub type Uart = UartPeripheral<uart::Enabled, pac::UART0, UartPins>;

pub struct Board {
    pub imu: ImuDevice,
    pub data_ready: DataReady,
    pub uart: Uart,
    /// Microseconds since the start; also for pauses.
    pub clock: Timer,
    pub watchdog: Watchdog,
    /// Whether the last start ended by the watchdog, and not by power or by hand.
    pub is_bitten: bool,
    /// Another number after most starts.
    pub session: u16,
}

pub fn start() -> Board {
    let (mut chip, mut core) =
        (pac::Peripherals::take().unwrap(), pac::CorePeripherals::take().unwrap());
    let is_bitten = chip.WATCHDOG.reason().read().timer().bit();
    let mut watchdog = Watchdog::new(chip.WATCHDOG);
    let Ok(clocks) = init_clocks_and_plls(
        CRYSTAL_HZ,
        chip.XOSC,
        chip.CLOCKS,
        chip.PLL_SYS,
        chip.PLL_USB,
        &mut chip.RESETS,
        &mut watchdog,
    ) else {
        panic!("the clocks do not start");
    };
    // Its ticks come from the crystal, so there is none before.
    watchdog.pause_on_debug(true);
    watchdog.start(WATCHDOG_US.micros());
    // Main sleeps until there is an interrupt, and a sensor that is silent is none.
    core.SYST.set_clock_source(SystClkSource::Core);
    core.SYST.set_reload(clocks.system_clock.freq().to_Hz() / WAKE_HZ - 1);
    core.SYST.clear_current();
    core.SYST.enable_counter();
    core.SYST.enable_interrupt();

    let clock = Timer::new(chip.TIMER, &mut chip.RESETS, &clocks);
    let peripheral_clock = clocks.peripheral_clock.freq();
    let bank = Sio::new(chip.SIO).gpio_bank0;
    let pins = Pins::new(chip.IO_BANK0, chip.PADS_BANK0, bank, &mut chip.RESETS);

    let bus = Spi::new(
        chip.SPI0,
        (pins.gpio19.reconfigure(), pins.gpio16.reconfigure(), pins.gpio18.reconfigure()),
    )
    .init(&mut chip.RESETS, peripheral_clock, IMU_HZ.Hz(), MODE_0);
    let Ok(imu) = Device::new(bus, pins.gpio17.reconfigure(), clock, bmi323::TIMING.at(IMU_HZ));

    let serial = UartConfig::new(BAUD.Hz(), DataBits::Eight, None, StopBits::One);
    let uart_pins = (pins.gpio0.reconfigure(), pins.gpio1.reconfigure());
    let uart = UartPeripheral::new(chip.UART0, uart_pins, &mut chip.RESETS)
        .enable(serial, peripheral_clock)
        .unwrap();

    // Its phase when it is looked at is a matter of chance.
    let oscillator = RingOscillator::new(chip.ROSC).initialize();
    let session =
        (0..u16::BITS).fold(0, |bits, _| bits << 1 | u16::from(oscillator.get_random_bit()));

    let data_ready = pins.gpio20.reconfigure();
    Board { imu, data_ready, uart, clock, watchdog, is_bitten, session }
}
