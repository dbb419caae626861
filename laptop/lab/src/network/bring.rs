//! Brings a trained network onto a chip: quantises the network, runs the quantised network on the chip's model, and
//! compares the outputs with those of the original.

use super::{Chip, Compare, Cost, Distance, OnChip, Trained, Trains};
use crate::Result;
use crate::network::NetworkKind;
use crate::network::fault::ensure;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Number of time steps in a window. A comparison of two runs checks for each window whether the same outputs have the
/// most spikes in both runs.
pub const WINDOW: usize = 20;

/// A network to bring onto a chip, and the recordings on which it is tuned and tested.
pub struct Request<'a> {
    /// The chip to bring the network onto.
    pub chip: &'a dyn Chip,
    /// The network in double precision.
    pub trained: &'a Trained,
    /// Input spikes, by step, of the recording on which the chip's parameters are tuned.
    pub tuned: &'a Trains,
    /// A second recording, which only tests the quantised network. If `None`, the network is tested on `tuned`.
    pub held_out: Option<HeldOut<'a>>,
    /// Outputs that the training framework computed, in all steps of `held_out`, of which `tuned` is the beginning, or
    /// of `tuned` if there is no `held_out`. `None` if they are not known.
    pub framework: Option<&'a Outputs>,
    /// When neurons compare their potentials with their thresholds. `None` tries both possibilities and chooses the one
    /// whose spikes agree better with double precision. Has no effect on chips that offer no choice.
    pub compare: Option<Compare>,
    /// Called during the search for the chip's parameters, with the number of finished parts of the search and the
    /// total number of parts.
    pub progress: &'a (dyn Fn(usize, usize) + Sync),
}

/// The outputs of a network, by step.
pub enum Outputs {
    /// The outputs that fire.
    Spikes(Trains),
    /// The potential of each output, for networks whose outputs never fire.
    Potentials(Vec<Vec<f64>>),
}

impl Outputs {
    /// Checks that these can be outputs of a network, in `steps` steps.
    ///
    /// # Errors
    /// Returns an error if there are more or fewer steps, if spikes are given of outputs that never fire, or potentials
    /// of outputs that fire, or if a step has outputs that the network does not have, or too few potentials.
    pub(super) fn check(&self, of: &OutputLayer, steps: usize) -> Result<()> {
        let has_steps = |given| -> Result<()> {
            ensure!(given == steps, NetworkKind::OutputSteps { given, steps });
            Ok(())
        };
        let OutputLayer { outputs, fires } = *of;
        match (self, fires) {
            (Self::Spikes(given), true) => {
                has_steps(given.len())?;
                for (step, fired) in (1..).zip(given) {
                    for &output in fired {
                        let is_known = usize::from(output) < outputs;
                        ensure!(is_known, NetworkKind::SpikeOutput { step, output, outputs });
                    }
                }
            }
            (Self::Potentials(given), false) => {
                has_steps(given.len())?;
                for (step, given) in (1..).zip(given.iter().map(Vec::len)) {
                    ensure!(given == outputs, NetworkKind::Potentials { step, given, outputs });
                }
            }
            (Self::Spikes(_), false) => return Err(NetworkKind::OutputsNeverFire.into()),
            (Self::Potentials(_), true) => return Err(NetworkKind::OutputsFire.into()),
        }
        Ok(())
    }
}

/// The layer of a network whose spikes or potentials are its outputs.
#[derive(Clone, Copy)]
pub(super) struct OutputLayer {
    /// Number of outputs.
    pub outputs: usize,
    /// Whether the outputs are neurons that fire.
    pub fires: bool,
}

/// A recording on which a network is tested after its parameters were tuned on a different recording.
#[derive(Clone, Copy)]
pub struct HeldOut<'a> {
    /// Input spikes of all steps, including those before `from`.
    pub steps: &'a Trains,
    /// Index of the first step that is compared. The steps before `from` only bring the network into its state.
    /// Parameters may have been tuned on those earlier steps.
    pub from: usize,
}

