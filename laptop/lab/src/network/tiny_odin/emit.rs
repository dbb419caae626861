//! Writes a network for tinyODIN as Rust source: constant data for `spikewire_chips`.

use super::super::chip::{Remarks, lines, list};
use super::Quantised;
use spikewire_chips::{Describe, TinyOdinNeuron};

/// Returns Rust source that defines the network. The source compiles without `std` if `spikewire-chips` has its feature
/// `embedded-hal`.
pub(super) fn emit(network: &Quantised, remarks: &Remarks) -> String {
    let (count, inputs) = (network.neurons(), network.inputs());
    let outputs = (0..count).filter(|&neuron| network.output(neuron as u8).is_some());
    let outputs: Vec<u16> = outputs.collect();
    let (source, meaning, every) = (&remarks.source, &remarks.inputs, network.steps_a_leak);
    let layers = list(
        network.layers.iter().map(|layer| format!("{} ({})", layer.neurons.len(), layer.name)),
    );
    let bias = if network.has_bias {
        format!(
            "\n/// The input that carries the bias: it must fire in every step, before the other inputs.\npub const BIAS: u16 = {};\n",
            inputs - 1
        )
    } else {
        String::new()
    };
    let micros = remarks.micros(every);
    let idle =
        if network.leaks() { "" } else { " No neuron leaks, so that no leaks need be sent." };
    let neurons = lines((0..count).map(|neuron| {
        let TinyOdinNeuron { threshold, leak, .. } = network.neuron(neuron as u8);
        format!("TinyOdinNeuron {{ threshold: {threshold}, leak: {leak}, ..TinyOdinNeuron::REST }}")
    }));
    let row = |weight: &dyn Fn(u8) -> i8| {
        format!("[{}]", list((0..count).map(|post| weight(post as u8))))
    };
    let rows = lines((0..inputs).map(|input| row(&|post| network.input_weight(input, post))));
    let senders = if network.is_recurrent() { count } else { 0 };
    let recurrent = lines((0..senders).map(|pre| row(&|post| network.weight(pre as u8, post))));
    let (readable, places) = (outputs.len(), list(outputs.iter()));
    format!(
        "//! {source}, brought onto tinyODIN by `spikewire network`.

use core::num::NonZeroU32;
use spikewire_chips::{{Inputs, TinyOdinNetwork, TinyOdinNeuron}};
{bias}
/// Number of steps between two leaks of all neurons{micros}.{idle}
pub const STEPS_A_LEAK: NonZeroU32 = NonZeroU32::new({every}).unwrap();

/// Neurons in each layer: {layers}. Inputs: {meaning}.
#[rustfmt::skip]
pub static NETWORK: TinyOdinNetwork<{inputs}, {count}, {readable}> = TinyOdinNetwork {{
    neurons: [
{neurons}    ],
    inputs: Inputs::Rows([
{rows}    ]),
    recurrent: &[
{recurrent}    ],
    outputs: [{places}],
}};
"
    )
}
