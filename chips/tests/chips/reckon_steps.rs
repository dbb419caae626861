//! Tests of `ReckOnSteps`: drawn networks in steps of one to four ticks, on the model of the chip, against plain arithmetic
//! written from the documentation of `ReckOnSteps` and of the chip.

#![allow(clippy::needless_range_loop, reason = "a neuron's number is its column in several tables")]

use embedded_hal::spi::ErrorKind;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use silicon::board::CallFault;
use silicon::reckon::{Board, Port, Spi};
use spikewire_chips::{
    ChipError, DescribeReckOn, ReckOn, ReckOnOutputs, ReckOnPair, ReckOnSettings, ReckOnShared,
    ReckOnSteps, ReckOnStepsState, ReckOnTick,
};

type Chip = ReckOn<Spi, Port>;
type Error = ChipError<ErrorKind, u64>;

/// A drawn network, and the ticks of its steps.
#[derive(Clone, Debug)]
struct Net {
    /// Number of inputs of the network itself. The others belong to [`ticks`](Self::ticks).
    inputs: u16,
    pairs: Vec<ReckOnPair>,
    input_weights: Vec<Vec<i8>>,
    recurrent: Vec<Vec<i8>>,
    output_weights: Vec<Vec<i8>>,
    shared: ReckOnShared,
    /// For each tick, the inputs that always fire before it, and those that raise.
    ticks: Vec<[Vec<u8>; 2]>,
    late: u16,
}

impl DescribeReckOn for Net {
    fn neurons(&self) -> u16 {
        self.recurrent.len() as u16
    }
    fn inputs(&self) -> u16 {
        self.input_weights.len() as u16
    }
    fn outputs(&self) -> u16 {
        self.output_weights[0].len() as u16
    }
    fn pair(&self, pair: u16) -> ReckOnPair {
        self.pairs[usize::from(pair)]
    }
    fn input_weight(&self, input: u16, neuron: u16) -> i8 {
        self.input_weights[usize::from(input)][usize::from(neuron)]
    }
    fn recurrent_weight(&self, from: u16, to: u16) -> i8 {
        self.recurrent[usize::from(from)][usize::from(to)]
    }
    fn output_weight(&self, neuron: u16, output: u16) -> i8 {
        self.output_weights[usize::from(neuron)][usize::from(output)]
    }
    fn shared(&self) -> ReckOnShared {
        self.shared
    }
}

/// The kinds of outputs, without their units.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Spikes,
    Potentials,
    Leaky,
}

struct Draw(Pcg32);

impl Draw {
    fn below(&mut self, end: u32) -> u32 {
        self.0.next_u32() % end
    }

    /// Draws rows of weights of up to `most`, a third of which are not 0.
    fn rows(&mut self, rows: usize, columns: usize, most: i8) -> Vec<Vec<i8>> {
        let mut all = vec![vec![0; columns]; rows];
        for weight in all.iter_mut().flatten() {
            if self.below(3) == 0 {
                *weight = (self.below(2 * most as u32 + 1) as i32 - i32::from(most)) as i8;
            }
        }
        all
    }

    fn net(&mut self, kind: Kind, neurons: usize, outputs: usize, ticks: usize) -> Net {
        let inputs = 1 + self.below(6) as u16;
        // Each tick has an input that always fires and one that raises, and shares none with the others.
        let mut each = vec![];
        let mut next = inputs as u8;
        for _ in 0..ticks {
            each.push([vec![next], vec![next + 1]]);
            next += 2;
        }
        let pair = |draw: &mut Self| ReckOnPair {
            keep: 28_672 + draw.below(4_097) as u16,
            threshold: 100 + draw.below(300) as i16,
        };
        let (shift, keep, most) = match kind {
            Kind::Spikes => (7, 64, 0),
            Kind::Potentials => (3, 1 + self.below(120) as u8, 40),
            // The sum of all weights may be 16 382.
            Kind::Leaky => (1, 64, 127),
        };
        let mut output_weights = self.rows(neurons, outputs, most);
        if kind == Kind::Spikes {
            for output in 0..outputs {
                output_weights[neurons - 1 - output][output] = 64;
            }
        }
        Net {
            inputs,
            pairs: (0..neurons.div_ceil(2)).map(|_| pair(self)).collect(),
            input_weights: self.rows(next.into(), neurons, 127),
            recurrent: self.rows(neurons, neurons, 60),
            output_weights,
            shared: ReckOnShared {
                shifts: [1, 2, shift],
                keep,
                resets_to_zero: self.below(2) == 0,
            },
            ticks: each,
            late: self.below(6) as u16,
        }
    }
}

