//! A trained network in double precision, and its simulation.

use super::bring::OutputLayer;
use super::controller::{Asked, Fires, Reset};
use crate::network::fault::{Context, LayerKind, NetworkKind, Result, ensure};

/// Maximum number of layers in a network.
const LAYERS: usize = 3;

/// Spikes of a layer or of the inputs: for each step, the numbers of the neurons or inputs that fire. A number may
/// occur several times in a step.
pub type Trains = Vec<Vec<u16>>;

/// A trained network: layers of integrate-and-fire neurons, each fully connected to the layer before it.
#[derive(Clone, Debug)]
pub struct Trained {
    /// The layers whose neurons fire, from input to output.
    pub layers: Vec<Layer>,
    /// Output neurons that never fire and that follow the last of `layers`. `None` if the outputs are the spikes of the
    /// last layer.
    pub readout: Option<Readout>,
    /// Whether the network was trained in a chip's integers. `ReckOn` then takes weights, thresholds and decay factors
    /// as they are, if all of them are integers of the chip and no layer needs gates.
    pub integers: bool,
}

/// Leaky neurons that never fire, and whose potentials are the network's outputs.
#[derive(Clone, Debug)]
pub struct Readout {
    /// Name of the layer in the network's file.
    pub name: String,
    /// The weights: one row for each output, with one weight for each neuron of the last layer.
    pub weights: Vec<Vec<f64>>,
    /// For each output, the factor by which a step multiplies its potential, 0 to 1.
    pub keep: Vec<f64>,
}

impl Readout {
    fn check(&self, neurons: usize) -> Result<()> {
        let Self { weights, keep, .. } = self;
        ensure!(!weights.is_empty() && keep.len() == weights.len(), LayerKind::NoWeights);
        for (output, row) in weights.iter().enumerate() {
            let weights = row.len();
            ensure!(weights == neurons, LayerKind::OutputRow { output, weights, neurons });
            if let Some(&weight) = row.iter().find(|weight| !weight.is_finite()) {
                return Err(LayerKind::OutputWeight { output, weight }.into());
            }
        }
        if let Some(&keep) = keep.iter().find(|keep| !(0.0..=1.0).contains(*keep)) {
            return Err(LayerKind::OutputKeep { keep }.into());
        }
        Ok(())
    }

    /// Returns the outputs' potentials after each step, given the spikes `fired` of the last layer.
    fn run(&self, fired: &Trains) -> Vec<Vec<f64>> {
        let mut potentials = vec![0.0; self.weights.len()];
        let step = |fired: &Vec<u16>| {
            for ((potential, row), keep) in potentials.iter_mut().zip(&self.weights).zip(&self.keep)
            {
                let driven: f64 = fired.iter().map(|&neuron| row[usize::from(neuron)]).sum();
                *potential = *potential * keep + driven;
            }
            potentials.clone()
        };
        fired.iter().map(step).collect()
    }
}

/// A layer of neurons that fire, and the weights that lead to them.
#[derive(Clone, Debug)]
pub struct Layer {
    /// Name of the layer in the network's file.
    pub name: String,
    /// The weights: one row for each neuron, with one weight for each input.
    pub weights: Vec<Vec<f64>>,
    /// The recurrent weights, from the layer's neurons to the same neurons. Each row holds the weights that lead to one
    /// neuron: one weight from each neuron of the layer. A spike acts one step after it was fired. Empty unless the
    /// layer is recurrent.
    pub recurrent: Vec<Vec<f64>>,
    /// For each neuron, the amount that every step adds to its potential.
    pub bias: Vec<f64>,
    /// Leak and threshold of each neuron.
    pub neurons: Vec<Neuron>,
    /// How a spike resets its neuron's potential.
    pub reset: Reset,
    /// Whether a neuron fires when its potential equals its threshold.
    pub fires: Fires,
}

