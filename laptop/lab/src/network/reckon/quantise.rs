//! Quantises a network from double precision to the integers of the chip `ReckOn`.

use super::super::trained::{Readout, fires_at};
use super::super::{Distance, Trained, Trains};
use super::part::{Part, Seat};
use super::place::Places;
use super::recorded::{Group, Recorded};
use super::round::{Rounded, Traces, clipped};
use crate::network::Fires;
use crate::network::fault::{FitKind, Result, ensure};
use rayon::prelude::*;
use spikewire_chips::{
    DescribeReckOn, ReckOnOutputs, ReckOnPair, ReckOnShared, ReckOnSteps, ReckOnTick,
};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The integer that stands for a decay factor of 1. Each tick of the chip multiplies a neuron's potential by its decay
/// factor.
pub(super) const KEEP: f64 = 32_768.0;
/// The integer that stands for an output's decay factor of 1. Each tick of the chip multiplies the output's potential
/// by its decay factor.
const OUTPUT_KEEP: f64 = 128.0;
/// Largest difference between a neuron's decay factor of a step on the chip and the trained one that is not reported.
const KEEP_TOLERANCE: f64 = 1e-4;
/// Largest relative error of a leak of the chip's outputs. Beyond it, the driver leaks the outputs.
const LEAK_TOLERANCE: f64 = 0.02;
/// Smallest factor by which the chip can multiply a neuron's potential in a tick. One step of the network takes one or
/// more ticks of the chip.
pub(super) const LEAST_KEEP: f64 = 0.875;
/// Maximum number of the chip's ticks that one step of the network takes.
const MOST_TICKS: u32 = 16;
pub(super) const LARGEST: f64 = 127.0;
/// Largest potential, in the chip's units, that a neuron may reach in the recording. The rest of the 16-bit range is
/// left for other recordings.
const ROOM: f64 = 0.8 * 32_767.0;
/// Largest sum of an output's weights of one sign, in the chip's units and before they are rounded, if the driver leaks
/// the outputs. Rounding up to 256 weights adds less than the rest up to [`ReckOnOutputs::LEAKY_SUM`].
const LEAKY_ROOM: f64 = ReckOnOutputs::LEAKY_SUM as f64 - 256.0;
/// Number of scales of weights to try for a pair: two neurons of the chip that share a leak and a threshold. The scales
/// lie evenly between half of the largest scale at which the pair's weights and potentials fit the chip, and all of it.
const SCALES: u32 = 200;
/// Number of scales, those at which rounding changes the potentials least, at which the pair is simulated.
const SIMULATED: usize = 32;
/// Number of left shifts that the chip offers for weights. The chip can shift weights by 0 to 7 bits.
const SHIFTS: u8 = 8;
/// A network in the integers of `ReckOn`.
#[derive(Clone, Debug)]
pub(super) struct Quantised {
    pub(super) places: Places,
    pub(super) pairs: Vec<ReckOnPair>,
    /// The weights of inputs: one row for each input, with one weight for each neuron of the chip. The bias is the last
    /// input, if the network has a bias.
    pub(super) inputs: Vec<Vec<i8>>,
    /// Number of inputs of the network itself: all but those of biases and gates.
    own_inputs: usize,
    /// The weights between neurons: one row for each sending neuron, with one weight for each receiving neuron.
    pub(super) recurrent: Vec<Vec<i8>>,
    /// The weights of outputs: one row for each neuron, with one weight for each output.
    pub(super) outputs: Vec<Vec<i8>>,
    pub(super) shared: ReckOnShared,
    /// The ticks of a step. Each lists the inputs that fire before the tick in addition to the network's own inputs.
    pub(super) ticks: Vec<Tick>,
    /// For each layer, its name and its number of neurons.
    pub(super) layers: Vec<(String, usize)>,
    /// Factor that converts an output's potential on the chip to the units of the trained network. `None` if the
    /// outputs report the spikes of neurons.
    pub(super) unit: Option<f64>,
    /// For each output, the share of its potential that a step keeps. Empty unless the driver leaks the potentials.
    pub(super) keeps: Vec<f32>,
    /// Largest share of the 16 bits of a potential that an output reaches in the recording; `None` unless the chip leaks
    /// the potentials. Outputs whose potentials the driver leaks cannot leave the 16 bits.
    pub(super) output_peak: Option<f64>,
    /// For each layer, how rounding changed its weights. If the outputs are potentials, one more entry is for the
    /// weights of the outputs.
    pub(super) changes: Vec<Change>,
    /// Number of neurons whose leak on the chip differs from the trained one, and the largest difference between the
    /// two decay factors of a step. Leaks differ because the two neurons of a pair share one, and because a tick keeps
    /// at least [`LEAST_KEEP`].
    pub(super) shared_keeps: (usize, f64),
    /// The reason for which resets without a delay are not on the chip. `None` if they are, or if there are none.
    pub(super) no_room: Option<String>,
}

