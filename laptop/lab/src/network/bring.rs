//! Brings a trained network onto a chip, and compares it there with the original.

use super::{Chip, Compare, Cost, Distance, OnChip, Trained, Trains};
use crate::Result;
use crate::network::fault::ensure;
use std::collections::{BTreeMap, BTreeSet};

/// Number of steps over which outputs are counted.
pub const WINDOW: usize = 20;

/// A network, and the recording with which it is brought onto the chip.
pub struct Request<'a> {
    /// The chip.
    pub chip: &'a dyn Chip,
    /// The network.
    pub trained: &'a Trained,
    /// The spikes on which the chip's numbers are tuned, by step.
    pub tuned: &'a Trains,
    /// Spikes on which the result is only tested.
    pub held_out: Option<HeldOut<'a>>,
    /// Spikes of the outputs in the training framework: on the recording, and on the one held out.
    pub own: Option<(&'a Trains, &'a Trains)>,
    /// When neurons compare with their thresholds; `None` chooses the way that agrees better with the original.
    pub compare: Option<Compare>,
    /// Called with the number of parts of the search that are done, and the number in all.
    pub progress: &'a (dyn Fn(usize, usize) + Sync),
}

/// A recording on which nothing is tuned.
#[derive(Clone, Copy)]
pub struct HeldOut<'a> {
    /// The spikes of all its steps.
    pub steps: &'a Trains,
    /// First step that counts. The steps before it were tuned on, and are only run to reach the state that follows
    /// them.
    pub from: usize,
}

/// A network on a chip, and the accuracy lost by quantising.
pub struct Brought {
    /// The network.
    pub network: Box<dyn OnChip>,
    /// The figures on the recording on which it is tuned.
    pub tuned: Figures,
    /// The figures on the recording that was held out.
    pub held_out: Option<Figures>,
    /// The cost of each part of the chip's arithmetic by itself. The network runs in double precision except for that
    /// part; the number is the share of active steps in which the same outputs fire as without it. Measured on the
    /// recording held out, or on the one tuned on if there is none.
    pub costs: Vec<(Cost, f64)>,
    /// Share of active steps in which double precision fires as the training framework did.
    pub reading: Option<f64>,
}

/// Comparison of the network in double precision with the chip's model.
pub struct Figures {
    /// The figures of each layer.
    pub layers: Vec<LayerFigures>,
    /// Number of steps.
    pub steps: usize,
    /// Number of steps in which the same outputs fire.
    pub agreeing: usize,
    /// Number of active steps: those in which an output fires, in double precision or on the chip.
    pub active: usize,
    /// Number of active steps in which the same outputs fire in both.
    pub active_agreeing: usize,
    /// Number of windows of [`WINDOW`] steps in which an output fires.
    pub windows: usize,
    /// Number of windows in which the same outputs fire most often.
    pub windows_agreeing: usize,
    /// Mean number of the chip's clocks in a step.
    pub mean_clocks: f64,
    /// Number of the chip's clocks in the longest step.
    pub most_clocks: u64,
    /// Number of spikes lost on their way into the chip.
    pub lost: u32,
    /// Comparison of the outputs that never fire.
    pub potentials: Option<PotentialFigures>,
}

/// Comparison of the outputs' potentials in double precision with the chip's model.
pub struct PotentialFigures {
    /// Name in the file.
    pub name: String,
    /// Number of outputs.
    pub outputs: usize,
    /// Number of weights that exceeded the chip's range.
    pub clipped: usize,
    /// Root mean square of the potentials in double precision.
    pub size: f64,
    /// Root mean square of the chip's deviation from them.
    pub error: f64,
}

/// Comparison of a layer in double precision with the chip's model.
pub struct LayerFigures {
    /// Name in the file.
    pub name: String,
    /// Number of neurons.
    pub neurons: usize,
    /// Number of weights that exceeded the chip's range.
    pub clipped: usize,
    /// Number of spikes in double precision.
    pub spikes: usize,
    /// Number of spikes on the chip.
    pub on_chip: usize,
    /// Squared distance of van Rossum, summed over all neurons.
    pub distance: f64,
}

/// Quantises the network, and runs it on the chip's model.
///
/// # Errors
/// Returns an error if the network does not fit, or if the chip's model refuses a call.
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

/// Returns the share of steps with the same spikes in both trains, of the steps in which either has a spike.
fn agreement(one: &[Vec<u16>], other: &[Vec<u16>]) -> Option<f64> {
    let active = one.iter().zip(other).filter(|(one, other)| !one.is_empty() || !other.is_empty());
    let (active, same) = active.fold((0, 0), |(active, same), (one, other)| {
        let [one, other] = [one, other].map(|all| all.iter().collect::<BTreeSet<_>>());
        (active + 1, same + usize::from(one == other))
    });
    (active > 0).then(|| f64::from(same as u32) / f64::from(active))
}

/// A network in double precision: its layers, and the spikes and potentials of a run.
pub(super) struct Original {
    /// Name and number of neurons of each layer that fires.
    pub layers: Vec<(String, usize)>,
    /// Name and number of the outputs that never fire.
    pub readout: Option<(String, usize)>,
    pub fired: Vec<Trains>,
    /// The outputs' potentials, for each step.
    pub potentials: Vec<Vec<f64>>,
}

impl Original {
    /// Returns the run without the steps before `from`.
    fn behind(&self, from: usize) -> Self {
        Self {
            layers: self.layers.clone(),
            readout: self.readout.clone(),
            fired: self.fired.iter().map(|all| all[from..].to_vec()).collect(),
            potentials: self.potentials.iter().skip(from).cloned().collect(),
        }
    }

    /// Replaces the outputs' spikes by those in the training framework.
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

/// Runs the quantised network, and compares it with the original from step `from` on.
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

/// Returns for each step the output with the highest potential; none until an output has one.
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

    /// Returns how well the network agrees, averaged over steps and windows: 0 to 1.
    pub(super) fn holds(&self) -> f64 {
        let windows = self.windows_agreeing as f64 / self.windows.max(1) as f64;
        f64::midpoint(self.agreement().unwrap_or(0.0), windows)
    }

    /// Returns the share of active steps in which the same outputs fire; `None` if none ever fires.
    pub fn agreement(&self) -> Option<f64> {
        (self.active > 0).then(|| self.active_agreeing as f64 / self.active as f64)
    }
}

/// Returns the outputs that fire most often.
fn most(steps: &[Vec<u16>]) -> Vec<u16> {
    let mut counts = BTreeMap::new();
    for output in steps.iter().flatten() {
        *counts.entry(*output).or_insert(0) += 1;
    }
    let most = counts.values().max().copied();
    counts.retain(|_, count| Some(*count) == most);
    counts.into_keys().collect()
}
