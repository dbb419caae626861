//! One codec, from samples to spikes and back: its encoder and its decoder, with parameters that are constants.
//!
//! `CODEC` in the environment chooses it, see `build.rs`. It is not run, so it needs no board and no memory map.

#![cfg_attr(target_os = "none", no_std, no_main)]

use core::hint::black_box;
#[cfg(target_os = "none")]
use panic_never as _;
#[allow(unused_imports)] // each codec has its own
use spikewire::{
    Scheme, Start,
    population::Gaussian,
    rate::{Bsa, Criterion, Hough, Taps, ThresholdHough},
    temporal::{MovingWindow, StepForward, TemporalContrast},
};

/// A floating-point unit's samples, and those of a core without.
#[cfg(not(target_abi = ""))]
mod sample {
    pub type Sample = f32;

    pub const fn sample(whole: i32) -> Sample {
        whole as Sample
    }
}
#[cfg(target_abi = "")]
mod sample {
    pub type Sample = fixed::types::I16F16;

    pub const fn sample(whole: i32) -> Sample {
        Sample::const_from_int(whole)
    }
}
use sample::{Sample, sample};

#[allow(dead_code)] // with no codec, to see what the program takes alone
fn both_ways<P>(scheme: &'static P)
where
    P: Scheme<Sample = Sample, Output: Default, Code: Default> + Start,
{
    let (mut encoder, mut decoder) = (scheme.encoder(), scheme.decoder());
    if cfg!(calls = "slice") {
        let (samples, mut outputs) = ([sample(0); 8], [P::Output::default(); 8]);
        let (codes, mut values) = ([P::Code::default(); 8], [sample(0); 8]);
        encoder.encode_slice(black_box(&samples[..]), black_box(&mut outputs[..]));
        decoder.decode_slice(black_box(&codes[..]), black_box(&mut values[..]));
    } else {
        black_box(encoder.encode(black_box(sample(0))));
        black_box(decoder.decode(black_box(P::Code::default())));
    }
    black_box((encoder.state(), decoder.state()));
}

/// The codes of the paper.
fn link() {
    #[cfg(codec = "TBR")]
    both_ways(const { &TemporalContrast::new(sample(1)) });
    #[cfg(codec = "MW, W = 5")]
    both_ways(const { &MovingWindow::<_, 5>::new(sample(1)) });
    #[cfg(codec = "SF")]
    both_ways(const { &StepForward::new(sample(1)) });
    #[cfg(codec = "BSA, 24 taps")]
    both_ways(
        const { &Bsa::<_, 24>::new(Taps::triangular(sample(1)), Criterion::Subtractive(sample(1))) },
    );
    #[cfg(codec = "HSA, 15 taps")]
    both_ways(const { &Hough::<_, 15>::new(Taps::triangular(sample(1))) });
    #[cfg(codec = "T-HSA, 15 taps")]
    both_ways(const { &ThresholdHough::<_, 15>::new(Taps::triangular(sample(1)), sample(1)) });
    #[cfg(codec = "GRF, 20 neurons")]
    both_ways(const { &Gaussian::<_, 20>::linear(sample(-1)..=sample(1)) });
}

/// Where the linker begins.
#[cfg(target_os = "none")]
#[unsafe(no_mangle)]
extern "C" fn _start() -> ! {
    link();
    loop {
        core::hint::spin_loop();
    }
}

/// For the lints, which also read this on the host.
#[cfg(not(target_os = "none"))]
fn main() {
    link();
}
