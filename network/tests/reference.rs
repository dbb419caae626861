//! Random networks of two layers, the first recurrent, are compared with a plain transcription, which has neither
//! blocks nor lists of spikes and shares no code with the crate: every bit of every potential must agree.

#![expect(
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::similar_names,
    reason = "a test may panic, and names are those of the form"
)]

use proptest::prelude::*;
use spikewire::{Event, Polarity, Tick};
use spikewire_network::{
    Cuba, Full, Layer, Li, Lif, Network, NoReset, OneToOne, Reset, Spikes, State, Subtract,
    SubtractLate, SubtractNoDelay, ToValue, ToValueHeld, ToValueLate, Weights,
};

/// A generator of random bits: arrays of thousands of weights are too large for proptest's strategies.
struct Bits(u32);

impl Bits {
    fn next(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0
    }

    /// Draws a number in -1..1, with few or with many binary digits.
    fn float(&mut self) -> f32 {
        (self.next() >> 8) as f32 / 8_388_608.0 - 1.0
    }
}

/// The rules, by name.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Rule {
    ToValue,
    ToValueLate,
    ToValueHeld,
    Subtract,
    SubtractLate,
    SubtractNoDelay,
    NoReset,
}

/// A number type with the operations of a neuron, each rounded.
trait Kind: Copy + PartialOrd + Default + std::fmt::Debug {
    type Decay: Copy;
    fn times(self, decay: Self::Decay) -> Self;
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
}

impl Kind for f32 {
    type Decay = f32;
    fn times(self, decay: f32) -> f32 {
        self * decay
    }
    fn add(self, other: f32) -> f32 {
        self + other
    }
    fn sub(self, other: f32) -> f32 {
        self - other
    }
}

/// Integers with room for any sum; all tests but one stay within the crate's range.
impl Kind for i64 {
    type Decay = i64;
    fn times(self, decay: i64) -> i64 {
        (self * decay).div_euclid(65_536)
    }
    fn add(self, other: i64) -> i64 {
        self + other
    }
    fn sub(self, other: i64) -> i64 {
        self - other
    }
}

/// A neuron as the documentation of the rules defines it.
#[derive(Clone, Copy, Debug)]
struct Plain<K: Kind> {
    current_decay: Option<K::Decay>,
    decay: K::Decay,
    bias: K,
    inner_bias: K,
    /// Threshold; `at_threshold` is whether it fires at it, and `reset` the value to which it returns.
    threshold: K,
    at_threshold: bool,
    reset: K,
}

impl<K: Kind> Plain<K> {
    fn is_above(&self, v: K) -> bool {
        v > self.threshold || self.at_threshold && v == self.threshold
    }

    fn step(&self, rule: Rule, v: &mut K, current: &mut K, sum: K) -> bool {
        let input = match self.current_decay {
            Some(decay) => {
                *current = current.times(decay).add(sum);
                current.add(self.inner_bias)
            }
            None => sum,
        };
        let fired_before = self.is_above(*v);
        let from = if rule == Rule::ToValueLate && fired_before { self.reset } else { *v };
        let u = from.times(self.decay).add(input);
        let less = u.sub(self.threshold);
        let (next, fires) = match rule {
            Rule::ToValue if self.is_above(u) => (self.reset, true),
            Rule::Subtract if self.is_above(u) => (less, true),
            Rule::ToValue | Rule::Subtract => (u, false),
            Rule::ToValueLate | Rule::NoReset => (u, self.is_above(u)),
            Rule::ToValueHeld => {
                let v = if fired_before { self.reset } else { u };
                (v, self.is_above(v))
            }
            Rule::SubtractLate => {
                let v = if fired_before { less } else { u };
                (v, self.is_above(v))
            }
            Rule::SubtractNoDelay => {
                let fires = self.is_above(if fired_before { less } else { u });
                (if fires { less } else { u }, fires)
            }
        };
        *v = next;
        fires
    }
}

