//! Writes a network for the flight controller as Rust source: constant data for `spikewire-network`.

use super::super::Trains;
use super::super::chip::{Remarks, list};
use super::net::{Layer, Net, Neuron, Recurrent};
use super::number::Number;
use super::rule::{Current, Fires, Reset, Rule};
use std::collections::BTreeSet;
use std::fmt::Write;

/// A number type of the controller whose numbers can be written as Rust source.
pub(super) trait Spelled: Number {
    /// Name of the number type in generated source.
    const TYPE: &'static str;
    /// Name of the function that constructs a neuron of this number type.
    const NEW: &'static str;

    fn spell(self) -> String;
    fn spell_factor(factor: Self::Factor) -> String;
    /// Returns the bits of a number, as `spikewire-network` adds them to a checksum.
    fn word(self) -> u32;
    /// Returns the bits of a decay.
    fn word_of_factor(factor: Self::Factor) -> u32;
    /// Returns the words of rows of weights and of their shift.
    fn words_of_weights(rows: &[&[Self]], shift: u32) -> Vec<u32>;
    /// Returns the next smaller number.
    fn below(self) -> Self;
    /// Returns the Rust source that constructs a matrix of weights with these rows. The source holds integer weights
    /// without their `shift` low bits, which are 0.
    fn spell_weights(rows: &[&[Self]], shift: u32) -> String;
}

impl Spelled for f32 {
    const TYPE: &'static str = "f32";
    const NEW: &'static str = "new";

    fn spell(self) -> String {
        // `{:?}` prints the shortest digits that parse to the same number, and always a decimal point or exponent.
        format!("{self:?}")
    }

    fn spell_factor(factor: Self) -> String {
        factor.spell()
    }

    fn word(self) -> u32 {
        self.to_bits()
    }

    fn word_of_factor(factor: Self) -> u32 {
        factor.to_bits()
    }

    fn words_of_weights(rows: &[&[Self]], _: u32) -> Vec<u32> {
        rows.iter().flat_map(|row| row.iter()).map(|weight| weight.to_bits()).collect()
    }

    fn below(self) -> Self {
        self.next_down()
    }

    fn spell_weights(rows: &[&[Self]], _: u32) -> String {
        format!("Weights::new(&[\n{}])", spell_rows(rows, Spelled::spell))
    }
}

impl Spelled for i32 {
    const TYPE: &'static str = "i32";
    const NEW: &'static str = "integer";

    fn spell(self) -> String {
        self.to_string()
    }

    fn spell_factor(factor: u32) -> String {
        factor.to_string()
    }

    fn word(self) -> u32 {
        self.cast_unsigned()
    }

    fn word_of_factor(factor: u32) -> u32 {
        factor
    }

    fn words_of_weights(rows: &[&[Self]], shift: u32) -> Vec<u32> {
        // In flash a weight is a byte that is 128 above it.
        let bytes = rows.iter().flat_map(|row| row.iter()).map(|weight| (weight >> shift) + 128);
        bytes.map(i32::cast_unsigned).chain([1 << shift]).collect()
    }

    fn below(self) -> Self {
        self.saturating_sub(1)
    }

    fn spell_weights(rows: &[&[Self]], shift: u32) -> String {
        let rows = spell_rows(rows, |weight| (weight >> shift).to_string());
        format!("Weights::packed(&[\n{rows}], {shift})")
    }
}

fn spell_rows<K: Copy>(rows: &[&[K]], spell: impl Fn(K) -> String) -> String {
    let mut text = String::new();
    for row in rows {
        _ = writeln!(text, "    [{}],", list(row.iter().map(|&weight| spell(weight))));
    }
    text
}

