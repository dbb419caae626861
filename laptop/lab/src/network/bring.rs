//! A trained network onto a chip: what is asked for, and what came of it.

use super::{Chip, Compare, Cost, Distance, OnChip, Trained, Trains};
use crate::Result;
use crate::network::fault::ensure;
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
    /// Spikes which only show what the numbers are worth.
    pub held_out: Option<HeldOut<'a>>,
    /// The outputs that fired where the network was trained: on the recording, and on what is held out.
    pub own: Option<(&'a Trains, &'a Trains)>,
    /// When neurons compare with their thresholds; what holds better unless given.
    pub compare: Option<Compare>,
    /// Called with the parts of the search that are done and those in all.
    pub progress: &'a (dyn Fn(usize, usize) + Sync),
}

/// A recording on which nothing is tuned.
#[derive(Clone, Copy)]
pub struct HeldOut<'a> {
    /// All of its steps, which are run.
    pub steps: &'a Trains,
    /// The first step that counts: those before it, on which the network was tuned, only lead to its state.
    pub from: usize,
}

/// A network for the chip, and what quantising costs.
pub struct Brought {
    /// The network.
    pub network: Box<dyn OnChip>,
    /// The figures on the recording on which it is tuned.
    pub tuned: Figures,
    /// The figures on the recording that was held out.
    pub held_out: Option<Figures>,
    /// The share of the steps with an output that is left if only this part of the chip's arithmetic is the chip's, on the
    /// recording that was held out, or else on that of the tuning.
    pub costs: Vec<(Cost, f64)>,
    /// The share of the steps with an output in which double precision fires as the network did where it was trained.
    pub reading: Option<f64>,
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
    let Request { chip, trained, tuned, held_out, own, compare, progress } = *request;
    let mut original = Original::of(trained, tuned);
    let mut other = held_out.map(|held_out| Original::of(trained, held_out.steps));
    let from = held_out.map_or(0, |held_out| held_out.from);
    let mut reading = None;
    if let Some((own, own_other)) = own {
        let shown = other.as_ref().map_or((&original, own), |other| (other, own_other));
        let read = shown.0.fired.last();
        reading = read.and_then(|read| agreement(read.get(from..)?, shown.1.get(from..)?));
        original.fire(own)?;
        if let Some(other) = &mut other {
            other.fire(own_other)?;
        }
    }
    let network = chip.quantise(trained, tuned, &original.fired, compare, progress)?;
    let shown = (held_out.map_or(tuned, |all| all.steps), other.as_ref().unwrap_or(&original));
    let costs = network.costs().into_iter().filter_map(|cost| {
        let alone = cost.alone(trained, (tuned, &original.fired), shown.0);
        Some((cost, agreement(shown.1.fired.last()?.get(from..)?, alone.get(from..)?)?))
    });
    let costs = if trained.readout.is_none() { costs.collect() } else { vec![] };
    let tuned = figures(&original, &*network, tuned, 0)?;
    let held_out = held_out
        .zip(other)
        .map(|(all, original)| figures(&original, &*network, all.steps, all.from))
        .transpose()?;
    Ok(Brought { network, tuned, held_out, costs, reading })
}

/// The share of the steps in which either has a spike in which both have the same.
fn agreement(one: &[Vec<u16>], other: &[Vec<u16>]) -> Option<f64> {
    let active = one.iter().zip(other).filter(|(one, other)| !one.is_empty() || !other.is_empty());
    let (active, same) = active.fold((0, 0), |(active, same), (one, other)| {
        let [one, other] = [one, other].map(|all| all.iter().collect::<BTreeSet<_>>());
        (active + 1, same + usize::from(one == other))
    });
    (active > 0).then(|| f64::from(same as u32) / f64::from(active))
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
    /// What it did from a step on.
    fn behind(&self, from: usize) -> Self {
        Self {
            layers: self.layers.clone(),
            readout: self.readout.clone(),
            fired: self.fired.iter().map(|all| all[from..].to_vec()).collect(),
            potentials: self.potentials.iter().skip(from).cloned().collect(),
        }
    }

    /// Takes what the outputs did where the network was trained.
    fn fire(&mut self, own: &Trains) -> Result<()> {
        if let (None, Some(last)) = (&self.readout, self.fired.last_mut()) {
            let (steps, given) = (last.len(), own.len());
            ensure!(steps == given, "spikes of {given} steps, where the recording has {steps}");
            let outputs = self.layers.last().map_or(0, |(_, neurons)| *neurons);
            let highest = own.iter().flatten().max().copied().unwrap_or(0);
            ensure!(
                usize::from(highest) < outputs,
                "spikes of output {highest}, of {outputs} outputs"
            );
            last.clone_from(own);
        }
        Ok(())
    }

    pub(super) fn of(trained: &Trained, inputs: &Trains) -> Self {
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

/// Runs the quantised network beside the original, and compares them from a step on.
pub(super) fn figures(
    original: &Original,
    network: &dyn OnChip,
    inputs: &Trains,
    from: usize,
) -> Result<Figures> {
    let mut ran = network.run(inputs)?;
    let original = &original.behind(from);
    ran.fired.iter_mut().for_each(|all| drop(all.drain(..from)));
    ran.potentials.drain(..from.min(ran.potentials.len()));
    ran.clocks.drain(..from);
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
    let steps = inputs.len() - from;
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

    /// How well the network holds, by steps and by windows: 0 to 1.
    pub(super) fn holds(&self) -> f64 {
        let windows = self.windows_agreeing as f64 / self.windows.max(1) as f64;
        f64::midpoint(self.agreement().unwrap_or(0.0), windows)
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