/// A network in plain arithmetic.
struct Plain<'a> {
    net: &'a Net,
    potentials: Vec<i32>,
    /// Whether each neuron fired at the last tick, and at the tick before that.
    fired: Vec<bool>,
    fired_before: Vec<bool>,
    /// The outputs' potentials on the chip, without an end of their range.
    outputs: Vec<i64>,
    /// The values of outputs that the driver leaks.
    leaky: Vec<f32>,
    has_run: bool,
}

impl<'a> Plain<'a> {
    fn new(net: &'a Net) -> Self {
        let (neurons, outputs) = (net.recurrent.len(), net.output_weights[0].len());
        Self {
            net,
            potentials: vec![0; neurons],
            fired: vec![false; neurons],
            fired_before: vec![false; neurons],
            outputs: vec![0; outputs],
            leaky: vec![0.0; outputs],
            has_run: false,
        }
    }

    /// Runs a tick. Neurons leak and fire, and the outputs leak to the answer, which is returned. Then inputs and spikes act.
    fn tick(&mut self, inputs: &[u8]) -> Vec<i64> {
        let Net { pairs, input_weights, recurrent, output_weights, shared, .. } = self.net;
        let [of_inputs, between, of_outputs] = shared.shifts;
        self.fired_before.clone_from(&self.fired);
        for (at, potential) in self.potentials.iter_mut().enumerate() {
            let ReckOnPair { keep, threshold } = pairs[at / 2];
            self.fired[at] = *potential >= i32::from(threshold);
            *potential = (*potential * i32::from(keep)) >> 15;
            if self.fired[at] {
                *potential =
                    if shared.resets_to_zero { 0 } else { *potential - i32::from(threshold) };
            }
        }
        for output in &mut self.outputs {
            *output = (*output * i64::from(shared.keep)) >> 7;
        }
        let answer = self.outputs.clone();
        for source in 0..input_weights.len().max(recurrent.len()) {
            let is_input = inputs.iter().any(|input| usize::from(*input) == source);
            let is_spike = self.fired.get(source).is_some_and(|fired| *fired);
            for (at, potential) in self.potentials.iter_mut().enumerate() {
                if is_input {
                    *potential += i32::from(input_weights[source][at]) << of_inputs;
                }
                if is_spike {
                    *potential += i32::from(recurrent[source][at]) << between;
                }
                *potential = (*potential).clamp(i16::MIN.into(), i16::MAX.into());
            }
            if is_spike {
                for (at, output) in self.outputs.iter_mut().enumerate() {
                    *output += i64::from(output_weights[source][at]) << of_outputs;
                }
            }
        }
        answer
    }

    /// Runs a step, and returns the values of the outputs.
    fn step(&mut self, kind: Kind, inputs: &[u16], unit: f32, keeps: &[f32]) -> Vec<f32> {
        let ticks = self.net.ticks.len();
        let shown = usize::from(self.net.late) % ticks;
        let mut values = vec![];
        for (at, [always, raises]) in self.net.ticks.iter().enumerate() {
            let mut sent = always.clone();
            if at == 0 {
                sent.extend(inputs.iter().map(|input| *input as u8));
            }
            if self.has_run || at == ticks - 1 {
                sent.extend(raises);
            }
            let answer = self.tick(&sent);
            if at != shown {
                continue;
            }
            // The answer shows the spikes of the tick before.
            let weights = &self.net.output_weights;
            let senders: Vec<usize> =
                (0..weights.len()).filter(|at| self.fired_before[*at]).collect();
            for output in 0..answer.len() {
                let value = match kind {
                    Kind::Spikes => {
                        f32::from(u8::from(senders.iter().any(|at| weights[*at][output] != 0)))
                    }
                    Kind::Potentials => answer[output] as f32 * unit,
                    Kind::Leaky => {
                        let sum: i32 =
                            senders.iter().map(|at| i32::from(weights[*at][output])).sum();
                        let sum = sum << self.net.shared.shifts[2];
                        self.leaky[output] = self.leaky[output] * keeps[output] + sum as f32 * unit;
                        self.leaky[output]
                    }
                };
                values.push(value);
            }
        }
        self.has_run = true;
        values
    }
}