/// Returns the Rust source of a module that defines the network. For integers, `shifts` are the left shifts of the
/// layers' weights. For each output, `units` contains the value of an integer potential of 1, in the units of the
/// trained network. Both lists are empty for floating point. `check` contains the input spikes of the self-test.
pub(super) fn emit<K: Spelled>(
    net: &Net<K>,
    shifts: &[u32],
    units: &[f64],
    check: &Trains,
    remarks: &Remarks,
) -> String {
    let mut body = String::new();
    for (number, layer) in (1..).zip(&net.layers) {
        let shift = shifts.get(number - 1).copied().unwrap_or(0);
        body += &statics(layer, number, shift);
    }
    body += &network(net);
    if !units.is_empty() {
        let units = list(units.iter().map(|unit| format!("{:?}", *unit as f32)));
        let count = net.layers.last().map_or(0, |layer| layer.neurons.len());
        _ = write!(
            body,
            "\n/// For each output, the value of a potential of 1, in the units of the trained network.\npub const UNITS: [f32; {count}] = [{units}];\n"
        );
    }
    body += &checked(net, shifts, check);
    let Remarks { source, inputs, step_us } = remarks;
    let every = step_us.map_or(String::new(), |step| format!(" A step: {step} µs."));
    let words: BTreeSet<&str> = body.split(|c: char| !c.is_alphanumeric()).collect();
    let used = list(NAMES.iter().filter(|name| words.contains(*name)));
    format!(
        "//! {source} for the flight controller, written by `spikewire network --on controller`.
//!
//! Inputs: {inputs}.{every}
{rules}
#![allow(clippy::all, clippy::pedantic, reason = \"written by a program\")]

use spikewire_network::{{Network, State, Weights}};
use spikewire_network::{{{used}}};
{body}",
        rules =
            net.rules().iter().flat_map(|rule| ["//! - ", rule.as_str(), "\n"]).collect::<String>(),
    )
}

/// Types and functions of `spikewire-network` that a generated module may use. The module imports only those that it
/// uses.
const NAMES: [&str; 17] = [
    "Cuba",
    "Forward",
    "Full",
    "Layer",
    "Li",
    "Lif",
    "NoReset",
    "OneToOne",
    "Spiking",
    "Subtract",
    "SubtractLate",
    "SubtractNoDelay",
    "Then",
    "ToValue",
    "ToValueHeld",
    "ToValueLate",
    "Values",
];

/// Returns the Rust source that defines a layer's weights, neurons and type.
fn statics<K: Spelled>(layer: &Layer<K>, number: usize, shift: u32) -> String {
    let Layer { name, weights, own, neurons, rule } = layer;
    let (inputs, count, numbers) = (weights.len(), neurons.len(), K::TYPE);
    let rows: Vec<&[K]> = weights.iter().map(Vec::as_slice).collect();
    let kind = kind(&neurons[0], rule);
    let mut text = format!(
        "\n/// {name}: weights by input, then neuron.
#[rustfmt::skip]
static WEIGHTS_{number}: Weights<{numbers}, {inputs}, {count}> = {};
",
        K::spell_weights(&rows, shift)
    );
    let rows: Vec<&[K]> = match own {
        Recurrent::None => vec![],
        Recurrent::Full(rows) => rows.iter().map(Vec::as_slice).collect(),
        Recurrent::OneToOne(own) => vec![own],
    };
    if !rows.is_empty() {
        _ = write!(
            text,
            "\n/// {name}: weights of its own spikes of the step before.
#[rustfmt::skip]
static OWN_{number}: Weights<{numbers}, {}, {count}> = {};
",
            rows.len(),
            K::spell_weights(&rows, shift)
        );
    }
    let spelled = if neurons.iter().all(|neuron| *neuron == neurons[0]) {
        format!("[{}; {count}]", neuron(&neurons[0], rule))
    } else {
        let lines = neurons.iter().map(|one| format!("    {},\n", neuron(one, rule)));
        format!("[\n{}]", lines.collect::<String>())
    };
    let recurrence = match own {
        Recurrent::None => "Forward".to_owned(),
        Recurrent::Full(_) => format!("Full<'static, {numbers}, {count}>"),
        Recurrent::OneToOne(_) => format!("OneToOne<'static, {numbers}, {count}>"),
    };
    _ = write!(
        text,
        "\n#[rustfmt::skip]
static NEURONS_{number}: [{kind}; {count}] = {spelled};

type Layer{number} = Layer<'static, {kind}, {inputs}, {count}, Spiking, {recurrence}>;
"
    );
    text
}

