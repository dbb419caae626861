//! Generates the module `flight` in a build script.

use crate::{Flight, FlightError, FlightErrorKind, escaped, rust};
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Generates `flight.rs` from a flight file, in the directory `OUT_DIR`. Call it in `build.rs`: cargo then runs the
/// build script again when the file changes. Cargo warns of each parameter that the sample type changes.
///
/// # Errors
/// Returns an error if the file is not a valid flight, if a channel has no unit, if the flight's scheme cannot be written as a constant, or if `flight.rs`
/// cannot be written, as outside of a build script.
pub fn build(path: impl AsRef<Path>) -> Result<(), FlightError> {
    let path = path.as_ref();
    println!("cargo:rerun-if-changed={}", path.display());
    let flight = Flight::read(path)?;
    for file in &flight.files {
        println!("cargo:rerun-if-changed={}", file.display());
    }
    flight.check_units().map_err(|error| error.in_file(path))?;
    for rounded in flight.rounded() {
        println!("cargo:warning={}: {}", path.display(), escaped(&rounded.to_string()));
    }
    let text = rust(&flight).map_err(|error| error.in_file(path))?;
    let directory = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    let written = fs::write(directory.join("flight.rs"), text);
    written.map_err(|error| FlightError::new("OUT_DIR", FlightErrorKind::File(error)))
}
