//! A trained network onto a chip: what is asked for, and what came of it.

use super::{Chip, Distance, OnChip, Trained, Trains};
use crate::Result;
use std::collections::{BTreeMap, BTreeSet};

/// The steps over which outputs are counted.
pub const WINDOW: usize = 20;

/// A network, and the recording with which it is brought onto the chip.
pub struct Request<'a> {
    /// The chip.
    pub chip: &'a dyn Chip,
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
    pub network: Box<dyn OnChip>,
    /// The figures on the recording on which it is tuned.
    pub tuned: Figures,
    /// The figures on the recording that was held out.
    pub held_out: Option<Figures>,
}

/// The network in double precision beside the chip's model.
pub struct Figures {
    /// The figures of each layer.
    pub layers: Vec<LayerFigures>,
    /// Steps.
    pub steps: usize,
    /// Steps in which the outputs that fire are the same.
    pub agreeing: usize,
    /// Steps in which an output fires, in double precision or on the chip.
    pub active: usize,
    /// Active steps in which the same outputs fire as in double precision.
    pub active_agreeing: usize,
    /// Windows of [`WINDOW`] steps in which an output fires.
    pub windows: usize,
    /// Windows in which the same outputs fire most.
    pub windows_agreeing: usize,
    /// The chip's clocks for a step: the mean.
    pub mean_clocks: f64,
    /// The chip's clocks for the longest step.
    pub most_clocks: u64,
    /// Spikes lost on their way into the chip.
    pub lost: u32,
    /// Outputs that never fire.
    pub potentials: Option<PotentialFigures>,
}

/// Potentials of outputs in double precision beside the chip's model.
pub struct PotentialFigures {
    /// The name in its file.
    pub name: String,
    /// Outputs.
    pub outputs: usize,
    /// Weights that were larger than the chip's.
    pub clipped: usize,
    /// The root mean square of the potentials in double precision.
    pub size: f64,
    /// The root mean square of their difference on the chip.
    pub error: f64,
}

/// A layer in double precision beside the chip's model.
pub struct LayerFigures {
    /// The name in its file.
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
/// Returns an error if the network does not fit, or the chip's model refuses something.
pub fn bring(request: &Request) -> Result<Brought> {
    let Request { chip, trained, tuned, held_out, progress } = *request;
    let original = Original::of(trained, tuned);
    let network = chip.quantise(trained, tuned, &original.fired, progress)?;
    let tuned = figures(&original, &*network, tuned)?;
    let held_out = held_out
        .map(|held_out| figures(&Original::of(trained, held_out), &*network, held_out))
        .transpose()?;
    Ok(Brought { network, tuned, held_out })
}

/// A network in double precision: its layers, and what it did.
pub(super) struct Original {
    /// The name and number of the neurons of each layer that fires.
    pub layers: Vec<(String, usize)>,
    /// The same of outputs that never fire.
    pub readout: Option<(String, usize)>,
    pub fired: Vec<Trains>,
    /// The outputs' potentials, by step.
    pub potentials: Vec<Vec<f64>>,
}

impl Original {
    fn of(trained: &Trained, inputs: &Trains) -> Self {
        let fired = trained.run(inputs);
        Self {
            layers: trained
                .layers
                .iter()
                .map(|layer| (layer.name.clone(), layer.neurons.len()))
                .collect(),
            readout: trained
                .readout
                .as_ref()
                .map(|readout| (readout.name.clone(), readout.weights.len())),
            potentials: trained.potentials(&fired),
            fired,
        }
    }
}

/// Runs the quantised network beside the original.
pub(super) fn figures(
    original: &Original,
    network: &dyn OnChip,
    inputs: &Trains,
) -> Result<Figures> {
    let ran = network.run(inputs)?;
    let clipped = network.clipped();
    let layers = original.layers.iter().zip(&clipped).zip(original.fired.iter().zip(&ran.fired));
    let layers = layers.map(|(((name, neurons), &clipped), (original, fired))| LayerFigures {
        name: name.clone(),
        neurons: *neurons,
        clipped,
        spikes: original.iter().map(Vec::len).sum(),
        on_chip: fired.iter().map(Vec::len).sum(),
        distance: distance(*neurons, original, fired),
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
        lost: ran.lost,
        potentials: None,
    };
    if let Some((name, outputs)) = &original.readout {
        let potentials = &original.potentials;
        figures.potentials = Some(PotentialFigures {
            name: name.clone(),
            outputs: *outputs,
            clipped: clipped.last().copied().unwrap_or(0),
            size: root_mean_square(potentials.iter().flatten().copied()),
            error: root_mean_square(
                potentials
                    .iter()
                    .flatten()
                    .zip(ran.potentials.iter().flatten())
                    .map(|(a, b)| a - b),
            ),
        });
        // Of one output none is the highest.
        if *outputs > 1 {
            figures.compare(&highest(potentials), &highest(&ran.potentials));
        }
    } else if let (Some(original), Some(fired)) = (original.fired.last(), ran.fired.last()) {
        figures.compare(original, fired);
    }
    Ok(figures)
}

fn root_mean_square(numbers: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = numbers.fold((0.0, 0), |(sum, count), n| (sum + n * n, count + 1));
    (sum / f64::from(count.max(1))).sqrt()
}

/// The output whose potential is the highest, by step; none before any has one.
fn highest(potentials: &[Vec<f64>]) -> Trains {
    let of_step = |step: &Vec<f64>| {
        if step.iter().all(|potential| *potential == 0.0) {
            return vec![];
        }
        let most = step.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        step.iter()
            .position(|potential| *potential == most)
            .map(|at| at as u16)
            .into_iter()
            .collect()
    };
    potentials.iter().map(of_step).collect()
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
