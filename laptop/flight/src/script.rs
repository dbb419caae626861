//! A build script's one line.

use crate::{Flight, FlightError, FlightErrorKind, rust};
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Writes `flight.rs` into the directory of built files, from a flight's file. Call it in `build.rs`: cargo runs that
/// again if the file changes.
///
/// # Errors
/// Returns an error if the file is no flight, its scheme has no constant, or this is no build script.
pub fn build(path: impl AsRef<Path>) -> Result<(), FlightError> {
    let path = path.as_ref();
    println!("cargo:rerun-if-changed={}", path.display());
    let flight = Flight::read(path)?;
    let text = rust(&flight).map_err(|error| error.in_file(path))?;
    let directory = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    let written = fs::write(directory.join("flight.rs"), text);
    written.map_err(|error| FlightError::new("OUT_DIR", FlightErrorKind::File(error)))
}