/// Returns a neuron's type as Rust source, such as `Lif<f32, ToValue>`.
fn kind<K: Spelled>(neuron: &Neuron<K>, rule: &Rule) -> String {
    let (numbers, reset) = (K::TYPE, rule.reset.type_name());
    let inner = match neuron.spike {
        Some(_) => format!("Lif<{numbers}, {reset}>"),
        None => format!("Li<{numbers}>"),
    };
    match (neuron.current, rule.current) {
        (None, _) => inner,
        (Some(_), Current::Old) => format!("Cuba<{numbers}, {inner}, true>"),
        (Some(_), _) => format!("Cuba<{numbers}, {inner}>"),
    }
}

/// Returns the Rust source that constructs a neuron.
fn neuron<K: Spelled>(neuron: &Neuron<K>, rule: &Rule) -> String {
    let (numbers, new, zero) = (K::TYPE, K::NEW, K::default());
    let decay = K::spell_factor(neuron.decay);
    let bias = |bias: K| {
        if bias == zero { String::new() } else { format!(".with_bias({})", bias.spell()) }
    };
    let mut text = match neuron.spike {
        None => format!("Li::<{numbers}>::{new}({decay})"),
        Some(spike) => {
            let reset = rule.reset.type_name();
            let threshold = spike.threshold.spell();
            let mut text = format!("Lif::<{numbers}, {reset}>::{new}({decay}, {threshold})");
            // Norse's neurons that start above 0 fire that much lower, and still subtract the whole threshold.
            let by_default = if rule.reset.subtracts() { spike.threshold } else { zero };
            if rule.reset != Reset::NoReset && spike.reset != by_default {
                _ = write!(text, ".with_reset({})", spike.reset.spell());
            }
            if rule.fires == Fires::At {
                text += ".at_threshold()";
            }
            text
        }
    };
    if let Some(current) = neuron.current {
        let (current, inner) = (K::spell_factor(current), bias(neuron.inner));
        text = format!("Cuba::<{numbers}, _>::{new}({current}, {text}{inner})");
    }
    text += &bias(neuron.bias);
    if neuron.current.is_some() && rule.current == Current::Old {
        text += ".from_old_current()";
    }
    text
}

/// Returns the Rust source that defines the network's type, `Trained`, and the network itself, `NETWORK`.
fn network<K: Spelled>(net: &Net<K>) -> String {
    let (mut kind, mut value) = (String::new(), String::new());
    for (number, layer) in (1..).zip(&net.layers) {
        let own = match layer.own {
            Recurrent::None => String::new(),
            Recurrent::Full(_) => format!(".recurrent(Full(&OWN_{number}))"),
            Recurrent::OneToOne(_) => format!(".recurrent(OneToOne(&OWN_{number}))"),
        };
        let one = format!("Layer::new(&WEIGHTS_{number}, &NEURONS_{number}){own}");
        if number == 1 {
            (kind, value) = ("Layer1".into(), one);
        } else {
            kind = format!("Then<{kind}, Layer{number}>");
            _ = write!(value, "\n    .then({one})");
        }
    }
    format!(
        "\n/// The type of the network.
pub type Trained = {kind};

/// The network, in flash. Its state is `NETWORK.state()`.
#[rustfmt::skip]
pub static NETWORK: Trained = {value};
"
    )
}

/// Returns the checksum over words, as `spikewire-network` computes it.
fn checksum(words: impl IntoIterator<Item = u32>) -> u32 {
    let add = |sum: u32, word: u32| (sum.rotate_left(5) ^ word).wrapping_mul(0x9E37_79B1);
    words.into_iter().fold(0, add)
}

