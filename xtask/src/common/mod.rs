//! What every room uses: other programs, paths, progress, processor time, the error of a wrong command line.

pub mod cpu;
pub mod paths;
pub mod progress;
pub mod shell;
pub mod usage;