/// Runs a step of a layer; `weights` and `own` have rows by input.
fn plain_layer<K: Kind>(
    rule: Rule,
    neurons: &[Plain<K>],
    weights: &[Vec<K>],
    own: Option<&[Vec<K>]>,
    state: &mut [(K, K, bool)],
    input: &[u16],
) -> Vec<u16> {
    let before: Vec<usize> = (0..state.len()).filter(|&at| state[at].2).collect();
    let mut fired = Vec::new();
    for (at, neuron) in neurons.iter().enumerate() {
        let mut sum = neuron.bias;
        for row in input.iter().filter_map(|&input| weights.get(usize::from(input))) {
            sum = sum.add(row[at]);
        }
        for &row in own.iter().flat_map(|_| &before) {
            sum = sum.add(own.unwrap()[row][at]);
        }
        let (v, current, fires) = &mut state[at];
        *fires = neuron.step(rule, v, current, sum);
        if *fires {
            fired.push(at as u16);
        }
    }
    fired
}

/// Draws the inputs of a step, some of them twice, and some that do not exist.
fn inputs(bits: &mut Bits, all: usize) -> Vec<u16> {
    (0..bits.next() % 9).map(|_| (bits.next() as usize % (all + 1)) as u16).collect()
}

const IN: usize = 7;
const OUT: usize = 3;
const STEPS: usize = 60;

fn floats<R: Reset, const HIDDEN: usize>(
    rule: Rule,
    seed: u32,
    at_threshold: bool,
    with_current: bool,
) {
    let bits = &mut Bits(seed | 1);
    let mut rows = |count: usize, columns: usize| -> Vec<Vec<f32>> {
        (0..count).map(|_| (0..columns).map(|_| bits.float()).collect()).collect()
    };
    let (w, own, w_out) = (rows(IN, HIDDEN), rows(HIDDEN, HIDDEN), rows(HIDDEN, OUT));
    let mut plain = Vec::new();
    let hidden: [Lif<f32, R>; HIDDEN] = std::array::from_fn(|_| {
        // Thresholds that few sums hit exactly, and some that many do.
        let threshold = (bits.float() * 4.0).round() / 4.0 + 1.0;
        let (decay, bias) = (bits.float().abs(), bits.float() / 4.0);
        let subtracts = !matches!(rule, Rule::ToValue | Rule::ToValueLate | Rule::ToValueHeld);
        let reset = if subtracts { threshold } else { 0.0 };
        let zero = 0.0;
        plain.push(Plain {
            current_decay: None,
            decay,
            bias,
            inner_bias: zero,
            threshold,
            at_threshold,
            reset,
        });
        let neuron = Lif::<f32, R>::new(decay, threshold).with_bias(bias);
        if at_threshold { neuron.at_threshold() } else { neuron }
    });
    let outputs: [Li<f32>; OUT] = std::array::from_fn(|at| Li::<f32>::new(0.3 * at as f32));
    let plain_out: Vec<Plain<f32>> = (0..OUT)
        .map(|at| Plain {
            current_decay: None,
            decay: 0.3 * at as f32,
            bias: 0.0,
            inner_bias: 0.0,
            threshold: f32::INFINITY,
            at_threshold: false,
            reset: 0.0,
        })
        .collect();
    let array = |rows: &[Vec<f32>]| -> Vec<[f32; HIDDEN]> {
        rows.iter().map(|row| row.clone().try_into().unwrap()).collect()
    };
    let w_in = Weights::<f32, IN, HIDDEN>::new(&array(&w).try_into().unwrap());
    let back = Weights::<f32, HIDDEN, HIDDEN>::new(&array(&own).try_into().unwrap());
    let out_rows: Vec<[f32; OUT]> =
        w_out.iter().map(|row| row.clone().try_into().unwrap()).collect();
    let out = Weights::<f32, HIDDEN, OUT>::new(&out_rows.try_into().unwrap());
    let last = Layer::new(&out, &outputs);

    let steps: Vec<Vec<u16>> = (0..STEPS).map(|_| inputs(bits, IN)).collect();
    let mut expected = Vec::new();
    if with_current {
        for one in &mut plain {
            (one.current_decay, one.inner_bias, one.bias) = (Some(0.4), one.bias, 0.0);
        }
    }
    let (mut own_state, mut out_state) =
        (vec![(0.0, 0.0, false); HIDDEN], vec![(0.0, 0.0, false); OUT]);
    for input in &steps {
        let fired = plain_layer(rule, &plain, &w, Some(&own), &mut own_state, input);
        plain_layer(Rule::ToValue, &plain_out, &w_out, None, &mut out_state, &fired);
        let values: Vec<u32> = out_state.iter().map(|(v, ..)| v.to_bits()).collect();
        let potentials: Vec<u32> = own_state.iter().map(|(v, ..)| v.to_bits()).collect();
        expected.push((fired, potentials, values));
    }
    let unknown = steps.iter().flatten().filter(|&&input| usize::from(input) >= IN).count() as u32;
    macro_rules! compare {
        ($neurons:expr) => {{
            let network = Layer::new(&w_in, $neurons).recurrent(Full(&back)).then(last);
            let mut state = network.state();
            for (input, (fired, potentials, values)) in steps.iter().zip(&expected) {
                network.step(&mut state, input);
                assert_eq!(state.first.spikes(), fired);
                let bits = |values: &[f32]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
                assert_eq!(bits(state.first.values()), *potentials);
                assert_eq!(bits(state.values()), *values);
            }
            assert_eq!((state.rejected(), state.saturated()), (unknown, 0));
        }};
    }
    if with_current {
        let behind_currents = hidden.map(|neuron| Cuba::<f32, _>::new(0.4, neuron));
        compare!(&behind_currents);
    } else {
        compare!(&hidden);
    }
}

