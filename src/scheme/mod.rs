//! The coding schemes: how samples become spikes, and spikes samples.

mod calibrate;
mod cells;
mod code;
mod codec;
#[cfg(feature = "alloc")]
pub mod dynamic;
mod fingerprint;
mod held;
mod histogram;
mod index;
mod moments;
pub mod population;
pub mod rate;
mod survey;
pub mod temporal;
pub mod timing;

pub use calibrate::{Calibration, Differences};
pub use code::{Code, Destination, NeuronSpike, Output, Polarity, Spike};
pub use codec::{Decoder, Encoder, Recovery, Scheme, Start};
pub use fingerprint::Fingerprint;
pub use histogram::Histogram;
pub use moments::Moments;
pub use survey::{Conditions, Fit, Survey, Unfit};
