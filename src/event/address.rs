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

/// The methods that set the addresses and the length of sub-timesteps of a bank or of what decodes one, in these fields.
macro_rules! addressed {
    (
        $(#[$first_doc:meta])* $($first:ident).+;
        $(#[$slot_doc:meta])* $($slot_ticks:ident).+;
    ) => {
        $(#[$first_doc])*
        ///
        /// # Panics
        /// Panics if the last address is above 65 535; at compile time where it initialises a constant.
        #[must_use]
        pub const fn with_first_address(mut self, first_address: u16) -> Self {
            $crate::error::unwrap($crate::error::first_address(first_address, Self::ADDRESSES));
            self.$($first).+ = first_address;
            self
        }

        $(#[$first_doc])*
        ///
        /// # Errors
        /// Returns an error if the last address is above 65 535.
        pub fn try_with_first_address(mut self, first_address: u16) -> Result<Self, ConfigError> {
            $crate::error::first_address(first_address, Self::ADDRESSES)?;
            self.$($first).+ = first_address;
            Ok(self)
        }

        $(#[$slot_doc])*
        #[must_use]
        pub const fn with_slot_ticks(mut self, slot_ticks: u32) -> Self {
            self.$($slot_ticks).+ = slot_ticks;
            self
        }
    };
}
pub(crate) use addressed;

#[cfg(feature = "link")]
impl Event {
    /// Fills unused slots of a buffer.
    pub(crate) const ZERO: Self =
        Self { tick: Tick::from_micros(0), address: 0, polarity: Polarity::Down };
}
