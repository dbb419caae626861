//! The error of a command line that cannot be understood.

use anyhow::Error;
use std::fmt;

/// An error that ends the program with exit status 2.
#[derive(Debug)]
pub struct Usage(String);

impl fmt::Display for Usage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Usage {}

pub fn usage(message: String) -> Error {
    Usage(message).into()
}
