//! The messages that the nodes send, as serde puts them into CDR.

use ros2_client::builtin_interfaces::Time;
use serde::{Deserialize, Serialize};

/// `spyke_msgs/Spyke`, one number a sample, or with a list of them `spyke_msgs/SpykeArray`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Spyke<Spikes> {
    pub spike: Spikes,
    pub said: Said,
}

/// What both say of the sample beside its spikes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Said {
    /// The value that decoding starts from; 0 where the scheme has none.
    pub start: f32,
    pub min_input: f32,
    pub max_input: f32,
    /// 0 where the scheme has none.
    pub threshold: f32,
    pub input: f32,
    pub scheme: String,
    pub timestamp: Time,
}

/// `spyke_msgs/SpykeValue`
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct SpykeValue {
    pub value: f64,
    pub timestamp: Time,
}

/// `std_msgs/Header`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Header {
    pub stamp: Time,
    pub frame_id: String,
}

/// `spikewire_msgs/Spike`
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Spike {
    pub address: u16,
    pub slot: u16,
    pub polarity: i8,
}

/// `spikewire_msgs/Spikes`
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct FlightSpikes {
    pub header: Header,
    pub sample: u64,
    pub spikes: Vec<Spike>,
    pub start: Vec<f32>,
}

/// `spikewire_msgs/Values`
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct FlightValues {
    pub header: Header,
    pub values: Vec<f64>,
}

/// `diagnostic_msgs/DiagnosticArray`
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct DiagnosticArray {
    pub header: Header,
    pub status: Vec<DiagnosticStatus>,
}

/// `diagnostic_msgs/DiagnosticStatus`
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct DiagnosticStatus {
    /// 0 is good, 1 a warning.
    pub level: u8,
    pub name: String,
    pub message: String,
    pub hardware_id: String,
    /// Keys and values.
    pub values: Vec<(String, String)>,
}

/// One number, or those of several neurons and sub-timesteps.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub(crate) enum Spikes {
    One(i8),
    Many(Vec<i8>),
}

impl From<Vec<i8>> for Spikes {
    fn from(spikes: Vec<i8>) -> Self {
        match spikes[..] {
            [one] => Self::One(one),
            _ => Self::Many(spikes),
        }
    }
}
