//! Tests of `Steps`: time steps in which each neuron compares its potential with its threshold once. The tests run
//! random networks with the driver on tinyODIN's model, and compare the spikes with those of plain arithmetic.

use proptest::prelude::*;
use silicon::Board;
use spikewire_chips::{
    Describe, Input, Steps, StepsLayer, StepsState, TinyOdin, TinyOdinInput, TinyOdinNeuron,
};

/// A neuron of the reference: the test's own computation of the network, with which the chip's spikes must agree.
/// `potential` leaves out the offset by which the chip lowers all potentials during a step.
#[derive(Clone, Debug)]
struct Neuron {
    threshold: i32,
    leak: i32,
    /// The neuron's rung: the amount by which each event that raises the layer raises this neuron's potential.
    rung: i32,
    /// Number of leaks that act only on this neuron, at the end of each step in which it fires.
    own: u16,
    /// Weights from the previous layer or, in the first layer, from the inputs. Each sender has one weight for each
    /// entry of [`Net::rows`]; the weights of the first sender come first. Contains no weights from the bias or from
    /// the neuron's own layer.
    weights: Vec<i8>,
    bias: Vec<i8>,
    own_weights: Vec<i8>,
    potential: i32,
}

#[derive(Clone, Debug)]
struct Net {
    inputs: usize,
    has_bias: bool,
    /// Numbers of events that one spike sends: one number for each row of synapses of the input or neuron that spikes.
    rows: Vec<u16>,
    layers: Vec<(bool, Vec<Neuron>)>,
    /// Number of rungs (see [`Neuron::rung`]) by which the chip keeps each potential below that of the reference
    /// between two steps.
    below: u16,
    /// Number of rungs by which each threshold on the chip lies above that of the reference.
    above: u16,
    leaks: Vec<Vec<u16>>,
    lift: u16,
}

fn towards(potential: i32, centre: i32, by: i32) -> i32 {
    let away = potential - centre;
    centre + away.signum() * (away.abs() - by).max(0)
}

impl Net {
    /// Runs a step. Returns the neurons that fire, as one list for each layer. `before` holds these lists of the
    /// previous step.
    fn step(&mut self, step: usize, inputs: &[u16], before: &[Vec<u16>]) -> Vec<Vec<u16>> {
        let [below, above, lift] = [self.below, self.above, self.lift].map(i32::from);
        let rows = &self.rows;
        let sum = |weights: &[i8], from: u16| -> i32 {
            let own = &weights[usize::from(from) * rows.len()..];
            rows.iter().zip(own).map(|(&times, &weight)| i32::from(times) * i32::from(weight)).sum()
        };
        let mut drive = inputs.to_vec();
        let mut fired = Vec::new();
        for ((loops, neurons), before) in self.layers.iter_mut().zip(before) {
            let mut own = Vec::new();
            for (at, neuron) in (0..).zip(neurons) {
                let mut potential = neuron.potential;
                potential += drive.iter().map(|&from| sum(&neuron.weights, from)).sum::<i32>();
                if self.has_bias {
                    potential += sum(&neuron.bias, 0);
                }
                if *loops {
                    potential +=
                        before.iter().map(|&from| sum(&neuron.own_weights, from)).sum::<i32>();
                }
                if potential >= neuron.threshold {
                    own.push(at);
                    // On the chip, a neuron that fires returns to 0 before all rungs have come. The other rungs then
                    // raise it: as many as fit into the excess over its threshold.
                    let beyond = (potential - neuron.threshold) / neuron.rung;
                    // If these rungs lead to the threshold again, the neuron fires again, which counts once.
                    let again = (neuron.threshold + above * neuron.rung - 1) / neuron.rung + 1;
                    let beyond = beyond % again;
                    potential = (beyond - above) * neuron.rung;
                }
                neuron.potential = potential;
            }
            drive.clone_from(&own);
            fired.push(own);
        }
        for ((_, neurons), fired) in self.layers.iter_mut().zip(&fired) {
            for (at, neuron) in (0..).zip(neurons) {
                let leaks = &self.leaks[step % self.leaks.len()];
                for fallen in leaks {
                    let centre = (i32::from(*fallen) - above) * neuron.rung;
                    neuron.potential = towards(neuron.potential, centre, neuron.leak);
                }
                if fired.contains(&at) {
                    for _ in 0..neuron.own {
                        let centre = (below - lift) * neuron.rung;
                        neuron.potential = towards(neuron.potential, centre, neuron.leak);
                    }
                }
            }
        }
        fired
    }

