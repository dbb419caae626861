//! Tests of `Steps`: time steps in which each neuron compares its potential with its threshold once. The tests run
//! random networks with the driver on tinyODIN's model, and compare the spikes with those of plain arithmetic.

use std::cell::Cell;
use std::collections::BTreeSet;
use std::rc::Rc;

use proptest::prelude::*;
use silicon::Board;
use silicon::board::CallFault;
use spikewire_chips::{
    AerPort, ChipError, Describe, Input, Inputs, Steps, StepsLayer, StepsState, TinyOdin,
    TinyOdinInput, TinyOdinNetwork, TinyOdinNeuron, TinyOdinRegisters,
};

type Error = ChipError<embedded_hal::spi::ErrorKind, u64>;

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

    /// Returns the chip's numbers of neurons that are listed by layer.
    fn numbers(&self, fired: &[Vec<u16>]) -> Vec<u8> {
        let (mut first, mut numbers) = (0, vec![]);
        for ((_, neurons), fired) in self.layers.iter().zip(fired) {
            numbers.extend(fired.iter().map(|neuron| (first + neuron) as u8));
            first += neurons.len() as u16;
        }
        numbers
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

/// A network without a witness, as [`Rows`] loads it, and its description for the driver.
struct Described {
    layers: Vec<StepsLayer>,
    own_leaks: Vec<u16>,
}

impl Described {
    fn new(net: &Net) -> Self {
        let mut described = Self { layers: vec![], own_leaks: vec![] };
        for (loops, neurons) in &net.layers {
            let layer = StepsLayer { neurons: neurons.len() as u16, loops: *loops };
            described.layers.push(layer);
            described.own_leaks.extend(neurons.iter().map(|neuron| neuron.own));
        }
        described
    }

    fn steps<'a>(&'a self, net: &'a Net, leaks: &'a [&'a [u16]]) -> Steps<'a> {
        Steps {
            inputs: net.inputs as u16,
            has_bias: net.has_bias,
            rows: &net.rows,
            layers: &self.layers,
            rungs: net.above + net.below,
            leaks,
            lift: net.lift,
            own_leaks: &self.own_leaks,
        }
    }
}

/// Sizes of a network: small, or with 33 to 254 neurons, of one to three layers.
#[derive(Clone, Debug)]
struct Sizes {
    inputs: usize,
    layers: Vec<usize>,
    loops: Vec<bool>,
    rows: Vec<u16>,
    has_bias: bool,
}

impl Sizes {
    /// Number of rows of synapses that the chip needs.
    fn rows(&self) -> usize {
        let last = self.layers.len() - 1;
        let mut sources = self.inputs + usize::from(self.has_bias);
        for (at, neurons) in self.layers.iter().enumerate() {
            sources += neurons * (usize::from(at < last) + usize::from(self.loops[at]));
        }
        sources * self.rows.len() + self.layers.len() + 2
    }
}

fn sizes(layers: impl Strategy<Value = Vec<usize>>) -> impl Strategy<Value = Sizes> {
    let rows = prop::sample::select(vec![vec![1], vec![2], vec![1, 1], vec![2, 1]]);
    let sizes = (1..5_usize, layers, prop::collection::vec(any::<bool>(), 3), rows, any::<bool>());
    sizes.prop_map(|(inputs, layers, loops, rows, has_bias)| {
        let mut sizes = Sizes { inputs, layers, loops, rows, has_bias };
        // Gives up rows until the network fits the chip.
        for layer in (0..sizes.layers.len()).rev() {
            if sizes.rows() > 256 {
                sizes.loops[layer] = false;
            }
        }
        if sizes.rows() > 256 {
            sizes.rows.truncate(1);
        }
        sizes
    })
}

fn small() -> impl Strategy<Value = Sizes> {
    sizes(prop::collection::vec(1..6_usize, 1..4))
}

/// 33 to 254 neurons in three layers, of which the first two have up to 60 each: every neuron sends in one or two rows.
fn large() -> impl Strategy<Value = Sizes> {
    sizes((17..=60_usize, 17..=60_usize, 1..=134_usize).prop_map(|(a, b, c)| vec![a, b, c]))
}

/// Weights of -3 to 3, of which about `share` in 10 are not 0.
fn weights(count: usize, share: u32) -> impl Strategy<Value = Vec<i8>> {
    let weight = (0..10_u32, -3_i8..=3);
    let weight = weight.prop_map(move |(part, weight)| if part < share { weight } else { 0 });
    prop::collection::vec(weight, count)
}

fn layer(from: usize, count: usize, rows: usize, share: u32) -> impl Strategy<Value = Vec<Neuron>> {
    let neuron = (
        (1..40, 0..5, 4..=7, 0..5_u16),
        weights(from * rows, share),
        weights(rows, 10),
        weights(count * rows, share),
    );
    let neuron = neuron.prop_map(|((threshold, leak, rung, own), weights, bias, own_weights)| {
        Neuron { threshold, leak, rung, own, weights, bias, own_weights, potential: 0 }
    });
    prop::collection::vec(neuron, count)
}

/// The most that a step can add to a neuron's potential, and the most that it can take away, leaks left out.
struct Drive {
    up: i32,
    down: i32,
}

impl Net {
    fn drive(&self) -> Drive {
        let mut drive = Drive { up: 0, down: 0 };
        for (loops, neurons) in &self.layers {
            for neuron in neurons {
                let bias: &[i8] = if self.has_bias { &neuron.bias } else { &[] };
                let own: &[i8] = if *loops { &neuron.own_weights } else { &[] };
                let (mut up, mut down) = (0, 0);
                for weights in [&neuron.weights, bias, own] {
                    for (weight, times) in weights.iter().zip(self.rows.iter().cycle()) {
                        let weight = i32::from(*weight) * i32::from(*times);
                        up += weight.max(0);
                        down += (-weight).max(0);
                    }
                }
                drive = Drive { up: drive.up.max(up), down: drive.down.max(down) };
            }
        }
        drive
    }

    /// Number of steps after which a potential could reach the end of the chip's range, -2048.
    fn most_steps(&self) -> usize {
        let rung = i32::from(LARGEST_RUNG);
        let room = 2048 - i32::from(self.below + self.above) * rung;
        (room / (self.drive().down + LEAKS)).try_into().unwrap()
    }
}

const LARGEST_RUNG: u16 = 7;
/// Seven leaks of 4: the most by which the leaks of a step move a potential.
const LEAKS: i32 = 28;

prop_compose! {
    fn net(sizes: impl Strategy<Value = Sizes>, share: u32)(sizes in sizes)(
        layers in layers(&sizes, share),
        (above, lift) in (0..4_u16, 0..=20_u16),
        // The last place of all is drawn often.
        leaks in prop::collection::vec(prop::collection::btree_set(0..=24_u16, 0..4), 1..4),
        sizes in Just(sizes),
    ) -> Net {
        let Sizes { inputs, rows, has_bias, loops, .. } = sizes;
        let layers = loops.into_iter().zip(layers).collect();
        let mut net = Net { inputs, has_bias, rows, layers, below: 0, above, leaks: vec![], lift };
        // Rungs of 4 lower a neuron by more than a step adds.
        net.below = ((net.drive().up + LEAKS) / 4 + 1).try_into().unwrap();
        let rungs = net.above + net.below;
        // Leaks may have moved a potential upwards since it was compared: a lift must leave room for that.
        net.lift = net.lift.min(net.below - LEAKS as u16 / 4);
        let place = |leak: u16| if leak > 20 { rungs } else { leak.min(rungs) };
        let list = |leaks: std::collections::BTreeSet<u16>| leaks.into_iter().map(place).collect();
        net.leaks = leaks.into_iter().map(list).collect();
        net
    }
}

fn layers(sizes: &Sizes, share: u32) -> impl Strategy<Value = Vec<Vec<Neuron>>> + use<> {
    let rows = sizes.rows.len();
    let from = std::iter::once(&sizes.inputs).chain(&sizes.layers);
    let layers =
        from.zip(&sizes.layers).map(|(from, count)| layer(*from, *count, rows, share).boxed());
    layers.collect::<Vec<_>>()
}

fn recording(steps: std::ops::Range<usize>) -> impl Strategy<Value = Vec<BTreeSet<u16>>> {
    prop::collection::vec(prop::collection::btree_set(0..6_u16, 0..4), steps)
}

/// Runs a network on the chip's model and in plain arithmetic, and compares the spikes of each step and the potentials at the
/// end.
fn compare(net: &Net, recording: &[BTreeSet<u16>]) -> Result<(), TestCaseError> {
    let mut plain = net.clone();
    let leaks: Vec<&[u16]> = net.leaks.iter().map(Vec::as_slice).collect();
    let described = Described::new(net);
    let steps = described.steps(net, &leaks);
    let network = Rows(net, steps.all_rows());

    let board = Board::<silicon::TinyOdin>::new(4, 1);
    let mut chip = TinyOdin::new(board.spi(), board.port(), TinyOdinInput::MAX_CLOCKS);
    let mut gated = chip.reset(&mut board.clone()).unwrap();
    gated.load(&network, |_| ()).unwrap();
    let mut running = gated.run(&network.registers()).unwrap();
    let (mut state, mut unmapped) = (StepsState::REST, 0);
    let mut before = vec![vec![]; net.layers.len()];
    for (at, inputs) in recording.iter().take(net.most_steps()).enumerate() {
        let mut fired = vec![];
        running.step(&steps, &mut state, inputs.iter().copied(), |n| fired.push(n)).unwrap();
        let known: Vec<u16> =
            inputs.iter().copied().filter(|input| usize::from(*input) < net.inputs).collect();
        unmapped += (inputs.len() - known.len()) as u32;
        before = plain.step(at, &known, &before);
        fired.sort_unstable();
        prop_assert_eq!(fired, plain.numbers(&before), "step {}", at);
    }
    prop_assert_eq!(running.counters().unmapped_events, unmapped);
    let mut gated = running.gate(|_| ()).unwrap();
    for neuron in 0..net.count() {
        let (_, _, meant) = plain.neuron(neuron).unwrap();
        let held = gated.neuron(neuron as u8).unwrap().potential;
        prop_assert_eq!(i32::from(held), meant.potential - i32::from(net.below) * meant.rung);
    }
    Ok(())
}

proptest! {
    #![proptest_config(crate::cases(150))]

    #[test]
    fn each_neuron_compares_once_a_step(net in net(small(), 10), recording in recording(1..20)) {
        compare(&net, &recording)?;
    }
}

proptest! {
    #![proptest_config(crate::cases(6))]

    #[test]
    fn each_of_up_to_254_neurons_compares_once_a_step(
        net in net(large(), 2),
        recording in recording(2..6),
    ) {
        compare(&net, &recording)?;
    }
}

/// A network of three layers, which needs each part of a step: two rows, a bias, a recurrent layer, leaks at the last place,
/// own leaks and a lift.
fn deep() -> Net {
    let neuron = |threshold, weights: &[i8], own_weights: &[i8]| Neuron {
        threshold,
        leak: 1,
        rung: 7,
        own: 2,
        weights: weights.to_vec(),
        bias: vec![1, 1],
        own_weights: own_weights.to_vec(),
        potential: 0,
    };
    let one = vec![neuron(4, &[3, 1, -1, 2], &[]), neuron(3, &[0, 2, 3, 0], &[])];
    let two =
        vec![neuron(5, &[3, 1, 2, 0], &[-3, 1, 1, 0]), neuron(4, &[0, 2, 3, 1], &[0, 0, -2, 1])];
    let three = vec![neuron(6, &[3, 0, 2, 2], &[])];
    Net {
        inputs: 2,
        has_bias: true,
        rows: vec![2, 1],
        layers: vec![(false, one), (true, two), (false, three)],
        below: 8,
        above: 1,
        leaks: vec![vec![0, 9], vec![3]],
        lift: 3,
    }
}

/// Runs [`deep`] for three steps. The call of the port with the number `call`, counted from the first step, fails: the step
/// in which it does must end in its error, and all before it must have the right spikes. Returns false if the fault lay behind the
/// last step.
fn fails_at(net: &Net, call: u64, fault: CallFault) -> bool {
    let leaks: Vec<&[u16]> = net.leaks.iter().map(Vec::as_slice).collect();
    let described = Described::new(net);
    let steps = described.steps(net, &leaks);
    let network = Rows(net, steps.all_rows());
    let board = Board::<silicon::TinyOdin>::new(4, 1);
    let mut chip = TinyOdin::new(board.spi(), board.port(), TinyOdinInput::MAX_CLOCKS);
    let mut gated = chip.reset(&mut board.clone()).unwrap();
    gated.load(&network, |_| ()).unwrap();
    let mut running = gated.run(&network.registers()).unwrap();
    let failing = board.pins().calls + call;
    board.pins().call_faults.push_back((failing, fault));
    let (mut plain, mut state) = (net.clone(), StepsState::REST);
    let mut before = vec![vec![]; net.layers.len()];
    for (at, inputs) in [&[0_u16, 1][..], &[1], &[0]].into_iter().enumerate() {
        let mut fired = vec![];
        match running.step(&steps, &mut state, inputs.iter().copied(), |n| fired.push(n)) {
            Ok(()) => {
                assert!(
                    board.pins().calls <= failing,
                    "call {call} of step {at}: a swallowed fault"
                );
                before = plain.step(at, inputs, &before);
                fired.sort_unstable();
                assert_eq!(fired, plain.numbers(&before), "step {at}");
            }
            Err(error) => {
                assert_eq!(error, Error::Port(failing));
                return true;
            }
        }
    }
    false
}

fn faults(every: usize) {
    let net = deep();
    let mut count = 0;
    for call in (0_u64..).step_by(every) {
        let fault = if call % 2 == 0 { CallFault::Before } else { CallFault::After };
        if !fails_at(&net, call, fault) {
            break;
        }
        count += 1;
    }
    assert!(count * every > 1_000, "{count}");
}

#[test]
fn a_fault_of_a_call_ends_the_step_in_its_error() {
    faults(17);
}

#[test]
#[ignore = "takes a minute: run with --release"]
fn a_fault_of_any_call_ends_the_step_in_its_error() {
    faults(1);
}

/// A network of `N` neurons in one layer, with an input, and the rows that raise and lower.
const fn single<const N: usize>() -> TinyOdinNetwork<3, N, N> {
    let neuron = TinyOdinNeuron { threshold: 5, leak: 0, potential: -14, is_disabled: false };
    TinyOdinNetwork {
        neurons: [neuron; N],
        inputs: Inputs::Rows([[5; N], [7; N], [-7; N]]),
        recurrent: &[],
        outputs: [0; N],
    }
}

const LAYER: StepsLayer = StepsLayer { neurons: 3, loops: false };
const SINGLE: Steps = Steps {
    inputs: 1,
    has_bias: false,
    rows: &[1],
    layers: &[LAYER],
    rungs: 2,
    leaks: &[],
    lift: 0,
    own_leaks: &[],
};

/// Loads a network, and returns the results of a step with each description. No refused step may touch the pins.
fn step_of(network: &impl Describe<TinyOdinInput>, all: &[Steps]) -> Vec<Result<(), Error>> {
    let board = Board::<silicon::TinyOdin>::new(4, 1);
    let mut chip = TinyOdin::new(board.spi(), board.port(), TinyOdinInput::MAX_CLOCKS);
    let mut gated = chip.reset(&mut board.clone()).unwrap();
    gated.load(network, |_| ()).unwrap();
    let mut running = gated.run(&network.registers()).unwrap();
    let mut results = vec![];
    for steps in all {
        let before = board.pins().calls;
        let result = running.step(steps, &mut { StepsState::REST }, [0], |_| ());
        assert!(result.is_ok() || board.pins().calls == before);
        results.push(result);
    }
    results
}

fn refusal(result: Result<(), Error>) -> (&'static str, i64) {
    let Err(Error::OutOfRange { what, value, .. }) = result else { panic!("{result:?}") };
    (what, value)
}

#[test]
fn steps_that_need_the_neuron_of_the_probe_are_refused() {
    assert_eq!(step_with_layer(&single::<254>(), 254), Ok(()));
    assert_eq!(refusal(step_with_layer(&single::<254>(), 252)), ("neurons of steps", 252));
    assert_eq!(refusal(step_with_layer(&single::<255>(), 255)), ("neurons of steps", 255));
    assert_eq!(refusal(step_with_layer(&single::<256>(), 256)), ("neurons of steps", 256));
    // The witness would be the neuron of the probe.
    assert_eq!(refusal(step_with_layer(&single::<255>(), 254)), ("neurons of the network", 255));
}

fn step_with_layer(network: &impl Describe<TinyOdinInput>, neurons: u16) -> Result<(), Error> {
    let layers = [StepsLayer { neurons, loops: false }];
    step_of(network, &[Steps { layers: &layers, ..SINGLE }]).remove(0)
}

#[test]
fn steps_that_contradict_themselves_or_the_network_are_refused() {
    let wrong = [
        (Steps { rungs: 0, lift: 2, ..SINGLE }, ("rows of steps", 1)),
        (Steps { inputs: 2, ..SINGLE }, ("rows of steps", 4)),
        (Steps { lift: 1, ..SINGLE }, ("rows of steps", 4)),
        (
            Steps { layers: &[StepsLayer { neurons: 4, ..LAYER }], ..SINGLE },
            ("neurons of steps", 4),
        ),
        (Steps { leaks: &[&[1, 0]], ..SINGLE }, ("leak", 0)),
        (Steps { leaks: &[&[0], &[2, 3]], ..SINGLE }, ("leak", 3)),
        (Steps { own_leaks: &[1; 4], ..SINGLE }, ("own leaks", 4)),
    ];
    for (steps, expected) in wrong {
        assert_eq!(refusal(step_of(&single::<3>(), &[steps]).remove(0)), expected);
    }
    let good = [SINGLE, Steps { leaks: &[&[0, 0, 2], &[]], own_leaks: &[1, 2, 3], ..SINGLE }];
    assert_eq!(step_of(&single::<3>(), &good), [Ok(()), Ok(())]);

    // With no rungs there is nothing to lift from, also if the rows are there.
    let bare = TinyOdinNetwork {
        neurons: single::<3>().neurons,
        inputs: Inputs::Rows([[5; 3]]),
        recurrent: &[],
        outputs: [0, 1, 2],
    };
    let results = step_of(&bare, &[Steps { rungs: 0, lift: 2, ..SINGLE }]);
    assert_eq!(refusal(results[0]), ("lift", 2));
}

#[test]
fn steps_need_a_network_that_was_loaded_and_its_registers() {
    let network = single::<3>();
    let board = Board::<silicon::TinyOdin>::new(4, 1);
    let mut chip = TinyOdin::new(board.spi(), board.port(), TinyOdinInput::MAX_CLOCKS);
    let mut gated = chip.reset(&mut board.clone()).unwrap();
    gated.load(&network, |_| ()).unwrap();
    let good = network.registers();
    let others = [
        TinyOdinRegisters { is_open_loop: false, ..good },
        TinyOdinRegisters { last_neuron: 1, ..good },
    ];
    for registers in others {
        let mut running = chip.gated().unwrap().run(&registers).unwrap();
        let result = running.step(&SINGLE, &mut { StepsState::REST }, [0], |_| ());
        assert_eq!(result, Err(Error::OtherNetwork));
        running.gate(|_| ()).unwrap();
    }
    // A state of steps with more lists of leaks.
    let mut state = StepsState::REST;
    let mut running = chip.gated().unwrap().run(&good).unwrap();
    let two = Steps { leaks: &[&[], &[]], ..SINGLE };
    running.step(&two, &mut state, [], |_| ()).unwrap();
    assert_eq!(refusal(running.step(&SINGLE, &mut state, [], |_| ())), ("list of leaks", 1));

    // The last event is still at work.
    running.gate(|_| ()).unwrap();

    // A reset puts all memory in doubt; `verify` finds the network again.
    let gated = chip.reset(&mut board.clone()).unwrap();
    let mut running = gated.run(&good).unwrap();
    let result = running.step(&SINGLE, &mut { StepsState::REST }, [0], |_| ());
    assert_eq!(refusal(result), ("neurons of steps", 3));
    let mut gated = running.gate(|_| ()).unwrap();
    gated.verify(&network, |_| ()).unwrap();
    let mut running = gated.run(&good).unwrap();
    running.step(&SINGLE, &mut { StepsState::REST }, [0], |_| ()).unwrap();
}

/// A layer of twelve neurons and a witness.
const WATCHED: TinyOdinNetwork<4, 13, 12> = {
    let neuron = TinyOdinNeuron { threshold: 50, leak: 1, potential: -70, is_disabled: false };
    let mut network = TinyOdinNetwork {
        neurons: [neuron; 13],
        inputs: Inputs::Rows([[6; 13], [7; 13], [-7; 13], [7; 13]]),
        recurrent: &[],
        outputs: spikewire_chips::neurons_from::<0, 12>(),
    };
    network.neurons[12] = TinyOdinNeuron { threshold: 2047, leak: 0, ..neuron };
    if let Inputs::Rows(rows) = &mut network.inputs {
        rows[0][12] = 0;
    }
    network
};
const WATCHED_STEPS: Steps = Steps {
    layers: &[StepsLayer { neurons: 12, loops: false }],
    rungs: 10,
    leaks: &[&[0, 5, 10]],
    lift: 10,
    own_leaks: &[2; 12],
    ..SINGLE
};

/// A port during whose call with the number `at` the chip receives a reset pulse of three clock cycles.
struct Pulsed {
    board: Board<silicon::TinyOdin>,
    port: silicon::Port<silicon::TinyOdin>,
    at: Rc<Cell<Option<u64>>>,
}

impl Pulsed {
    fn port(&mut self) -> &mut silicon::Port<silicon::TinyOdin> {
        let mut pins = self.board.pins();
        if self.at.get() == Some(pins.calls) {
            self.at.set(None);
            pins.chip.set_reset(true);
            pins.chip.run(3);
            pins.chip.set_reset(false);
        }
        drop(pins);
        &mut self.port
    }
}

impl AerPort for Pulsed {
    type Error = u64;

    fn set_input(&mut self, word: u32) -> Result<(), u64> {
        self.port().set_input(word)
    }
    fn set_input_request(&mut self, is_high: bool) -> Result<(), u64> {
        self.port().set_input_request(is_high)
    }
    fn input_acknowledge(&mut self) -> Result<bool, u64> {
        self.port().input_acknowledge()
    }
    fn output_request(&mut self) -> Result<bool, u64> {
        self.port().output_request()
    }
    fn output(&mut self) -> Result<u8, u64> {
        self.port().output()
    }
    fn set_output_acknowledge(&mut self, is_high: bool) -> Result<(), u64> {
        self.port().set_output_acknowledge(is_high)
    }
    fn set_reset(&mut self, is_high: bool) -> Result<(), u64> {
        self.port().set_reset(is_high)
    }
}

/// The results of a step in which the chip may receive a reset pulse.
struct Pulse {
    is_ok: bool,
    /// The neurons of the layer after the step.
    neurons: Vec<u128>,
    /// Whether the witness differs from its first state.
    is_noticed: bool,
    /// Number of calls of the port in the step.
    calls: u64,
}

/// Runs two steps. In the second one, at the call of the port with the number `call`, the chip receives a reset pulse.
fn pulse(call: Option<u64>) -> Pulse {
    let board = Board::<silicon::TinyOdin>::new(4, 1);
    let at = Rc::new(Cell::new(None));
    let port = Pulsed { board: board.clone(), port: board.port(), at: at.clone() };
    let mut chip = TinyOdin::new(board.spi(), port, TinyOdinInput::MAX_CLOCKS);
    let mut gated = chip.reset(&mut board.clone()).unwrap();
    gated.load(&WATCHED, |_| ()).unwrap();
    let mut state = StepsState::REST;
    let mut running = gated.run(&WATCHED.registers()).unwrap();
    running.step(&WATCHED_STEPS, &mut state, [0], |_| ()).unwrap();
    let before = board.pins().calls;
    at.set(call.map(|call| before + call));
    let is_ok = running.step(&WATCHED_STEPS, &mut state, [0], |_| ()).is_ok();
    let calls = board.pins().calls - before;
    board.run(1_000);
    let neurons = board.pins().chip.neurons[..12].to_vec();
    let is_noticed = match running.check_witness(&WATCHED_STEPS, &WATCHED, |_| ()) {
        Ok(mut running) => {
            running.step(&WATCHED_STEPS, &mut state, [0], |_| ()).unwrap();
            false
        }
        Err(error) => {
            assert!(matches!(error, Error::ReadBack { .. } | Error::Handshake(_)), "{error}");
            true
        }
    };
    Pulse { is_ok, neurons, is_noticed, calls }
}

/// A reset pulse within a step often leaves wrong potentials without an error. The witness shows most of these.
#[test]
fn the_witness_shows_a_short_reset_within_a_step() {
    let clean = pulse(None);
    assert!(clean.is_ok && !clean.is_noticed);
    let [mut silent, mut noticed] = [0; 2];
    for call in (0..clean.calls).step_by(5) {
        let pulse = pulse(Some(call));
        if pulse.is_ok && pulse.neurons != clean.neurons {
            silent += 1;
            noticed += u32::from(pulse.is_noticed);
        }
    }
    println!("{silent} resets without an error, of which the witness shows {noticed}");
    assert!(silent > 20 && 10 * noticed > 6 * silent, "{noticed} of {silent}");

    // A network without a witness.
    let board = Board::<silicon::TinyOdin>::new(4, 1);
    let mut chip = TinyOdin::new(board.spi(), board.port(), TinyOdinInput::MAX_CLOCKS);
    let mut gated = chip.reset(&mut board.clone()).unwrap();
    gated.load(&single::<3>(), |_| ()).unwrap();
    let running = gated.run(&single::<3>().registers()).unwrap();
    let checked = running.check_witness(&SINGLE, &single::<3>(), |_| ());
    assert!(matches!(checked, Err(Error::OutOfRange { value: 3, min: 4, max: 4, .. })));
    assert!(chip.running().is_ok(), "the chip runs on");
}
