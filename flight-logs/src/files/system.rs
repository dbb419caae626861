//! Files of the operating system.

pub use std::fs::File;
use std::io;
use std::path::Path;

/// Returns whether there is a directory of this name.
pub fn is_dir(path: &Path) -> bool {
    path.is_dir()
}

/// Returns whether there is a regular file of this name, which can be read more than once.
pub fn is_file(path: &Path) -> bool {
    path.is_file()
}

/// Creates a nameless file for decompressed bytes, which is deleted when it is closed.
///
/// # Errors
/// Returns an error if no temporary file can be created.
pub fn scratch() -> io::Result<File> {
    tempfile::tempfile()
}