    fn neuron(&self, neuron: usize) -> Option<(usize, usize, &Neuron)> {
        let mut first = 0;
        for (layer, (_, neurons)) in self.layers.iter().enumerate() {
            if let Some(found) = neurons.get(neuron - first) {
                return Some((layer, neuron - first, found));
            }
            first += neurons.len();
        }
        None
    }

    /// Returns the weight from row `row` of tinyODIN's synapses to neuron `post`.
    fn row(&self, row: usize, post: usize) -> i8 {
        let (layer, _, neuron) = self.neuron(post).unwrap();
        let rows = self.rows.len();
        let mut at = row;
        let mut take = |count: usize| {
            let found = (at < count * rows).then_some(at);
            at = at.wrapping_sub(count * rows);
            found
        };
        if let Some(at) = take(self.inputs) {
            return if layer == 0 { neuron.weights[at] } else { 0 };
        }
        if let Some(at) = take(self.has_bias.into()) {
            return neuron.bias[at];
        }
        for (from, (loops, neurons)) in self.layers.iter().enumerate() {
            if from + 1 < self.layers.len()
                && let Some(at) = take(neurons.len())
            {
                return if layer == from + 1 { neuron.weights[at] } else { 0 };
            }
            if *loops && let Some(at) = take(neurons.len()) {
                return if layer == from { neuron.own_weights[at] } else { 0 };
            }
        }
        let rung = neuron.rung as i8;
        match at.checked_sub(self.layers.len()) {
            None => {
                if layer == at {
                    rung
                } else {
                    0
                }
            }
            Some(0) => -rung,
            Some(_) => rung,
        }
    }

    fn count(&self) -> usize {
        self.layers.iter().map(|(_, neurons)| neurons.len()).sum()
    }
}

/// The network in the form that the driver loads: each row of synapses is described as the row of an input, and there
/// are no recurrent weights. The second field is the number of rows.
struct Rows<'a>(&'a Net, u16);

impl Describe<TinyOdinInput> for Rows<'_> {
    fn neurons(&self) -> u16 {
        self.0.count() as u16
    }

    fn neuron(&self, neuron: u8) -> TinyOdinNeuron {
        let Some((_, _, neuron)) = self.0.neuron(neuron.into()) else {
            return TinyOdinNeuron::DISABLED;
        };
        let above = i32::from(self.0.above) * neuron.rung;
        TinyOdinNeuron {
            threshold: (neuron.threshold + above) as u16,
            leak: neuron.leak as u8,
            potential: (-i32::from(self.0.below) * neuron.rung) as i16,
            is_disabled: false,
        }
    }

    fn inputs(&self) -> u16 {
        self.1
    }

    fn virtual_input(&self, _: u16) -> Option<(u8, i8)> {
        None
    }

    fn input_weight(&self, input: u16, post: u8) -> i8 {
        self.0.row(input.into(), post.into())
    }

    fn is_recurrent(&self) -> bool {
        false
    }

    fn weight(&self, _: u8, _: u8) -> i8 {
        0
    }

    fn output(&self, neuron: u8) -> Option<u16> {
        Some(neuron.into())
    }
}

fn weights(count: usize) -> impl Strategy<Value = Vec<i8>> {
    prop::collection::vec(-3_i8..=3, count)
}

fn layer(
    from: usize,
    count: usize,
    rows: usize,
    has_bias: bool,
) -> impl Strategy<Value = (bool, Vec<Neuron>)> {
    let neuron = (
        (1..40, 0..5, 4..=7, 0..5_u16),
        weights(from * rows),
        weights(if has_bias { rows } else { 0 }),
        weights(count * rows),
    );
    let neuron = neuron.prop_map(|((threshold, leak, rung, own), weights, bias, own_weights)| {
        Neuron { threshold, leak, rung, own, weights, bias, own_weights, potential: 0 }
    });
    (any::<bool>(), prop::collection::vec(neuron, count))
}

