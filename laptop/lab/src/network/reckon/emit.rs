//! Writes the network as Rust: constant data for `spikewire_chips`.

use super::super::chip::{Remarks, lines, list};
use super::Quantised;
use super::quantise::FIRED;
use spikewire_chips::{DescribeReckOn, ReckOnPair, ReckOnShared};

pub(super) fn emit(network: &Quantised, remarks: &Remarks) -> String {
    let (inputs, count, outputs) = (network.inputs(), network.neurons(), network.outputs());
    let (source, meaning, micros) = (&remarks.source, &remarks.inputs, remarks.micros(1));
    let layers = list(network.layers.iter().map(|(name, neurons)| format!("{neurons} ({name})")));
    let bias = network.bias.map_or(String::new(), |bias| {
        format!(
            "\n/// The input that every step must be told, beside its others.\npub const BIAS: u8 = {bias};\n"
        )
    });
    let answer = match network.unit {
        Some(unit) => format!(
            "/// What 1 in an answer stands for in the units of the training.\npub const UNIT: f32 = {:?};",
            unit as f32
        ),
        None => format!(
            "/// The bit of an answer that says whether the output's neuron fired; each lower one is a step older.
pub const FIRED: u32 = {FIRED};"
        ),
    };
    let late = network.late();
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

use spikewire_chips::{{ReckOnNetwork, ReckOnPair, ReckOnShared}};
{bias}
/// Steps from inputs to the answer that shows what they did; a step is a tick{micros}.
pub const LATE: usize = {late};

{answer}

/// Layers of {layers}; {outputs} outputs. Inputs: {meaning}.
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
