//! A Matek H743 (SLIM, WING or MINI with an ICM-42688-P): clocks, pins and DMA streams. Another board changes this file only.
//!
//! The pins are those of `configs/MATEKH743/config.h` of Betaflight's configurations.

use embassy_executor::Spawner;
use embassy_stm32::{
    Config, bind_interrupts, dma,
    exti::{self, ExtiInput},
    gpio::{Level, Output, Pull, Speed},
    interrupt::typelevel,
    mode::Async,
    peripherals::{DMA1_CH0, DMA1_CH1, IWDG1, RNG, USB_OTG_FS},
    rcc::{
        AHBPrescaler, APBPrescaler, Hse, HseMode, Hsi48Config, Pll, PllDiv, PllMul, PllPreDiv,
        PllSource, Sysclk, VoltageScale, mux,
    },
    rng::{self, Rng},
    spi::{self, Spi, mode::Master},
    time::Hertz,
    usb,
    wdg::IndependentWatchdog,
};
use embassy_time::Delay;
use embassy_usb::{
    Builder, UsbDevice,
    class::cdc_acm::{CdcAcmClass, Sender, State},
};
use flight::Timing;
use static_cell::StaticCell;

use crate::memory;

bind_interrupts!(struct Interrupts {
    DMA1_STREAM0 => dma::InterruptHandler<DMA1_CH0>;
    DMA1_STREAM1 => dma::InterruptHandler<DMA1_CH1>;
    EXTI2 => exti::InterruptHandler<typelevel::EXTI2>;
    OTG_FS => usb::InterruptHandler<USB_OTG_FS>;
    RNG => rng::InterruptHandler<RNG>;
});

pub type Imu = flight::Device<Spi<'static, Async, Master>, Output<'static>, Delay>;
pub type DataReady = ExtiInput<'static, Async>;
pub type Usb = Sender<'static, UsbDriver>;
type UsbDriver = usb::Driver<'static, USB_OTG_FS>;

const CRYSTAL_HZ: u32 = 8_000_000;
/// 800 MHz in the PLL.
const PLL_HZ: u32 = CRYSTAL_HZ / 4 * 400;
/// 100 MHz by 8; the sensor takes 24.
const IMU_HZ: u32 = PLL_HZ / 8 / 8;
const IMU_TIMING: Timing = Timing { guard: 100, pause: 0 }.at(IMU_HZ);
/// The core: 400 MHz, the limit at voltage scale 1.
const _: () = assert!(PLL_HZ / 2 == 400_000_000 && IMU_HZ == 12_500_000);

/// Longer than the sensor takes to start, with a pause to the next try.
const WATCHDOG_US: u32 = 500_000;
/// Of a packet of USB's full speed.
const PACKET: u16 = 64;

pub struct Board {
    pub imu: Imu,
    pub data_ready: DataReady,
    pub usb: Usb,
    pub watchdog: IndependentWatchdog<'static, IWDG1>,
    /// A number from the part's generator: another after most starts.
    pub session: u16,
}

pub fn start(spawner: Spawner) -> Board {
    memory::start();
    let p = embassy_stm32::init(clocks());
    let mut watchdog = IndependentWatchdog::new(p.IWDG1, WATCHDOG_US);
    watchdog.unleash();

    let mut at = spi::Config::default(); // mode 0
    at.frequency = Hertz(IMU_HZ);
    at.gpio_speed = Speed::VeryHigh;
    let bus = Spi::new(p.SPI1, p.PA5, p.PD7, p.PA6, p.DMA1_CH0, p.DMA1_CH1, Interrupts, at);
    let select = Output::new(p.PC15, Level::High, Speed::Medium);
    let Ok(imu) = flight::Device::new(bus, select, Delay, IMU_TIMING);

    Board {
        imu,
        data_ready: ExtiInput::new(p.PB2, p.EXTI2, Pull::Down, Interrupts),
        usb: serial(usb(p.USB_OTG_FS, p.PA12, p.PA11), spawner),
        watchdog,
        session: Rng::new(p.RNG, Interrupts).next_u32() as u16,
    }
}

fn usb(
    otg: embassy_stm32::Peri<'static, USB_OTG_FS>,
    plus: embassy_stm32::Peri<'static, embassy_stm32::peripherals::PA12>,
    minus: embassy_stm32::Peri<'static, embassy_stm32::peripherals::PA11>,
) -> UsbDriver {
    static RECEIVED: StaticCell<[u8; 256]> = StaticCell::new();
    let mut config = usb::Config::default();
    // The board's supply is not wired to PA9.
    config.vbus_detection = false;
    usb::Driver::new_fs(otg, Interrupts, plus, minus, RECEIVED.init([0; 256]), config)
}

/// A serial port over USB; the task that serves the bus is spawned.
fn serial(driver: UsbDriver, spawner: Spawner) -> Usb {
    static CONFIGURATION: StaticCell<[u8; 128]> = StaticCell::new();
    static BOS: StaticCell<[u8; 32]> = StaticCell::new();
    static CONTROL: StaticCell<[u8; 64]> = StaticCell::new();
    static STATE: StaticCell<State<'static>> = StaticCell::new();

    // Vendor and product of pid.codes for tests: for a product of yours, ask for your own.
    let mut config = embassy_usb::Config::new(0x1209, 0x0001);
    config.product = Some("spikewire link");
    let mut builder = Builder::new(
        driver,
        config,
        CONFIGURATION.init([0; 128]),
        BOS.init([0; 32]),
        &mut [],
        CONTROL.init([0; 64]),
    );
    let class = CdcAcmClass::new(&mut builder, STATE.init(State::new()), PACKET);
    spawner.spawn(serve(builder.build()).expect("spawned once"));
    let (sender, _) = class.split();
    sender
}

#[embassy_executor::task]
async fn serve(mut usb: UsbDevice<'static, UsbDriver>) {
    usb.run().await
}

fn clocks() -> Config {
    let mut config = Config::default();
    let rcc = &mut config.rcc;
    rcc.hsi = None;
    rcc.hse = Some(Hse { freq: Hertz(CRYSTAL_HZ), mode: HseMode::Oscillator });
    // For USB, corrected by the host's frames.
    rcc.hsi48 = Some(Hsi48Config { sync_from_usb: true });
    rcc.mux.usbsel = mux::Usbsel::HSI48;
    rcc.pll1 = Some(Pll {
        source: PllSource::HSE,
        prediv: PllPreDiv::DIV4,
        mul: PllMul::MUL400,
        fracn: None,
        divp: Some(PllDiv::DIV2),
        divq: Some(PllDiv::DIV8), // SPI1
        divr: None,
    });
    rcc.sys = Sysclk::PLL1_P;
    rcc.ahb_pre = AHBPrescaler::DIV2;
    rcc.apb1_pre = APBPrescaler::DIV2;
    rcc.apb2_pre = APBPrescaler::DIV2;
    rcc.apb3_pre = APBPrescaler::DIV2;
    rcc.apb4_pre = APBPrescaler::DIV2;
    rcc.voltage_scale = VoltageScale::Scale1;
    config
}