/// Converts a threshold to a whole number, for chips whose neurons fire at or above their thresholds. Returns the
/// smallest whole potential at which a neuron with this `threshold` fires.
pub(super) fn fires_at(threshold: f64, fires: Fires) -> f64 {
    match fires {
        // The small term keeps rounding errors from changing the result.
        Fires::Above => (threshold + 1e-9).floor() + 1.0,
        Fires::At => (threshold - 1e-9).ceil().max(1.0),
    }
}

/// The parameters of a leaky integrate-and-fire neuron that rests at 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neuron {
    /// Factor by which a step multiplies the potential, 0 to 1; 1 for a perfect integrator.
    pub keep: f64,
    /// Amount by which a step moves the potential towards 0 after the multiplication by `keep`. 0 unless the network
    /// was trained with the leak of tinyODIN.
    pub leak: f64,
    /// Threshold of the potential, above 0.
    pub threshold: f64,
}

impl Neuron {
    /// Returns the potential after the leak of one step.
    pub(super) fn left(self, potential: f64) -> f64 {
        let kept = potential * self.keep;
        if self.leak == 0.0 { kept } else { kept.signum() * (kept.abs() - self.leak).max(0.0) }
    }
}

impl Layer {
    /// Returns the number of inputs of the layer.
    pub fn inputs(&self) -> usize {
        self.weights.first().map_or(0, Vec::len)
    }

    /// Replaces a reset that a neuron of a chip does not have with the most similar reset that it has.
    pub(super) fn reset_by_chip(self) -> Self {
        let reset = match self.reset {
            Reset::ToValueHeld => Reset::ToValue,
            Reset::SubtractNoDelay => Reset::Subtract,
            reset => reset,
        };
        Self { reset, ..self }
    }

    /// Returns whether a potential makes neuron `at` fire.
    pub(super) fn is_over(&self, at: usize, potential: f64) -> bool {
        let Neuron { threshold, .. } = self.neurons[at];
        match self.fires {
            Fires::Above => potential > threshold,
            Fires::At => potential >= threshold,
        }
    }

    fn check(&self) -> Result<()> {
        let Self { weights, recurrent, bias, neurons, .. } = self;
        let first = self.inputs();
        ensure!(!weights.is_empty() && first > 0, LayerKind::NoWeights);
        for (neuron, row) in weights.iter().enumerate() {
            let weights = row.len();
            ensure!(weights == first, LayerKind::Row { neuron, weights, first });
            if let Some(&weight) = row.iter().chain(&bias[neuron..=neuron]).find(|w| !w.is_finite())
            {
                return Err(LayerKind::Weight { neuron, weight }.into());
            }
        }
        let count = neurons.len();
        ensure!(
            recurrent.is_empty()
                || recurrent.len() == count && recurrent.iter().all(|row| row.len() == count),
            LayerKind::NotSquare { neurons: count }
        );
        if let Some(&weight) = recurrent.iter().flatten().find(|weight| !weight.is_finite()) {
            return Err(LayerKind::RecurrentWeight { weight }.into());
        }
        for (neuron, &Neuron { keep, threshold, leak }) in neurons.iter().enumerate() {
            ensure!(
                threshold > 0.0 && threshold.is_finite(),
                LayerKind::Threshold { neuron, threshold }
            );
            ensure!(leak.is_finite() && leak >= 0.0, LayerKind::Leak { neuron, leak });
            ensure!((0.0..=1.0).contains(&keep), LayerKind::Keep { neuron, keep });
        }
        Ok(())
    }

