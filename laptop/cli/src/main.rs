//! The program `spikewire`: encodes recordings as spikes, decodes them, tunes the encoders, and listens to boards.

use std::process::ExitCode;

fn main() -> ExitCode {
    spikewire_cli::run()
}
