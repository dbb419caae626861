//! The system's files.

pub use std::fs::File;
use std::io;
use std::path::Path;

/// Returns whether there is a directory of this name.
pub fn is_dir(path: &Path) -> bool {
    path.is_dir()
}

/// Returns whether there is a file of this name that can be read again from its start.
pub fn is_file(path: &Path) -> bool {
    path.is_file()
}

/// Opens a nameless file to unpack into, which is gone once it is closed.
///
/// # Errors
/// Returns an error if no temporary file can be made.
pub fn scratch() -> io::Result<File> {
    tempfile::tempfile()
}
