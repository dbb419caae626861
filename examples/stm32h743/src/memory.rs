//! Caches, and the memory that DMA and processor share.
//!
//! DMA1 and DMA2 do not reach the DTCM, where the statics are. The driver's one buffer lies in SRAM1 of domain D2, which
//! they reach without crossing into the processor's domain. That memory is not cached, so that no line has to be cleaned or
//! thrown away before or after a transfer: a forgotten one would be a wrong sample now and then. It costs the processor some
//! slow reads of 132 bytes a millisecond. The data cache then serves the constants in flash alone, as the DTCM is never in it.

use core::{mem::MaybeUninit, ptr::addr_of_mut};

use cortex_m::{Peripherals, peripheral::MPU};
use embassy_stm32::pac::RCC;
use icm42688p::{Buffer, NEW_BUFFER};

/// Where SRAM1 begins, and the power of two of its length in bytes: `memory.x` has the same.
const SRAM1: u32 = 0x3000_0000;
const SRAM1_SIZE: u32 = 17;

/// SRAM1 has no clock before [`start`], so this is written after it.
#[unsafe(link_section = ".dma")]
static mut DMA: MaybeUninit<Buffer> = MaybeUninit::uninit();

/// Turns SRAM1 and the caches on. Comes first of all.
pub fn start() {
    RCC.ahb2enr().modify(|register| register.set_sram1en(true));
    let mut core = Peripherals::take().expect("taken once");
    leave_out_of_cache(&mut core.MPU);
    core.SCB.enable_icache();
    core.SCB.enable_dcache(&mut core.CPUID);
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
    // SAFETY: the region holds the buffer alone, which nobody has touched yet.
    unsafe {
        mpu.rnr.write(0);
        mpu.rbar.write(SRAM1);
        mpu.rasr.write(attributes);
        mpu.ctrl.write(DEFAULT_MAP_ELSEWHERE | ENABLE);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// The driver's buffer. Called once, after [`start`], by a task that is spawned once.
pub fn dma_buffer() -> &'static mut Buffer {
    // SAFETY: called once, so that this is the only reference.
    unsafe { (*addr_of_mut!(DMA)).write(NEW_BUFFER) }
}
