//! Filters before a code: against vibration, which a code would otherwise spend its spikes on.
//!
//! A [`Filtered`] scheme is a filter and a scheme, and a scheme itself: encoders, banks and links take it as they take any
//! other. Its codes are those of the filtered samples, and its decoder is the scheme's own.
//!
//! ```
//! use spikewire::{Scheme, filter::{Biquad, Filtered}, temporal::SendOnDelta};
//!
//! const ROLL: Filtered<Biquad<i16>, SendOnDelta<i16, 16>> =
//!     Biquad::low_pass(40.0, 500.0).before(SendOnDelta::new(98)); // 40 Hz at 500 samples a second
//!
//! let mut encoder = ROLL.encoder();
//! let shaken = (0..500).map(|i| if i % 2 == 0 { 300 } else { -300 }); // a vibration of 250 Hz
//! assert!(shaken.skip(1).all(|rate| encoder.encode(rate).count().abs() <= 2));
//! ```
//!
//! | filter | state in `f32`, 16 and 32 bits | for |
//! |---|---|---|
//! | [`FirstOrder::low_pass`] | 4, 8, 8 bytes | broad noise, with the least delay |
//! | [`Biquad::low_pass`] | 8, 16, 24 bytes | vibration above the band of control |
//! | [`Biquad::notch`] | 8, 16, 24 bytes | one line, as of a rotor at hover |
//!
//! Filters in a row are nested: `NOTCH.before(LOW_PASS.before(SCHEME))`.
//!
//! # What every filter keeps to
//!
//! - **Start:** the first finite sample sets the steady state: the output is that sample, without a transient from 0.
//! - **Constants:** the gain at DC is 1. In fixed point a signal that stays at a value brings the output to exactly that
//!   value, and in `f32` to within rounding.
//! - **Samples that are not finite** pass as they are, so that the scheme rejects and counts them, and leave the state as
//!   it was. An output is finite if its sample is: where `f32` overflows, the filter starts anew from the sample.
//! - **Bits:** the same on every core. Each type says its operations in their order; no sample takes a division.

mod before;
mod biquad;
mod design;
mod first_order;

pub use before::{Filtered, FilteredState};
pub use biquad::{Biquad, BiquadState};
pub use first_order::{FirstOrder, FirstOrderState};

use core::fmt::Debug;

use crate::{Fingerprint, Sample};

/// A filter of samples: checked parameters as plain data, in a `const` or a `static`, and a small state for each channel.
///
/// A filter of your own may go before a scheme, too. It must return a finite sample for a finite sample, or a receiver
/// may take values for exact that are not; and for any other sample that sample, with the state as it was.
pub trait Filter {
    /// The type of its samples.
    type Sample: Sample;
    /// What changes from sample to sample.
    type State: Copy + Debug;

    /// The state before the first sample.
    const START: Self::State;

    /// The fingerprint of the filter's name and of all its parameters, as [`Scheme::fingerprint`](crate::Scheme::fingerprint).
    fn fingerprint(&self) -> Fingerprint;

    /// Filters one sample.
    fn filter(&self, state: &mut Self::State, sample: Self::Sample) -> Self::Sample;

    /// Filters samples in order into `outputs`, with the results of [`filter`](Self::filter), bit for bit. Stops at the
    /// end of the shorter slice and returns its length.
    fn filter_slice(
        &self,
        state: &mut Self::State,
        samples: &[Self::Sample],
        outputs: &mut [Self::Sample],
    ) -> usize {
        for (output, &sample) in outputs.iter_mut().zip(samples) {
            *output = self.filter(state, sample);
        }
        samples.len().min(outputs.len())
    }

    /// The rate of the samples that it is made for, in Hz; `None` if it suits any.
    fn rate(&self) -> Option<f32> {
        None
    }

    /// By how many samples a slow signal comes late: the group delay at DC. Over the rate, it is the time that a control
    /// loop waits.
    fn delay(&self) -> f32;
}
