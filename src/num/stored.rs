//! The trait of the numbers in a state: with the feature `serde` they can be written and read back.

/// `Serialize` and `DeserializeOwned` with the feature `serde`; every type without.
#[cfg(feature = "serde")]
pub trait Stored: serde::Serialize + serde::de::DeserializeOwned {}

/// `Serialize` and `DeserializeOwned` with the feature `serde`; every type without.
#[cfg(not(feature = "serde"))]
pub trait Stored {}

#[cfg(feature = "serde")]
impl<T: serde::Serialize + serde::de::DeserializeOwned> Stored for T {}

#[cfg(not(feature = "serde"))]
impl<T> Stored for T {}