/// A tick of a step. At each tick, the chip's neurons leak and compare their potentials with their thresholds.
///
/// A step has several ticks if the trained neurons leak more in a step than the chip's neurons can leak in a tick. The
/// network's own inputs fire before the first tick of the step. Layer `n` is to fire only at tick `n`, modulo the
/// number of ticks in a step.
///
/// If spikes subtract the threshold or act on their own layer, *gates* keep the layer from firing at other ticks. Gates
/// are additional inputs. Some of them lower all neurons of the layer after the tick at which the layer may fire. The
/// others raise the neurons again before the next tick at which the layer may fire.
#[derive(Clone, Debug, Default)]
pub(super) struct Tick {
    /// Numbers of the inputs that fire before this tick in every step: biases, and gates that lower neurons.
    pub(super) always: Vec<u8>,
    /// Numbers of the gates (which are inputs) that raise neurons before this tick. In the first step, only the last
    /// tick's gates fire, as only the neurons that they raise have been lowered by then: at the first tick. All other
    /// neurons are lowered for the first time after they have been compared with their thresholds.
    pub(super) raises: Vec<u8>,
}

/// How rounding changed the weights of a layer, or those of the outputs.
#[derive(Clone, Debug, Default)]
pub(super) struct Change {
    pub(super) name: String,
    pub(super) weights: usize,
    /// Number of weights that exceeded the chip's range and were clipped.
    pub(super) clipped: usize,
    /// Number of weights other than 0 that were rounded to 0.
    pub(super) vanished: usize,
    /// Sum of the squared weights, then sum of the squared amounts by which rounding changed the weights.
    sums: [f64; 2],
}

impl Change {
    /// Returns the root mean square of the amounts by which rounding changed the weights, divided by the root mean
    /// square of the weights.
    pub(super) fn relative(&self) -> f64 {
        let [weights, changes] = self.sums;
        if weights > 0.0 { (changes / weights).sqrt() } else { 0.0 }
    }

    /// Rounds `weight * scale` to an integer, clips it to the range of the chip's weights, and returns it. Adds the
    /// weight and its change to the statistics in `self`.
    fn weight(&mut self, weight: f64, scale: f64) -> i8 {
        let held = clipped(weight * scale) as i8;
        self.held(weight, held, scale);
        held
    }

    /// Adds a weight to the statistics that the chip holds as the integer `held`.
    fn held(&mut self, weight: f64, held: i8, scale: f64) {
        self.weights += 1;
        self.clipped += usize::from(clipped(weight * scale) != (weight * scale).round());
        self.vanished += usize::from(held == 0 && weight != 0.0);
        let change = f64::from(held) / scale - weight;
        self.sums[0] += weight * weight;
        self.sums[1] += change * change;
    }
}

/// A neuron of the chip in double precision, and the weights that lead to the neuron. Weights and potentials are in
/// units of the neuron's threshold.
pub(super) struct Source {
    pub(super) seat: Seat,
    pub(super) keep: f64,
    /// The neuron's threshold, in the units of the trained network.
    pub(super) threshold: f64,
    /// The weight of each input.
    pub(super) inputs: Vec<f64>,
    pub(super) bias: f64,
    /// Amount that the gates add in each step, besides raising the neuron by what they lowered it.
    pub(super) raise: f64,
    /// Amount by which gates lower the neuron; 0 if the neuron needs no gates. Gates are inputs that keep the neuron
    /// from firing at some ticks.
    pub(super) gate: f64,
    /// The neurons that send spikes to this one. Each entry is the sender's number on the chip, and the weight.
    pub(super) recurrent: Vec<(usize, f64)>,
    /// Sum of two amounts: the largest absolute potential that the neuron reaches in double precision, and the amount
    /// [`gate`](Self::gate) by which gates lower the neuron.
    pub(super) peak: f64,
}

