//! Temporal codes: a spike when the signal moves by a step.
//!
//! Their decoders add up steps, so that an error adds up too when a spike is lost: send keyframes
//! ([`Encoder::keyframe`](crate::Encoder::keyframe)) over a link that may lose spikes.
//!
//! **First value.** An encoder starts from its first sample, a decoder from 0. Tell the decoder that sample,
//! or a keyframe, by [`Decoder::resync`](crate::Decoder::resync). The value of the sample from which a decoder
//! starts is known, so the code of that sample is not decoded.

mod contrast;
#[cfg(feature = "alloc")]
pub(super) mod dynamic;
mod moving_window;
mod step_forward;
mod steps;

pub use contrast::{ContrastState, TemporalContrast};
pub use moving_window::{MovingWindow, MovingWindowState};
pub use step_forward::{StepForward, StepForwardState};
pub use steps::StepState;