/// A network that was brought onto a chip or the flight controller, and comparisons that show how accurate it is.
pub struct Brought {
    /// The quantised network.
    pub network: Box<dyn OnChip>,
    /// Comparison with the reference, for the recording that was used to tune the parameters.
    pub tuned: Figures,
    /// Comparison with the reference on the held-out recording; `None` if there is no such recording.
    pub held_out: Option<Figures>,
    /// The parts of the chip's arithmetic, each with a measure of its effect on the spikes. For each part, two runs of
    /// the network are compared: one in double precision except for this part, and one entirely in double precision.
    /// The measure is the share of active steps in which the same outputs fire in both runs. A step is active if an
    /// output fires in either run. The runs use the held-out recording. If there is none, they use the recording on
    /// which the parameters were tuned.
    pub costs: Vec<(Cost, f64)>,
    /// Share of active steps in which the same outputs fire in double precision and in the training framework. A step
    /// is active if an output fires in either run. A low share suggests that the network's file, or the rule of its
    /// neurons, was understood wrongly. `None` if the framework's spikes are not given, or if no output fires, or if the
    /// network was trained in a chip's integers, since double precision does not round as they do.
    pub reading: Option<f64>,
    /// Root mean square of the difference between the outputs' potentials in double precision and in the training
    /// framework, divided by that of the framework's potentials. A large number suggests the same as a low
    /// [`reading`](Self::reading). `None` if the framework's potentials are not given, or if all are 0, or if the network
    /// was trained in a chip's integers.
    pub reading_error: Option<f64>,
}

/// Comparison of a network on the chip's model with a reference. The reference is the network in double precision;
/// its outputs are those of the training framework, if they are given. If outputs never fire, the one with the highest
/// potential counts as the one that fires, and a single one does not count.
#[derive(Debug, Serialize)]
pub struct Figures {
    /// The comparison of each layer.
    pub layers: Vec<LayerFigures>,
    /// Number of steps compared.
    pub steps: usize,
    /// Number of steps in which the same outputs fire in the reference and on the chip, including steps in which no
    /// output fires.
    pub agreeing: usize,
    /// Number of active steps: those in which an output fires, in the reference or on the chip.
    pub active: usize,
    /// Number of [`active`](Self::active) steps in which the same outputs fire in the reference and on the chip.
    pub active_agreeing: usize,
    /// Number of windows of [`WINDOW`] steps in which an output fires, in the reference or on the chip.
    pub windows: usize,
    /// Number of [`windows`](Self::windows) in which the outputs with the most spikes are the same in the reference and
    /// on the chip.
    pub windows_agreeing: usize,
    /// Mean number of clock cycles that the chip takes for a step. On the flight controller: the mean number of weight
    /// additions in a step.
    pub mean_clocks: f64,
    /// Largest number of clock cycles that the chip takes for a step. On the flight controller: the largest number of
    /// weight additions in a step.
    pub most_clocks: u64,
    /// Number of spikes that were lost on their way into the chip.
    pub lost: u32,
    /// Number of steps in which the potential of an output reached the end of the chip's range, so that its value is
    /// wrong. Steps before the held-out ones count, too.
    pub clipped: u32,
    /// Comparison of the outputs' potentials, for networks whose outputs never fire.
    pub potentials: Option<PotentialFigures>,
}

/// Comparison of the outputs' potentials on the chip's model with those of the reference: those of the training
/// framework, if they are given, otherwise those in double precision.
#[derive(Debug, Serialize)]
pub struct PotentialFigures {
    /// Name of the output layer in the network's file.
    pub name: String,
    /// Number of outputs.
    pub outputs: usize,
    /// Number of the outputs' weights that exceeded the chip's range and were clipped.
    pub clipped: usize,
    /// Root mean square of the reference's potentials, in the units of the trained network.
    pub size: f64,
    /// Root mean square of the difference between the chip's potentials and the reference's, in the same units.
    pub error: f64,
}

/// Comparison of a layer on the chip's model with the same layer of the reference: double precision or, for the spikes
/// of outputs, the training framework if they are given.
#[derive(Debug, Serialize)]
pub struct LayerFigures {
    /// Name of the layer in the network's file.
    pub name: String,
    /// Number of neurons.
    pub neurons: usize,
    /// Number of weights that exceeded the chip's range and were clipped.
    pub clipped: usize,
    /// Number of spikes of the layer in the reference, in all steps.
    pub spikes: usize,
    /// Number of spikes of the layer on the chip, in all steps.
    pub on_chip: usize,
    /// Squared van Rossum distance between the layer's spikes in the reference and on the chip, summed over all
    /// neurons.
    pub distance: f64,
}

