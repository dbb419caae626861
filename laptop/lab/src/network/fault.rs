//! The reasons for which a network cannot be read, or cannot be brought onto a chip or the controller.

use super::controller::{Asked, Choice, Framework};
use crate::error::{At, room};
use crate::{Error, Place, Spot};
use catalogue::kinds;
use hdf5_reader::error::Error as Hdf5Error;
use spikewire_chips::ReckOnAnswer;

pub(super) use crate::Result;

kinds! {
    /// The reason for which a network is refused. Also covers refused settings of a network, and refused spikes that
    /// are given with it. Reasons that concern a single layer are in `LayerKind`.
    pub enum NetworkKind by spell of subject {
        OpenRule { framework: Option<Framework>, open: Vec<Choice> } => (
            "the file does not say by which rule its neurons step: {}",
            super::controller::words(spell, *framework, open)
        ),
        NoRule { nearest: Box<Asked>, step: usize, steps: usize } => (
            "no rule gives the recorded outputs: with {}, the nearest, they part in step {step} of {steps}; the outputs may be \
             those of another network, another input or another {}",
            nearest.settings(spell),
            spell("dt")
        ),
        OtherRule { fits: Box<Asked> } => (
            "by the rule that was asked for the network does not give the recorded outputs; it gives all of them by {}",
            fits.settings(spell)
        ),
        SeveralRules { rules: Vec<Asked>, steps: usize } => (
            "{} rules give the recorded outputs in all {steps} steps: a recording with more spikes would tell them apart; say \
             which:\n  {}",
            rules.len(),
            rules.iter().map(|rule| rule.settings(spell)).collect::<Vec<_>>().join("\n  ")
        ),
        NoNetwork => (
            "no network: it is neither a NIR graph (HDF5) nor JSON, and its name does not end in .toml"
        ),
        NotToml { error: toml::de::Error } => ("no network in TOML: {error}"),
        HasRule => (
            "a network in TOML holds the rule by which its neurons step: leave out {}, {} and the like",
            spell("as"),
            spell("reset")
        ),
        NotAnInput { word: String } => ("`{word}` is not the number of an input"),
        NoInputs { inputs: usize, step: Vec<u16> } =>
            ("the network has {inputs} inputs, and not those of {step:?}"),
        ShorterThanStep { tau: f64, step: f64 } => (
            "a time constant of {tau:e} s is shorter than a step of {step} s; {} gives the step that the network was \
             trained with",
            spell("dt")
        ),
        NorsesTime { tau: f64, step: f64, meant: f64 } => (
            "a time constant of {tau:e} s is shorter than a step of {step} s; Norse writes time constants times the dt \
             that it was called with (0.001 unless told): if that was {step} s, they are right with {} {meant}",
            spell("dt")
        ),
        NoNeurons => ("the network has no neurons"),
        NoLayers => ("the network has no layer of LIF or IF neurons"),
        TooManyLayers { layers: usize, most: usize } =>
            ("the network has {layers} layers, of which {most} at most are taken"),
        Resets { resets: usize, layers: usize } =>
            ("{resets} resets are asked for, and {layers} layers fire"),
        JsonResets { resets: usize } =>
            ("layers in JSON have one reset, and {resets} are asked for"),
        OutputSteps { given: usize, steps: usize } =>
            ("outputs of {given} steps, and the recording has {steps}"),
        SpikeOutput { step: usize, output: u16, outputs: usize } =>
            ("a spike of output {output} in step {step}, and the network has {outputs} outputs"),
        OutputsFire => ("potentials, but the network's outputs fire"),
        OutputsNeverFire => ("spikes, but the network's outputs never fire"),
        Potentials { step: usize, given: usize, outputs: usize } =>
            ("{given} potentials in step {step}, and the network has {outputs} outputs"),
    }
}
room!(NetworkKind, Network);