/// Runs `steps` steps on the model, and returns the number of spikes of outputs or values other than 0. If `fault` is a number of a
/// call of the port, counted from the first step, this call fails: the step in which it does must end in its error. Returns `None` if
/// the fault lay behind the last step.
fn compare(
    kind: Kind,
    net: &Net,
    steps: usize,
    draw: &mut Draw,
    fault: Option<(u64, CallFault)>,
) -> Option<usize> {
    let unit = 0.25;
    let outputs = net.output_weights[0].len();
    let keeps: Vec<f32> = (0..outputs).map(|at| 0.5 + at as f32 / 32.0).collect();
    let ticks: Vec<ReckOnTick> =
        net.ticks.iter().map(|[always, raises]| ReckOnTick { always, raises }).collect();
    let described = ReckOnSteps {
        inputs: net.inputs,
        ticks: &ticks,
        late: net.late,
        outputs: match kind {
            Kind::Spikes => ReckOnOutputs::Spikes,
            Kind::Potentials => ReckOnOutputs::Potentials { unit },
            Kind::Leaky => ReckOnOutputs::Leaky { unit, keeps: &keeps },
        },
    };
    let board = Board::new(10, 1);
    let mut chip = Chip::new(board.spi(), board.port(), 20_000);
    let mut programmed = chip.reset(&mut board.clone()).unwrap();
    programmed.load(net, |_| ()).unwrap();
    let mut sample = programmed.run(&ReckOnSettings::POTENTIALS).unwrap().begin().unwrap();
    let mut failing = None;
    if let Some((call, fault)) = fault {
        let call = board.pins().calls + call;
        failing = Some(call);
        board.pins().call_faults.push_back((call, fault));
    }
    let (mut state, mut plain, mut seen) = (ReckOnStepsState::REST, Plain::new(net), 0);
    for step in 0..steps {
        let inputs: Vec<u16> = (0..net.inputs).filter(|_| draw.below(2) == 0).collect();
        match sample.run(&described, &mut state, inputs.iter().copied()) {
            Ok(values) => {
                assert!(failing.is_none_or(|call| board.pins().calls <= call), "a swallowed fault");
                let expected = plain.step(kind, &inputs, unit, &keeps);
                assert_eq!(values[..outputs], expected, "{kind:?}, step {step}");
                assert_eq!(values[outputs..], [0.0; 16][outputs..]);
                assert_eq!(state.values(), values);
                seen += expected.iter().filter(|value| **value != 0.0).count();
            }
            Err(error) => {
                assert_eq!(error, Error::Port(failing.unwrap()), "{kind:?}, step {step}");
                return Some(seen);
            }
        }
    }
    failing.is_none().then_some(seen)
}

#[test]
fn steps_of_one_to_four_ticks_show_what_plain_arithmetic_shows() {
    let mut draw = Draw(Pcg32::seed_from_u64(61));
    for kind in [Kind::Spikes, Kind::Potentials, Kind::Leaky] {
        let mut seen = 0;
        for (neurons, outputs, ticks) in [(16, 16, 1), (40, 9, 2), (35, 16, 3), (18, 12, 4)] {
            let net = draw.net(kind, neurons, outputs, ticks);
            seen += compare(kind, &net, 40, &mut draw, None).unwrap();
        }
        assert!(seen > 200, "{kind:?}: {seen}");
    }
}

fn faults(every: usize) {
    for (kind, ticks) in [(Kind::Spikes, 2), (Kind::Potentials, 1), (Kind::Leaky, 3)] {
        let mut count = 0;
        for call in (0..).step_by(every) {
            let mut draw = Draw(Pcg32::seed_from_u64(5));
            let net = draw.net(kind, 4, 2, ticks);
            let fault = if call % 2 == 0 { CallFault::Before } else { CallFault::After };
            if compare(kind, &net, 3, &mut draw, Some((call as u64, fault))).is_none() {
                break;
            }
            count += 1;
        }
        assert!(count * every > 100, "{kind:?}: {count}");
    }
}

