//! Arithmetic of the recursive filters, of first and of second order.
//!
//! Every type has the same transfer functions, in a form whose coefficients are all differences from an integrator:
//! a low corner then costs no digits, and at DC the gain is 1 whatever the coefficients are rounded to.

// Coefficients and state stay in registers only where the steps of a loop are in it.
#![allow(clippy::inline_always)]

mod float;
mod narrow;
#[cfg(feature = "fixed")]
mod wide;

use core::fmt::Debug;

use bytemuck::Pod;

use super::{DoubleDouble, Sample, SampleKind, Stored, convert::round, word};

/// How many fraction bits an integer coefficient has. Coefficients lie within 0 to 4.
const FRACTION: u32 = 29;

/// The coefficients of a second-order section, with the poles `1 - (2 - damping - gain) / z + (1 - damping) / z²`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub(crate) struct Section<C> {
    /// The poles' polynomial at `z = 1`, 0 to 4.
    pub(crate) gain: C,
    /// 1 less the product of the poles, 0 to 2.
    pub(crate) damping: C,
    /// The first tap of the numerator, which is the same backwards: over the gain in `f32`, as it is in integers,
    /// where it lies within 0 to 1.
    pub(crate) tap: C,
}

/// Filters of one sample type.
pub(crate) trait Recursive: Sized {
    /// A coefficient: `f32`, or an integer with [`FRACTION`] fraction bits.
    type Coefficient: Copy + PartialEq + Debug + Pod + Send + Sync + Stored;
    /// The state of a second-order section.
    type Second: Copy + Debug + Send + Sync + Stored;
    /// The state of a first-order low-pass.
    type First: Copy + Debug + Send + Sync + Stored;

    /// The state before the first sample.
    const SECOND: Self::Second;
    /// The state before the first sample.
    const FIRST: Self::First;

    /// Filters a sample by a second-order section.
    fn second(self, section: Section<Self::Coefficient>, state: &mut Self::Second) -> Self;

    /// Filters a sample by a first-order low-pass.
    fn first(self, gain: Self::Coefficient, state: &mut Self::First) -> Self;

    /// [`second`](Self::second) of each sample, up to the end of the shorter slice.
    fn second_slice(
        section: Section<Self::Coefficient>,
        state: &mut Self::Second,
        samples: &[Self],
        outputs: &mut [Self],
    );

    /// [`first`](Self::first) of each sample, up to the end of the shorter slice.
    fn first_slice(
        gain: Self::Coefficient,
        state: &mut Self::First,
        samples: &[Self],
        outputs: &mut [Self],
    );

    /// The value of a coefficient.
    fn value(coefficient: Self::Coefficient) -> f64;
}

/// The methods of integer samples, whose states have the functions `steady` and `step`, and which the first sample
/// finds without an output.
macro_rules! integers {
    ($second:ident, $first:ident, $to_bits:path, $from_bits:path) => {
        #[inline]
        fn second(self, section: Section<i32>, state: &mut $second) -> Self {
            let sample = $to_bits(self);
            if state.output == $second::NONE {
                *state = $second::steady(sample);
            }
            $from_bits(state.step(section, sample))
        }

        #[inline]
        fn first(self, gain: i32, state: &mut $first) -> Self {
            let sample = $to_bits(self);
            if state.0 == $first::NONE {
                *state = $first::steady(sample);
            }
            $from_bits(state.step(gain, sample))
        }

        /// Coefficients and state stay in registers.
        #[inline]
        fn second_slice(
            section: Section<i32>,
            state: &mut $second,
            samples: &[Self],
            outputs: &mut [Self],
        ) {
            let mut local = *state;
            if local.output == $second::NONE
                && let Some(&first) = samples.first()
            {
                local = $second::steady($to_bits(first));
            }
            for (output, &sample) in outputs.iter_mut().zip(samples) {
                *output = $from_bits(local.step(section, $to_bits(sample)));
            }
            *state = local;
        }

        #[inline]
        fn first_slice(gain: i32, state: &mut $first, samples: &[Self], outputs: &mut [Self]) {
            let mut local = *state;
            if local.0 == $first::NONE
                && let Some(&first) = samples.first()
            {
                local = $first::steady($to_bits(first));
            }
            for (output, &sample) in outputs.iter_mut().zip(samples) {
                *output = $from_bits(local.step(gain, $to_bits(sample)));
            }
            *state = local;
        }

        fn value(coefficient: i32) -> f64 {
            f64::from(coefficient) / (1_u64 << FRACTION) as f64
        }
    };
}
use integers;

/// The nearest coefficient.
pub(crate) const fn coefficient<S: Sample>(value: DoubleDouble) -> S::Coefficient {
    match S::KIND {
        SampleKind::F32 => word((value.rounded() as f32).to_bits() as u64),
        _ => word(round(value.rounded() * (1_u64 << FRACTION) as f64) as u64),
    }
}