fn integers<R: Reset, const HIDDEN: usize>(rule: Rule, seed: u32, at_threshold: bool, shift: u32) {
    let bits = &mut Bits(seed | 1);
    let mut rows = |count: usize, columns: usize| -> Vec<Vec<i8>> {
        (0..count).map(|_| (0..columns).map(|_| (bits.next() >> 16) as i8).collect()).collect()
    };
    let (w, own) = (rows(IN, HIDDEN), rows(HIDDEN, HIDDEN));
    let mut plain: Vec<Plain<i64>> = Vec::new();
    let hidden: [_; HIDDEN] = std::array::from_fn(|_| {
        let threshold = (bits.next() % 200) as i32 + (90 << shift);
        let (decay, current_decay) = (bits.next() % 65_537, bits.next() % 60_000);
        let (bias, inner_bias) = ((bits.next() % 99) as i32 - 49, (bits.next() % 99) as i32 - 49);
        let subtracts = !matches!(rule, Rule::ToValue | Rule::ToValueLate | Rule::ToValueHeld);
        plain.push(Plain {
            current_decay: Some(current_decay.into()),
            decay: decay.into(),
            bias: bias.into(),
            inner_bias: inner_bias.into(),
            threshold: threshold.into(),
            at_threshold,
            reset: if subtracts { threshold.into() } else { 0 },
        });
        let neuron = Lif::<i32, R>::integer(decay, threshold).with_bias(inner_bias);
        let neuron = if at_threshold { neuron.at_threshold() } else { neuron };
        Cuba::<i32, _>::integer(current_decay, neuron).with_bias(bias)
    });
    let array = |rows: &[Vec<i8>]| -> Vec<[i8; HIDDEN]> {
        rows.iter().map(|row| row.clone().try_into().unwrap()).collect()
    };
    let w_in = Weights::<i32, IN, HIDDEN>::packed(&array(&w).try_into().unwrap(), shift);
    // The layer's own are shifted as the inputs' or otherwise.
    let own_shift = if seed.is_multiple_of(2) { shift } else { 4 - shift };
    let back = Weights::<i32, HIDDEN, HIDDEN>::packed(&array(&own).try_into().unwrap(), own_shift);
    let wide = |rows: &[Vec<i8>], shift: u32| -> Vec<Vec<i64>> {
        rows.iter().map(|row| row.iter().map(|&w| i64::from(w) << shift).collect()).collect()
    };
    let (w, own) = (wide(&w, shift), wide(&own, own_shift));
    let network = Layer::new(&w_in, &hidden).recurrent(Full(&back));
    let (mut state, mut plain_state) = (network.state(), vec![(0_i64, 0_i64, false); HIDDEN]);
    for step in 0..STEPS {
        let mut input = inputs(bits, IN);
        if step == 30 {
            // More than the sums of 16 bits hold at once.
            input = (0..700).map(|at| (at % IN) as u16).collect();
        }
        let fired = plain_layer(rule, &plain, &w, Some(&own), &mut plain_state, &input);
        assert_eq!(network.step(&mut state, &input), fired);
        let (values, currents): (Vec<i64>, Vec<i64>) =
            plain_state.iter().map(|&(v, i, _)| (v, i)).unzip();
        assert_eq!(state.values().iter().map(|&v| v.into()).collect::<Vec<i64>>(), values);
        assert_eq!(state.currents().map(i64::from).to_vec(), currents);
    }
    assert_eq!(state.saturated(), 0);
}