    /// Runs the layer on the inputs of all steps; returns the neurons that fire, by step. For each step and neuron,
    /// calls `see` with the neuron's index and the neuron's potential before a reset.
    pub(super) fn follow(&self, inputs: &Trains, mut see: impl FnMut(usize, f64)) -> Trains {
        let mut potentials = vec![0.0; self.neurons.len()];
        let mut before: Vec<u16> = Vec::new();
        let step = |fired: &Vec<u16>| {
            let mut out = Vec::new();
            for (at, potential) in potentials.iter_mut().enumerate() {
                let weights = &self.weights[at];
                let driven: f64 = fired.iter().map(|&input| weights[usize::from(input)]).sum();
                let back: f64 =
                    before.iter().map(|&own| self.recurrent[at][usize::from(own)]).sum();
                let driven = driven + back + self.bias[at];
                if self.step(at, driven, potential, |potential| see(at, potential)) {
                    out.push(at as u16);
                }
            }
            if !self.recurrent.is_empty() {
                before.clone_from(&out);
            }
            out
        };
        inputs.iter().map(step).collect()
    }

    /// Runs one step of neuron `at`; returns whether it fires. `driven` is the sum of the bias and the weights that the
    /// step adds to the potential. Calls `see` with the potential that the neuron compares with its threshold.
    fn step(&self, at: usize, driven: f64, potential: &mut f64, see: impl FnOnce(f64)) -> bool {
        let Neuron { threshold, .. } = self.neurons[at];
        let fires = |potential| self.is_over(at, potential);
        let (before, was_over) = (*potential, fires(*potential));
        let next = self.neurons[at].left(before) + driven;
        let less = next - threshold;
        // `reached` is compared with the threshold, and `reset` is the potential after a spike. Resets that come a step
        // late have acted before the comparison.
        let (reached, reset) = match self.reset {
            Reset::ToValue => (next, 0.0),
            Reset::NoReset => (next, next),
            Reset::Subtract => (next, less),
            Reset::ToValueLate => {
                let next = if was_over { driven } else { next };
                (next, next)
            }
            Reset::ToValueHeld => {
                let next = if was_over { 0.0 } else { next };
                (next, next)
            }
            Reset::SubtractLate => {
                let next = if was_over { less } else { next };
                (next, next)
            }
            Reset::SubtractNoDelay => {
                let reached = if was_over { less } else { next };
                see(reached);
                *potential = if fires(reached) { less } else { next };
                return fires(reached);
            }
        };
        see(reached);
        *potential = if fires(reached) { reset } else { reached };
        fires(reached)
    }
}

/// Returns an error unless a layer with `inputs` inputs can follow the layer named `before`, which has `neurons`
/// neurons.
pub(super) fn fits(inputs: usize, before: &str, neurons: usize) -> Result<()> {
    let misfit = || LayerKind::Inputs { inputs, before: before.to_owned(), neurons }.into();
    if inputs == neurons { Ok(()) } else { Err(misfit()) }
}

impl Trained {
    /// Returns the layer whose spikes or potentials are the outputs.
    pub(super) fn outputs(&self) -> OutputLayer {
        match (&self.readout, self.layers.last()) {
            (Some(readout), _) => OutputLayer { outputs: readout.weights.len(), fires: false },
            (None, Some(last)) => OutputLayer { outputs: last.neurons.len(), fires: true },
            (None, None) => OutputLayer { outputs: 0, fires: true },
        }
    }

    /// Makes a network whose outputs are the spikes of the last of `layers`.
    ///
    /// # Errors
    /// Returns an error if there are no layers or too many, if a layer does not fit the one before it, or if a number
    /// is invalid.
    pub fn new(layers: Vec<Layer>) -> Result<Self> {
        ensure!(!layers.is_empty(), NetworkKind::NoLayers);
        let (count, most) = (layers.len(), LAYERS);
        ensure!(count <= most, NetworkKind::TooManyLayers { layers: count, most });
        for layer in &layers {
            layer.check().context(&layer.name)?;
        }
        for pair in layers.windows(2) {
            let (before, after) = (&pair[0], &pair[1]);
            fits(after.inputs(), &before.name, before.neurons.len()).context(&after.name)?;
        }
        Ok(Self { layers, readout: None, integers: false })
    }

