//! Writes a network for `ReckOn` as Rust source: constant data for `spikewire_chips`.

use super::super::chip::{Remarks, lines, list};
use super::Quantised;
use super::quantise::Tick;
use spikewire_chips::{DescribeReckOn, ReckOnPair, ReckOnShared, ReckOnSteps};

pub(super) fn emit(network: &Quantised, remarks: &Remarks) -> String {
    let (inputs, count, outputs) = (network.inputs(), network.neurons(), network.outputs());
    let (source, meaning, micros) = (&remarks.source, &remarks.inputs, remarks.micros(1));
    let layers = list(network.layers.iter().map(|(name, neurons)| format!("{neurons} ({name})")));
    let ticks = network.ticks.iter().map(|Tick { always, raises }| {
        format!(
            "ReckOnTick {{ always: &[{}], raises: &[{}] }}",
            list(always.iter()),
            list(raises.iter())
        )
    });
    let ticks = lines(ticks);
    let ReckOnSteps { inputs: own, late, outputs: shown, .. } = network.steps(&[]);
    let shown = format!("{shown:?}").replace('[', "&[");
    let pairs = lines(network.pairs.iter().map(|ReckOnPair { keep, threshold }| {
        format!("ReckOnPair {{ keep: {keep}, threshold: {threshold} }}")
    }));
    let rows = |rows: &[Vec<i8>]| lines(rows.iter().map(|row| format!("[{}]", list(row.iter()))));
    let is_recurrent = network.recurrent.iter().flatten().any(|weight| *weight != 0);
    let recurrent = rows(if is_recurrent { &network.recurrent } else { &[] });
    let (of_inputs, of_outputs) = (rows(&network.inputs), rows(&network.outputs));
    let ReckOnShared { shifts, keep, resets_to_zero } = network.shared;
    format!(
        "//! {source}, brought onto ReckOn by `spikewire network`.

use spikewire_chips::{{
    ReckOnNetwork, ReckOnOutputs, ReckOnPair, ReckOnShared, ReckOnSteps, ReckOnTick,
}};

/// A time step{micros}.
#[rustfmt::skip]
pub const STEPS: ReckOnSteps<'static> = ReckOnSteps {{
    inputs: {own},
    ticks: &[
{ticks}    ],
    late: {late},
    outputs: ReckOnOutputs::{shown},
}};

/// Neurons in each layer: {layers}; {outputs} outputs. Inputs: {meaning}.
#[rustfmt::skip]
pub static NETWORK: ReckOnNetwork<{inputs}, {count}, {outputs}> = ReckOnNetwork {{
    pairs: &[
{pairs}    ],
    inputs: [
{of_inputs}    ],
    recurrent: &[
{recurrent}    ],
    outputs: [
{of_outputs}    ],
    shared: ReckOnShared {{ shifts: {shifts:?}, keep: {keep}, resets_to_zero: {resets_to_zero} }},
}};
"
    )
}