/// Runs a function with every rule.
macro_rules! every_rule {
    ($run:ident, $hidden:literal, $($arguments:expr),*) => {
        $run::<ToValue, $hidden>(Rule::ToValue, $($arguments),*);
        $run::<ToValueLate, $hidden>(Rule::ToValueLate, $($arguments),*);
        $run::<ToValueHeld, $hidden>(Rule::ToValueHeld, $($arguments),*);
        $run::<Subtract, $hidden>(Rule::Subtract, $($arguments),*);
        $run::<SubtractLate, $hidden>(Rule::SubtractLate, $($arguments),*);
        $run::<SubtractNoDelay, $hidden>(Rule::SubtractNoDelay, $($arguments),*);
        $run::<NoReset, $hidden>(Rule::NoReset, $($arguments),*);
    };
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// The sizes cover blocks of 16 neurons, groups of four and single neurons.
    #[test]
    fn floats_have_the_references_bits(seed: u32, at: bool, current: bool) {
        every_rule!(floats, 1, seed, at, current);
        every_rule!(floats, 16, seed, at, current);
        every_rule!(floats, 39, seed, at, current);
    }

    #[test]
    fn integers_are_the_references(seed: u32, at: bool, shift in 0_u32..=4) {
        every_rule!(integers, 1, seed, at, shift);
        every_rule!(integers, 16, seed, at, shift);
        every_rule!(integers, 39, seed, at, shift);
    }

    /// Potentials stay finite with any input, and inputs that are not accepted are counted.
    #[test]
    fn values_that_are_not_finite_are_counted(values in prop::collection::vec(any::<f32>(), 3)) {
        let weights = Weights::<f32, 3, 5>::new(&[[1e15; 5], [-1e15; 5], [0.5; 5]]);
        let neurons = [Li::<f32>::new(1.0); 5];
        let layer = Layer::new(&weights, &neurons).of_values();
        let mut state = layer.state();
        let values: [f32; 3] = values.try_into().unwrap();
        for _ in 0..9 {
            layer.step(&mut state, &values);
            prop_assert!(state.values().iter().all(|v| v.is_finite()));
        }
        let odd = values.iter().filter(|value| !value.is_finite() || value.abs() > 1e6).count();
        prop_assert_eq!(state.rejected(), 9 * odd as u32);
    }
}

#[test]
fn nan_and_infinities_count_as_zero() {
    let weights = Weights::<f32, 2, 1>::new(&[[2.0], [3.0]]);
    let neurons = [Li::<f32>::new(0.0)];
    let layer = Layer::new(&weights, &neurons).of_values();
    let mut state = layer.state();
    for (odd, rejected) in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1.1e6].into_iter().zip(1..)
    {
        layer.step(&mut state, &[odd, 5.0]);
        assert_eq!((state.values(), state.rejected()), (&[15.0][..], rejected));
    }
}

