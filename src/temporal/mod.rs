//! Temporal codes: a spike when the signal moves by a step.
//!
//! All three share one decoder, [`StepDecoder`], which adds up the steps. Its error adds up too when
//! a spike is lost: send keyframes ([`Encoder::keyframe`](crate::Encoder::keyframe)) over a link
//! that may lose spikes.

mod contrast;
mod moving_window;
mod step_decoder;
mod step_forward;
mod window_sum;

pub use contrast::{TemporalContrast, TemporalContrastEncoder};
pub use moving_window::{MovingWindow, MovingWindowEncoder};
pub use step_decoder::StepDecoder;
pub use step_forward::{StepForward, StepForwardEncoder};
pub(crate) use window_sum::Windowed;