prop_compose! {
    fn net()(
        (inputs, hidden, outputs, rows, has_bias) in (
            1..5_usize,
            0..6_usize,
            1..4_usize,
            prop::sample::select(vec![vec![1], vec![2], vec![1, 1], vec![2, 1]]),
            any::<bool>(),
        ),
    )(
        one in layer(inputs, if hidden > 0 { hidden } else { outputs }, rows.len(), has_bias),
        two in layer(hidden, outputs, rows.len(), has_bias),
        (above, lift) in (0..4_u16, 0..=20_u16),
        leaks in prop::collection::vec(prop::collection::btree_set(0..=20_u16, 0..4), 1..4),
        (inputs, rows, has_bias, is_deep) in Just((inputs, rows, has_bias, hidden > 0)),
    ) -> Net {
        let leaks = leaks.into_iter().map(|leaks| leaks.into_iter().collect()).collect();
        let layers = if is_deep { vec![one, two] } else { vec![one] };
        // A step adds at most 11 spikes of three events of weight 3, and seven leaks of 4: 127 in all, less than the 128
        // by which 32 rungs of 4 lower a neuron.
        Net { inputs, has_bias, rows, layers, below: 32, above, leaks, lift }
    }
}

proptest! {
    #![proptest_config(crate::cases(150))]

    #[test]
    fn each_neuron_compares_once_a_step(
        net in net(),
        recording in prop::collection::vec(prop::collection::btree_set(0..6_u16, 0..4), 1..20),
    ) {
        let mut plain = net.clone();
        let (rungs, leaks) = (net.above + net.below, &net.leaks);
        let leaks: Vec<&[u16]> = leaks.iter().map(Vec::as_slice).collect();
        let layers: Vec<StepsLayer> = net
            .layers
            .iter()
            .map(|(loops, all)| StepsLayer { neurons: all.len() as u16, loops: *loops })
            .collect();
        let own: Vec<u16> = net.layers.iter().flat_map(|(_, all)| all).map(|n| n.own).collect();
        let steps = Steps {
            inputs: net.inputs as u16,
            has_bias: net.has_bias,
            rows: &net.rows,
            layers: &layers,
            rungs,
            leaks: &leaks,
            lift: net.lift,
            own_leaks: &own,
        };
        let network = Rows(&net, steps.all_rows());

        let board = Board::<silicon::TinyOdin>::new(4, 1);
        let mut chip = TinyOdin::new(board.spi(), board.port(), TinyOdinInput::MAX_CLOCKS);
        let mut gated = chip.reset(&mut board.clone()).unwrap();
        gated.load(&network, |_| ()).unwrap();
        let mut running = gated.run(&network.registers()).unwrap();
        let (mut state, mut unmapped) = (StepsState::REST, 0);
        let mut before = vec![vec![]; net.layers.len()];
        for (at, inputs) in recording.iter().enumerate() {
            let mut fired = vec![];
            running.step(&steps, &mut state, inputs.iter().copied(), |n| fired.push(n)).unwrap();
            let known: Vec<u16> =
                inputs.iter().copied().filter(|input| usize::from(*input) < net.inputs).collect();
            unmapped += (inputs.len() - known.len()) as u32;
            before = plain.step(at, &known, &before);
            let mut first = 0;
            let mut expected = vec![];
            for (layer, own) in plain.layers.iter().zip(&before) {
                expected.extend(own.iter().map(|neuron| first + *neuron as u8));
                first += layer.1.len() as u8;
            }
            fired.sort_unstable();
            prop_assert_eq!(fired, expected, "step {}", at);
        }
        prop_assert_eq!(running.counters().unmapped_events, unmapped);
        let mut gated = running.gate(|_| ()).unwrap();
        for neuron in 0..net.count() {
            let (_, _, meant) = plain.neuron(neuron).unwrap();
            let held = gated.neuron(neuron as u8).unwrap().potential;
            prop_assert_eq!(i32::from(held), meant.potential - i32::from(net.below) * meant.rung);
        }
    }
}