fn largest(weights: impl Iterator<Item = f64>) -> f64 {
    weights.fold(0.0, |most, weight| most.max(weight.abs()))
}

/// Returns the largest sum of weights of one sign that lead to an output, without its sign.
fn sum_of_a_sign(weights: &[Vec<f64>]) -> f64 {
    let mut most = 0.0_f64;
    for row in weights {
        let rises: f64 = row.iter().filter(|weight| **weight > 0.0).sum();
        let falls: f64 = row.iter().filter(|weight| **weight < 0.0).sum();
        most = most.max(rises).max(-falls);
    }
    most
}

impl Source {
    fn largest(&self) -> [f64; 2] {
        [
            largest(self.inputs.iter().copied().chain([self.bias])),
            largest(self.recurrent.iter().map(|(_, weight)| *weight)),
        ]
    }
}

/// Returns the largest factor by which the weights and potentials of a pair can be multiplied so that all of them fit
/// the chip. A pair is two neurons of the chip that share a leak and a threshold. `shifts` has two entries: the chip's
/// left shift of input weights, and its left shift of weights between neurons.
fn scale(pair: &[Source], shifts: [u8; 2]) -> f64 {
    let room = largest(pair.iter().map(|source| source.peak.max(1.0)));
    let of_kind = |kind: usize| {
        let most = largest(pair.iter().map(|source| source.largest()[kind]));
        if most > 0.0 { LARGEST * f64::from(1 << shifts[kind]) / most } else { f64::INFINITY }
    };
    (ROOM / room).min(of_kind(0)).min(of_kind(1))
}

/// Returns a measure of how much rounding changes a pair: two neurons of the chip that share a leak and a threshold.
/// The measure is the sum of the squared changes of all weights, plus the squared loss of potential of each neuron. A
/// neuron loses potential because the chip rounds each leak. `shifts` has the same meaning as for [`scale`].
fn change(pair: &[Source], shifts: [u8; 2]) -> f64 {
    let scale = scale(pair, shifts);
    let [inputs, recurrent] = shifts.map(|shift| scale / f64::from(1 << shift));
    let squared = |weight: f64, scale: f64| ((weight * scale).round() / scale - weight).powi(2);
    let of_source = |source: &Source| {
        let inputs: f64 =
            source.inputs.iter().chain([&source.bias]).map(|&weight| squared(weight, inputs)).sum();
        let own: f64 = source.recurrent.iter().map(|&(_, weight)| squared(weight, recurrent)).sum();
        let lost = 0.5 / (1.0 - source.keep).max(0.01) / scale;
        inputs + own + lost * lost
    };
    pair.iter().map(of_source).sum()
}