    /// Makes a network whose outputs are the potentials of `readout`, which follows the last of `layers`. If `readout`
    /// is `None`, the outputs are the spikes of the last layer.
    ///
    /// # Errors
    /// Returns the errors of [`new`](Self::new). Also returns an error if the readout does not fit the last layer, or
    /// if it contains an invalid number.
    pub fn with_readout(layers: Vec<Layer>, readout: Option<Readout>) -> Result<Self> {
        let network = Self::new(layers)?;
        if let (Some(readout), Some(last)) = (&readout, network.layers.last()) {
            readout.check(last.neurons.len()).context(&readout.name)?;
        }
        Ok(Self { readout, ..network })
    }

    /// Sets how the neurons of each layer reset, and whether they fire at the threshold or only above it. Takes both
    /// from `asked`. A single reset in `asked` applies to all layers. Several resets apply to one layer each.
    ///
    /// # Errors
    /// Returns an error if `asked` contains several resets, and their number is not the number of layers.
    pub(super) fn reset_by(mut self, asked: &Asked) -> Result<Self> {
        let (rule, resets, layers) = (asked.or_plain(), &asked.resets, self.layers.len());
        ensure!(
            resets.len() < 2 || resets.len() == layers,
            NetworkKind::Resets { resets: resets.len(), layers }
        );
        for (at, layer) in self.layers.iter_mut().enumerate() {
            let own = if resets.len() < 2 { None } else { resets.get(at) };
            (layer.reset, layer.fires) = (own.copied().unwrap_or(rule.reset), rule.fires);
        }
        Ok(self)
    }

    /// Replaces resets that a neuron of a chip does not have with the most similar resets that it has.
    pub(super) fn reset_by_chip(self) -> Self {
        let layers = self.layers.into_iter().map(Layer::reset_by_chip).collect();
        Self { layers, ..self }
    }

    /// Adapts layers to chips on which a spike subtracts the threshold one step later. Changes only layers in which a
    /// spike subtracts the threshold in the same step. In the trained layer, the leak of the next step also reduces the
    /// subtracted amount. The chip subtracts the whole threshold, after the leak. A positive weight from each neuron to
    /// itself adds the difference to the potential.
    pub(super) fn late(mut self) -> Self {
        for layer in &mut self.layers {
            if layer.reset != Reset::Subtract {
                continue;
            }
            let count = layer.neurons.len();
            layer.reset = Reset::SubtractLate;
            if layer.neurons.iter().all(|neuron| neuron.keep == 1.0) {
                continue;
            }
            if layer.recurrent.is_empty() {
                layer.recurrent = vec![vec![0.0; count]; count];
            }
            for (at, Neuron { keep, threshold, .. }) in layer.neurons.iter().enumerate() {
                layer.recurrent[at][at] += (1.0 - keep) * threshold;
            }
        }
        self
    }

    /// Returns the number of inputs of the network.
    pub fn inputs(&self) -> usize {
        self.layers.first().map_or(0, Layer::inputs)
    }

    /// Runs the network on the inputs of all steps; returns the neurons that fire, by layer, then by step. A spike
    /// passes through all layers within its step.
    pub fn run(&self, inputs: &Trains) -> Vec<Trains> {
        let mut all: Vec<Trains> = Vec::new();
        for layer in &self.layers {
            let fired = layer.follow(all.last().unwrap_or(inputs), |_, _| ());
            all.push(fired);
        }
        all
    }

