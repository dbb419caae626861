//! Assigns the neurons of a network to those of the chip.

use super::super::Trained;
use super::part::{Part, Seat};
use crate::Spot;
use crate::network::fault::{FitKind, Result, ensure};
use std::collections::BTreeMap;

const NEURONS: usize = 256;
const OUTPUTS: usize = 16;
/// Largest difference between the decay factors of two neurons that may share a leak. A step multiplies a neuron's
/// potential by its decay factor.
const SAME: f64 = 1e-4;

/// The order of a layer's parts on the chip. Two parts of the same neuron form a pair if their leaks are the same.
const PARTS: [&[Part]; 3] = [&[Part::Main, Part::Over], &[Part::Return], &[Part::Relay]];

/// The assignment of the network's neurons to the chip's neurons. Two adjacent neurons of the chip form a pair, which
/// shares a leak and a threshold. The neurons in a pair therefore belong to the same layer, and their leaks are as
/// similar as possible.
#[derive(Clone, Debug)]
pub(super) struct Places {
    /// For each neuron of the chip, the part of a neuron of the network that it is. `None` if the chip's neuron stays
    /// free. One neuron of a pair stays free if a layer has an odd number of neurons, or if no other neuron of the layer
    /// has a similar leak.
    pub(super) neurons: Vec<Option<Seat>>,
    /// Index of the chip's neuron for each part of each neuron of the network.
    by_seat: BTreeMap<Seat, usize>,
}

/// Returns the location that an error reports for the layer `name`.
fn layer_at(name: &str) -> Spot {
    Spot::Part(name.to_owned())
}

impl Places {
    /// Number of the chip's inputs.
    pub(super) const INPUTS: usize = 256;

    /// Assigns all neurons of a network to the chip.
    ///
    /// # Errors
    /// Returns an error if the chip has too few neurons, inputs or outputs.
    pub(super) fn new(trained: &Trained, has_bias: bool) -> Result<Self> {
        // Neurons of different leaks get a pair each, unless the chip is too small for that.
        let apart = Self::placed(trained, has_bias, SAME);
        if apart.is_ok() { apart } else { Self::placed(trained, has_bias, f64::INFINITY) }
    }

    /// Assigns all neurons of a network to the chip. Two neurons of a layer may form a pair if their decay factors
    /// differ by at most `most`. A step multiplies a neuron's potential by its decay factor. `has_bias` says whether
    /// the network has a bias, which takes one of the chip's inputs.
    ///
    /// # Errors
    /// Returns an error if the chip has too few neurons, inputs or outputs.
    fn placed(trained: &Trained, has_bias: bool, most: f64) -> Result<Self> {
        let (mut neurons, mut by_seat) = (Vec::new(), BTreeMap::new());
        for (at, layer) in trained.layers.iter().enumerate() {
            let mut order: Vec<usize> = (0..layer.neurons.len()).collect();
            order.sort_by(|&one, &other| {
                layer.neurons[one].keep.total_cmp(&layer.neurons[other].keep)
            });
            let has = |part: &&Part| Part::of(layer).contains(part);
            for parts in PARTS.iter().filter(|parts| parts.iter().any(|part| has(&part))) {
                if !neurons.len().is_multiple_of(2) {
                    neurons.push(None);
                }
                let mut last = 0.0;
                for &neuron in &order {
                    for &part in parts.iter().filter(has) {
                        // Parts that only repeat spikes all have the same leak.
                        let keep = if part.repeats() { 1.0 } else { layer.neurons[neuron].keep };
                        if !neurons.len().is_multiple_of(2) && keep - last > most {
                            neurons.push(None);
                        }
                        last = keep;
                        let seat = Seat { layer: at, part, neuron };
                        by_seat.insert(seat, neurons.len());
                        neurons.push(Some(seat));
                    }
                }
            }
            let (count, needed) = (layer.neurons.len(), neurons.len());
            let kind = || FitKind::Neurons { most: NEURONS, layer: count, needed };
            ensure!(needed <= NEURONS, kind().at(layer_at(&layer.name)));
        }
        let inputs = trained.inputs() + usize::from(has_bias);
        let kind = || FitKind::Inputs { most: Self::INPUTS, inputs, has_bias };
        ensure!(inputs <= Self::INPUTS, kind().at(layer_at(&trained.layers[0].name)));
        let (name, outputs) = match (&trained.readout, trained.layers.last()) {
            (Some(readout), _) => (readout.name.as_str(), readout.weights.len()),
            (None, Some(layer)) => (layer.name.as_str(), layer.neurons.len()),
            (None, None) => ("", 0),
        };
        ensure!(outputs <= OUTPUTS, FitKind::Outputs { most: OUTPUTS, outputs }.at(layer_at(name)));
        Ok(Self { neurons, by_seat })
    }

    /// Returns the number of the chip's neuron that is this part of a neuron of the network.
    ///
    /// # Panics
    /// Panics if the neuron of the network has no such part.
    pub(super) fn of(&self, seat: Seat) -> usize {
        self.by_seat[&seat]
    }

    /// Returns, for each pair of neurons on the chip, what the two neurons are. A pair holds two neurons, or one if its
    /// second place stays free.
    pub(super) fn pairs(&self) -> impl Iterator<Item = Vec<Seat>> {
        self.neurons.chunks(2).map(|pair| pair.iter().flatten().copied().collect())
    }

    /// Returns whether the layers that reset without a delay do so on the chip, with several neurons for each of theirs.
    pub(super) fn has_parts(&self) -> bool {
        self.by_seat.keys().any(|seat| seat.part != Part::Main)
    }
}
