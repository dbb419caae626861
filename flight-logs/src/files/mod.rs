//! Access to files of the operating system or, in WebAssembly, to files that the web page provides.
//!
//! WebAssembly in a browser has no file system. The page provides the files that its user chose, and all readers open
//! them here by name.

#[cfg(target_family = "wasm")]
mod lent;
#[cfg(not(target_family = "wasm"))]
mod system;

#[cfg(target_family = "wasm")]
pub use lent::{Bytes, File, is_dir, is_file, lend, scratch, take_back};
#[cfg(not(target_family = "wasm"))]
pub use system::{File, is_dir, is_file, scratch};

use std::io::{self, Read};
use std::path::Path;

/// Returns whether a file of this name exists and is not empty.
pub fn has_bytes(path: &Path) -> bool {
    File::open(path).is_ok_and(|mut file| file.read(&mut [0]).is_ok_and(|read| read > 0))
}

/// Reads a whole file as text.
///
/// # Errors
/// Returns an error if the file is missing, cannot be read, or is not UTF-8.
pub fn read_to_string(path: &Path) -> io::Result<String> {
    let mut text = String::new();
    File::open(path)?.read_to_string(&mut text)?;
    Ok(text)
}
