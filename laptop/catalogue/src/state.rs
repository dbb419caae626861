//! Operations of visitors on the states of a scheme.

/// A state that can be written and read back with the feature `serde`; every state without.
#[cfg(feature = "serde")]
pub trait State: serde::Serialize + serde::de::DeserializeOwned {}

/// A state that can be written and read back with the feature `serde`; every state without.
#[cfg(not(feature = "serde"))]
pub trait State {}

#[cfg(feature = "serde")]
impl<T: serde::Serialize + serde::de::DeserializeOwned> State for T {}

#[cfg(not(feature = "serde"))]
impl<T> State for T {}