/// Returns the checksum over the weights and neurons of a layer.
fn checksum_of<K: Spelled>(layer: &Layer<K>, shift: u32) -> u32 {
    let rows: Vec<&[K]> = layer.weights.iter().map(Vec::as_slice).collect();
    let mut words = K::words_of_weights(&rows, shift);
    match &layer.own {
        Recurrent::None => {}
        Recurrent::Full(own) => {
            let rows: Vec<&[K]> = own.iter().map(Vec::as_slice).collect();
            words.extend(K::words_of_weights(&rows, shift));
        }
        Recurrent::OneToOne(own) => words.extend(K::words_of_weights(&[own], shift)),
    }
    // A number that equals the constructor's own value is not spelled: 0 in place of a negative 0.
    let or = |number: K, usual: K| if number == usual { usual } else { number };
    let (rule, zero) = (&layer.rule, K::default());
    for neuron in &layer.neurons {
        let mut bias = neuron.bias;
        if let Some(current) = neuron.current {
            words.extend([K::word_of_factor(current), or(bias, zero).word()]);
            bias = neuron.inner;
        }
        words.extend([K::word_of_factor(neuron.decay), or(bias, zero).word()]);
        if let Some(spike) = neuron.spike {
            let usual = if rule.reset.subtracts() { spike.threshold } else { zero };
            let reset = if rule.reset == Reset::NoReset { usual } else { or(spike.reset, usual) };
            let is_at = rule.fires == Fires::At;
            let threshold = if is_at { spike.threshold.below() } else { spike.threshold };
            words.extend([threshold.word(), reset.word()]);
        }
    }
    checksum(words)
}

/// Returns the Rust source of the self-test before arming: a checksum, input spikes, the spikes and potentials that must
/// result, and the function `is_intact`, which runs the steps and compares the results.
fn checked<K: Spelled>(net: &Net<K>, shifts: &[u32], inputs: &Trains) -> String {
    let sums = net.layers.iter().enumerate();
    let sums = sums.map(|(at, layer)| checksum_of(layer, shifts.get(at).copied().unwrap_or(0)));
    // A chain adds up the checksums of its two parts, as it nests them.
    let sum = sums.reduce(|first, next| checksum([first, next])).unwrap_or(0);
    let done = net.run(inputs);
    let (steps, layers) = (inputs.len(), net.layers.len());
    let spikes = |fired: &[u16]| format!("&[{}]", list(fired.iter()));
    let mut rows = String::new();
    for (step, inputs) in inputs.iter().enumerate() {
        let fired = list(done.fired.iter().map(|layer| spikes(&layer[step])));
        _ = writeln!(rows, "    ({}, [{fired}]),", spikes(inputs));
    }
    let last = list(done.potentials.last().into_iter().flatten().map(|v| v.spell()));
    let outputs = net.layers.last().map_or(0, |layer| layer.neurons.len());
    // The state of a chain of type `Then<Then<A, B>, C>` nests the layers as `first.first`, `first.next` and `next`.
    let path = |layer: usize| {
        let firsts = ".first".repeat(layers - 1 - layer.max(1).min(layers - 1));
        match (layers, layer) {
            (1, _) => String::new(),
            (_, 0) => format!("{firsts}.first"),
            _ => format!("{firsts}.next"),
        }
    };
    let names = list((1..=layers).map(|layer| format!("fired_{layer}")));
    let compared =
        (0..layers).map(|layer| format!("state{}.spikes() == *fired_{}", path(layer), layer + 1));
    let compared = compared.collect::<Vec<_>>().join("\n            && ");
    let numbers = K::TYPE;
    format!(
        "\n/// Checksum over the weights and neurons.
pub const CHECKSUM: u32 = {sum:#010x};

/// Steps from rest: for each step, the inputs that fire, and the neurons of each layer that must then fire.
#[rustfmt::skip]
static STEPS: [(&[u16], [&[u16]; {layers}]); {steps}] = [
{rows}];

/// The outputs' potentials after the last step of `STEPS`.
#[rustfmt::skip]
static POTENTIALS: [{numbers}; {outputs}] = [{last}];

/// Returns whether weights and neurons have their checksum, and {steps} steps, in which every input fires, give the known
/// spikes and potentials, bit by bit. If not, the flash, the compiler or the core has altered the network: do not arm.
pub fn is_intact() -> bool {{
    if NETWORK.checksum() != CHECKSUM {{
        return false;
    }}
    let mut state = NETWORK.state();
    let spikes_are = STEPS.iter().all(|(inputs, [{names}])| {{
        NETWORK.step(&mut state, inputs);
        {compared}
    }});
    spikes_are && state.values() == POTENTIALS
}}
"
    )
}
