//! Files of the operating system.

pub use std::fs::File;
use std::io;
use std::path::Path;

/// Returns whether a directory of this name exists.
pub fn is_dir(path: &Path) -> bool {
    path.is_dir()
}

/// Returns whether a regular file of this name exists. A pipe does not count, because it can be read only once.
pub fn is_file(path: &Path) -> bool {
    path.is_file()
}

/// Creates a temporary file without a name, for decompressed bytes. The operating system deletes a closed file.
///
/// # Errors
/// Returns an error if no temporary file can be created.
pub fn scratch() -> io::Result<File> {
    tempfile::tempfile()
}
