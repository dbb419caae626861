//! A board's channel through probe-rs.

use super::Channel;
use anyhow::{Context, Result, anyhow, bail};
use probe_rs::config::Registry;
use probe_rs::probe::{DebugProbeSelector, list::Lister};
use probe_rs::rtt::{Rtt, ScanRegion, try_attach_to_rtt};
use probe_rs::{Core, Permissions};
use std::time::Duration;

/// A board, and the channel to read.
#[derive(Clone, Debug)]
pub struct Board {
    /// The chip, as probe-rs calls it: `STM32F405RG`, `RP2040`.
    pub chip: String,
    /// The debug probe, where there are several: `VENDOR:PRODUCT[:SERIAL]`.
    pub probe: Option<String>,
    /// Number of the board's channel, from 0.
    pub channel: usize,
    /// Address of the control block; all RAM is searched unless given.
    pub address: Option<u64>,
}

/// Finds chip, probe and channel, and hands the channel over.
///
/// # Errors
/// Returns an error if the probe, the board or the channel is missing, or an access to it fails.
pub fn with_channel(
    board: &Board,
    use_it: impl FnOnce(&mut dyn Channel) -> Result<()>,
) -> Result<()> {
    /// A board that has just started sets up its channels first.
    const PATIENCE: Duration = Duration::from_secs(2);
    let Board { chip, probe, channel: number, address } = board;
    let target = Registry::from_builtin_families()
        .get_target_by_name(chip)
        .with_context(|| format!("`chip` {chip}"))?;
    let selector = probe
        .as_deref()
        .map(|text| text.parse::<DebugProbeSelector>().with_context(|| format!("`probe` {text}")));
    let probes = Lister::new().list(selector.transpose()?.as_ref());
    let probe = match probes.as_slice() {
        [] => bail!("no debug probe found{}", hint()),
        [one] => one,
        several => {
            let names: Vec<String> =
                several.iter().map(|probe| DebugProbeSelector::from(probe).to_string()).collect();
            bail!("{} debug probes found; `probe` says which: {}", names.len(), names.join(", "))
        }
    };
    let probe = probe.open().with_context(|| format!("{probe}"))?;
    let mut session = probe
        .attach(target, Permissions::default())
        .with_context(|| format!("the probe does not reach the {chip}"))?;
    let mut core = session.core(0)?;
    let region = address.map_or(ScanRegion::Ram, ScanRegion::Exact);
    let mut rtt = try_attach_to_rtt(&mut core, PATIENCE, &region)
        .context("the board has no RTT, or it is not set up yet")?;
    if rtt.up_channel(*number).is_none() {
        let count = rtt.up_channels().len();
        bail!("`channel` {number}: the board has {count}, numbered from 0");
    }
    use_it(&mut Probed { core, rtt, number: *number })
}

/// A hint on what may keep a probe from being found.
fn hint() -> &'static str {
    if cfg!(target_os = "linux") {
        "; is it plugged in, and may this user open it (udev rules of probe-rs)? CMSIS-DAP version 1 is not supported"
    } else {
        "; is it plugged in? CMSIS-DAP version 1 is not supported"
    }
}

/// A channel of a board that runs on.
struct Probed<'a> {
    core: Core<'a>,
    rtt: Rtt,
    number: usize,
}

impl Channel for Probed<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        let channel = self.rtt.up_channel(self.number).ok_or_else(|| anyhow!("it is gone"))?;
        Ok(channel.read(&mut self.core, buffer)?)
    }
}