/// Quantises the network for the chip, runs the quantised network on the chip's model, and compares the outputs with
/// those of the original.
///
/// # Errors
/// Returns an error if the network does not fit the chip, if the framework's outputs do not fit the network, or if the
/// chip's model refuses a call.
pub fn bring(request: &Request) -> Result<Brought> {
    let Request { chip, trained, tuned, held_out, framework: own, compare, progress } = *request;
    let mut original = Original::of(trained, tuned);
    if let Some(own) = own {
        own.check(&trained.outputs(), held_out.map_or(tuned, |all| all.steps).len())?;
    }
    let mut other = held_out.map(|held_out| Original::of(trained, held_out.steps));
    let from = held_out.map_or(0, |held_out| held_out.from);
    let mut reading = Reading::default();
    if let Some(own) = own {
        if !trained.integers {
            reading = Reading::of(other.as_ref().unwrap_or(&original), own, from);
        }
        original.replace_outputs(own);
        if let Some(other) = &mut other {
            other.replace_outputs(own);
        }
    }
    let network = chip.quantise(trained, tuned, &original.fired, compare, progress)?;
    let shown = (held_out.map_or(tuned, |all| all.steps), other.as_ref().unwrap_or(&original));
    let resets_otherwise = trained.layers.iter().any(|layer| !network.resets_as(layer.reset));
    let reset = resets_otherwise.then_some(Cost::Reset);
    let costs = network.costs().into_iter().chain(reset).filter_map(|cost| {
        let alone = cost.alone(trained, (tuned, &original.fired), shown.0);
        Some((cost, agreement(shown.1.fired.last()?.get(from..)?, alone.get(from..)?)?))
    });
    let costs = if trained.readout.is_none() { costs.collect() } else { vec![] };
    let tuned = figures(&original, &*network, tuned, 0)?;
    let held_out = held_out
        .zip(other)
        .map(|(all, original)| figures(&original, &*network, all.steps, all.from))
        .transpose()?;
    let Reading { share, error } = reading;
    Ok(Brought { network, tuned, held_out, costs, reading: share, reading_error: error })
}

/// How far a network's outputs in double precision are those of the training framework: see [`Brought::reading`] and
/// [`Brought::reading_error`].
#[derive(Default)]
pub(super) struct Reading {
    pub share: Option<f64>,
    pub error: Option<f64>,
}

impl Reading {
    /// Compares the outputs of `original` with those of the framework from step `from` on.
    pub(super) fn of(original: &Original, framework: &Outputs, from: usize) -> Self {
        match framework {
            Outputs::Spikes(framework) => {
                let fired = original.fired.last().and_then(|fired| fired.get(from..));
                let share = match (fired, framework.get(from..)) {
                    (Some(fired), Some(framework)) => agreement(fired, framework),
                    _ => None,
                };
                Self { share, error: None }
            }
            Outputs::Potentials(framework) => {
                let size = root_mean_square(framework.iter().skip(from).flatten().copied());
                let potentials = original.potentials.iter().skip(from);
                let error = difference(potentials, framework.iter().skip(from));
                Self { share: None, error: (size > 0.0).then(|| error / size) }
            }
        }
    }
}

/// Compares two spike trains step by step. Among the steps in which at least one of them has a spike, returns the share
/// in which the same neurons fire in both; `None` if neither train has a spike.
pub(super) fn agreement(one: &[Vec<u16>], other: &[Vec<u16>]) -> Option<f64> {
    let active = one.iter().zip(other).filter(|(one, other)| !one.is_empty() || !other.is_empty());
    let (active, same) = active.fold((0, 0), |(active, same), (one, other)| {
        let [one, other] = [one, other].map(|all| all.iter().collect::<BTreeSet<_>>());
        (active + 1, same + usize::from(one == other))
    });
    (active > 0).then(|| f64::from(same as u32) / f64::from(active))
}

/// The reference for comparisons: the spikes and potentials of one run in double precision, in which the training
/// framework's outputs replace its own if they are given, and the sizes of the layers.
pub(super) struct Original {
    /// For each layer whose neurons fire: the layer's name and its number of neurons.
    pub layers: Vec<(String, usize)>,
    /// Name of the output layer and number of outputs, if the outputs never fire; `None` if the outputs are spikes.
    pub readout: Option<(String, usize)>,
    pub fired: Vec<Trains>,
    /// The outputs' potentials, by step; compared only if the outputs never fire.
    pub potentials: Vec<Vec<f64>>,
}

