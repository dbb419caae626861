//! Address events: which neuron fired, when, and with which polarity.

use super::Tick;
use crate::Polarity;

/// An address event: which neuron fired, when, and with which polarity.
///
/// Eight bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Event {
    /// The time of the spike.
    pub tick: Tick,
    /// The neuron. A [`Bank`](crate::Bank) numbers the neurons of its channels one after the other.
    pub address: u16,
    /// The direction.
    pub polarity: Polarity,
}

#[cfg(feature = "link")]
impl Event {
    /// Fills unused slots of a buffer.
    pub(crate) const ZERO: Self =
        Self { tick: Tick::from_micros(0), address: 0, polarity: Polarity::Down };
}
