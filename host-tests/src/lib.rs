//! What the crate is measured against: an independent reference of every coding scheme, and real
//! flight data to run both on.

pub mod compare;
pub mod flight;
pub mod reference;
