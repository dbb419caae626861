//! Reads an RTT channel of a board through a debug probe, with the library probe-rs.

use super::{CaptureKind, Channel};
use crate::{Error, Result};
use catalogue::run::Given;
use probe_rs::config::Registry;
use probe_rs::probe::{DebugProbeSelector, list::Lister};
use probe_rs::rtt::{Rtt, ScanRegion, try_attach_to_rtt};
use probe_rs::{Core, Permissions};
use std::time::Duration;

/// A board at a debug probe, and the channel to read from it.
#[derive(Clone, Debug)]
pub struct Board {
    /// Name of the chip in probe-rs, such as `STM32F405RG` or `RP2040`.
    pub chip: String,
    /// The debug probe as `VENDOR:PRODUCT[:SERIAL]`. Must be given if several probes are connected.
    pub probe: Option<String>,
    /// Number of the channel on the board, from 0.
    pub channel: usize,
    /// Address of RTT's control block on the board. If `None`, all RAM is searched for the control block.
    pub address: Option<u64>,
}

/// Finds the chip, the probe and the channel of `board`, and passes the channel to `use_it`.
///
/// # Errors
/// Returns an error if the probe, the board or the channel is missing, or if an access fails.
pub fn with_channel(
    board: &Board,
    use_it: impl FnOnce(&mut dyn Channel) -> Result<()>,
) -> Result<()> {
    /// Longest time to search for RTT's control block, the table in the board's memory that lists the channels. The
    /// search repeats because a board that has just started must first set up this table.
    const PATIENCE: Duration = Duration::from_secs(2);
    let Board { chip, probe, channel: number, address } = board;
    let target = Registry::from_builtin_families()
        .get_target_by_name(chip)
        .map_err(|error| CaptureKind::NoChip { why: chain(&error) }.of(Given::new("chip", chip)))?;
    let selector = probe.as_deref().map(|text| {
        let wrong = |why| CaptureKind::NotASelector { why }.of(Given::new("probe", text));
        text.parse::<DebugProbeSelector>().map_err(|error| wrong(chain(&error)))
    });
    let probes = Lister::new().list(selector.transpose()?.as_ref());
    let probe = match probes.as_slice() {
        [] => return Err(CaptureKind::NoProbe { hint: hint() }.into()),
        [one] => one,
        several => {
            let names: Vec<String> =
                several.iter().map(|probe| DebugProbeSelector::from(probe).to_string()).collect();
            return Err(CaptureKind::SeveralProbes { names }.into());
        }
    };
    let probe = probe.open().map_err(|error| {
        let (probe, why) = (probe.to_string(), chain(&error));
        CaptureKind::NoProbeOpen { probe, why }
    })?;
    let mut session = probe
        .attach(target, Permissions::default())
        .map_err(|error| CaptureKind::NotReached { chip: chip.clone(), why: chain(&error) })?;
    let mut core = session.core(0).map_err(Error::other)?;
    let region = address.map_or(ScanRegion::Ram, ScanRegion::Exact);
    let mut rtt = try_attach_to_rtt(&mut core, PATIENCE, &region)
        .map_err(|error| CaptureKind::NoRtt { why: chain(&error) })?;
    if rtt.up_channel(*number).is_none() {
        let channels = rtt.up_channels().len();
        return Err(CaptureKind::NoChannel { channels }.of(Given::new("channel", number)));
    }
    use_it(&mut Probed { core, rtt, number: *number })
}

/// Formats an error of probe-rs: its message, followed by the messages of its causes, joined by colons.
fn chain(error: &(dyn std::error::Error + 'static)) -> String {
    let causes = std::iter::successors(Some(error), |error| error.source());
    causes.map(ToString::to_string).collect::<Vec<_>>().join(": ")
}

/// Returns the end of the error message for a debug probe that was not found. It names possible reasons.
fn hint() -> &'static str {
    if cfg!(target_os = "linux") {
        "; is it plugged in, and may this user open it (udev rules of probe-rs)? CMSIS-DAP version 1 is not supported"
    } else {
        "; is it plugged in? CMSIS-DAP version 1 is not supported"
    }
}

/// A channel of RTT: a buffer in a board's memory that a debug probe reads. The board keeps running meanwhile.
struct Probed<'a> {
    core: Core<'a>,
    rtt: Rtt,
    number: usize,
}

impl Channel for Probed<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        let channel = self.rtt.up_channel(self.number).ok_or(CaptureKind::Gone)?;
        channel.read(&mut self.core, buffer).map_err(Error::other)
    }
}
