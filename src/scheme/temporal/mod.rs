//! Temporal codes: a spike when the signal moves by a step.
//!
//! Their decoders add up steps, so that a lost spike leaves an error until the next keyframe: send keyframes
//! ([`Encoder::keyframe`](crate::Encoder::keyframe)) over a link that may lose spikes.
//!
//! **First value.** An encoder starts from its first sample, a decoder from 0. Give the decoder the first sample,
//! or a keyframe, by [`Decoder::resync`](crate::Decoder::resync), and decode from the next spike on: the value of
//! that sample is known, so its own spike is left out.
//!
//! **Scale.** In `f32`, samples and threshold times a power of two give the same spikes, and values times that power.
//!
//! ```
//! use spikewire::{Scheme, temporal::MovingWindow};
//!
//! const CLIMB: MovingWindow<f32, 2> = MovingWindow::new(1.0);
//!
//! let samples = [5.0, 0.0, 0.0, 0.0];
//! let mut encoder = CLIMB.encoder();
//! encoder.prime(&samples[..2]); // the mean is 2.5, so that the first sample spikes
//! let spikes = samples.map(|x| encoder.encode(x));
//!
//! let mut decoder = CLIMB.decoder();
//! decoder.resync(samples[0]);
//! let values = [spikes[1], spikes[2], spikes[3]].map(|spike| decoder.decode(spike));
//! assert_eq!(values, [4.0, 3.0, 3.0]); // after 5, which is known
//! ```

mod adaptive;
mod adaptive_contrast;
mod band;
mod contrast;
mod doublings;
#[cfg(feature = "alloc")]
pub(super) mod dynamic;
mod moving_window;
mod send_on_delta;
mod step_forward;
mod steps;

pub use adaptive::{AdaptiveState, AdaptiveStepForward, AdaptiveStepState};
pub use adaptive_contrast::{AdaptiveContrast, AdaptiveContrastState, AdaptiveContrastStep};
pub use contrast::{ContrastState, TemporalContrast};
pub use moving_window::{MovingWindow, MovingWindowState};
pub(super) use send_on_delta::with_most;
pub use send_on_delta::{SendOnDelta, SendOnDeltaState, Steps};
pub use step_forward::{StepForward, StepForwardState};
pub use steps::StepState;
