//! Shared by all modules: running programs, paths, links, progress, processor time, the error of a wrong command line.

pub mod cpu;
pub mod links;
pub mod paths;
pub mod progress;
pub mod shell;
mod usage;

pub use shell::{cargo, command, lint, output, run};
pub use usage::{Usage, usage};
