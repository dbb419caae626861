//! The program `spikewire`: encodes recordings as spikes, decodes them, and repeats the paper's benchmark.

use std::process::ExitCode;

fn main() -> ExitCode {
    spikewire_cli::run()
}
