//! An STM32H743: watchdog, clocks, time, and the memory that DMA and processor share.
//!
//! DMA1 and DMA2 do not reach the DTCM, where the statics are. What they move, the driver's one buffer and each frame, lies in
//! SRAM1 of domain D2, which they reach without crossing into the processor's domain. That memory is not cached, so that no
//! line has to be cleaned or thrown away around a transfer: a forgotten one would be a wrong sample now and then. It costs
//! the processor some slow reads of 132 bytes a millisecond. The data cache then serves the constants in flash alone, as the DTCM is never in it.

use core::{
    mem::MaybeUninit,
    ptr::addr_of_mut,
    sync::atomic::{AtomicBool, Ordering::Relaxed},
};

use cortex_m::peripheral::MPU;
use embassy_stm32::{
    Config, Peripherals, pac,
    peripherals::IWDG1,
    rcc::{
        AHBPrescaler, APBPrescaler, Hse, HseMode, Hsi48Config, Pll, PllDiv, PllMul, PllPreDiv,
        PllSource, Sysclk, VoltageScale,
    },
    time::Hertz,
    wdg::IndependentWatchdog,
};
use embassy_time::{Duration, Instant};
use flight::Spin;
use icm42688p::{Buffer, NEW_BUFFER};
use spikewire::{Tick, link::MAX_FRAME};

use crate::Reset;

/// A crystal of 8 MHz, and 800 MHz in the PLL.
const CRYSTAL_HZ: u32 = 8_000_000;
const PLL_HZ: u32 = CRYSTAL_HZ / 4 * 400;
/// The limit at voltage scale 1.
const CORE_HZ: u32 = 400_000_000;
const _: () = assert!(PLL_HZ / 2 == CORE_HZ);
/// The clock of SPI1.
pub const SPI_HZ: u32 = PLL_HZ / 8;

/// Where SRAM1 begins, and the power of two of its length in bytes: the memory map has the same.
const SRAM1: u32 = 0x3000_0000;
const SRAM1_SIZE: u32 = 17;

/// What DMA moves.
pub struct Dma {
    pub imu: Buffer,
    pub port: [u8; MAX_FRAME],
}

/// SRAM1 has no clock before [`start`], so this is written after it.
#[unsafe(link_section = ".dma")]
static mut DMA: MaybeUninit<Dma> = MaybeUninit::uninit();

/// The watchdog, which has a clock of its own and stands still while a debugger halts the core.
pub struct Watchdog(IndependentWatchdog<'static, IWDG1>);

impl Watchdog {
    pub fn start(limit: Duration) -> Self {
        pac::DBGMCU.apb4fzr1().modify(|frozen| frozen.set_iwdg1(true));
        // SAFETY: nobody else takes the watchdog.
        let mut dog = IndependentWatchdog::new(unsafe { IWDG1::steal() }, limit.as_micros() as u32);
        dog.unleash();
        Self(dog)
    }

    pub fn feed(&mut self) {
        self.0.pet();
    }

    pub fn reset(&self) -> Reset {
        let flags = pac::RCC.rsr().read();
        pac::RCC.rsr().modify(|flags| flags.set_rmvf(true));
        match (flags.iwdg1rstf(), flags.sftrstf()) {
            (true, _) => Reset::Watchdog,
            (_, true) => Reset::Software,
            _ => Reset::PowerOrPin,
        }
    }
}

/// Starts the clocks, SRAM1 and the caches.
pub fn start() -> Peripherals {
    let mut config = Config::default();
    let rcc = &mut config.rcc;
    rcc.hsi = None;
    rcc.hse = Some(Hse { freq: Hertz(CRYSTAL_HZ), mode: HseMode::Oscillator });
    rcc.hsi48 = Some(Hsi48Config::default()); // for the random generator
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
    let p = embassy_stm32::init(config);

    pac::RCC.ahb2enr().modify(|register| register.set_sram1en(true));
    // SAFETY: nobody else takes the core's peripherals.
    let mut core = unsafe { cortex_m::Peripherals::steal() };
    leave_out_of_cache(&mut core.MPU);
    core.SCB.enable_icache();
    core.SCB.enable_dcache(&mut core.CPUID);
    p
}

/// Makes SRAM1 normal memory that is not cached; all else stays as the architecture has it.
fn leave_out_of_cache(mpu: &mut MPU) {
    // PM0253, 4.6: TEX 001, C 0, B 0; full access; nothing is executed.
    const NOT_CACHED: u32 = 1 << 19;
    const FULL_ACCESS: u32 = 0b011 << 24;
    const EXECUTE_NEVER: u32 = 1 << 28;
    const ENABLE: u32 = 1;
    const DEFAULT_MAP_ELSEWHERE: u32 = 1 << 2;
    let attributes = NOT_CACHED | FULL_ACCESS | EXECUTE_NEVER | (SRAM1_SIZE - 1) << 1 | ENABLE;
    // SAFETY: the region holds the buffers alone, which nobody has touched yet.
    unsafe {
        mpu.rnr.write(0);
        mpu.rbar.write(SRAM1);
        mpu.rasr.write(attributes);
        mpu.ctrl.write(DEFAULT_MAP_ELSEWHERE | ENABLE);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// Returns the buffers, after [`start`].
///
/// # Panics
/// They were taken before.
pub fn dma() -> &'static mut Dma {
    static IS_TAKEN: AtomicBool = AtomicBool::new(false);
    assert!(!IS_TAKEN.swap(true, Relaxed), "the buffers are taken");
    // SAFETY: this is the only reference, as the flag says.
    unsafe { (*addr_of_mut!(DMA)).write(Dma { imu: NEW_BUFFER, port: [0; MAX_FRAME] }) }
}

/// Waits by the core's cycles, of which this core does two turns of the loop.
pub fn spin() -> Spin {
    Spin::new(2 * CORE_HZ)
}

/// Microseconds since the start.
pub fn now() -> Tick {
    Tick::from_micros(Instant::now().as_micros())
}