/// Quantises a network for the chip. First chooses the left shifts of weights at which rounding changes the weights
/// least. Then chooses a scale for each pair of neurons: among those at which rounding changes the potentials least,
/// the one with the smallest sum of two numbers: the distance of the spikes from those in double precision, and the
/// mean squared error of the potentials. All other neurons are assumed to fire as in double precision. Calls `progress`
/// with the number of finished neurons and the total number of neurons.
///
/// # Errors
/// Returns an error if the network does not fit the chip.
pub(super) fn quantise(
    trained: &Trained,
    inputs: &Trains,
    fired: &[Trains],
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<Quantised> {
    let has_bias = trained.layers.iter().any(|layer| layer.bias.iter().any(|bias| *bias != 0.0));
    let places = Places::new(trained, has_bias)?;
    let resets_to_zero = !trained.layers.iter().any(|layer| layer.reset.subtracts());
    ensure!(
        resets_to_zero || trained.layers.iter().all(|layer| layer.reset.subtracts()),
        FitKind::MixedResets
    );
    let mut neurons = trained.layers.iter().flat_map(|layer| &layer.neurons);
    ensure!(neurons.all(|neuron| neuron.leak == 0.0), FitKind::LeakByAmount { owner: "ReckOn's" });
    let at = trained.layers.first().map_or(Fires::Above, |layer| layer.fires);
    let ticks = ticks(trained);
    let original = Recorded::new(trained, &places, ticks, inputs, fired);
    let pairs: Vec<Vec<Source>> = places
        .pairs()
        .map(|pair| pair.into_iter().map(|seat| original.source(seat)).collect())
        .collect();
    let all = (0..SHIFTS).flat_map(|input| (0..SHIFTS).map(move |own| [input, own]));
    let integers = trained.integers;
    let is_whole = |pair: &Vec<Source>, shifts| exact_scale(pair, shifts, ticks).is_some();
    let are_whole = |shifts: [u8; 2]| integers && pairs.iter().all(|pair| is_whole(pair, shifts));
    let change = |&shifts: &[u8; 2]| {
        let changes = pairs.iter().map(|pair| change(pair, shifts));
        if are_whole(shifts) { -1.0 } else { changes.sum::<f64>() }
    };
    let changes: Vec<([u8; 2], f64)> = all.map(|shifts| (shifts, change(&shifts))).collect();
    let best = changes.iter().min_by(|(_, one), (_, other)| one.total_cmp(other));
    let shifts = best.map_or([0; 2], |(shifts, _)| *shifts);

    let done = AtomicUsize::new(0);
    let total: usize = places.neurons.iter().flatten().count();
    let rule = Rule { ticks, integers, resets_to_zero, fires: at };
    let chosen = pairs.par_iter().map(|pair| {
        let chosen = Chosen::new(pair, &original, shifts, rule);
        progress(done.fetch_add(pair.len(), Ordering::Relaxed) + pair.len(), total);
        chosen
    });
    let chosen: Vec<Chosen> = chosen.collect();

    let count = places.neurons.len();
    let mut network = Quantised {
        pairs: Vec::new(),
        inputs: vec![vec![0; count]; trained.inputs()],
        own_inputs: trained.inputs(),
        recurrent: vec![vec![0; count]; count],
        outputs: Vec::new(),
        shared: ReckOnShared { shifts: [shifts[0], shifts[1], 0], keep: 0, resets_to_zero },
        ticks: vec![Tick::default(); ticks],
        layers: trained.layers.iter().map(|l| (l.name.clone(), l.neurons.len())).collect(),
        unit: None,
        keeps: vec![],
        output_peak: None,
        changes: trained
            .layers
            .iter()
            .map(|layer| Change { name: layer.name.clone(), ..Change::default() })
            .collect(),
        shared_keeps: (0, 0.0),
        no_room: None,
        places,
    };
    for (pair, Chosen { keep, scale, rounded }) in pairs.iter().zip(&chosen) {
        network.pairs.push(ReckOnPair { keep: *keep, threshold: fires_at(*scale, at) as i16 });
        for (source, rounded) in pair.iter().zip(rounded) {
            network.put(source, rounded, *scale, shifts);
            network.tell_keep(source.keep, (f64::from(*keep) / KEEP).powi(ticks as i32));
        }
    }
    network.put_bias(&pairs, &chosen, shifts[0]);
    network.put_gates(&pairs, &chosen, shifts[0]);
    let (inputs, most) = (network.inputs.len(), Places::INPUTS);
    ensure!(inputs <= most, FitKind::Inputs { most, inputs, has_bias });
    match &trained.readout {
        Some(readout) => {
            network.read_out(readout, &trained.potentials(fired), integers);
        }
        None => network.follow(trained.layers.len() - 1),
    }
    Ok(network)
}

/// Returns the number of ticks in a step: the smallest number of ticks, up to [`MOST_TICKS`], in which a neuron of the
/// chip can leak as much as the network's neurons leak in a step. Neurons that compare twice in a step need two ticks.
fn ticks(trained: &Trained) -> usize {
    let neurons = trained.layers.iter().flat_map(|layer| &layer.neurons);
    let least = neurons.map(|neuron| neuron.keep).fold(1.0, f64::min);
    let most = LEAST_KEEP.powi(MOST_TICKS as i32);
    let compared =
        if trained.layers.iter().any(|layer| Part::of(layer).len() > 1) { 2.0 } else { 1.0 };
    (least.max(most).ln() / LEAST_KEEP.ln() - 1e-9).ceil().max(compared) as usize
}

/// Returns the factor by which a tick multiplies a neuron's potential. The factor is at least [`LEAST_KEEP`]. `keep` is
/// the factor for a whole step, and `ticks` is the number of ticks in a step.
pub(super) fn keep_of(keep: f64, ticks: usize) -> f64 {
    keep.powf(1.0 / ticks as f64).max(LEAST_KEEP)
}

fn mean_keep(pair: &[Source], ticks: usize) -> u16 {
    let kept = pair.iter().map(|source| keep_of(source.keep, ticks));
    (kept.sum::<f64>() / pair.len().max(1) as f64 * KEEP).round() as u16
}

/// Returns whether the chip holds `weight * scale` exactly.
fn is_whole(weight: f64, scale: f64) -> bool {
    (weight * scale - clipped(weight * scale)).abs() < 1e-9
}

/// Returns the scale at which the chip's integers are exactly the trained numbers, or `None` if there is no such scale.
/// Serves only networks that were trained in the chip's integers: in others, whole numbers may be too small to leak
/// as trained, since the chip rounds potentials down. `shifts` has the same meaning as for [`scale`], and `ticks` is the
/// number of ticks in a step.
fn exact_scale(pair: &[Source], shifts: [u8; 2], ticks: usize) -> Option<f64> {
    let scale = pair.first().map_or(1.0, |source| source.threshold);
    let [inputs, recurrent] = shifts.map(|shift| scale / f64::from(1 << shift));
    let kept = (f64::from(mean_keep(pair, ticks)) / KEEP).powi(ticks as i32);
    let are_whole = pair.iter().all(|source| {
        source.threshold == scale
            && source.bias == 0.0
            && source.gate == 0.0
            && (source.keep - kept).abs() < 1e-9
            && source.inputs.iter().all(|weight| is_whole(*weight, inputs))
            && source.recurrent.iter().all(|(_, weight)| is_whole(*weight, recurrent))
    });
    (are_whole && scale <= 32_767.0).then_some(scale)
}

/// The scale and the leak of a pair, and its neurons' weights in the chip's integers.
struct Chosen {
    keep: u16,
    scale: f64,
    rounded: Vec<Rounded>,
}

impl Chosen {
    /// Chooses the scale of a pair, as [`quantise`] says.
    fn new(pair: &[Source], original: &Recorded, shifts: [u8; 2], rule: Rule) -> Self {
        let keep = mean_keep(pair, rule.ticks);
        let of = |source: &Source| Traces::new(source, keep, rule, original.group(source.seat));
        let traces: Vec<Traces> = pair.iter().map(of).collect();
        if let Some(scale) = exact_scale(pair, shifts, rule.ticks).filter(|_| rule.integers) {
            let of = |(source, traces): (&Source, &Traces)| {
                Rounded::new(source, traces, keep, scale, shifts, rule.ticks)
            };
            return Self { keep, scale, rounded: pair.iter().zip(&traces).map(of).collect() };
        }
        let most = scale(pair, shifts);
        let mut rounded: Vec<(f64, f64, Vec<Rounded>)> = (0..SCALES)
            .map(|part| most * (1.0 - 0.5 * f64::from(part) / f64::from(SCALES)))
            .map(|scale| {
                let of = |(source, traces): (&Source, &Traces)| {
                    Rounded::new(source, traces, keep, scale, shifts, rule.ticks)
                };
                let all: Vec<Rounded> = pair.iter().zip(&traces).map(of).collect();
                (all.iter().map(|rounded| rounded.error).sum(), scale, all)
            })
            .collect();
        rounded.sort_by(|(one, ..), (other, ..)| one.total_cmp(other));
        rounded.truncate(SIMULATED);
        let simulated = rounded.into_iter().map(|(error, scale, all)| {
            let of = |(source, rounded): (&Source, &Rounded)| {
                let held = Held::new(rounded, keep, scale, shifts, rule);
                held.distance(original.group(source.seat), source.seat.neuron)
            };
            let distance: f64 = pair.iter().zip(&all).map(of).sum();
            (distance + error, Self { keep, scale, rounded: all })
        });
        let best = simulated.min_by(|(one, _), (other, _)| one.total_cmp(other));
        best.expect("several scales are simulated").1
    }
}

/// The rule by which all neurons of the chip fire and reset.
#[derive(Clone, Copy)]
pub(super) struct Rule {
    /// Number of ticks in a step.
    pub(super) ticks: usize,
    /// Whether the network was trained in the chip's integers.
    pub(super) integers: bool,
    pub(super) resets_to_zero: bool,
    pub(super) fires: Fires,
}

/// A neuron in the chip's integers, for a simulation of this neuron alone.
struct Held {
    keep: i32,
    threshold: i32,
    inputs: Vec<i32>,
    recurrent: BTreeMap<usize, i32>,
    bias: i32,
    /// Amount by which gates lower the neuron, and amount by which gates raise the neuron again. Gates are inputs that
    /// keep the neuron from firing at some ticks.
    gates: (i32, i32),
    rule: Rule,
}

impl Held {
    fn new(rounded: &Rounded, keep: u16, scale: f64, shifts: [u8; 2], rule: Rule) -> Self {
        let of = |&(from, weight): &(usize, i8)| (from, i32::from(weight) << shifts[1]);
        let recurrent = rounded.recurrent.iter().map(of).collect();
        Self {
            keep: keep.into(),
            threshold: fires_at(scale, rule.fires) as i32,
            inputs: rounded.inputs.iter().map(|weight| i32::from(*weight) << shifts[0]).collect(),
            recurrent,
            bias: i32::from(rounded.bias) << shifts[0],
            gates: rounded.gates,
            rule,
        }
    }

    /// Runs the neuron on the spikes that act on `group`. Returns the distance between two spike trains: the neuron's
    /// spikes in this run, and the spikes of the neuron with index `neuron` in double precision.
    fn distance(&self, group: &Group, neuron: usize) -> f64 {
        let (mut potential, mut distance) = (0_i32, Distance::default());
        let (mut is_over, mut raised) = (false, 0);
        let mut added = vec![0; self.rule.ticks];
        for (drive, meant) in group.drives.iter().zip(&group.fired) {
            added.fill(0);
            added[0] += raised;
            if let Some(second) = added.get_mut(1) {
                *second -= self.gates.0;
            }
            let inputs = drive.inputs.iter().map(|&input| self.inputs[usize::from(input)]);
            added[group.ahead] += inputs.sum::<i32>() + self.bias;
            for (tick, from) in &drive.spikes {
                added[*tick] += self.recurrent.get(from).unwrap_or(&0);
            }
            let mut count = 0;
            for added in &added {
                let kept = match (is_over, self.rule.resets_to_zero) {
                    (false, _) => (potential * self.keep) >> 15,
                    (true, true) => 0,
                    (true, false) => ((potential * self.keep) >> 15) - self.threshold,
                };
                potential = (kept + added).clamp(i16::MIN.into(), i16::MAX.into());
                is_over = potential >= self.threshold;
                count += usize::from(is_over);
            }
            raised = self.gates.1;
            let meant = meant.iter().filter(|fired| usize::from(**fired) == neuron).count();
            distance.step(count, meant);
        }
        distance.value()
    }
}

impl Quantised {
    /// Returns the delay of the chip's outputs: the number of ticks between the inputs of a step and the output values
    /// that show the effect of these inputs.
    pub(super) fn late(&self) -> usize {
        self.layers.len() + 1
    }

    /// Returns the description of a step for the driver. `ticks` are those of [`ticks`](Self::ticks).
    pub(super) fn steps<'a>(&'a self, ticks: &'a [ReckOnTick<'a>]) -> ReckOnSteps<'a> {
        let outputs = match self.unit {
            None => ReckOnOutputs::Spikes,
            Some(unit) if self.keeps.is_empty() => ReckOnOutputs::Potentials { unit: unit as f32 },
            Some(unit) => ReckOnOutputs::Leaky { unit: unit as f32, keeps: &self.keeps },
        };
        ReckOnSteps { inputs: self.own_inputs as u16, ticks, late: self.late() as u16, outputs }
    }

    /// Adds an input, and returns the number of the input. Each entry of `weights` is the number of a neuron of the
    /// chip, and the weight from the input to this neuron. All other weights of the input are 0.
    fn add_input(&mut self, weights: impl IntoIterator<Item = (usize, i8)>) -> usize {
        let mut row = vec![0; self.places.neurons.len()];
        for (at, weight) in weights {
            row[at] = weight;
        }
        self.inputs.push(row);
        self.inputs.len() - 1
    }

    /// Adds the inputs that carry the biases of neurons. For each tick of a step, one input carries the biases of the
    /// layers that may fire at this tick. There is no such input if all these biases are 0.
    fn put_bias(&mut self, pairs: &[Vec<Source>], chosen: &[Chosen], shift: u8) {
        for tick in 0..self.ticks.len() {
            let mut weights = Vec::new();
            for (pair, Chosen { scale, rounded, .. }) in pairs.iter().zip(chosen) {
                for (source, rounded) in pair.iter().zip(rounded) {
                    let Seat { layer, .. } = source.seat;
                    if layer % self.ticks.len() == tick && source.bias != 0.0 {
                        weights.push((self.places.of(source.seat), rounded.bias));
                        let scale = scale / f64::from(1 << shift);
                        let change = &mut self.changes[layer];
                        change.held(rounded.exact_bias, rounded.bias, scale);
                    }
                }
            }
            if !weights.is_empty() {
                let input = self.add_input(weights);
                self.ticks[tick].always.push(input as u8);
            }
        }
    }

    /// Adds the gates. Gates are inputs that keep neurons from firing except at their own tick of a step. Some gates
    /// lower the neurons before the tick after their own. The others raise the neurons again before their own tick comes
    /// again.
    fn put_gates(&mut self, pairs: &[Vec<Source>], chosen: &[Chosen], shift: u8) {
        let ticks = self.ticks.len();
        for (lowers, tick) in (0..ticks).flat_map(|tick| [(true, tick), (false, tick)]) {
            let mut rests: Vec<(usize, i32)> = Vec::new();
            for (pair, Chosen { rounded, .. }) in pairs.iter().zip(chosen) {
                for (Source { seat, .. }, Rounded { gates, .. }) in pair.iter().zip(rounded) {
                    let own = seat.part.tick(seat.layer, ticks);
                    let (at, amount) =
                        if lowers { ((own + 1) % ticks, -gates.0) } else { (own, gates.1) };
                    if at == tick {
                        rests.push((self.places.of(*seat), amount >> shift));
                    }
                }
            }
            while rests.iter().any(|(_, rest)| *rest != 0) {
                let take = |(at, rest): &mut (usize, i32)| {
                    let weight = (*rest).clamp(-128, 127);
                    *rest -= weight;
                    (*at, weight as i8)
                };
                let weights: Vec<(usize, i8)> = rests.iter_mut().map(take).collect();
                let input = self.add_input(weights) as u8;
                let Tick { always, raises } = &mut self.ticks[tick];
                if lowers { always.push(input) } else { raises.push(input) }
            }
        }
    }

    fn put(&mut self, source: &Source, rounded: &Rounded, scale: f64, shifts: [u8; 2]) {
        let at = self.places.of(source.seat);
        // Other parts have copies of the weights, or weights that were not trained.
        let counts = source.seat.part == Part::Main;
        let change = &mut self.changes[source.seat.layer];
        let mut tell = |weight, held, scale| {
            if counts {
                change.held(weight, held, scale);
            }
        };
        let [inputs, recurrent] = shifts.map(|shift| scale / f64::from(1 << shift));
        for ((row, &weight), &held) in
            self.inputs.iter_mut().zip(&source.inputs).zip(&rounded.inputs)
        {
            if weight != 0.0 {
                tell(weight, held, inputs);
                row[at] = held;
            }
        }
        for (&(from, held), &(_, weight)) in rounded.recurrent.iter().zip(&source.recurrent) {
            if weight != 0.0 {
                tell(weight, held, recurrent);
                self.recurrent[from][at] = held;
            }
        }
    }

    fn tell_keep(&mut self, trained: f64, held: f64) {
        let (count, most) = &mut self.shared_keeps;
        let difference = (trained - held).abs();
        *count += usize::from(difference > KEEP_TOLERANCE);
        *most = most.max(difference);
    }

    /// Sets the weights, the shift and the leak of the outputs in a network whose outputs are potentials instead of
    /// spikes. The chip leaks them if its one leak is near enough to all of theirs, otherwise the driver. `integers` says whether the network was trained in the chip's integers: their
    /// weights stay as they are if the chip holds them and leaks.
    fn read_out(&mut self, readout: &Readout, potentials: &[Vec<f64>], integers: bool) {
        let Readout { name, weights, keep } = readout;
        let ticks = self.ticks.len();
        let kept = keep.iter().map(|keep| keep.powf(1.0 / ticks as f64));
        let mean = kept.sum::<f64>() / keep.len() as f64;
        let mut held = (mean * OUTPUT_KEEP).round();
        let is_near = |keep: &f64| {
            (keep - (held / OUTPUT_KEEP).powi(ticks as i32)).abs() <= LEAK_TOLERANCE * (1.0 - keep)
        };
        let chip_leaks = held >= 1.0 && keep.iter().all(is_near);
        let most = largest(weights.iter().flatten().copied()).max(f64::MIN_POSITIVE);
        let reached = largest(potentials.iter().flatten().copied());
        let (mut shifts, mut room) = (0..SHIFTS, ROOM / reached.max(most));
        if !chip_leaks {
            self.keeps = keep.iter().map(|keep| *keep as f32).collect();
            held = f64::from(ReckOnOutputs::LEAKY_KEEP);
            (shifts, room) = (1..2, LEAKY_ROOM / sum_of_a_sign(weights).max(most));
        }
        let fits = |shift: &u8| LARGEST * f64::from(1 << shift) / most <= room;
        let are_whole = |shift: &u8| {
            weights.iter().flatten().all(|weight| is_whole(*weight, 1.0 / f64::from(1 << shift)))
        };
        let whole = (0..SHIFTS).find(|shift| integers && chip_leaks && are_whole(shift));
        let shift = whole.or(shifts.clone().rev().find(fits)).unwrap_or(shifts.start);
        let largest = (LARGEST * f64::from(1 << shift) / most).min(room);
        let scale = if whole.is_some() { 1.0 } else { largest };
        let mut change = Change { name: name.clone(), ..Change::default() };
        let last = self.layers.len() - 1;
        self.outputs = vec![vec![0; weights.len()]; self.places.neurons.len()];
        for (output, row) in weights.iter().enumerate() {
            for (neuron, &weight) in row.iter().enumerate() {
                self.outputs[self.places.of(Seat::main(last, neuron))][output] =
                    change.weight(weight, scale / f64::from(1 << shift));
            }
        }
        self.changes.push(change);
        self.shared.shifts[2] = shift;
        self.shared.keep = held as u8;
        // The chip sends a potential after it has leaked once more.
        self.unit = Some(if chip_leaks { OUTPUT_KEEP / held / scale } else { 1.0 / scale });
        self.output_peak = chip_leaks.then_some(reached * scale / f64::from(i16::MAX));
    }

    /// Adds, for each neuron of layer `last`, an output that reports the neuron's spikes.
    fn follow(&mut self, last: usize) {
        let (weight, shift, keep) = ReckOnOutputs::SPIKES;
        let outputs = self.layers[last].1;
        self.outputs = vec![vec![0; outputs]; self.places.neurons.len()];
        for output in 0..outputs {
            self.outputs[self.places.of(Seat::main(last, output))][output] = weight;
        }
        self.shared.shifts[2] = shift;
        self.shared.keep = keep;
    }
}

fn at(rows: &[Vec<i8>], row: u16, column: u16) -> i8 {
    let row = rows.get(usize::from(row));
    row.and_then(|row| row.get(usize::from(column))).copied().unwrap_or(0)
}

impl DescribeReckOn for Quantised {
    fn neurons(&self) -> u16 {
        self.places.neurons.len() as u16
    }

    fn inputs(&self) -> u16 {
        self.inputs.len() as u16
    }

    fn outputs(&self) -> u16 {
        self.outputs.first().map_or(0, Vec::len) as u16
    }

    fn pair(&self, pair: u16) -> ReckOnPair {
        self.pairs.get(usize::from(pair)).copied().unwrap_or(ReckOnPair::REST)
    }

    fn input_weight(&self, input: u16, neuron: u16) -> i8 {
        at(&self.inputs, input, neuron)
    }

    fn recurrent_weight(&self, from: u16, to: u16) -> i8 {
        at(&self.recurrent, from, to)
    }

    fn output_weight(&self, neuron: u16, output: u16) -> i8 {
        at(&self.outputs, neuron, output)
    }

    fn shared(&self) -> ReckOnShared {
        self.shared
    }
}