kinds! {
    /// The reason for which a NIR file cannot be read, or for which its graph is not supported.
    pub enum NirKind by spell of subject {
        Damaged { cause: Hdf5Error } => ("damaged: {cause}"),
        NoGraphInFile { cause: Hdf5Error } => ("an HDF5 file without a NIR graph: {cause}"),
        NoGraph { cause: Hdf5Error } => ("no NIR graph: {cause}"),
        NoNodes => ("no NIR graph"),
        TooDeep { most: usize } => ("graphs in graphs, {most} deep"),
        NotOne { kind: &'static str, found: Vec<String> } =>
            ("{} nodes are {kind}, where there must be one: {found:?}", found.len()),
        NoInput => ("no input"),
        NoType { cause: Hdf5Error } => ("no type: {cause}"),
        NoSuchNode { from: String, to: String } =>
            ("node `{from}` leads to `{to}`, which there is not"),
        LeadsBack { from: String, to: String } =>
            ("node `{from}` leads back to `{to}`: a layer may lead back to itself only"),
        NotAChain { from: String, to: Vec<String> } =>
            ("node `{from}` leads to {} nodes, {to:?}: only a chain is taken", to.len()),
        NotOnTheWay { node: String, first: String, last: String } =>
            ("node `{node}` is not on the way from `{first}` to `{last}`"),
        AfterSilent => ("it follows on neurons that never fire"),
        WeightsOnWeights => ("weights follow on weights; there must be neurons between them"),
        NoWeights => ("no weights lead to it"),
        UnknownNode => (
            "nothing here has anything like it; Linear, Affine, LIF, IF and CubaLIF are taken, and last LI, I and CubaLI"
        ),
        NotSquare { weights: String, neurons: usize } =>
            ("its recurrent weights `{weights}` are not {neurons} by {neurons}"),
        Dimensions { dimensions: usize } =>
            ("weights of {dimensions} dimensions, where there must be 2"),
        Empty { outputs: usize, inputs: usize } => ("weights of shape {outputs} x {inputs}"),
        NoArray { name: String } => ("no `{name}`"),
        ArrayType { name: String, datatype: String } =>
            ("`{name}` holds numbers of a type that is not taken: {datatype}"),
        Unread { name: String, cause: Hdf5Error } => ("`{name}` cannot be read: {cause}"),
        NotFinite { name: String, number: f64 } => ("`{name}` holds {number}{}", {
            let keeps_all = name.starts_with("tau") && number.is_infinite();
            if keeps_all {
                ", as snnTorch exports beta=1, a neuron that keeps all of its potential: export it as IF, or with a \
                 beta below 1"
            } else {
                ""
            }
        }),
    }
}
room!(NirKind, Nir);

kinds! {
    /// The reason for which the parameters of a layer are invalid.
    pub enum LayerKind by spell of subject {
        Count { values: usize, name: String, neurons: usize } =>
            ("{values} values of `{name}` for {neurons} neurons"),
        NoWeights => ("no weights"),
        Inputs { inputs: usize, before: String, neurons: usize } =>
            ("weights for {inputs} inputs, but {before} has {neurons} neurons"),
        Row { neuron: usize, weights: usize, first: usize } =>
            ("neuron {neuron} has {weights} weights where the first has {first}"),
        OutputRow { output: usize, weights: usize, neurons: usize } =>
            ("output {output} has {weights} weights, but the last layer has {neurons} neurons"),
        NotSquare { neurons: usize } => ("recurrent weights are not {neurons} by {neurons}"),
        Weight { neuron: usize, weight: f64 } => ("neuron {neuron} has a weight of {weight}"),
        OutputWeight { output: usize, weight: f64 } => ("output {output} has a weight of {weight}"),
        RecurrentWeight { weight: f64 } => ("a recurrent weight of {weight}"),
        Threshold { neuron: usize, threshold: f64 } =>
            ("neuron {neuron} fires at {threshold} above rest, which must be above 0 and finite"),
        Leak { neuron: usize, leak: f64 } =>
            ("neuron {neuron} leaks {leak} a step, which must be 0 or above"),
        Keep { neuron: usize, keep: f64 } =>
            ("neuron {neuron} keeps {keep} of its potential a step, which must lie in 0..=1"),
        OutputKeep { keep: f64 } =>
            ("an output keeps {keep} of its potential a step, which must lie in 0..=1"),
        TimeConstant { tau: f64 } => ("a time constant of {tau} s"),
    }
}
room!(LayerKind, Layer);

kinds! {
    /// The reason for which a network does not fit a chip or the controller.
    pub enum FitKind by spell of subject {
        NoReset =>
            ("the chips' neurons are reset when they fire: {} none is for the controller", spell("reset")),
        Neurons { most: usize, layer: usize, needed: usize } =>
            ("the chip has {most} neurons, and with this layer's {layer} the network needs {needed}"),
        Inputs { most: usize, inputs: usize, has_bias: bool } => (
            "the chip has {most} inputs, and the network has {inputs}{}",
            if *has_bias { ", one of them the bias" } else { "" }
        ),
        Outputs { most: usize, outputs: usize } =>
            ("the chip has {most} outputs, and the network has {outputs}"),
        Rows { most: usize, inputs: usize, has_bias: bool, senders: usize } => (
            "the chip has {most} rows of synapses, and {inputs} inputs{} with {senders} neurons that send spikes to \
             neurons need {}",
            if *has_bias { ", one of them the bias," } else { "" },
            inputs + senders
        ),
        Spikes { layer: String, inputs: usize, most: usize } => (
            "{layer} takes spikes of {inputs} inputs and own neurons, and with weights of 8 bits {most} at most; f32 has no \
             such limit"
        ),
        Size { inputs: usize, neurons: usize, most: usize } =>
            ("{inputs} inputs and {neurons} neurons, of which {most} are the most"),
        Number { number: f64 } =>
            ("a weight, bias, threshold or reset value of {number}, where 1e15 is the most"),
        MixedResets => (
            "some layers subtract their threshold and others reset to a value: ReckOn does the same in all"
        ),
        LeakByAmount { owner: &'static str } =>
            ("a leak by an amount is tinyODIN's: {owner} neurons keep a share"),
        LastingCurrent { left: f64 } => (
            "a spike's current lasts: a step leaves {left:.3} of it, and the chip's neurons have no current; train with \
             `tau_syn` of a step, or LIF"
        ),
        HalfRule => (
            "`threshold`, `reset` and `fires` go together, as do `current_keep` and `current`; `reset_value` and `recurrent` \
             need the first, `inner` the second"
        ),
        SilentInside => ("neurons that never fire must be the last"),
        NoReadout => ("tinyODIN has no outputs that never fire; ReckOn has"),
        NoRoomToCompare => (
            "the network leaves no room for comparing once a step: neurons 254 and 255 must be free, a row for each layer, \
             and two"
        ),
        LateOutputs => ("this chip's outputs come steps later: only tinyODIN answers step by step here"),
        NoBytes => ("a network on the controller is compiled in: there are no bytes to load"),
    }
}
room!(FitKind, Fit);

kinds! {
    /// The reason for which a run on a chip's model fails. The chip's driver may report an error. The model may also
    /// give an impossible answer, such as a spike of a neuron that the network does not use.
    pub enum ModelKind by spell of subject {
        Refused { error: Box<dyn std::error::Error + Send + Sync> } => ("the chip's model: {error}"),
        Answer { answer: Option<ReckOnAnswer> } => ("the chip's model answers {answer:?}"),
        StrayNeuron { neuron: u8 } => ("neuron {neuron} fires, which the network has not"),
    }
}
room!(ModelKind, Model);

/// Leaves the enclosing function with the error `$kind`, unless `$condition` is true.
macro_rules! ensure {
    ($condition:expr, $kind:expr) => {
        let holds: bool = $condition;
        if !holds {
            return Err($kind.into());
        }
    };
}
pub(super) use ensure;

/// Adds to an error the part of the network in which it occurred, such as a layer.
pub(super) trait Context<T> {
    fn context(self, part: impl Into<String>) -> Result<T>;

    fn with_context<S: Into<String>>(self, part: impl FnOnce() -> S) -> Result<T>;
}

impl<T, E: Into<Error>> Context<T> for Result<T, E> {
    fn context(self, part: impl Into<String>) -> Result<T> {
        self.at(|| Place::from(Spot::Part(part.into())))
    }

    fn with_context<S: Into<String>>(self, part: impl FnOnce() -> S) -> Result<T> {
        self.at(|| Place::from(Spot::Part(part().into())))
    }
}
