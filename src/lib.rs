//! Sensor samples to spikes and back, on a flight controller.
//!
//! Streaming encoders and decoders for the spike codes of neuromorphic robotics, one sample at a
//! time, in memory of fixed size: no heap, no panic, no unsafe code, and the same bits on every core.
//!
//! ```
//! use spikewire::{Scheme, temporal::StepForward};
//!
//! const ROLL: StepForward<f32> = StepForward::new(0.35); // a bad constant fails the build
//!
//! let mut encoder = ROLL.encoder(); // the first sample becomes the baseline
//! let mut decoder = ROLL.decoder(); // starts at 0; `resync` sets it
//! for rate in [0.0, 0.4, 0.9, 0.8, 0.2] {
//!     let spike = encoder.encode(rate); // Up, Down or None
//!     let estimate = decoder.decode(spike);
//!     assert!((estimate - rate).abs() <= 0.55);
//! }
//! ```
//!
//! A [`Scheme`] is a code with its parameters, in a `const` or a `static`. An [`Encoder`] or a [`Decoder`] is a
//! reference to it and a small state; a [`Bank`] is one scheme with a state for each channel. Events and keyframes
//! leave the interrupt as one stream of [items](Item), in order, through a queue to a link, a sink or a chip.
//!
//! # Schemes
//!
//! | family | scheme | for |
//! |---|---|---|
//! | [`temporal`] | [`TemporalContrast`](temporal::TemporalContrast) (TBR) | changes, as an event camera sees them |
//! | | [`AdaptiveContrast`](temporal::AdaptiveContrast) | changes, with a threshold that follows them |
//! | | [`StepForward`](temporal::StepForward) (SF) | following a signal closely with few spikes |
//! | | [`SendOnDelta`](temporal::SendOnDelta) | following a signal that jumps |
//! | | [`AdaptiveStepForward`](temporal::AdaptiveStepForward) | following a signal that jumps, one spike a sample |
//! | | [`MovingWindow`](temporal::MovingWindow) (MW) | changes against a short past |
//! | [`rate`] | [`Hough`](rate::Hough) (HSA) | a reconstruction that never exceeds the signal |
//! | | [`ThresholdHough`](rate::ThresholdHough) (T-HSA) | a closer reconstruction than HSA |
//! | | [`Bsa`](rate::Bsa) (BSA) | smooth signals, with a filter of unit sum |
//! | | [`BsaToolbox`](rate::BsaToolbox) | BSA as in the paper's tables |
//! | | [`SigmaDelta`](rate::SigmaDelta) | a mean from one neuron |
//! | | `Bernoulli` | a mean by chance (feature `rand-010`) |
//! | | [`WeightedBurst`](rate::WeightedBurst) | a mean, with few spikes while it is low |
//! | | [`IntegrateAndFire`](rate::IntegrateAndFire) (IF, LIF) | a mean, and an integral that never drifts |
//! | [`population`] | [`Position`](population::Position) | a value, dense where it matters |
//! | | [`Gaussian`](population::Gaussian) (GRF) | a value over an even range |
//! | | [`Slots`](population::Slots) | a value finer than the neurons, by spike time |
//! | | `Probabilistic` | a value by chance (feature `rand-010`) |
//! | | [`Gaussian::companded`](population::Gaussian::companded), [`with_widths`](population::Gaussian::with_widths) | a value, finer where it is most of the time |
//! | | [`NonLinearSlots`](population::NonLinearSlots) | the same, with finer values by spike time |
//! | | [`RankOrder`](population::RankOrder) | a value finer than the neurons, by who fires first |
//! | [`timing`] | [`FirstSpike`](timing::FirstSpike) (TTFS) | a value by one spike's time, fine where it is small |
//! | | [`LatencyPhase`](timing::LatencyPhase) | many channels on one line |
//! | | [`WeightedPhase`](timing::WeightedPhase) | a value in binary: the finest value in few slots |
//! | | [`Burst`](timing::Burst) | a value by the count and interval of its spikes |
//!
//! *The paper*, in the documentation of the schemes, is Dupeyroux, Stroobants and de Croon,
//! *A toolbox for neuromorphic perception in robotics*, 2022.
//!
//! A low-pass or a notch goes [before](filter) any of them.
//!
//! # Features
//!
//! All features are off by default, and additive.
//!
//! | feature | adds |
//! |---|---|
//! | `fixed` | `FixedI16` and `FixedI32` with any fraction as [`Sample`]s |
//! | `alloc` | `dynamic`: any filter length, window and number of neurons at run time, on the heap; not for firmware |
//! | `rand-010` | probabilistic and Bernoulli spiking, from any `rand_core` generator |
//! | `defmt` | `defmt::Format` on public data |
//! | `serde` | `Serialize` on public data; `Deserialize` where nothing has to be checked, and on [states](Encoder::with_state) |
//! | `queue` | bounded queues from interrupts to main; `EventQueue` needs a `critical-section` implementation in the program |
//! | `heapless-09` | `heapless::Vec`, `Deque`, `spsc` and `mpmc` as ends of queues, by way of `Counted` |
//! | `portable-atomic` | `heapless::mpmc` on a Cortex-M0; needs a `critical-section` implementation in the program |
//! | `link` | `link`: framed events over any byte transport |
//! | `link-small` | the same with 960 bytes of tables less, and two look-ups a byte for the checksum in place of one |
//! | `embedded-hal` | [`out`]: SPI |
//! | `async` | [`out`]: asynchronous SPI; waiting on a queue |
//! | `embedded-io-07` | [`out`]: UART and USB serial, over ports of `embedded-io` 0.7 |
//! | `embedded-io-06` | [`out`]: the same over ports of `embedded-io` 0.6 |
#![no_std]
#![cfg_attr(docsrs, feature(doc_cfg))]
#![forbid(unsafe_code)]

