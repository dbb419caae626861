//! Spikes from recordings and back, and the benchmark of the paper.

use std::process::ExitCode;

fn main() -> ExitCode {
    spikewire_cli::run()
}