#[test]
fn integers_saturate_and_count_it() {
    let weights = Weights::<i32, 1, 17>::packed(&[[-128; 17]], 10);
    let neurons = [Li::<i32>::integer(65_536); 17];
    let layer = Layer::new(&weights, &neurons);
    let mut state = layer.state();
    // 4096 spikes reach the end of the range at once, and stay there.
    let most = [0; 4096];
    layer.step(&mut state, &most);
    assert_eq!((state.values()[0], state.saturated()), (-(1 << 29), 0));
    layer.step(&mut state, &most);
    assert_eq!((state.values(), state.saturated()), (&[-(1 << 29); 17][..], 17));
    // More spikes than a step takes are rejected.
    layer.step(&mut state, &[0; 4100]);
    assert_eq!((state.rejected(), state.saturated()), (4, 34));
}

#[test]
fn integers_take_values_and_divide_by_the_shift() {
    let weights = Weights::<i32, 2, 5>::packed(&[[100; 5], [-3; 5]], 4);
    let neurons = [Li::<i32>::integer(0); 5];
    let layer = Layer::new(&weights, &neurons).of_values();
    let mut state = layer.state();
    layer.step(&mut state, &[1_000, 7]);
    assert_eq!(*state.values(), [(100_000 - 21) >> 4; 5]);
}

#[test]
fn bad_parameters_are_refused() {
    for weight in [f32::NAN, f32::INFINITY, -2e15] {
        let error = Weights::<f32, 2, 3>::try_new(&[[0.0; 3], [0.0, weight, 0.0]]).unwrap_err();
        assert_eq!((error.parameter, error.place), ("weight", (1, 1)));
    }
    for decay in [f32::NAN, -0.1, 1.1] {
        assert_eq!(Lif::<f32, ToValue>::try_new(decay, 1.0).unwrap_err().parameter, "decay");
        assert!(Li::<f32>::try_new(decay).is_err());
    }
    assert_eq!(Lif::<f32, ToValue>::try_new(0.5, f32::NAN).unwrap_err().parameter, "threshold");
    assert!(Lif::<f32, ToValue>::new(0.5, 1.0).try_with_bias(f32::INFINITY).is_err());
    assert!(Lif::<i32, ToValue>::try_integer(65_537, 1).is_err());
    assert!(Lif::<i32, ToValue>::try_integer(65_536, (1 << 27) + 1).is_err());
    let error = Lif::<i32, ToValue>::try_integer(65_537, 1).unwrap_err();
    assert_eq!(error.to_string(), "decay 65537 at row 0, column 0 must lie in 0..=65536");
}

/// A change of one bit of a weight or of a neuron changes the checksum, as does another order.
#[test]
fn every_bit_is_in_the_checksum() {
    type Neurons = [Cuba<f32, Lif<f32, ToValue>>; 2];
    let sum = |numbers: [f32; 7]| {
        let [a, b, c, current, decay, threshold, reset] = numbers;
        let (weights, own) = (Weights::new(&[[a, b]]), Weights::new(&[[c, a]]));
        let lif = Lif::<f32, ToValue>::try_new(decay, threshold).ok()?.with_reset(reset);
        let neurons: Neurons = [Cuba::<f32, _>::try_new(current, lif).ok()?; 2];
        Some(Layer::new(&weights, &neurons).recurrent(OneToOne(&own)).checksum())
    };
    let numbers = [0.5_f32, -3.25, 1e-3, 0.25, 0.75, 1.5, 0.125];
    let (known, mut told) = (sum(numbers).unwrap(), 0);
    assert_eq!(sum(numbers), Some(known));
    for place in 0..numbers.len() {
        for bit in 0..32 {
            let mut flipped = numbers;
            flipped[place] = f32::from_bits(flipped[place].to_bits() ^ 1 << bit);
            if flipped[place].is_nan() || flipped[place].abs() > 1e15 {
                continue;
            }
            if let Some(sum) = sum(flipped) {
                assert_ne!(sum, known, "number {place}, bit {bit}");
                told += 1;
            }
        }
    }
    assert!(told > 150, "{told}");
    let mut swapped = numbers;
    swapped.swap(0, 1);
    assert_ne!(sum(swapped), Some(known));

    let neurons = [Li::<i32>::integer(65_536); 2];
    let sum = |rows, shift| Layer::new(&Weights::packed(&rows, shift), &neurons).checksum();
    for bit in 0..8 {
        let flipped = (5 ^ 1 << bit) as u8 as i8;
        assert_ne!(sum([[3, flipped], [0, -1]], 2), sum([[3, 5], [0, -1]], 2));
    }
    assert_ne!(sum([[3, 5], [0, -1]], 3), sum([[3, 5], [0, -1]], 2));
}

