//! Room for the chip's memories.

use core::{mem::MaybeUninit, ptr::addr_of_mut};
use embedded_alloc::LlffHeap;

#[global_allocator]
static HEAP: LlffHeap = LlffHeap::empty();

/// 36 KiB of memories, and what was fired and taken since the last look.
const SIZE: usize = 64 * 1024;

/// Called once, before anything is allocated.
pub fn init() {
    static mut ROOM: [MaybeUninit<u8>; SIZE] = [MaybeUninit::uninit(); SIZE];
    // SAFETY: called once, and nothing else has this room.
    unsafe { HEAP.init(addr_of_mut!(ROOM) as usize, SIZE) }
}