#[test]
fn a_fault_of_a_call_ends_the_step_in_its_error() {
    faults(41);
}

#[test]
#[ignore = "takes a minute: run with --release"]
fn a_fault_of_any_call_ends_the_step_in_its_error() {
    faults(1);
}

/// One input that fires all neurons, each with a weight to each of two outputs.
fn clipping(neurons: usize, shift: u8, keep: u8, weights: [i8; 2]) -> Net {
    Net {
        inputs: 1,
        pairs: vec![ReckOnPair { keep: 32_768, threshold: 100 }; neurons.div_ceil(2)],
        input_weights: vec![vec![100; neurons]],
        recurrent: vec![vec![0; neurons]; neurons],
        output_weights: vec![weights.to_vec(); neurons],
        shared: ReckOnShared { shifts: [0, 0, shift], keep, resets_to_zero: true },
        ticks: vec![[vec![], vec![]]],
        late: 2,
    }
}

/// Runs a network that fires in the first step, and returns the results of four steps.
fn run_clipping(net: &Net, outputs: ReckOnOutputs<'_>) -> Vec<Result<[f32; 2], Error>> {
    let board = Board::new(10, 1);
    let mut chip = Chip::new(board.spi(), board.port(), Chip::MAX_CLOCKS);
    let mut programmed = chip.reset(&mut board.clone()).unwrap();
    programmed.load(net, |_| ()).unwrap();
    let mut sample = programmed.run(&ReckOnSettings::POTENTIALS).unwrap().begin().unwrap();
    let ticks = [ReckOnTick { always: &[], raises: &[] }];
    let steps = ReckOnSteps { inputs: 1, ticks: &ticks, late: 2, outputs };
    let mut state = ReckOnStepsState::REST;
    let mut results = vec![];
    for step in 0..4 {
        let result = sample.run(&steps, &mut state, (step == 0).then_some(0));
        results.push(result.map(|values| [values[0], values[1]]));
    }
    results
}

/// A spike into four neurons with output weights of 127 and a shift of 7 adds 65 024, which the chip clips to 16 bits.
#[test]
fn outputs_that_leak_in_the_driver_cannot_clip() {
    let leaky = ReckOnOutputs::Leaky { unit: 1.0, keeps: &[0.5; 2] };
    for (neurons, shift, weights, sum) in
        [(4, 7, [0, 127], 65_024), (4, 7, [-128, 0], 65_536), (65, 1, [127, 0], 16_510)]
    {
        let results = run_clipping(&clipping(neurons, shift, 64, weights), leaky);
        let (what, max) = ("sum of output weights", 16_382);
        assert_eq!(results[0], Err(Error::OutOfRange { what, value: sum, min: 0, max }));
    }
    let results = run_clipping(&clipping(64, 1, 64, [127, -127]), leaky);
    assert_eq!(results[2], Ok([16_256.0, -16_256.0]));
    assert_eq!(results[3], Ok([8_128.0, -8_128.0]));
}

#[test]
fn a_potential_at_the_end_of_its_range_is_reported() {
    let potentials = ReckOnOutputs::Potentials { unit: 1.0 };
    let results = run_clipping(&clipping(4, 7, 64, [0, 127]), potentials);
    assert_eq!(results[1], Ok([0.0, 0.0]));
    assert_eq!(results[2], Err(Error::Clipped { output: 1 }));
    assert_eq!(results[3], Ok([0.0, 8191.0]), "it goes on, and decays");
    let results = run_clipping(&clipping(4, 7, 127, [-128, 0]), potentials);
    assert_eq!(results[2], Err(Error::Clipped { output: 0 }));
    let results = run_clipping(&clipping(2, 7, 64, [0, 127]), potentials);
    assert_eq!(results[2], Ok([0.0, 16_256.0]));
}

