//! Writes a network for `ReckOn` as Rust source: constant data for `spikewire_chips`.

use super::super::chip::{Remarks, lines, list};
use super::Quantised;
use super::quantise::{FIRED, Tick};
use spikewire_chips::{DescribeReckOn, ReckOnPair, ReckOnShared};

pub(super) fn emit(network: &Quantised, remarks: &Remarks) -> String {
    let (inputs, count, outputs) = (network.inputs(), network.neurons(), network.outputs());
    let (source, meaning, micros) = (&remarks.source, &remarks.inputs, remarks.micros(1));
    let layers = list(network.layers.iter().map(|(name, neurons)| format!("{neurons} ({name})")));
    let ticks = network.ticks.len();
    let gates = |which: fn(&Tick) -> &Vec<usize>| {
        list(network.ticks.iter().map(|tick| format!("&[{}]", list(which(tick).iter()))))
    };
    let bias = match &network.ticks[..] {
        [tick] => tick.always.first().map_or(String::new(), |bias| {
            format!(
                "\n/// The input that carries the bias: it must fire in every step, like the other inputs.\npub const BIAS: u8 = {bias};\n"
            )
        }),
        _ => format!(
            "
/// Number of ticks in a step. The network's own inputs fire before the first tick of a step.
pub const TICKS: usize = {ticks};

/// For each tick of a step, the additional inputs that fire before this tick. Some are biases. The others are gates,
/// which lower the potentials of neurons so that the neurons do not fire at some ticks.
pub static ALWAYS: [&[u8]; TICKS] = [{}];

/// For each tick of a step, the gates that fire before this tick and raise the lowered neurons again. In the first step
/// of a run, only the gates of the last tick fire.
pub static RAISES: [&[u8]; TICKS] = [{}];
",
            gates(|tick| &tick.always),
            gates(|tick| &tick.raises)
        ),
    };
    let age = if ticks == 1 { "a step" } else { "a tick" };
    let answer = match network.unit {
        Some(unit) => format!(
            "/// The value of 1 in an answer, in the units of the trained network.\npub const UNIT: f32 = {:?};",
            unit as f32
        ),
        None => format!(
            "/// The bit of an answer that says whether the output's neuron fired; each lower bit is {age} older.
pub const FIRED: u32 = {FIRED};"
        ),
    };
    let late = network.late();
    let (unit, step) = match ticks {
        1 => ("steps", "A step is a tick"),
        _ => ("ticks", "A step has `TICKS` ticks"),
    };
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
/// Delay of the chip's answers, in {unit}. An answer shows the effect of the inputs sent `LATE` {unit} earlier.
/// {step}{micros}.
pub const LATE: usize = {late};

{answer}

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
