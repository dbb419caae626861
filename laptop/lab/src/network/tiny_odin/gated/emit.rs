//! Writes Rust source for a network whose neurons compare their potentials with their thresholds once a step. The
//! source is constant data for `spikewire_chips`.

use super::super::super::chip::{Remarks, lines, list};
use super::Gated;
use spikewire_chips::{Describe, Steps, StepsLayer, TinyOdinNeuron};

/// Returns Rust source that defines the network and the sequence of events in its steps. The source compiles without
/// `std`.
pub(super) fn emit(network: &Gated, remarks: &Remarks) -> String {
    let (source, meaning) = (&remarks.source, &remarks.inputs);
    let (count, rows) = (network.neurons(), network.inputs());
    let layers = list(
        network.layers.iter().map(|layer| format!("{} ({})", layer.neurons.len(), layer.name)),
    );
    let outputs = (0..count).filter(|&neuron| network.output(neuron as u8).is_some());
    let outputs: Vec<u16> = outputs.collect();
    let neurons = lines((0..count).map(|neuron| {
        let TinyOdinNeuron { threshold, leak, potential, .. } = network.neuron(neuron as u8);
        format!("TinyOdinNeuron {{ threshold: {threshold}, leak: {leak}, potential: {potential}, is_disabled: false }}")
    }));
    let row =
        |row| format!("[{}]", list((0..count).map(|post| network.input_weight(row, post as u8))));
    let weights = lines((0..rows).map(row));
    let (readable, places) = (outputs.len(), list(outputs.iter()));
    let witness = if network.has_witness() { "; then the witness" } else { "" };
    let steps = network.with_steps(steps);
    format!(
        "//! {source}, brought onto tinyODIN by `spikewire network`.

use spikewire_chips::{{Inputs, Steps, StepsLayer, TinyOdinNetwork, TinyOdinNeuron}};

/// The sequence of events in each step of the network, for `Running::step`. Inputs: {meaning}.
#[rustfmt::skip]
pub static STEPS: Steps = {steps};

/// Neurons in each layer: {layers}{witness}. The field `inputs` contains the rows of synapses that `STEPS` uses.
#[rustfmt::skip]
pub static NETWORK: TinyOdinNetwork<{rows}, {count}, {readable}> = TinyOdinNetwork {{
    neurons: [
{neurons}    ],
    inputs: Inputs::Rows([
{weights}    ]),
    recurrent: &[],
    outputs: [{places}],
}};
"
    )
}

fn steps(steps: &Steps) -> String {
    let &Steps { inputs, has_bias, rows, layers, rungs, leaks, lift, own_leaks } = steps;
    let layers = list(layers.iter().map(|StepsLayer { neurons, loops }| {
        format!("StepsLayer {{ neurons: {neurons}, loops: {loops} }}")
    }));
    let rows = list(rows.iter());
    let leaks = list(leaks.iter().map(|turn| format!("&[{}]", list(turn.iter()))));
    let own_leaks = list(own_leaks.iter());
    format!(
        "Steps {{
    inputs: {inputs},
    has_bias: {has_bias},
    rows: &[{rows}],
    layers: &[{layers}],
    rungs: {rungs},
    leaks: &[{leaks}],
    lift: {lift},
    own_leaks: &[{own_leaks}],
}}"
    )
}
