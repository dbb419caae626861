//! How the crate is run and compared with the reference.
//!
//! Every comparison is of bits. The samples of the crate become the numbers of the reference without
//! rounding: `f32` stays `f32`, and every integer type fits `f64`.

mod check;
mod run;
mod wire;

pub use check::{
    assert_rate_spikes, assert_step_spikes, check_position, check_rate, check_rate_decoder,
    check_step_decoder,
};
pub use run::{Repeatable, Run, decode, encode, run};
pub use wire::{Wire, assert_same_values, finite, reals, saturated, signs_of, spikes_of, whole};