impl Original {
    /// Returns a copy without the steps before `from`.
    fn behind(&self, from: usize) -> Self {
        Self {
            layers: self.layers.clone(),
            readout: self.readout.clone(),
            fired: self.fired.iter().map(|all| all[from..].to_vec()).collect(),
            potentials: self.potentials.iter().skip(from).cloned().collect(),
        }
    }

    /// Replaces the outputs by the first of `framework`, those that the training framework computed.
    pub(super) fn replace_outputs(&mut self, framework: &Outputs) {
        match framework {
            Outputs::Spikes(framework) => {
                if let Some(last) = self.fired.last_mut() {
                    *last = framework.iter().take(last.len()).cloned().collect();
                }
            }
            Outputs::Potentials(framework) => {
                self.potentials = framework.iter().take(self.potentials.len()).cloned().collect();
            }
        }
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

/// Runs the quantised network on the chip's model, and compares the result with the original from step `from` on.
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
        clipped: ran.clipped,
        potentials: None,
    };
    if let Some((name, outputs)) = &original.readout {
        let potentials = &original.potentials;
        figures.potentials = Some(PotentialFigures {
            name: name.clone(),
            outputs: *outputs,
            clipped: clipped.last().copied().unwrap_or(0),
            size: root_mean_square(potentials.iter().flatten().copied()),
            error: difference(potentials.iter(), ran.potentials.iter()),
        });
        // With a single output, the highest output says nothing.
        if *outputs > 1 {
            figures.compare(&highest(potentials), &highest(&ran.potentials));
        }
    } else if let (Some(original), Some(fired)) = (original.fired.last(), ran.fired.last()) {
        figures.compare(original, fired);
    }
    Ok(figures)
}

/// Returns the root mean square of the differences between two runs' potentials.
fn difference<'a>(
    one: impl Iterator<Item = &'a Vec<f64>>,
    other: impl Iterator<Item = &'a Vec<f64>>,
) -> f64 {
    root_mean_square(one.flatten().zip(other.flatten()).map(|(one, other)| one - other))
}

fn root_mean_square(numbers: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = numbers.fold((0.0, 0), |(sum, count), n| (sum + n * n, count + 1));
    (sum / f64::from(count.max(1))).sqrt()
}

/// Returns, for each step, the output with the highest potential. The list for a step is empty if all its potentials
/// are 0.
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

    /// Returns the share of active steps in which the same outputs fire in the reference and on the chip; `None` if no
    /// output ever fires.
    pub fn agreement(&self) -> Option<f64> {
        (self.active > 0).then(|| self.active_agreeing as f64 / self.active as f64)
    }
}

/// Returns how well the outputs' spikes on the chip, `fired`, agree with those of the original, from 0 to 1. The result
/// is the mean of two shares. The first is the share of steps in which the same outputs fire. The second is the share
/// of windows in which the same outputs have the most spikes. Steps and windows in which no output fires do not count.
pub(super) fn holds(original: &[Vec<u16>], fired: &[Vec<u16>]) -> f64 {
    let all = original.chunks(WINDOW).zip(fired.chunks(WINDOW));
    let all = all.map(|(original, fired)| (most(original), most(fired)));
    let all = all.filter(|(original, fired)| !original.is_empty() || !fired.is_empty());
    let (same, windows) =
        all.fold((0, 0), |(same, all), (one, other)| (same + u32::from(one == other), all + 1_u32));
    let windows = f64::from(same) / f64::from(windows.max(1));
    f64::midpoint(agreement(original, fired).unwrap_or(0.0), windows)
}

/// Returns the outputs with the most spikes in these steps: several if they are tied, none if no output fires.
fn most(steps: &[Vec<u16>]) -> Vec<u16> {
    let mut counts = BTreeMap::new();
    for output in steps.iter().flatten() {
        *counts.entry(*output).or_insert(0) += 1;
    }
    let most = counts.values().max().copied();
    counts.retain(|_, count| Some(*count) == most);
    counts.into_keys().collect()
}
