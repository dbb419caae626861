//! Schemes whose filter length, window, number of neurons or of slots is chosen at run time.
//!
//! For tools on a computer, as taps, centres and states are on the heap. With the same parameters they give the
//! results of the schemes in [`rate`](crate::rate), [`temporal`](crate::temporal) and
//! [`population`](crate::population), bit for bit, but more slowly. Codes of a population have a fixed capacity:
//! [`Neuron<1024>`](crate::population::Neuron) for any number of neurons up to 1024.
//!
//! ```
//! use spikewire::{Scheme, Spike, dynamic::{Hough, Taps}};
//!
//! let taps = [0.5, 1.0, 0.5];
//! let scheme = Hough::try_new(Taps::try_new(&taps)?)?;
//! let mut encoder = scheme.encoder();
//! let spikes = [0.6, 1.2, 0.7, 0.0].map(|x| encoder.encode(x));
//! assert_eq!(spikes, [None, None, Some(Spike::Up), Some(Spike::None)]);
//! assert_eq!(scheme.latency(), 2);
//! # Ok::<(), spikewire::ConfigError>(())
//! ```

#[cfg(feature = "rand-010")]
pub use super::population::dynamic::Probabilistic;
pub use super::population::dynamic::{LEVELS, NEURONS, Position, Slots};
pub use super::population::dynamic_nonlinear::NonLinearSlots;
pub use super::population::dynamic_rank_order::RankOrder;
pub use super::rate::dynamic::{
    Bsa, BsaToolbox, BsaToolboxState, Hough, LONGEST, Rate, RateDecoderState, RateState, Taps,
    ThresholdHough,
};
pub use super::temporal::dynamic::{MovingWindow, MovingWindowState, WIDEST};
pub use super::timing::dynamic::{Burst, FirstSpike, LatencyPhase, WeightedPhase};
