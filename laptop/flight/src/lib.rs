//! One file that describes a flight on spikes, and the code for both of its ends.
//!
//! A [`Flight`] says what a vehicle codes and what its far end decodes: channels, scheme, sample type, parameters, filter,
//! period, keyframes and frame format. The laptop program writes it, and reads it wherever it codes or listens; a
//! firmware makes its constants from it. Two ends that are made from one file cannot disagree on a threshold.
//!
//! # From the file to a firmware
//!
//! `build.rs`, with this crate among the build dependencies:
//!
//! ```no_run
//! # // In `main`:
//! spikewire_flight::build("flight.toml").unwrap();
//! ```
//!
//! `src/main.rs`, into which [`rust`] puts the module `flight`:
//!
//! ```ignore
//! include!(concat!(env!("OUT_DIR"), "/flight.rs"));
//!
//! let mut bank = flight::BANK;
//! let mut transmitter = flight::transmitter(session);
//! let mut receiver = flight::receiver(); // at the far end
//! ```

mod error;
mod file;
mod filter;
mod flight;
mod rust;
mod script;

pub use error::{FlightError, FlightErrorKind, Place};
pub use filter::{Filter, Filtering};
pub use flight::{Channel, Flight, Parts};
pub use rust::rust;
pub use script::build;
