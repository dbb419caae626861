//! Drivers for neuromorphic chips.
#![doc = include_str!("../README.md")]
#![no_std]
#![cfg_attr(docsrs, feature(doc_cfg))]
#![forbid(unsafe_code)]

mod akd1500;
mod error;
mod family;
mod odin;
mod output_source;
mod reckon;
mod tinyodin;
mod xylo;

pub use akd1500::{Akd1500, ConvolutionEvent, DenseEvent};
pub use error::ChipError;
pub use family::{
    AerPort, Counters, Describe, FormatError, Gated, Input, Inputs, Network, NetworkBytes,
    OdinChip, Phase, Progress, Running, Spikes, Steps, StepsLayer, StepsState, neurons_from,
};
pub use odin::{
    Odin, OdinInput, OdinLearning, OdinNetwork, OdinNeuron, OdinRegisters, OdinSynapse,
};
pub use output_source::OutputSource;
pub use reckon::{
    DescribeReckOn, Programmed, ReckOn, ReckOnAnswer, ReckOnAnswers, ReckOnBytes, ReckOnLearning,
    ReckOnNetwork, ReckOnOutputs, ReckOnPair, ReckOnPort, ReckOnSample, ReckOnSettings,
    ReckOnShared, ReckOnStep, ReckOnSteps, ReckOnStepsState, ReckOnTarget, ReckOnTask, ReckOnTick,
    Started,
};
pub use tinyodin::{TinyOdin, TinyOdinInput, TinyOdinNetwork, TinyOdinNeuron, TinyOdinRegisters};
pub use xylo::{InputBank, Registers, Xylo, XyloMap, pack_counts};

/// The code of the pages on chips, for doctests alone.
#[cfg(doctest)]
pub mod pages {
    #[doc = include_str!("../../docs/how-to/chip-tinyodin.md")]
    pub struct TinyOdin;
    #[doc = include_str!("../../docs/how-to/chip-reckon.md")]
    pub struct ReckOn;
    #[doc = include_str!("../../docs/how-to/chip-akd1500.md")]
    pub struct Akd1500;
    #[doc = include_str!("../../docs/how-to/chip-xylo.md")]
    pub struct Xylo;
}
