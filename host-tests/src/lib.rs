//! What the crate is measured against: an independent reference of every coding scheme, real flight data
//! to run both on, and models of the chips.

pub mod compare;
pub mod flight;
pub mod reference;

pub use silicon;
