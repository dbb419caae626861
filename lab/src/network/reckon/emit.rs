//! The network as Rust: constant data for `spikewire::chip`.

use super::super::chip::{Told, list};
use super::Quantised;
use super::quantise::FIRED;
use spikewire::chip::{DescribeReckOn, ReckOnPair, ReckOnShared};
use std::fmt::Write;

pub(super) fn emit(network: &Quantised, told: &Told) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write(&mut text, network, told);
    text
}

fn write(text: &mut String, network: &Quantised, told: &Told) -> std::fmt::Result {
    let (inputs, count, outputs) = (network.inputs(), network.neurons(), network.outputs());
    let layers = network.layers.iter().map(|(name, neurons)| format!("{neurons} ({name})"));
    let layers = layers.collect::<Vec<_>>().join(", ");
    let micros = told.step_us.map(|step| format!(", {step:.0} µs in the recording"));
    let micros = micros.unwrap_or_default();

    writeln!(text, "//! {}, brought onto ReckOn by `spikewire network`.", told.source)?;
    writeln!(text)?;
    writeln!(text, "use spikewire::chip::{{ReckOnNetwork, ReckOnPair, ReckOnShared}};")?;
    if let Some(bias) = network.bias {
        writeln!(text, "\n/// The input that every step must be told, beside its others.")?;
        writeln!(text, "pub const BIAS: u8 = {bias};")?;
    }
    writeln!(
        text,
        "\n/// Steps from inputs to the answer that shows what they did; a step is a tick{micros}."
    )?;
    writeln!(text, "pub const LATE: usize = {};", network.late())?;
    if let Some(unit) = network.unit {
        writeln!(text, "\n/// What 1 in an answer stands for in the units of the training.")?;
        writeln!(text, "pub const UNIT: f32 = {:?};", unit as f32)?;
    } else {
        writeln!(
            text,
            "\n/// The bit of an answer that says whether the output's neuron fired; each lower one is a step older."
        )?;
        writeln!(text, "pub const FIRED: u32 = {FIRED};")?;
    }
    writeln!(text, "\n/// Layers of {layers}; {outputs} outputs. Inputs: {}.", told.inputs)?;
    writeln!(text, "#[rustfmt::skip]")?;
    writeln!(
        text,
        "pub static NETWORK: ReckOnNetwork<{inputs}, {count}, {outputs}> = ReckOnNetwork {{"
    )?;
    writeln!(text, "    pairs: &[")?;
    for ReckOnPair { keep, threshold } in &network.pairs {
        writeln!(text, "        ReckOnPair {{ keep: {keep}, threshold: {threshold} }},")?;
    }
    writeln!(text, "    ],")?;
    rows(text, "inputs: [", &network.inputs, "]")?;
    let is_recurrent = network.recurrent.iter().flatten().any(|weight| *weight != 0);
    rows(text, "recurrent: &[", if is_recurrent { &network.recurrent } else { &[] }, "]")?;
    rows(text, "outputs: [", &network.outputs, "]")?;
    let ReckOnShared { shifts, keep, resets_to_zero } = network.shared;
    writeln!(
        text,
        "    shared: ReckOnShared {{ shifts: {shifts:?}, keep: {keep}, resets_to_zero: {resets_to_zero} }},"
    )?;
    writeln!(text, "}};")
}

fn rows(text: &mut String, open: &str, rows: &[Vec<i8>], close: &str) -> std::fmt::Result {
    writeln!(text, "    {open}")?;
    for row in rows {
        writeln!(text, "        [{}],", list(row.iter()))?;
    }
    writeln!(text, "    {close},")
}