/// Weights of both signs in one tick, of which the first bring the potential to the end of its range: the answer shows no
/// trace of it. Weights whose sum of one sign stays within the range come out exactly, in either order.
#[test]
fn a_clip_hidden_by_weights_of_the_other_sign_is_the_documented_limit() {
    let potentials = ReckOnOutputs::Potentials { unit: 1.0 };
    // Four neurons with the first weight, then four with the second, shifted left by 7 bits.
    for (first, second, answer) in [
        // 4 x 16 256 are 65 024, clipped to 32 767. Less 65 024 that is -32 257, halved by the leak.
        (127, -127, -16_129.0),
        (-127, 127, 16_128.0),
        // 4 x 8064 are 32 256.
        (63, -63, 0.0),
        (-63, 63, 0.0),
        (63, -32, 7_936.0),
    ] {
        let mut net = clipping(8, 7, 64, [first, 0]);
        for neuron in 4..8 {
            net.output_weights[neuron][0] = second;
        }
        let results = run_clipping(&net, potentials);
        assert_eq!(results[2], Ok([answer, 0.0]), "{first} {second}");
        // The same in the driver's sums needs a smaller shift, and has the right answer.
        let mut net = clipping(8, 1, 64, [first, 0]);
        for neuron in 4..8 {
            net.output_weights[neuron][0] = second;
        }
        let leaky = ReckOnOutputs::Leaky { unit: 1.0, keeps: &[0.5; 2] };
        let sum = 8.0 * (f32::from(first) + f32::from(second));
        assert_eq!(run_clipping(&net, leaky)[2], Ok([sum, 0.0]), "{first} {second}");
    }
}

#[test]
fn steps_of_another_network_are_refused_before_anything_is_sent() {
    let net = clipping(4, 1, 64, [1, 2]);
    let board = Board::new(10, 1);
    let mut chip = Chip::new(board.spi(), board.port(), Chip::MAX_CLOCKS);
    let mut programmed = chip.reset(&mut board.clone()).unwrap();
    programmed.load(&net, |_| ()).unwrap();
    let mut sample = programmed.run(&ReckOnSettings::POTENTIALS).unwrap().begin().unwrap();
    let ticks = [ReckOnTick { always: &[], raises: &[] }];
    let leaky = ReckOnOutputs::Leaky { unit: 1.0, keeps: &[0.5; 2] };
    let good = ReckOnSteps { inputs: 1, ticks: &ticks, late: 2, outputs: leaky };
    let always = [ReckOnTick { always: &[1], raises: &[] }];
    let raises = [ReckOnTick { always: &[], raises: &[200] }];
    let short = ReckOnOutputs::Leaky { unit: 1.0, keeps: &[0.5] };
    let many = [ticks[0]; 256];
    let wrong = [
        (ReckOnSteps { inputs: 2, ..good }, "inputs of steps"),
        (ReckOnSteps { ticks: &always, ..good }, "input of a tick"),
        (ReckOnSteps { ticks: &raises, ..good }, "input of a tick"),
        (ReckOnSteps { ticks: &[], ..good }, "ticks"),
        (ReckOnSteps { ticks: &many, ..good }, "ticks"),
        (ReckOnSteps { outputs: short, ..good }, "keeps"),
        (ReckOnSteps { outputs: ReckOnOutputs::Spikes, ..good }, "shift of outputs"),
    ];
    let before = board.pins().calls;
    for (steps, name) in wrong {
        let error = sample.run(&steps, &mut { ReckOnStepsState::REST }, [0]).unwrap_err();
        assert!(matches!(error, Error::OutOfRange { what, .. } if what == name), "{name}: {error}");
    }
    assert_eq!(board.pins().calls, before);
    sample.run(&good, &mut { ReckOnStepsState::REST }, [0]).unwrap();
    for (shift, keep, name) in [(0, 64, "shift of outputs"), (1, 63, "keep of outputs")] {
        let results = run_clipping(&clipping(4, shift, keep, [1, 2]), leaky);
        assert!(matches!(results[0], Err(Error::OutOfRange { what, .. }) if what == name));
    }
    for keep in [0, 129] {
        let potentials = ReckOnOutputs::Potentials { unit: 1.0 };
        let results = run_clipping(&clipping(4, 1, keep, [1, 2]), potentials);
        assert!(matches!(results[0], Err(Error::OutOfRange { what: "keep of outputs", .. })));
    }

    // A reset clears the chip's registers.
    let programmed = chip.reset(&mut board.clone()).unwrap();
    let mut sample = programmed.run(&ReckOnSettings::POTENTIALS).unwrap().begin().unwrap();
    let error = sample.run(&good, &mut { ReckOnStepsState::REST }, [0]).unwrap_err();
    assert_eq!(error, Error::OtherNetwork);
}
