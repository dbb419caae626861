//! The host stands in for a board: its output is what every board must print.

use critical_section as _; // links the standard library's
use std::{
    fmt,
    io::{self, Write},
    process,
};

/// Standard output, as `core::fmt` writes to it.
pub struct Console(io::Stdout);

impl fmt::Write for Console {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.write_all(text.as_bytes()).map_err(|_| fmt::Error)
    }
}

pub fn console() -> Console {
    Console(io::stdout())
}

pub fn finish(result: fmt::Result) -> ! {
    process::exit(result.is_err().into())
}
