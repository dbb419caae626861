//! The network as Rust: constant data for `spikewire::chip`.

use super::super::chip::{Told, list};
use super::Quantised;
use spikewire::chip::{Describe, TinyOdinNeuron};
use std::fmt::Write;

/// A file of Rust, which compiles without `std` beside the crate's feature `embedded-hal`.
pub(super) fn emit(network: &Quantised, told: &Told) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write(&mut text, network, told);
    text
}

fn write(text: &mut String, network: &Quantised, told: &Told) -> std::fmt::Result {
    let (count, inputs) = (network.neurons(), network.inputs());
    let outputs = (0..count).filter(|&neuron| network.output(neuron as u8).is_some());
    let outputs: Vec<u16> = outputs.collect();
    let names =
        network.layers.iter().map(|layer| format!("{} ({})", layer.neurons.len(), layer.name));
    let names = names.collect::<Vec<_>>().join(", ");
    let every = network.steps_a_leak;

    writeln!(text, "//! {}, brought onto tinyODIN by `spikewire network`.", told.source)?;
    writeln!(text)?;
    writeln!(text, "use core::num::NonZeroU32;")?;
    writeln!(text, "use spikewire::chip::{{Inputs, TinyOdinNetwork, TinyOdinNeuron}};")?;
    if network.has_bias {
        writeln!(text, "\n/// The input that every step must be told, before its others.")?;
        writeln!(text, "pub const BIAS: u16 = {};", inputs - 1)?;
    }
    let micros =
        told.step_us.map(|step| format!(", {:.0} µs in the recording", step * every as f64));
    let micros = micros.unwrap_or_default();
    let idle = if network.leaks() { "" } else { " No neuron leaks: none need be sent." };
    writeln!(text, "\n/// Steps from one leak of all neurons to the next{micros}.{idle}")?;
    writeln!(text, "pub const STEPS_A_LEAK: NonZeroU32 = NonZeroU32::new({every}).unwrap();")?;
    writeln!(text, "\n/// Layers of {names}. Inputs: {}.", told.inputs)?;
    writeln!(text, "#[rustfmt::skip]")?;
    writeln!(
        text,
        "pub static NETWORK: TinyOdinNetwork<{inputs}, {count}, {}> = TinyOdinNetwork {{",
        outputs.len()
    )?;
    writeln!(text, "    neurons: [")?;
    for neuron in 0..count {
        let TinyOdinNeuron { threshold, leak, .. } = network.neuron(neuron as u8);
        writeln!(
            text,
            "        TinyOdinNeuron {{ threshold: {threshold}, leak: {leak}, ..TinyOdinNeuron::REST }},"
        )?;
    }
    writeln!(text, "    ],")?;
    writeln!(text, "    inputs: Inputs::Rows([")?;
    for input in 0..inputs {
        let row = (0..count).map(|post| network.input_weight(input, post as u8));
        writeln!(text, "        [{}],", list(row))?;
    }
    writeln!(text, "    ]),")?;
    let recurrent = if network.is_recurrent() { count } else { 0 };
    writeln!(text, "    recurrent: &[")?;
    for pre in 0..recurrent {
        let row = (0..count).map(|post| network.weight(pre as u8, post as u8));
        writeln!(text, "        [{}],", list(row))?;
    }
    writeln!(text, "    ],")?;
    writeln!(text, "    outputs: [{}],", list(outputs.into_iter()))?;
    writeln!(text, "}};")
}
