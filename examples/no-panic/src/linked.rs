//! Every codec in every sample type, and every link and chip, linked with a panic handler that does not exist:
//! one path to a panic that the compiler cannot rule out, and this program fails to link.
//!
//! It is not run, so it needs no board and no memory map.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
use {cortex_m as _, panic_never as _};

mod codecs;
mod exercise;
mod frames;
mod links;
mod network;
mod reckon;

use fixed::{
    FixedI16, FixedI32,
    types::extra::{U8, U16},
};

fn link_all() {
    codecs::link::<f32>();
    codecs::link::<FixedI16<U8>>();
    codecs::link::<FixedI32<U16>>();
    codecs::link::<i16>();
    links::link();
    frames::link();
    network::link();
}

/// Where the linker begins.
#[cfg(target_os = "none")]
#[unsafe(no_mangle)]
extern "C" fn _start() -> ! {
    link_all();
    loop {
        core::hint::spin_loop();
    }
}

/// For the lints, which also read this on the host.
#[cfg(not(target_os = "none"))]
fn main() {
    link_all();
}