/// A layer that is given the state of another one, of the same type, does not go on from it, and counts it.
#[test]
fn states_of_other_networks_are_not_taken() {
    let (one, other) = (Weights::new(&[[1.0, 2.0]]), Weights::new(&[[10.0, 20.0]]));
    let neurons = [Li::<f32>::new(1.0); 2];
    let (one, other) = (Layer::new(&one, &neurons), Layer::new(&other, &neurons));
    let mut state = one.state();
    for _ in 0..3 {
        one.step(&mut state, &[0]);
    }
    assert_eq!((state.values(), state.rejected()), (&[3.0, 6.0][..], 0));
    other.step(&mut state, &[0]);
    assert_eq!((state.values(), state.rejected()), (&[10.0, 20.0][..], 1));
    other.step(&mut state, &[0]);
    assert_eq!((state.values(), state.rejected()), (&[20.0, 40.0][..], 1));
    // A copy of the network is the same one.
    let copy = other;
    copy.step(&mut state, &[0]);
    assert_eq!((state.values(), state.rejected()), (&[30.0, 60.0][..], 1));
}

/// Nor are its currents, and the spikes that act on a recurrent layer. Other neurons make another layer, and a chain counts
/// the states that its second layer refused.
#[test]
fn currents_and_spikes_of_other_networks_are_not_taken() {
    let weights = Weights::new(&[[1.0]]);
    let back = Weights::new(&[[10.0]]);
    let neuron = Cuba::<f32, _>::new(1.0, Lif::<f32, ToValue>::new(1.0, 0.5));
    let (neurons, others) = ([neuron], [neuron]);
    let one = Layer::new(&weights, &neurons).recurrent(Full(&back));
    let other = Layer::new(&weights, &others).recurrent(Full(&back));
    let mut state = one.state();
    assert_eq!(one.step(&mut state, &[0]), [0]);
    assert!(other.step(&mut state, &[]).is_empty());
    assert_eq!((state.values(), state.rejected()), (&[0.0][..], 1));

    let first = Layer::new(&weights, &others);
    let (chain, another) = (first.then(one), first.then(other));
    let mut state = chain.state();
    chain.step(&mut state, &[0]);
    assert_eq!(state.rejected(), 0);
    another.step(&mut state, &[0]);
    assert_eq!(state.rejected(), 1);
}

/// Numbers of inputs and addresses of events have 16 bits: those beyond are lost, and do not begin anew.
#[test]
fn addresses_do_not_wrap() {
    let event = |address| Event { tick: Tick::from(0), address, polarity: Polarity::Down };
    let mut spikes = Spikes::<4>::new();
    spikes.push_signed(event(32_768));
    assert_eq!((spikes.as_slice(), spikes.lost()), (&[][..], 1));
    spikes.push_signed(event(32_767));
    assert_eq!((spikes.as_slice(), spikes.lost()), (&[65_535][..], 1));
    spikes.clear();
    spikes.push(10);
    let last: Vec<u16> = spikes.events(5.into(), 65_525).map(|event| event.address).collect();
    assert_eq!(last, [65_535]);
    assert_eq!(spikes.events(5.into(), 65_526).count(), 0);
}

/// Sums of 16 bits hold the weights of 256 rows, and one more goes into another sum.
#[test]
fn sums_of_many_rows_are_exact() {
    for weight in [-128, 127] {
        let weights = Weights::<i32, 257, 9>::packed(&[[weight; 9]; 257], 0);
        let neurons = [Li::<i32>::integer(0); 9];
        let layer = Layer::new(&weights, &neurons);
        for count in 255..=257 {
            let mut state = layer.state();
            layer.step(&mut state, &(0..count).collect::<Vec<_>>());
            assert_eq!(*state.values(), [i32::from(weight) * i32::from(count); 9]);
        }
    }
}
