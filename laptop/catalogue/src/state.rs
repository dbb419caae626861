//! The trait of states that visitors can write and read.

use spikewire::Scheme;

/// A state that can be written and read back; with the feature `serde`.
#[cfg(feature = "serde")]
pub trait State: serde::Serialize + serde::de::DeserializeOwned {}

/// Any state; without the feature `serde`, states cannot be written.
#[cfg(not(feature = "serde"))]
pub trait State {}

#[cfg(feature = "serde")]
impl<T: serde::Serialize + serde::de::DeserializeOwned> State for T {}

#[cfg(not(feature = "serde"))]
impl<T> State for T {}

/// A scheme whose states can be written and read back, as those of all schemes can.
pub trait Storable: Scheme<EncoderState: State, DecoderState: State> {}

impl<P: Scheme<EncoderState: State, DecoderState: State>> Storable for P {}
