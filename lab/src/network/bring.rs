//! A trained network onto a chip: what is asked for, and what came of it.

use super::{Distance, Quantised, Trained, Trains, quantise, run_on_chip};
use anyhow::Result;
use std::collections::{BTreeMap, BTreeSet};

/// The steps over which outputs are counted.
pub const WINDOW: usize = 20;

/// What to bring onto the chip.
pub struct Request<'a> {
    /// The network.
    pub trained: &'a Trained,
    /// The spikes on which the chip's numbers are tuned, by step.
    pub tuned: &'a Trains,
    /// Spikes of another recording, which only show what the numbers are worth.
    pub held_out: Option<&'a Trains>,
    /// Called with the neurons that are done and those in all.
    pub progress: &'a (dyn Fn(usize, usize) + Sync),
}

/// A network for the chip, and what quantising costs.
pub struct Brought {
    /// The network.
    pub network: Quantised,
    /// On the recording that it is tuned on.
    pub tuned: Figures,
    /// On the recording that was held out.
    pub held_out: Option<Figures>,
}

/// The network in double precision beside the chip's model.
pub struct Figures {
    /// By layer.
    pub layers: Vec<LayerFigures>,
    /// Steps.
    pub steps: usize,
    /// Steps in which the outputs that fire are the same.
    pub agreeing: usize,
    /// Steps in which an output fires, in double precision or on the chip.
    pub active: usize,
    /// Of those, the steps in which the outputs that fire are the same.
    pub active_agreeing: usize,
    /// Times [`WINDOW`] steps in which an output fires.
    pub windows: usize,
    /// Of those, how many in which the outputs that fire most are the same.
    pub windows_agreeing: usize,
    /// The chip's clocks for a step: the mean.
    pub mean_clocks: f64,
    /// The most of a step.
    pub most_clocks: u64,
    /// Spikes lost as the chip's queue was full.
    pub overflows: u32,
}

/// A layer in double precision beside the chip's model.
pub struct LayerFigures {
    /// As its file calls it.
    pub name: String,
    /// Neurons.
    pub neurons: usize,
    /// Weights that were larger than the chip's.
    pub clipped: usize,
    /// Spikes in double precision.
    pub spikes: usize,
    /// Spikes on the chip.
    pub on_chip: usize,
    /// The distance of van Rossum, squared, over all neurons.
    pub distance: f64,
}

/// Quantises the network, and runs it on the chip's model.
///
/// # Errors
/// It does not fit, or the model refuses something.
pub fn bring(request: &Request) -> Result<Brought> {
    let Request { trained, tuned, held_out, progress } = *request;
    let original = trained.run(tuned);
    let network = quantise(trained, tuned, &original, progress)?;
    let tuned = figures(trained, &network, tuned, &original)?;
    let held_out = held_out
        .map(|held_out| figures(trained, &network, held_out, &trained.run(held_out)))
        .transpose()?;
    Ok(Brought { network, tuned, held_out })
}

fn figures(
    trained: &Trained,
    network: &Quantised,
    inputs: &Trains,
    original: &[Trains],
) -> Result<Figures> {
    let ran = run_on_chip(network, inputs)?;
    let layers = trained.layers.iter().zip(&network.layers).zip(original.iter().zip(&ran.fired));
    let layers = layers.map(|((layer, chip), (original, fired))| LayerFigures {
        name: layer.name.clone(),
        neurons: layer.neurons.len(),
        clipped: chip.neurons.iter().map(|neuron| neuron.clipped).sum(),
        spikes: original.iter().map(Vec::len).sum(),
        on_chip: fired.iter().map(Vec::len).sum(),
        distance: distance(layer.neurons.len(), original, fired),
    });
    let steps = inputs.len();
    let mut figures = Figures {
        layers: layers.collect(),
        steps,
        agreeing: 0,
        active: 0,
        active_agreeing: 0,
        windows: 0,
        windows_agreeing: 0,
        mean_clocks: ran.clocks.iter().sum::<u64>() as f64 / steps.max(1) as f64,
        most_clocks: ran.clocks.iter().max().copied().unwrap_or(0),
        overflows: ran.overflows,
    };
    if let (Some(original), Some(fired)) = (original.last(), ran.fired.last()) {
        figures.compare(original, fired);
    }
    Ok(figures)
}

fn distance(neurons: usize, original: &Trains, fired: &Trains) -> f64 {
    let mut distances = vec![Distance::default(); neurons];
    let mut counts = vec![(0, 0); neurons];
    for (original, fired) in original.iter().zip(fired) {
        counts.fill((0, 0));
        for &neuron in original {
            counts[usize::from(neuron)].0 += 1;
        }
        for &neuron in fired {
            counts[usize::from(neuron)].1 += 1;
        }
        for (distance, (one, other)) in distances.iter_mut().zip(&counts) {
            distance.step(*one, *other);
        }
    }
    distances.into_iter().map(Distance::value).sum()
}

impl Figures {
    fn compare(&mut self, original: &Trains, fired: &Trains) {
        for (original, fired) in original.iter().zip(fired) {
            let [original, fired] =
                [original, fired].map(|all| all.iter().collect::<BTreeSet<_>>());
            let agrees = usize::from(original == fired);
            self.agreeing += agrees;
            if !original.is_empty() || !fired.is_empty() {
                self.active += 1;
                self.active_agreeing += agrees;
            }
        }
        for (original, fired) in original.chunks(WINDOW).zip(fired.chunks(WINDOW)) {
            let (original, fired) = (most(original), most(fired));
            if !original.is_empty() || !fired.is_empty() {
                self.windows += 1;
                self.windows_agreeing += usize::from(original == fired);
            }
        }
    }

    /// The share of the steps with an output in which the outputs are the same; `None` if none ever fires.
    pub fn agreement(&self) -> Option<f64> {
        (self.active > 0).then(|| self.active_agreeing as f64 / self.active as f64)
    }
}

/// The outputs that fire most.
fn most(steps: &[Vec<u16>]) -> Vec<u16> {
    let mut counts = BTreeMap::new();
    for output in steps.iter().flatten() {
        *counts.entry(*output).or_insert(0) += 1;
    }
    let most = counts.values().max().copied();
    counts.retain(|_, count| Some(*count) == most);
    counts.into_keys().collect()
}
