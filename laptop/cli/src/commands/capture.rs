//! `spikewire capture`: copies the bytes that a board writes to an RTT channel, read through a debug probe.

use anyhow::Result;
use clap::Args;
use std::path::PathBuf;

/// Read an RTT channel through a debug probe; the board needs no other cable.
///
/// Needs a build with `--features capture`. The output is usually piped to `listen`: `spikewire capture --chip
/// STM32F405RG | spikewire listen`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  spikewire capture --chip STM32F405RG -o captured.bytes
  spikewire capture --chip RP2040 --seconds 60 | spikewire listen --from link")]
pub(crate) struct Capture {
    /// The chip's name in probe-rs, such as STM32F405RG or RP2040
    #[arg(long)]
    pub chip: String,
    /// USB identifiers of the debug probe, in hexadecimal; needed if several are connected
    #[arg(long, value_name = "VENDOR:PRODUCT[:SERIAL]")]
    pub probe: Option<String>,
    /// Number of the RTT channel on the board
    #[arg(long, default_value_t = 0)]
    pub channel: usize,
    /// Address of RTT's control block, such as 0x20000000; default: all RAM is searched
    #[arg(long, value_parser = address)]
    pub address: Option<u64>,
    /// Stop after this many seconds; Ctrl-C stops too
    #[arg(long)]
    pub seconds: Option<f64>,
    /// File to write the bytes to; default: standard output
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
/// Returns an error if the chip, probe, board or channel is not found, or if one of them disconnects.
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
        // Bytes received before the channel failed are kept.
        output.finish()?;
        say!("{} bytes", captured.bytes);
        captured.end
    })?)
}

/// The command in a build without the feature `capture`, which always fails.
///
/// # Errors
/// Always returns an error, which says how to build with the feature.
#[cfg(not(feature = "capture"))]
pub(crate) fn run(_: &Capture) -> Result<()> {
    anyhow::bail!(
        "this build has no `capture`; cargo install --path cli --features capture brings it"
    )
}