    /// Computes the potentials of the outputs in each step from `fired`, the spikes of all layers. Returns an empty
    /// list if the network's outputs are the spikes of the last layer.
    pub fn potentials(&self, fired: &[Trains]) -> Vec<Vec<f64>> {
        let (Some(readout), Some(fired)) = (&self.readout, fired.last()) else { return vec![] };
        readout.run(fired)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layer(weights: &[&[f64]], keep: f64, threshold: f64) -> Layer {
        Layer {
            name: "a layer".to_owned(),
            weights: weights.iter().map(|row| row.to_vec()).collect(),
            recurrent: vec![],
            bias: vec![0.0; weights.len()],
            neurons: vec![Neuron { keep, threshold, leak: 0.0 }; weights.len()],
            reset: Reset::ToValue,
            fires: Fires::Above,
        }
    }

    /// For a decay factor of 1/2 and a threshold of 4, each reset gives the spikes that are listed in the documentation
    /// of `spikewire-network`. All numbers are exact.
    #[test]
    fn each_reset_has_its_spikes() {
        let drive = [3, 3, 0, 4, 1, 5, 2, 0, 0, 6, 6, -4, 2, 7, 1, 8];
        for (reset, fires, expected) in [
            (Reset::ToValue, Fires::Above, "0100010001100101"),
            (Reset::ToValue, Fires::At, "0101010001100101"),
            (Reset::ToValueLate, Fires::Above, "0100010001100101"),
            (Reset::SubtractLate, Fires::Above, "0100010001100101"),
            (Reset::Subtract, Fires::At, "0101010001100101"),
        ] {
            let layer = Layer { reset, fires, ..layer(&[&[1.0]], 0.5, 4.0) };
            let mut potential = 0.0;
            let spikes = drive.map(|x| layer.step(0, f64::from(x), &mut potential, |_| ()));
            let spikes: String =
                spikes.iter().map(|fires| if *fires { '1' } else { '0' }).collect();
            assert_eq!(spikes, expected, "{reset:?} {fires:?}");
        }
    }

    #[test]
    fn a_neuron_leaks_adds_up_fires_above_its_threshold_and_starts_again() {
        // The potentials are 0.6, then 0.3 + 0.6 = 0.9, 0.45, and 0.225 + 1.2, at which the neuron fires and keeps 0.6.
        let one = layer(&[&[0.6]], 0.5, 1.0);
        let inputs = vec![vec![0], vec![0], vec![], vec![0, 0], vec![0]];
        assert_eq!(one.follow(&inputs, |_, _| ()), [vec![], vec![], vec![], vec![0], vec![]]);
        // A neuron does not fire at exactly its threshold.
        let exact = layer(&[&[0.5]], 1.0, 1.0);
        let fired = exact.follow(&vec![vec![0]; 6], |_, _| ());
        assert_eq!(fired, [vec![], vec![], vec![0], vec![], vec![], vec![0]]);
    }

    #[test]
    fn a_recurrent_spike_acts_in_the_next_step() {
        let one = layer(&[&[2.0], &[0.0]], 1.0, 1.0);
        let back = Layer { recurrent: vec![vec![0.0, 0.0], vec![1.5, 0.0]], ..one };
        let fired = back.follow(&vec![vec![0], vec![], vec![], vec![0], vec![0]], |_, _| ());
        assert_eq!(fired, [vec![0], vec![1], vec![], vec![0], vec![0, 1]]);
    }

    #[test]
    fn a_readout_adds_up_and_leaks() {
        let one = layer(&[&[2.0]], 1.0, 1.0);
        let readout = Readout {
            name: "outputs".to_owned(),
            weights: vec![vec![1.0], vec![-2.0]],
            keep: vec![0.5, 1.0],
        };
        let network = Trained::with_readout(vec![one], Some(readout)).unwrap();
        let fired = network.run(&vec![vec![0], vec![], vec![0]]);
        assert_eq!(network.potentials(&fired), [[1.0, -2.0], [0.5, -2.0], [1.25, -4.0]]);
    }

    #[test]
    fn a_step_passes_through_all_layers() {
        let network = Trained::new(vec![
            layer(&[&[2.0, 0.0], &[0.0, 2.0]], 1.0, 1.0),
            layer(&[&[2.0, -2.0]], 1.0, 1.0),
        ]);
        let fired = network.unwrap().run(&vec![vec![0], vec![1], vec![0], vec![0]]);
        assert_eq!(fired[0], [vec![0], vec![1], vec![0], vec![0]]);
        assert_eq!(fired[1], [vec![0], vec![], vec![], vec![0]]);
    }
}
