//! A network that `spikewire network` wrote, as a library for C: `network.h` beside it says what each function does.

#![cfg_attr(target_os = "none", no_std)]

use core::slice;
use spikewire_network::{Network, State};

include!(concat!(env!("OUT_DIR"), "/declared.rs"));

type Own = <network::Trained as Network>::State;

/// Bytes of a state.
#[unsafe(no_mangle)]
pub extern "C" fn network_size() -> usize {
    size_of::<Own>()
}

/// # Safety
/// `state` has room for `network_size()` bytes, aligned as `u64`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn network_reset(state: *mut Own) {
    // SAFETY: the caller's promise.
    unsafe { state.write(network::NETWORK.state()) };
}

/// # Safety
/// `state` was reset, `inputs` has `count` numbers, and `fired` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn network_step(
    state: *mut Own,
    inputs: *const u16,
    count: usize,
    fired: *mut *const u16,
) -> usize {
    // SAFETY: the caller's promise; no number is read of an empty list, whose pointer may be null.
    unsafe {
        let inputs = if count == 0 { &[] } else { slice::from_raw_parts(inputs, count) };
        let spikes = network::NETWORK.step(&mut *state, inputs);
        fired.write(spikes.as_ptr());
        spikes.len()
    }
}

/// # Safety
/// `state` was reset.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn network_values(state: *const Own) -> *const <Own as State>::Value {
    // SAFETY: the caller's promise.
    unsafe { (*state).values().as_ptr() }
}

/// Number of inputs, then of outputs.
#[unsafe(no_mangle)]
pub static NETWORK_INPUTS: usize = <network::Trained as Network>::INPUTS;
#[unsafe(no_mangle)]
pub static NETWORK_OUTPUTS: usize = <network::Trained as Network>::OUTPUTS;

#[unsafe(no_mangle)]
pub extern "C" fn network_is_intact() -> bool {
    network::is_intact()
}

/// The network has no path to it, but a library for C needs one.
#[cfg(target_os = "none")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}
