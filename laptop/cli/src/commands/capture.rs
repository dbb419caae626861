//! `spikewire capture`: what a board writes to RTT, through a debug probe, byte for byte.

use anyhow::Result;
use clap::Args;
use std::path::PathBuf;

/// Read a channel of RTT through a debug probe: no cable but the probe's.
///
/// Needs a build with `--features capture`. Pipe it on: `spikewire capture --chip STM32F405RG | spikewire listen`.
#[derive(Args, Clone, Debug)]
pub(crate) struct Capture {
    /// The chip, as probe-rs calls it: STM32F405RG, RP2040
    #[arg(long)]
    pub chip: String,
    /// The debug probe, where there are several
    #[arg(long, value_name = "VENDOR:PRODUCT[:SERIAL]")]
    pub probe: Option<String>,
    /// Which of the board's channels
    #[arg(long, default_value_t = 0)]
    pub channel: usize,
    /// Where the control block is, such as 0x20000000; all RAM is searched unless given
    #[arg(long, value_parser = address)]
    pub address: Option<u64>,
    /// Stop after this time; Ctrl-C stops as well
    #[arg(long)]
    pub seconds: Option<f64>,
    /// File of bytes; standard output unless given
    #[arg(short, long)]
    pub output: Option<PathBuf>,
}

fn address(text: &str) -> Result<u64, String> {
    let number = match text.strip_prefix("0x") {
        Some(digits) => u64::from_str_radix(digits, 16),
        None => text.parse(),
    };
    number.map_err(|error| error.to_string())
}

/// Runs the command.
///
/// # Errors
/// There is no such chip, probe, board or channel, or one of them went away.
#[cfg(feature = "capture")]
pub(crate) fn run(options: &Capture) -> Result<()> {
    use crate::stop::Stop;
    use lab::output::Output;
    use lab::rtt::{self, Board};
    let stop = Stop::new(options.seconds)?;
    let Capture { chip, probe, channel, address, .. } = options.clone();
    Ok(rtt::with_channel(&Board { chip, probe, channel, address }, |channel| {
        let mut output = Output::to(options.output.as_deref())?;
        let captured = rtt::capture(channel, &mut output, || stop.is_due());
        // What came before a channel failed is kept.
        output.finish()?;
        eprintln!("{} bytes", captured.bytes);
        captured.end
    })?)
}

/// Returns an error that says how to build the program with this command.
///
/// # Errors
/// Always.
#[cfg(not(feature = "capture"))]
pub(crate) fn run(_: &Capture) -> Result<()> {
    anyhow::bail!(
        "this build has no `capture`; cargo install --path cli --features capture brings it"
    )
}