#[cfg(feature = "alloc")]
extern crate alloc;
#[cfg(test)]
extern crate std;

mod error;
mod event;
pub mod filter;
mod num;
pub mod out;
mod scheme;
#[cfg(feature = "serde")]
mod serial;
mod wire;

pub use error::ConfigError;
pub use event::{
    AtMost, Bank, Bins, Event, FromEvents, FromItems, Item, Keyframe, Put, Readout, Schemes,
    Source, StepOver, Taken, Tick,
};
#[cfg(feature = "queue")]
pub use event::{
    Consumer, EventQueue, Overflow, Queue, QueueView, Refused, SpscConsumer, SpscProducer,
    SpscQueue,
};
#[cfg(feature = "heapless-09")]
pub use event::{Container, Counted, Element};
pub use num::{Sample, SampleKind};
#[cfg(feature = "alloc")]
pub use scheme::dynamic;
pub use scheme::{
    Calibration, Code, Conditions, Decoder, Destination, Differences, Encoder, Fingerprint, Fit,
    Histogram, Moments, NeuronSpike, Output, Polarity, Recovery, Scheme, Spike, Start, Survey,
    Unfit, population, rate, temporal, timing,
};
#[cfg(feature = "link")]
pub use wire::link;

/// The code of the README and of the pages in `docs`, for doctests alone.
#[cfg(all(doctest, feature = "fixed", feature = "queue", feature = "link"))]
pub mod pages {
    #[doc = include_str!("../README.md")]
    pub struct Readme;
    #[doc = include_str!("../docs/usage.md")]
    pub struct Usage;
    #[doc = include_str!("../docs/how-to/own-sensor.md")]
    pub struct OwnSensor;
    #[doc = include_str!("../docs/how-to/two-schemes.md")]
    pub struct TwoSchemes;
    #[doc = include_str!("../docs/how-to/fifo.md")]
    pub struct Fifo;
    #[doc = include_str!("../docs/how-to/log-to-sd.md")]
    pub struct LogToSd;
    #[doc = include_str!("../docs/how-to/mavlink.md")]
    pub struct Mavlink;
    #[doc = include_str!("../docs/how-to/pid-loop.md")]
    pub struct PidLoop;
    #[cfg(feature = "async")]
    #[doc = include_str!("../docs/how-to/async.md")]
    pub struct Async;
}
