//! Reads, checks and writes the flight file (`flight.toml`), which describes how a vehicle encodes its sensors as
//! spikes, and generates the sender and the receiver from it.
//!
//! A [`Flight`] holds what sender and receiver must have in common: channels, scheme, sample type, parameters, filter,
//! period, keyframes and frame format. The laptop program writes the file, and reads it to encode recordings and to
//! decode frames; a firmware generates its constants from it. Sender and receiver that are generated from one file
//! cannot differ in a threshold.
//!
//! # From the file to a firmware
//!
//! In `build.rs`, with this crate among the build dependencies:
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
mod keys;
mod rounding;
mod rust;
mod script;
mod spelling;
mod units;

pub use error::{FlightError, FlightErrorKind, Place};
pub use filter::{Filter, Filtering};
pub use flight::{Channel, Flight, Parts};
pub use rounding::Rounded;
pub use rust::rust;
pub use script::build;
pub use spelling::{escaped, visible};
pub use units::{Axis, STANDARD_GRAVITY, UnitSize, unit_of_name};
