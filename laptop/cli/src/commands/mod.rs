//! The commands of the program `spikewire`, one in each file.

pub(crate) mod advise;
pub(crate) mod bench;
pub(crate) mod capture;
pub(crate) mod convert;
pub(crate) mod dataset;
pub(crate) mod decode;
pub(crate) mod emit;
pub(crate) mod encode;
pub(crate) mod frames;
pub(crate) mod info;
pub(crate) mod listen;
pub(crate) mod network;
mod network_rule;
pub(crate) mod plot;
pub(crate) mod samples;
pub(crate) mod score;
pub(crate) mod signal;
pub(crate) mod tune;
